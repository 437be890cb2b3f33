//! Readers and filters against other programs (KUFE_PYTHON: numpy, scipy, pandas with pyarrow).

use std::path::{Path, PathBuf};
use std::process::Command;

use kufe_sled::{
    COLUMNS, Conditions, Entry, Model, Noise, OnGaps, PrepareOptions, Run, RunFormat,
    SimulateOptions, TrackShape, Vehicle, low_pass, prepare, read_columns, read_run, record,
    simulate, simulated_entry, write_run,
};

/// Runs a script; `None`, and says so, where the interpreter or a module is absent.
fn python(modules: &[&str], script: &str, arguments: &[&Path]) -> Option<String> {
    let interpreter = kufe_outside::python(&modules.join(", "))?;
    let output = Command::new(&interpreter)
        .arg("-c")
        .arg(script)
        .args(arguments)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(String::from_utf8(output.stdout).unwrap())
}

fn a_run(vehicle: &Vehicle) -> Run {
    let track = kufe_sled::sample_data::sample_track("east");
    let options = SimulateOptions {
        most_s: 8.0,
        rate_hz: 200.0,
        ..SimulateOptions::default()
    };
    let driver = kufe_sled::Driver::of_skill(0.5);
    let simulated = simulate(vehicle, &TrackShape::new(&track), &driver, &options).unwrap();
    let noise = Model::published().noise;
    record(
        &simulated,
        vehicle,
        noise.as_ref(),
        simulated_entry("r", &track, "d", options.conditions),
        1,
    )
}

fn entry(file: PathBuf) -> Entry {
    let conditions = Conditions {
        ice_c: -8.0,
        air_c: 0.0,
        air_pa: 95_000.0,
        humidity_pct: None,
        distance_m: None,
        mass_kg: None,
    };
    let text = || "x".to_string();
    Entry {
        ice_along: kufe_sled::IceAlong::default(),
        ice_of_track: kufe_sled::IceAlong::default(),
        run: text(),
        file,
        track: text(),
        driver: text(),
        driver_class: text(),
        session: text(),
        conditions,
    }
}

#[test]
fn low_pass_equals_scipys_sosfiltfilt() {
    let run = a_run(&Vehicle::new(&Model::published()).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("r.parquet");
    write_run(
        &run,
        &mut std::fs::File::create(&file).unwrap(),
        RunFormat::Parquet,
    )
    .unwrap();
    let script = "
import sys, pandas, scipy.signal as s
x = pandas.read_parquet(sys.argv[1])['ay_mps2'].to_numpy()
for corner in (20.0, 40.0, 3.0):
    y = s.sosfiltfilt(s.butter(4, corner, fs=200.0, output='sos'), x)
    print(' '.join(repr(float(v)) for v in y))
";
    let Some(output) = python(&["pandas", "pyarrow", "scipy"], script, &[&file]) else {
        return;
    };
    for (line, corner) in output.lines().zip([20.0, 40.0, 3.0]) {
        let ours = low_pass(run.column("ay_mps2").unwrap(), 200.0, corner);
        let theirs: Vec<f64> = line.split(' ').map(|v| v.parse().unwrap()).collect();
        assert_eq!(ours.len(), theirs.len());
        for (a, b) in ours.iter().zip(&theirs) {
            // Padding and initial state are SciPy's; rounding in the design of the poles is what differs.
            assert!((a - b).abs() < 1e-9, "{corner} Hz: {a} against {b}");
        }
    }
}

#[test]
fn parquet_and_matlab_files_of_other_programs_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let script = "
import sys, os, numpy, pandas, scipy.io
t = numpy.arange(200) * 0.01
data = {'t_s': t, 'v_mps': 20 + t, 'count': numpy.arange(200, dtype='int32'), 'half': (t / 2).astype('float32')}
frame = pandas.DataFrame(data)
frame['mood'] = 'fine'
frame['gap'] = [None if i == 7 else float(i) for i in range(200)]
for codec in ('snappy', 'zstd'):
    frame.to_parquet(os.path.join(sys.argv[1], codec + '.parquet'), compression=codec)
scipy.io.savemat(os.path.join(sys.argv[1], 'two.mat'), {k: data[k] for k in ('t_s', 'v_mps', 'half')}, format='5')
scipy.io.savemat(os.path.join(sys.argv[1], 'packed.mat'), {k: data[k][:, None] for k in ('t_s', 'v_mps', 'half')}, format='5', do_compression=True)
";
    if python(&["pandas", "pyarrow", "scipy"], script, &[folder.path()]).is_none() {
        return;
    }
    for name in ["snappy.parquet", "zstd.parquet", "two.mat", "packed.mat"] {
        let columns = read_columns(&folder.path().join(name), &[]).unwrap();
        assert_eq!(columns["t_s"].len(), 200, "{name}");
        assert!((columns["v_mps"][100] - 21.0).abs() < 1e-12, "{name}");
        assert!((columns["half"][100] - 0.5).abs() < 1e-6, "{name}");
        assert!(!columns.contains_key("mood"), "{name}");
        if name.ends_with("parquet") {
            assert_eq!(columns["count"][42], 42.0, "{name}");
            assert!(
                columns["gap"][7].is_nan() && columns["gap"][8] == 8.0,
                "{name}"
            );
        }
    }
}

