//! Readers and filters against other programs (KUFE_PYTHON: numpy, scipy, pandas with pyarrow).

use std::path::{Path, PathBuf};
use std::process::Command;

use kufe_sled::{
    COLUMNS, Conditions, Entry, Model, Noise, OnGaps, PrepareOptions, Run, RunFormat,
    SimulateOptions, TrackShape, Vehicle, low_pass, prepare, read_columns, read_run, record,
    simulate, simulated_entry, write_run,
};

/// Runs a Python script; prints a note and returns `None` without the interpreter or a module.
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

fn simulated_run(vehicle: &Vehicle) -> Run {
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
        humidity_pct: f64::NAN,
        distance_m: f64::NAN,
        mass_kg: f64::NAN,
    };
    let text = || "x".to_string();
    Entry {
        run: text(),
        file,
        track: text(),
        driver: text(),
        driver_class: text(),
        session: text(),
        conditions,
        ..Entry::default()
    }
}

#[test]
fn low_pass_equals_scipys_sosfiltfilt() {
    let run = simulated_run(&Vehicle::new(&Model::published()).unwrap());
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
            // Padding and initial state are those of SciPy. The design of the poles differs by
            // rounding.
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
for codec in ('none', 'snappy', 'gzip', 'zstd', 'brotli', 'lz4'):
    frame.to_parquet(os.path.join(sys.argv[1], codec + '.parquet'), compression=codec)
scipy.io.savemat(os.path.join(sys.argv[1], 'two.mat'), {k: data[k] for k in ('t_s', 'v_mps', 'half')}, format='5')
scipy.io.savemat(os.path.join(sys.argv[1], 'packed.mat'), {k: data[k][:, None] for k in ('t_s', 'v_mps', 'half')}, format='5', do_compression=True)
";
    if python(&["pandas", "pyarrow", "scipy"], script, &[folder.path()]).is_none() {
        return;
    }
    for codec in ["brotli", "lz4"] {
        let path = folder.path().join(format!("{codec}.parquet"));
        let error = read_columns(&path, &[]).unwrap_err().to_string();
        assert!(error.contains("expected snappy, gzip, zstd"), "{error}");
        assert!(
            error.contains(codec) && error.lines().count() == 1,
            "{error}"
        );
    }
    let packed = ["none", "snappy", "gzip", "zstd"].map(|codec| format!("{codec}.parquet"));
    let matlab = ["two.mat", "packed.mat"].map(str::to_owned);
    for name in packed.iter().chain(&matlab) {
        let columns = read_columns(&folder.path().join(name), &[])
            .unwrap()
            .columns;
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
fn runs_round_trip_through_csv_and_parquet() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let run = simulated_run(&vehicle);
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

#[test]
fn an_mdf4_log_is_refused_with_the_import_command() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.mf4");
    std::fs::write(&path, "MDF").unwrap();
    let error = read_columns(&path, &[]).unwrap_err().to_string();
    assert!(error.contains("kufe runs import"), "{error}");
}

/// A Parquet file with one row group; a closure writes each column.
fn parquet_file(
    schema: &str,
    columns: &[&dyn Fn(&mut parquet::file::writer::SerializedColumnWriter)],
) -> std::fs::File {
    use parquet::file::writer::SerializedFileWriter;
    let schema = parquet::schema::parser::parse_message_type(schema).unwrap();
    let file = tempfile::tempfile().unwrap();
    let mut writer = SerializedFileWriter::new(
        file.try_clone().unwrap(),
        std::sync::Arc::new(schema),
        std::sync::Arc::default(),
    )
    .unwrap();
    let mut group = writer.next_row_group().unwrap();
    for write in columns {
        let mut column = group.next_column().unwrap().unwrap();
        write(&mut column);
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
    file
}

#[test]
fn parquet_columns_are_read_by_their_logical_types() {
    use parquet::data_type::{FixedLenByteArrayType as Fixed, Int32Type as I32, Int64Type as I64};
    let i32s = |values: [i32; 3]| {
        move |column: &mut parquet::file::writer::SerializedColumnWriter| {
            column
                .typed::<I32>()
                .write_batch(&values, None, None)
                .unwrap();
        }
    };
    let i64s = |values: [i64; 3]| {
        move |column: &mut parquet::file::writer::SerializedColumnWriter| {
            column
                .typed::<I64>()
                .write_batch(&values, None, None)
                .unwrap();
        }
    };
    let schema = "message m {
        REQUIRED INT32 money (DECIMAL(9, 3)); REQUIRED INT64 long (DECIMAL(18, 2));
        REQUIRED FIXED_LEN_BYTE_ARRAY (3) wide (DECIMAL(6, 1));
        REQUIRED INT32 unsigned (UINT_32); REQUIRED INT64 unsigned_long (INTEGER(64, false));
        REQUIRED INT32 clock (TIME_MILLIS); REQUIRED INT64 stamp (TIMESTAMP(MICROS, true));
        REQUIRED INT64 nanos (TIMESTAMP(NANOS, false)); REQUIRED INT32 day (DATE);
        OPTIONAL INT32 gap (INTEGER(16, true)); }";
    let file = parquet_file(
        schema,
        &[
            &i32s([10_000, -1, 0]),
            &i64s([12_345, -5, 0]),
            &|column| {
                let bytes = [[0, 0, 15], [255, 255, 255], [1, 0, 0]];
                let values = bytes.map(|b: [u8; 3]| b.to_vec().into());
                column
                    .typed::<Fixed>()
                    .write_batch(&values, None, None)
                    .unwrap();
            },
            &i32s([-1, 7, 0]),
            &i64s([-1, 7, 0]),
            &i32s([2990, 0, 1]),
            &i64s([1_600_000_000_250_000, 0, 1]),
            &i64s([1_500_000_000, 0, 1]),
            &i32s([18_000, 0, 1]),
            &|column| {
                let typed = column.typed::<I32>();
                typed.write_batch(&[-3, 4], Some(&[1, 0, 1]), None).unwrap();
            },
        ],
    );
    let columns = kufe_sled::read_parquet(file, None, "a.parquet").unwrap();
    let columns: kufe_sled::Columns = columns.into_iter().collect();
    for (name, exact) in [
        ("money", [10.0, -0.001, 0.0]),
        ("long", [123.45, -0.05, 0.0]),
        ("wide", [1.5, -0.1, 6553.6]),
        ("unsigned", [4_294_967_295.0, 7.0, 0.0]),
        ("unsigned_long", [1.844_674_407_370_955_2e19, 7.0, 0.0]),
        ("clock", [2.99, 0.0, 0.001]),
        ("stamp", [1_600_000_000.25, 0.0, 1e-6]),
        ("nanos", [1.5, 0.0, 1e-9]),
    ] {
        assert_eq!(columns[name], exact, "{name}");
    }
    assert!(!columns.contains_key("day"));
    let gap = &columns["gap"];
    assert!(gap[0] == -3.0 && gap[1].is_nan() && gap[2] == 4.0);
}

#[test]
fn files_that_decompress_to_gigabytes_are_refused() {
    use parquet::data_type::DoubleType;
    let constant = |column: &mut parquet::file::writer::SerializedColumnWriter| {
        let batch = vec![1.0; 1 << 20];
        for _ in 0..10 {
            column
                .typed::<DoubleType>()
                .write_batch(&batch, None, None)
                .unwrap();
        }
    };
    let columns = ["a", "b", "c", "d"].map(|name| format!("REQUIRED DOUBLE {name};"));
    let schema = format!("message m {{ {} }}", columns.join(" "));
    let file = parquet_file(&schema, &[&constant, &constant, &constant, &constant]);
    let length = file.metadata().unwrap().len();
    assert!(length < 1_000_000, "{length}");
    let error = kufe_sled::read_parquet(file, None, "a.parquet").unwrap_err();
    assert!(
        error.to_string().contains("more than 24000000 numbers"),
        "{error}"
    );
    let zeros = matlab_file(&[&compressed(&matrix(
        "a",
        9,
        &[1, 50_000_000],
        2,
        &vec![0; 50_000_000],
    ))]);
    assert!(zeros.len() < 1_000_000);
    let error = kufe_sled::read_matlab(&zeros, "a.mat").unwrap_err();
    assert!(
        error.to_string().contains("more than 24000000 numbers"),
        "{error}"
    );
}

fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn words(values: &[u32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// An array of a MATLAB file: class, dimensions, storage type of the numbers, numbers.
fn matrix(name: &str, class: u32, dimensions: &[u32], kind: u32, data: &[u8]) -> Vec<u8> {
    let parts = [
        element(6, &words(&[class, 0])),
        element(5, &words(dimensions)),
        element(1, name.as_bytes()),
        element(kind, data),
    ];
    element(14, &parts.concat())
}

fn compressed(variable: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(variable).unwrap();
    let packed = packed.finish().unwrap();
    [words(&[15, packed.len() as u32]), packed].concat()
}

fn matlab_file(variables: &[&[u8]]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([0, 1, b'I', b'M']);
    bytes.extend(variables.concat());
    bytes
}

#[test]
fn matlab_files_with_tables_and_text_give_vectors_and_remarks() {
    let doubles: Vec<u8> = [0.0_f64, 0.5, 1.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let table = [
        element(6, &words(&[17, 0])),
        element(1, b"T"),
        element(1, b"MCOS"),
        element(1, b"table"),
        matrix("", 13, &[6, 1], 6, &words(&[0xdd00_0000, 2, 1, 1, 1, 1])),
    ];
    let fields = [
        element(6, &words(&[2, 0])),
        element(5, &words(&[1, 1])),
        element(1, b"gps"),
        [words(&[0x0004_0005, 8])].concat(),
        element(1, b"v\0\0\0\0\0\0\0t\0\0\0\0\0\0\0"),
        matrix("", 6, &[1, 3], 9, &doubles),
        matrix("", 12, &[3, 1], 2, &[1, 2, 3]),
    ];
    let bytes = matlab_file(&[
        &compressed(&matrix("t", 6, &[1, 3], 9, &doubles)),
        &element(14, &table.concat()),
        &matrix("note", 4, &[1, 2], 4, &[104, 0, 105, 0]),
        &matrix("n", 12, &[3, 1], 3, &[255, 255, 2, 0, 3, 0]),
        &matrix("scalar", 6, &[1, 1], 2, &[3]),
        &matrix("acc", 6, &[3, 2], 2, &[1, 2, 3, 4, 5, 6]),
        &matrix("wide", 6, &[2, 3], 2, &[1, 2, 3, 4, 5, 6]),
        &element(14, &fields.concat()),
    ]);
    let found = kufe_sled::read_matlab(&bytes, "a.mat").unwrap();
    let expected = [
        ("t", [0.0, 0.5, 1.0]),
        ("n", [-1.0, 2.0, 3.0]),
        ("acc(:,1)", [1.0, 2.0, 3.0]),
        ("acc(:,2)", [4.0, 5.0, 6.0]),
        ("gps.v", [0.0, 0.5, 1.0]),
        ("gps.t", [1.0, 2.0, 3.0]),
    ];
    let expected = expected.map(|(name, values)| (name.to_string(), values.to_vec()));
    assert_eq!(found.vectors, expected);
    assert!(found.remarks[0].starts_with("variable T is a table and not read; S = table2struct"));
    assert!(found.remarks[1].starts_with("variable note is a char array"));
    for length in 0..bytes.len() {
        let _ = kufe_sled::read_matlab(&bytes[..length], "a.mat");
    }
}
