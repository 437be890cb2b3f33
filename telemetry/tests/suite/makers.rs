//! Recordings made by other programs (KUFE_PYTHON: asammdf, h5py, SciPy, pandas with pyarrow).

use std::path::Path;
use std::process::Command;

use crate::truth::import;

/// Runs a script with a folder as its argument; `false`, with a message, where the interpreter or a
/// module is missing.
fn made(modules: &str, script: &str, folder: &Path) -> bool {
    let Some(interpreter) = kufe_outside::python(modules) else {
        return false;
    };
    let output = Command::new(interpreter)
        .arg("-c")
        .arg(script)
        .arg(folder)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    true
}

/// What every script writes: 20 s of speed at 20 Hz in km/h and of a lateral acceleration at 500 Hz
/// in g.
fn is_what_was_written(mapping: &str, folder: &Path) {
    let imported = import(folder, mapping).unwrap();
    let run = &imported[0].run;
    let start = imported[0].note.start_s;
    for (column, of) in [
        (
            "v_mps",
            (|t: f64| 25.0 + 3.0 * (0.7 * t).sin()) as fn(f64) -> f64,
        ),
        ("ay_mps2", |t| 9.806_65 * 0.4 * (2.0 * t).sin()),
    ] {
        for (row, value) in run
            .column(column)
            .unwrap()
            .iter()
            .enumerate()
            .skip(200)
            .take(1500)
        {
            let exact = of(start + row as f64 * 0.01);
            // The spline between 20 samples a second: (0.7/20)^4/384 of 3 m/s; numbers in single
            // precision.
            assert!(
                (value - exact).abs() < 5e-6 * exact.abs().max(1.0),
                "{column}, row {row}: {value} for {exact}"
            );
        }
    }
    let rate = |column: &str| imported[0].note.channels[column].rate_hz;
    assert!((rate("v_mps") - 20.0).abs() < 1e-3 && (rate("ay_mps2") - 500.0).abs() < 0.1);
}

#[test]
fn mdf4_by_asammdf_with_two_rates_is_read_by_its_own_clocks_and_units() {
    let folder = tempfile::tempdir().unwrap();
    let script = "
import sys, os, numpy as np
from asammdf import MDF, Signal
for name, compression in (('plain', 0), ('packed', 2)):
    slow, fast = np.arange(400) / 20.0, np.arange(10000) / 500.0
    log = MDF(version='4.10')
    log.append([Signal(3.6 * (25 + 3 * np.sin(0.7 * slow)), slow, name='GPS Speed', unit='km/h')])
    log.append([
        Signal((0.4 * np.sin(2 * fast)).astype('f4').astype('f8'), fast, name='LatAcc', unit='g'),
        Signal(np.arange(10000).astype('i2'), fast, name='Counter', unit=''),
    ])
    log.save(os.path.join(sys.argv[1], name + '.mf4'), compression=compression, overwrite=True)
";
    if !made("asammdf, numpy", script, folder.path()) {
        return;
    }
    let mapping = "[logger.box]\nfiles = \"NAME.mf4\"\n[channels]\nv_mps = { from = \"GPS Speed\" }\nay_mps2 = { from = \"LatAcc\" }\nn = { from = \"Counter\" }\n";
    for name in ["plain", "packed"] {
        is_what_was_written(&mapping.replace("NAME", name), folder.path());
    }
    let log = kufe_telemetry::read_log(
        &folder.path().join("plain.mf4"),
        kufe_telemetry::TextOptions::default(),
        None,
        u64::MAX,
    )
    .unwrap();
    let guessed = kufe_telemetry::guess_mapping(&[("raw/plain.mf4".into(), log)]);
    assert!(
        guessed.contains(
            "v_mps = { from = \"GPS Speed\" }      # likely: by its name; the file says km/h"
        ),
        "{guessed}"
    );
}

