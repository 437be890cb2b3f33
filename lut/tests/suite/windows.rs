//! The FMUs' library for Windows, loaded and called under Wine.

use std::io::Read as _;
use std::path::Path;
use std::process::Command;

use kufe_lut::{Fmi, Interpolator, Mode, Outside, Point, Quantity, Table, read_fmu};
use kufe_outside::{missing, program};

use crate::tables::{reduced, table};

/// Loads the library named first and prints the peak pressure and the flag at a force and a
/// curvature, by the functions of FMI 2.0 and of FMI 3.0.
const CALLER: &str = r#"
#include <windows.h>
#include <stdio.h>
#include <stdlib.h>
#include "fmi2.h"
#include "fmi3.h"

static void said2(void *e, const char *n, fmi2Status s, const char *c, const char *m, ...) {
  (void)e; (void)n; (void)s; (void)c; (void)m;
  fprintf(stderr, "message\n");
}
static void said3(void *e, fmi3Status s, const char *c, const char *m) {
  (void)e; (void)s; (void)c;
  fprintf(stderr, "%s\n", m);
}

int main(int count, char **words) {
  HMODULE library = LoadLibraryA(words[1]);
  const unsigned inputs[] = { 1, 4 }, pressure[] = { 5 }, flag[] = { 6 }, use[] = { 7 };
  const int yes[] = { 1 };
  const bool yes3[] = { true };
  double x[2], p[2];
  int outside2[1];
  bool outside3[1];
  if (count != 5 || !library) return 1;
#define FROM(Result, name, ...) Result (*name)(__VA_ARGS__) = (Result (*)(__VA_ARGS__))(void (*)(void))GetProcAddress(library, #name)
  FROM(fmi2Component, fmi2Instantiate, fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, int, int);
  FROM(fmi2Status, fmi2SetReal, fmi2Component, const unsigned *, size_t, const double *);
  FROM(fmi2Status, fmi2GetReal, fmi2Component, const unsigned *, size_t, double *);
  FROM(fmi2Status, fmi2SetBoolean, fmi2Component, const unsigned *, size_t, const int *);
  FROM(fmi2Status, fmi2GetBoolean, fmi2Component, const unsigned *, size_t, int *);
  FROM(fmi3Instance, fmi3InstantiateCoSimulation, fmi3String, fmi3String, fmi3String, bool, bool, bool, bool, const unsigned *, size_t, void *, fmi3LogMessageCallback, fmi3IntermediateUpdateCallback);
  FROM(fmi3Status, fmi3SetFloat64, fmi3Instance, const unsigned *, size_t, const double *, size_t);
  FROM(fmi3Status, fmi3GetFloat64, fmi3Instance, const unsigned *, size_t, double *, size_t);
  FROM(fmi3Status, fmi3SetBoolean, fmi3Instance, const unsigned *, size_t, const bool *, size_t);
  FROM(fmi3Status, fmi3GetBoolean, fmi3Instance, const unsigned *, size_t, bool *, size_t);
  fmi2CallbackFunctions functions = { said2, calloc, free, NULL, NULL };
  fmi2Component two = fmi2Instantiate("two", fmi2CoSimulation, words[2], words[3], &functions, 0, 0);
  fmi3Instance three = fmi3InstantiateCoSimulation("three", words[2], "a b\xc3\xbcro", false, false, false, false, NULL, 0, NULL, said3, NULL);
  FILE *file = fopen(words[4], "r");
  if (!two || !three || !file) return 2;
  fmi2SetBoolean(two, use, 1, yes);
  fmi3SetBoolean(three, use, 1, yes3, 1);
  while (fscanf(file, "%lf %lf", x, x + 1) == 2) {
    int wrong = fmi2SetReal(two, inputs, 2, x) | fmi2GetReal(two, pressure, 1, p) | fmi2GetBoolean(two, flag, 1, outside2);
    wrong |= (int)fmi3SetFloat64(three, inputs, 2, x, 2) | (int)fmi3GetFloat64(three, pressure, 1, p + 1, 1);
    wrong |= (int)fmi3GetBoolean(three, flag, 1, outside3, 1);
    printf("%.17g %.17g %d %d %d\n", p[0], p[1], outside2[0], (int)outside3[0], wrong);
  }
  return 0;
}
"#;

