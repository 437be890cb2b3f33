//! The block for Simulink: its S-function compiled against a small stand-in for Simulink's headers,
//! its script run by Octave.

use std::fmt::Write as _;
use std::process::Command;

use kufe_lut::{Interpolator, Mode, Point, Quantity, Table, simulink_files};

use crate::c::run_c;
use crate::tables::{reduced, table};

/// What the S-function uses of Simulink's `simstruc.h`, as a struct of numbers.
const SIMSTRUC: &str = r#"
#ifndef SIMSTRUC
#define SIMSTRUC
#include <stdio.h>
typedef int int_T;
typedef double real_T;
typedef struct { double parameter; int parameters, inputs, outputs; double in[8], out[16]; double sample_time; } SimStruct;
#define INHERITED_SAMPLE_TIME -1.0
#define SS_OPTION_EXCEPTION_FREE_CODE 1
#define ssSetNumSFcnParams(S, n) ((S)->parameters = (n))
#define ssGetNumSFcnParams(S) ((S)->parameters)
#define ssGetSFcnParamsCount(S) 1
#define ssSetSFcnParamTunable(S, n, t) ((void)(S))
#define ssGetSFcnParam(S, n) (&(S)->parameter)
#define mxGetScalar(p) (*(p))
#define ssSetNumContStates(S, n) ((void)(S))
#define ssSetNumDiscStates(S, n) ((void)(S))
#define ssSetNumInputPorts(S, n) ((S)->inputs = (n))
#define ssSetInputPortWidth(S, n, w) ((void)(S), (void)(n))
#define ssSetInputPortDirectFeedThrough(S, n, w) ((void)(S))
#define ssSetInputPortRequiredContiguous(S, n, w) ((void)(S))
#define ssSetNumOutputPorts(S, n) ((S)->outputs = (n))
#define ssSetOutputPortWidth(S, n, w) ((void)(S), (void)(n))
#define ssSetNumSampleTimes(S, n) ((void)(S))
#define ssSetOptions(S, o) ((void)(S))
#define ssSetSampleTime(S, n, t) ((S)->sample_time = (t))
#define ssSetOffsetTime(S, n, t) ((void)(S))
#define ssSetErrorStatus(S, message) printf("%s ", message)
#define ssGetInputPortRealSignal(S, n) (&(S)->in[n])
#define ssGetOutputPortRealSignal(S, n) (&(S)->out[n])
#endif
"#;

/// In the place of Simulink's `simulink.c`: a program that reads the mode and the inputs and prints
/// the outputs.
const SIMULINK: &str = r#"
#include <stdio.h>
int main(void) {
  SimStruct s = {0};
  int n;
  mdlInitializeSizes(&s);
  mdlInitializeSampleTimes(&s);
  printf("%d %d %g\n", s.inputs, s.outputs, s.sample_time);
  while (scanf("%lf", &s.parameter) == 1) {
    for (n = 0; n < s.inputs; ++n) if (scanf("%lf", &s.in[n]) != 1) return 1;
    mdlOutputs(&s, 0);
    for (n = 0; n < s.outputs; ++n) printf("%.17g ", s.out[n]);
    printf("\n");
  }
  mdlTerminate(&s);
  return 0;
}
"#;

fn written(folder: &std::path::Path, table: &Table, name: &str) -> [String; 3] {
    let files = simulink_files(name);
    let create = |file: &String| std::fs::File::create(folder.join(file)).unwrap();
    table
        .write_header(name, None, &mut create(&files[0]))
        .unwrap();
    table
        .write_s_function(name, None, &mut create(&files[1]))
        .unwrap();
    table
        .write_simulink_script(name, &mut create(&files[2]))
        .unwrap();
    files
}

