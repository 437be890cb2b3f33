//! Ranges and errors of the C header, and what calls its shared library: Python and C#.

use std::path::Path;
use std::process::Command;

use kufe_lut::{Interpolator, Mode, Point, Quantity, Table, binding_files};
use kufe_outside::{program, python};

use crate::c::run_c;
use crate::python::run_python;
use crate::tables::{sliding, table};

/// The header with its callers, and the shared library; None where there is no compiler.
fn library(folder: &Path, table: &Table) -> Option<()> {
    let mut compiler = program("cc")?;
    let [header, ctypes, csharp] = binding_files("front");
    let create = |file: &str| std::fs::File::create(folder.join(file)).unwrap();
    table
        .write_header("front", None, &mut create(&header))
        .unwrap();
    table.write_ctypes("front", &mut create(&ctypes)).unwrap();
    table.write_csharp("front", &mut create(&csharp)).unwrap();
    // The command that both files state.
    let printed = std::fs::read_to_string(folder.join(ctypes)).unwrap();
    let stated = printed
        .lines()
        .find_map(|line| line.trim().strip_prefix("cc "));
    let compiled = compiler
        .args(stated.unwrap().split(' '))
        .current_dir(folder)
        .output()
        .unwrap();
    let messages = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{messages}");
    Some(())
}

fn mu(table: &Table) -> f64 {
    let at = Point::sliding(1800.0, 0.013, 21.0, -4.5);
    let mu = Interpolator::new(table, Quantity::Mu, Mode::Smooth, None).unwrap();
    mu.at(at).value
}

#[test]
fn python_calls_the_shared_library_by_ctypes() {
    let Some(python) = python("ctypes") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let table = sliding(false);
    if library(folder.path(), &table).is_none() {
        return;
    }
    let printed = run_python(
        &python,
        folder.path(),
        "import front\n\
         x = 1800.0, 0.013, 21.0, -4.5\n\
         found, steep = front.mu_smooth(*x), front.mu_smooth_derivatives(*x)\n\
         assert steep.value == found.value and steep.out_of_range == found.out_of_range == 0\n\
         assert front.mu_smooth(*x[:3], -40.0).out_of_range == 1\n\
         h = 1e-3\n\
         slope = (front.mu_smooth(*x[:2], 21.0 + h, -4.5).value - front.mu_smooth(*x[:2], 21.0 - h, -4.5).value) / (2 * h)\n\
         assert abs(steep.d_v / slope - 1) < 1e-5, (steep.d_v, slope)\n\
         assert callable(front.film_mean_bilinear_derivatives)\n\
         print(repr(found.value))\n",
    );
    let value: f64 = printed.trim().parse().unwrap();
    assert!((value / mu(&table) - 1.0).abs() < 1e-13);
}

#[test]
fn csharp_calls_the_shared_library() {
    if program("mcs").is_none() || program("mono").is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let table = sliding(false);
    if library(folder.path(), &table).is_none() {
        return;
    }
    let main = "using System;\nusing System.Globalization;\n\
         class Program {\n  static void Main() {\n    \
         var found = front.mu_smooth(1800.0, 0.013, 21.0, -4.5);\n    \
         var steep = front.mu_smooth_derivatives(1800.0, 0.013, 21.0, -4.5);\n    \
         var outside = front.p_max_bilinear(1e6, 0.013, 21.0, -4.5);\n    \
         Console.WriteLine(string.Format(CultureInfo.InvariantCulture, \"{0:R} {1} {2} {3:R} {4}\",\n      \
         found.value, found.out_of_range, steep.value == found.value, steep.d_fz, outside.out_of_range));\n  }\n}\n";
    std::fs::write(folder.path().join("main.cs"), main).unwrap();
    let run = |name: &str, arguments: &[&str]| {
        let mut command = Command::new(name);
        command.args(arguments).current_dir(folder.path());
        // The runtime of Mono looks libraries up where the system does.
        let ran = command
            .env("LD_LIBRARY_PATH", folder.path())
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&ran.stderr).into_owned();
        assert!(ran.status.success(), "{name}: {error}");
        String::from_utf8(ran.stdout).unwrap()
    };
    run("mcs", &["-out:main.exe", "main.cs", "front.cs"]);
    let printed = run("mono", &["main.exe"]);
    let words: Vec<&str> = printed.split_whitespace().collect();
    let value: f64 = words[0].parse().unwrap();
    assert!((value / mu(&table) - 1.0).abs() < 1e-13, "{printed}");
    assert_eq!(
        [words[1], words[2], words[4]],
        ["0", "True", "1"],
        "{printed}"
    );
    let slope: f64 = words[3].parse().unwrap();
    assert!(slope.is_finite() && slope != 0.0, "{printed}");
}

#[test]
fn the_header_states_ranges_rules_and_errors() {
    let folder = tempfile::tempdir().unwrap();
    let table = table(false);
    let mut file = std::fs::File::create(folder.path().join("front.h")).unwrap();
    table.write_header("front", None, &mut file).unwrap();
    let main = "#include <stdio.h>\n#include \"front.h\"\n\
         int main(void) {\n  \
         printf(\"%g %g %g %g %d\\n\", FRONT_FZ_N_MIN, FRONT_FZ_N_MAX, FRONT_CURVATURE_1PM_MIN, FRONT_CURVATURE_1PM_MAX,\n    \
         FRONT_FZ_N_OUTSIDE == KUFE_LUT_HOLD);\n  \
         printf(\"%.17g %.17g %.17g %d\\n\", front_p_max_errors.solver, front_p_max_errors.smooth, front_p_max_errors.bilinear,\n    \
         isnan(front_area_errors.solver) != 0);\n  return 0;\n}\n";
    std::fs::write(folder.path().join("main.c"), main).unwrap();
    let Some(printed) = run_c(folder.path(), "main.c", &[], "") else {
        return;
    };
    let (ranges, errors) = printed.split_once('\n').unwrap();
    assert_eq!(ranges, "200 8000 -0.02 0.028 1");
    let measured = |mode| {
        let error = table.interpolation_error(Quantity::PMax, mode).unwrap();
        error.unwrap().max
    };
    let stated: Vec<f64> = errors
        .split_whitespace()
        .map(|word| word.parse().unwrap())
        .collect();
    let no_area = f64::from(u8::from(table.solver_error_of(Quantity::Area).is_none()));
    let expected = [
        table.solver_error(),
        measured(Mode::Smooth),
        measured(Mode::Bilinear),
        no_area,
    ];
    assert_eq!(stated, expected);
}