#[test]
fn matlab_v73_by_h5py_is_read_with_its_structs() {
    let folder = tempfile::tempdir().unwrap();
    // The layout that MATLAB R2023b writes: a user block of 512 bytes, old headers, chunks with
    // deflate, class attributes.
    let script = "
import sys, os, h5py, numpy as np
path = os.path.join(sys.argv[1], 'run.mat')
slow, fast = np.arange(400) / 20.0, np.arange(10000) / 500.0
with h5py.File(path, 'w', userblock_size=512, libver=('earliest', 'latest')) as f:
    def put(group, name, values, kind):
        d = group.create_dataset(name, data=values[None], chunks=(1, min(len(values), 1000)), compression='gzip', compression_opts=3)
        d.attrs['MATLAB_class'] = np.bytes_(kind)
    gps = f.create_group('gps'); gps.attrs['MATLAB_class'] = np.bytes_('struct')
    put(gps, 't', slow, 'double'); put(gps, 'v', 3.6 * (25 + 3 * np.sin(0.7 * slow)), 'double')
    # 10000 x 3 in MATLAB.
    f.create_dataset('acc', data=np.array([0.0 * fast, 0.4 * np.sin(2 * fast), fast]))
    put(f, 't', fast, 'double'); put(f, 'n', np.arange(10000, dtype='u2'), 'uint16')
    text = f.create_dataset('name', data=np.array([[105], [103]], dtype='u2')); text.attrs['MATLAB_class'] = np.bytes_('char')
with open(path, 'r+b') as f:
    f.write(b'MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .'.ljust(116) + b' ' * 8 + bytes([0, 2]) + b'IM')
";
    if !made("h5py, numpy", script, folder.path()) {
        return;
    }
    let mapping = "[logger.box]\nfiles = \"run.mat\"\ntime = \"t\"\n[channels]\nv_mps = { from = \"gps.v\", unit = \"km/h\", time = \"gps.t\" }\nay_mps2 = { from = \"acc(:,2)\", unit = \"g\" }\nn = { from = \"n\" }\n";
    is_what_was_written(mapping, folder.path());
}

#[test]
fn parquet_by_pandas_and_matlab_v5_by_scipy_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let script = "
import sys, os, numpy as np, pandas, scipy.io
t = np.arange(10000) / 500.0
data = {'t': 1e3 * t, 'v': 3.6 * (25 + 3 * np.sin(0.7 * t)), 'ay': 0.4 * np.sin(2 * t)}
pandas.DataFrame(data).to_parquet(os.path.join(sys.argv[1], 'run.parquet'))
scipy.io.savemat(os.path.join(sys.argv[1], 'run.mat'), data, do_compression=True)
";
    if !made("pandas, pyarrow, scipy", script, folder.path()) {
        return;
    }
    for name in ["run.parquet", "run.mat"] {
        let mapping = format!(
            "[logger.box]\nfiles = \"{name}\"\ntime = \"t\"\ntime_unit = \"ms\"\n[channels]\nv_mps = {{ from = \"v\", unit = \"km/h\" }}\nay_mps2 = {{ from = \"ay\", unit = \"g\" }}\n"
        );
        let imported = import(folder.path(), &mapping).unwrap();
        for (row, value) in imported[0]
            .run
            .column("v_mps")
            .unwrap()
            .iter()
            .enumerate()
            .skip(100)
            .take(1700)
        {
            let exact = 25.0 + 3.0 * (0.7 * row as f64 * 0.01).sin();
            assert!(
                (value - exact).abs() < 1e-6,
                "{name}, row {row}: {value} for {exact}"
            );
        }
    }
}

#[test]
fn a_resampled_chirp_is_that_of_scipy() {
    let folder = tempfile::tempdir().unwrap();
    let script = "
import sys, os, numpy as np, scipy.signal as s
t = np.arange(10000) / 500.0
x = s.chirp(t, 0.5, 20.0, 120.0) + 9.81
np.savetxt(os.path.join(sys.argv[1], 'run.csv'), np.c_[t, x], delimiter=',', header='t,x', comments='', fmt='%.12g')
y = s.sosfiltfilt(s.butter(4, 40.0, fs=500.0, output='sos'), x)[::5]
np.savetxt(os.path.join(sys.argv[1], 'expected.txt'), y, fmt='%.12g')
";
    if !made("numpy, scipy", script, folder.path()) {
        return;
    }
    let mapping =
        "[logger.box]\nfiles = \"run.csv\"\ntime = \"t\"\n[channels]\nx = { from = \"x\" }\n";
    let imported = import(folder.path(), mapping).unwrap();
    let ours = imported[0].run.column("x").unwrap();
    let expected = std::fs::read_to_string(folder.path().join("expected.txt")).unwrap();
    let expected: Vec<f64> = expected.lines().map(|line| line.parse().unwrap()).collect();
    assert_eq!(ours.len(), expected.len());
    for (row, (a, b)) in ours.iter().zip(&expected).enumerate() {
        // Twelve digits are written; the poles' design rounds differently.
        assert!((a - b).abs() < 1e-8, "row {row}: {a} against {b}");
    }
}
