//! Tables as FMUs, validated and simulated by FMPy.

use crate::python::run_python;
use crate::tables::{reduced, table};
use kufe_lut::{AxisKind, Fmi, Interpolator, Mode, Outside, Point, Quantity, Table};
use kufe_outside::python;

#[test]
fn the_fmu_is_valid_and_simulates_what_the_library_computes() {
    let Some(python) = python("fmpy") else { return };
    let linear = reduced().with_outside(AxisKind::Curvature, Outside::Linear);
    for (table, fmi) in [
        (table(false), Fmi::V2),
        (table(false), Fmi::V3),
        (linear, Fmi::V2),
        (reduced(), Fmi::V3),
    ] {
        the_fmu_agrees(&python, &table, fmi);
    }
}

fn written(folder: &std::path::Path, table: &Table, name: &str, fmi: Fmi) {
    let mut file = std::fs::File::create(folder.join("front.fmu")).unwrap();
    table.write_fmu(name, None, fmi, &mut file).unwrap();
}

fn the_fmu_agrees(python: &std::path::Path, table: &Table, fmi: Fmi) {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), table, "front <&>", fmi);
    let out = run_python(
        python,
        folder.path(),
        "import numpy as np, fmpy\n\
         from fmpy.validation import validate_fmu\n\
         problems = validate_fmu('front.fmu')\n\
         assert not problems, problems\n\
         d = fmpy.read_model_description('front.fmu')\n\
         assert d.modelExchange and d.coSimulation and d.modelName == 'front <&>'\n\
         t = np.linspace(0, 1, 41)\n\
         s = np.zeros(41, dtype=[(n, float) for n in ('time', 'fz', 'v', 'pitch_rate', 'curvature')])\n\
         s['time'], s['fz'], s['v'], s['pitch_rate'] = t, 300 + 9000 * t, 30.0, -0.6 * t\n\
         s['curvature'] = 0.03 - 0.06 * t\n\
         for kind in ('CoSimulation', 'ModelExchange'):\n\
         \x20 for smooth in (True, False):\n\
         \x20   for use in (False, True):\n\
         \x20     r = fmpy.simulate_fmu('front.fmu', fmi_type=kind, step_size=0.025, output_interval=0.025, stop_time=1.0, input=s, solver='Euler',\n\
         \x20       start_values=dict(smooth=smooth, use_curvature=use), output=['fz', 'v', 'pitch_rate', 'curvature', 'pressure', 'out_of_range'])\n\
         \x20     assert len(r) >= 41, len(r)\n\
         \x20     for row in r:\n\
         \x20       print(kind, int(smooth), int(use), *(repr(float(row[n])) for n in ('time', 'fz', 'v', 'pitch_rate', 'curvature', 'pressure')), int(row['out_of_range']))\n",
    );
    let (mut inside, mut outside) = (0, 0);
    for line in out.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |n: usize| words[n].parse::<f64>().unwrap();
        let mode = if words[1] == "1" {
            Mode::Smooth
        } else {
            Mode::Bilinear
        };
        let curvature = if words[2] == "1" {
            number(7)
        } else {
            kufe_lut::curvature_from_pitch(number(5), number(6))
        };
        let own = Interpolator::new(table, Quantity::PMax, mode, None)
            .unwrap()
            .at(Point::at_rest(number(4), curvature));
        let pressure = number(8);
        assert!(
            (pressure / own.value - 1.0).abs() < 1e-14,
            "{line} {}",
            own.value
        );
        // In Model Exchange the flag moves at the event after the step that leaves the table.
        if words[0] == "CoSimulation" {
            assert_eq!(words[9] == "1", own.out_of_range, "{line}");
        }
        if words[9] == "1" {
            outside += 1;
        } else {
            inside += 1;
        }
    }
    assert!(inside > 100 && outside > 40, "{inside} {outside}");
}

#[test]
fn an_fmu_of_either_version_stops_outside_an_axis_whose_rule_is_error() {
    let Some(python) = python("fmpy") else { return };
    for fmi in [Fmi::V2, Fmi::V3] {
        let folder = tempfile::tempdir().unwrap();
        let table = table(false).with_outside(AxisKind::Fz, Outside::Error);
        written(folder.path(), &table, "front", fmi);
        let printed = run_python(
            &python,
            folder.path(),
            "import numpy as np, fmpy\n\
             messages = []\n\
             def run(most):\n\
             \x20 t = np.linspace(0, 1, 11)\n\
             \x20 s = np.zeros(11, dtype=[(n, float) for n in ('time', 'fz', 'v', 'pitch_rate', 'curvature')])\n\
             \x20 s['time'], s['fz'], s['v'] = t, 300 + (most - 300) * t, 30.0\n\
             \x20 return fmpy.simulate_fmu('front.fmu', fmi_type='CoSimulation', step_size=0.1, output_interval=0.1, stop_time=1.0, input=s, output=['pressure'],\n\
             \x20   logger=lambda *words: messages.append(str(words)))\n\
             assert len(run(7900.0)) >= 11 and not messages, messages\n\
             try:\n\
             \x20 run(9300.0)\n\
             \x20 print('went on')\n\
             except Exception as stopped:\n\
             \x20 print('stopped', stopped)\n\
             assert any('rule is error' in m for m in messages), messages\n",
        );
        assert!(printed.starts_with("stopped"), "{fmi:?}: {printed}");
    }
}
