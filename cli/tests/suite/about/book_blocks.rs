//! The book's code blocks do what their pages state. The tutorial's are run by `.ci/commands`, Python's own page by the
//! Python package's tests.

use kufe_outside::missing;
use std::path::Path;
use std::process::Command;

use crate::kufe::{Bench, CASE};

/// The blocks of a page of the book in a language, in their order.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(page);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let fence = format!("\n```{language}\n");
    let found: Vec<String> = text
        .split(&fence)
        .skip(1)
        .map(|rest| rest.split("\n```").next().unwrap_or_default().to_owned())
        .collect();
    assert!(!found.is_empty(), "{page} has no block of {language}");
    found
}

/// Runs a block as a shell with `kufe` on its path; `None` where this machine has no bash.
fn shell(bench: &Bench, block: &str) -> Option<String> {
    let command = Path::new(env!("CARGO_BIN_EXE_kufe"));
    let folder = command.parent().expect("target/PROFILE");
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::iter::once(folder.to_owned()).chain(std::env::split_paths(&path));
    let Ok(output) = Command::new("bash")
        .args(["-euo", "pipefail", "-c", block])
        .env("PATH", std::env::join_paths(paths).expect("a path"))
        .current_dir(bench.folder.path())
        .output()
    else {
        missing("there is no bash");
        return None;
    };
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{block}\n{reported}");
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Runs a block in Python with `KUFE_PYTHON`, or reports which of its `modules` is missing.
fn python(bench: &Bench, modules: &str, block: &str) -> Option<String> {
    let output = Command::new(kufe_outside::python(modules)?)
        .args(["-c", block])
        .current_dir(bench.folder.path())
        .output()
        .expect("Python");
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{block}\n{reported}");
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn number(text: &str) -> f64 {
    text.trim()
        .parse()
        .unwrap_or_else(|_| panic!("{text}: expected a number"))
}

/// A peak pressure [Pa] of `front.lut`.
fn looked_up(bench: &Bench, fz: &str, curvature: &str, mode: &str) -> f64 {
    let words = [
        "lut",
        "query",
        "front.lut",
        "--json",
        "--mode",
        mode,
        "--fz-n",
        fz,
        "--curvature-1pm",
        curvature,
    ];
    let answer: serde_json::Value = serde_json::from_str(&bench.succeeds(&words)).expect("JSON");
    answer["p_max_pa"].as_f64().expect("a pressure")
}

#[test]
fn the_table_of_the_book_is_made_in_shards_read_by_pandas_and_used_by_simulators() {
    let bench = Bench::new();
    bench.write("bob.toml", CASE);
    bench.write("table.toml", &blocks("tables.md", "toml")[0]);
    for block in blocks("tables.md", "sh") {
        if shell(&bench, &block).is_none() {
            return;
        }
    }
    let ours = looked_up(&bench, "500", "0.02", "bilinear");

    let block = &blocks("tables.md", "python")[0];
    let ask = format!("{block}\nprint(p_max.loc[500.0, 0.02])\nassert len(checks) > 0");
    if let Some(theirs) = python(&bench, "pandas", &ask) {
        assert_eq!(number(&theirs), ours);
    }

    bench.succeeds(&["lut", "export", "front.lut", "--header"]);
    let fragment = &blocks("tables.md", "c")[0];
    let (include, body) = fragment.split_once('\n').expect("two lines");
    let code = format!(
        "#include <stdio.h>\n{include}\nint main(void) {{\ndouble v = 30.0, pitch_rate = -0.6;\n{body}\n\
         printf(\"%.17g\", p.value);\nreturn !p.out_of_range;\n}}\n"
    );
    bench.write("use.c", code);
    if Command::new("cc").arg("--version").output().is_ok() {
        let theirs = shell(&bench, "cc -std=c99 -Wall use.c -o use -lm && ./use");
        let ours = looked_up(&bench, "1800", "0.02", "smooth");
        assert!(theirs.is_some_and(|theirs| (number(&theirs) / ours - 1.0).abs() < 1e-12));
    } else {
        missing("there is no cc");
    }

    if !bench
        .kufe(&["lut", "export", "front.lut", "--fmu"])
        .status
        .success()
    {
        missing("this kufe was built without a C compiler");
        return;
    }
    let block = &blocks("tables.md", "python")[1];
    let ask = format!("{block}\nprint(result[result.dtype.names[1]][0])");
    if let Some(theirs) = python(&bench, "fmpy, numpy", &ask) {
        let ours = looked_up(&bench, "1500", "0", "smooth");
        // FMPy remarks that the optional input `curvature` is not set.
        let value = number(theirs.lines().last().unwrap_or_default());
        assert!((value / ours - 1.0).abs() < 1e-9, "{theirs}");
    }
}

#[test]
fn the_books_elastic_runner_is_solved() {
    let bench = Bench::new();
    let ice = CASE.split_once("[ice]").expect("a table [ice]").1;
    let block = &blocks("theory.md", "toml")[0];
    bench.write(
        "case.toml",
        format!("{block}\n[ice]{ice}").replace("p_max = 0.02", "p_max = 0.1"),
    );
    bench.succeeds(&["press", "case.toml", "-o", "out"]);
    assert!(bench.path("out/runner.vtu").exists());
}

#[test]
fn an_effect_of_ones_own_is_read_as_the_book_writes_it() {
    let bench = Bench::new();
    bench.succeeds(&["init", "--kind", "model", "model.toml"]);
    bench.write(
        "track.csv",
        "s_m,slope_rad,curvature_1pm,bank_rad\n0,0.1,0,0\n50,0.1,0,0\n100,0.1,0,0\n150,0.1,0,0\n",
    );
    let model = std::fs::read_to_string(bench.path("model.toml")).expect("a model");
    let block = &blocks("effects.md", "toml")[0];
    let time = |own: &str| {
        bench.write("own.toml", format!("{model}\n{own}"));
        let words = ["simulate", "own.toml", "track.csv", "--no-noise", "--json"];
        bench.kufe(&words)
    };
    // A candidate at 0 changes nothing; a drag of its own slows the sled.
    let still = time(block);
    assert!(still.status.success(), "{still:?}");
    let slower = block
        .replace("v_mps^2 * abs(delta_rad)", "v_mps^2")
        .replace("value = 0.0", "value = -5.0");
    let slowed = time(&slower);
    assert!(slowed.status.success(), "{slowed:?}");
    assert_ne!(still.stdout, slowed.stdout);
    let wrong = time(&block.replace("v_mps^2", "v_mps^^2"));
    assert_eq!(wrong.status.code(), Some(3));
    let reported = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert!(
        reported.contains("own.toml") && reported.contains("my-drag"),
        "{reported}"
    );
}