#[test]
fn the_library_for_windows_computes_what_rust_computes() {
    let (Some(mut compiler), Some(mut wine)) = (program("x86_64-w64-mingw32-gcc"), program("wine"))
    else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let table = reduced().with_outside(kufe_lut::AxisKind::Fz, Outside::Linear);
    let mut fmu = Vec::new();
    table.write_fmu("front", None, Fmi::V2, &mut fmu).unwrap();
    let read = read_fmu(std::io::Cursor::new(&fmu)).unwrap();
    if !read.platforms.contains(&"win64".to_string()) {
        missing("kufe-lut was built without MinGW-w64");
        return;
    }
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(&fmu)).unwrap();
    // A space and letters beyond ASCII: FMI 2.0 gives a URI, FMI 3.0 a path in UTF-8.
    let resources = folder.path().join("a büro");
    std::fs::create_dir(&resources).unwrap();
    let mut extract = |name: &str, to: &Path| {
        let mut bytes = Vec::new();
        let mut entry = archive.by_name(name).unwrap();
        entry.read_to_end(&mut bytes).unwrap();
        std::fs::write(to, &bytes).unwrap();
        bytes
    };
    let described = extract("modelDescription.xml", &folder.path().join("description"));
    extract("resources/table.bin", &resources.join("table.bin"));
    extract(
        "binaries/win64/kufe_lut.dll",
        &folder.path().join("kufe_lut.dll"),
    );
    for file in ["fmi2.h", "fmi3.h"] {
        let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("c").join(file);
        std::fs::copy(here, folder.path().join(file)).unwrap();
    }
    std::fs::write(folder.path().join("caller.c"), CALLER).unwrap();
    let compiled = compiler
        .args([
            "-std=c99",
            "-Wall",
            "-Werror",
            "caller.c",
            "-o",
            "caller.exe",
        ])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let messages = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{messages}");

    let described = String::from_utf8(described).unwrap();
    let (_, guid) = described.split_once("guid=\"").unwrap();
    let points = [
        (250.0, 0.0),
        (1234.5, 0.0201),
        (20_000.0, 0.01),
        (700.0, 0.5),
    ];
    let given: Vec<String> = points
        .iter()
        .map(|(f, k)| format!("{f:e} {k:e}\n"))
        .collect();
    std::fs::write(folder.path().join("points"), given.concat()).unwrap();
    let path = resources.to_str().unwrap();
    let uri = format!(
        "file:///Z:{}",
        path.replace(' ', "%20").replace('ü', "%C3%BC")
    );
    let ran = wine
        .args(["caller.exe", "kufe_lut.dll", &guid[..64], &uri, "points"])
        .current_dir(folder.path())
        .env("WINEPREFIX", folder.path().join("wine"))
        .env("WINEDEBUG", "-all")
        // Names of files are UTF-8.
        .env("LC_ALL", "C.UTF-8")
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&ran.stdout).into_owned();
    let error = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{printed} {error}");
    let lookup = Interpolator::new(&table, Quantity::PMax, Mode::Smooth, None).unwrap();
    assert_eq!(printed.lines().count(), points.len(), "{printed}");
    for ((fz, curvature), line) in points.into_iter().zip(printed.lines()) {
        let own = lookup.at(Point::at_rest(fz, curvature));
        let row: Vec<f64> = line
            .split_whitespace()
            .map(|w| w.parse().unwrap())
            .collect();
        for value in &row[..2] {
            assert!((value / own.value - 1.0).abs() < 1e-13, "{line} {own:?}");
        }
        let flag = f64::from(u8::from(own.out_of_range));
        assert_eq!(row[2..], [flag, flag, 0.0], "{line}");
    }
}

#[test]
fn both_versions_hold_a_library_for_each_platform() {
    let platforms = |fmi| {
        let mut fmu = Vec::new();
        let table: Table = table(false);
        table.write_fmu("front", None, fmi, &mut fmu).ok()?;
        Some(read_fmu(std::io::Cursor::new(fmu)).unwrap().platforms)
    };
    let (Some(two), Some(three)) = (platforms(Fmi::V2), platforms(Fmi::V3)) else {
        missing("kufe-lut was built without a C compiler");
        return;
    };
    assert_eq!(two.len(), three.len());
    let windows = [
        two.contains(&"win64".to_string()),
        three.contains(&"x86_64-windows".to_string()),
    ];
    let compiler = Command::new("x86_64-w64-mingw32-gcc")
        .arg("--version")
        .output();
    if compiler.is_ok() {
        assert_eq!(windows, [true; 2], "{two:?} {three:?}");
    } else {
        assert_eq!(windows, [false; 2], "{two:?} {three:?}");
    }
}