#[test]
fn written_runs_read_back_and_csv_and_parquet_say_the_same() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let run = a_run(&vehicle);
    let folder = tempfile::tempdir().unwrap();
    let mut prepared = Vec::new();
    for format in [RunFormat::Csv, RunFormat::Parquet] {
        let path = folder.path().join(format!("r.{}", format.extension()));
        write_run(&run, &mut std::fs::File::create(&path).unwrap(), format).unwrap();
        let back = read_run(entry(path), &COLUMNS, OnGaps::LeaveOut).unwrap();
        assert_eq!(back.len(), run.len());
        assert!((back.dt_s - run.dt_s).abs() < 1e-12);
        for name in COLUMNS {
            for (a, b) in back
                .column(name)
                .unwrap()
                .iter()
                .zip(run.column(name).unwrap())
            {
                assert!((a - b).abs() <= 0.5e-9, "{name}");
            }
        }
        let noise = Some(&Noise { ..Noise::default() });
        prepared.push(prepare(&back, &vehicle, noise, &PrepareOptions::default()).unwrap());
    }
    for (a, b) in prepared[0].states.iter().zip(&prepared[1].states) {
        assert!((a.fz_r_n - b.fz_r_n).abs() < 1e-4 && (a.alpha_f_rad - b.alpha_f_rad).abs() < 1e-8);
    }
}

#[cfg(feature = "mdf4")]
#[test]
fn mdf4_logs_are_read_with_their_own_time_channel() {
    use falcon_mdf::Mf4Writer;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.mf4");
    let time: Vec<f64> = (0..300).map(|i| f64::from(i) * 0.01).collect();
    let speed: Vec<f64> = time.iter().map(|t| 20.0 + t).collect();
    let mut writer = Mf4Writer::new();
    let group = writer.add_group(&time).unwrap();
    group.add_channel("v_mps", "m/s", &speed).unwrap();
    group
        .add_channel("alpha_rad", "rad", &vec![0.01; 300])
        .unwrap();
    let slow = writer.add_group(&[0.0, 1.0, 2.0]).unwrap();
    slow.add_channel("ice_c", "degC", &[-8.0, -8.1, -8.2])
        .unwrap();
    writer.write_to_file(&path).unwrap();
    let run = read_run(entry(path), &["v_mps", "alpha_rad"], OnGaps::LeaveOut).unwrap();
    assert_eq!(run.column("v_mps").unwrap(), speed);
    assert!((run.rate_hz() - 100.0).abs() < 1e-9);
    // Another rate: left out, not stretched.
    assert!(run.column("ice_c").is_err());
}