#[test]
fn the_s_function_gives_each_quantity_at_its_output_in_both_modes() {
    for (table, name) in [(table(false), "front"), (reduced(), "2 rear")] {
        let folder = tempfile::tempdir().unwrap();
        let [_, source, _] = written(folder.path(), &table, name);
        std::fs::write(folder.path().join("simstruc.h"), SIMSTRUC).unwrap();
        std::fs::write(folder.path().join("simulink.c"), SIMULINK).unwrap();
        let points = [(500.0, 0.0), (1234.5, 0.011), (1e9, -3.0)];
        let (mut given, mut wanted) = (String::new(), Vec::new());
        for (number, mode) in [(1, Mode::Smooth), (2, Mode::Bilinear)] {
            for (fz, curvature) in points {
                writeln!(given, "{number} {fz:e} {curvature:e}").unwrap();
                let mut outside = false;
                let mut row = Vec::new();
                for &quantity in Quantity::of(false) {
                    let found = Interpolator::new(&table, quantity, mode, None).unwrap();
                    let found = found.at(Point::at_rest(fz, curvature));
                    outside |= found.out_of_range;
                    row.push(found.value);
                }
                row.push(f64::from(u8::from(outside)));
                wanted.push(row);
            }
        }
        let flags = ["-ffp-contract=off", "-DMATLAB_MEX_FILE", "-I."];
        let Some(printed) = run_c(folder.path(), &source, &flags, &given) else {
            return;
        };
        let mut lines = printed.lines();
        assert_eq!(lines.next(), Some("2 7 -1"), "{printed}");
        for (line, row) in lines.zip(&wanted) {
            let found: Vec<f64> = line
                .split_whitespace()
                .map(|word| word.parse().unwrap())
                .collect();
            assert_eq!(found.len(), row.len(), "{line}");
            for (a, b) in found.iter().zip(row) {
                assert!((a - b).abs() <= 1e-14 * b.abs(), "{a} {b}");
            }
        }
        assert_eq!(printed.lines().count(), 1 + wanted.len());
    }
}

/// Octave has no Simulink: functions in the place of Simulink's write down what they are called
/// with.
#[test]
fn the_script_builds_a_library_whose_ports_have_names_and_units() {
    if kufe_outside::program("octave-cli").is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let [_, source, script] = written(folder.path(), &table(false), "front");
    let calls = [
        "mex",
        "new_system",
        "add_block",
        "set_param",
        "add_line",
        "save_system",
        "close_system",
    ];
    for name in calls {
        let body = format!(
            "function {name}(varargin)\n  printed = cellfun(@(a) num2str(a), varargin, 'UniformOutput', false);\n  printf('{name}: %s\\n', strjoin(printed, ', '));\nend\n"
        );
        std::fs::write(folder.path().join(format!("{name}.m")), body).unwrap();
    }
    std::fs::write(
        folder.path().join("bdIsLoaded.m"),
        "function yes = bdIsLoaded(name)\n  yes = false;\nend\n",
    )
    .unwrap();
    let function = script.strip_suffix(".m").unwrap();
    let ran = Command::new("octave-cli")
        .args(["--no-gui", "--norc", "--quiet", "--eval", function])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&ran.stdout);
    assert!(
        ran.status.success(),
        "{printed}{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    println!("{printed}");
    let has = |line: &str| assert!(printed.contains(line), "{line:?} in {printed}");
    assert!(printed.lines().next().unwrap().ends_with(&source));
    has("new_system: front_lib, Library");
    has("set_param: front_lib/front/table, FunctionName, front_sfun");
    has("set_param: front_lib/front/table, Parameters, mode");
    has("set_param: front_lib/front/fz_n, Port, 1, Unit, N");
    has("set_param: front_lib/front/curvature_1pm, Port, 2, Unit, 1/m");
    has("set_param: front_lib/front/p_max_pa, Port, 1, Unit, Pa");
    has("set_param: front_lib/front/area_m2, Port, 3, Unit, m^2");
    has("add_line: front_lib/front, curvature_1pm/1, table/2");
    has("add_line: front_lib/front, table/7, out_of_range/1");
    has("front_lib.slx");
}
