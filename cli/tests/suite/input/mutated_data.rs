//! Readers of tables, maps, meshes, models and measured data on damaged files, as `mutated_input.rs` does with hulls.

use std::path::Path;

use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec,
    WritableImage,
};
use kufe::jobs::TABLE_EXAMPLE;
use kufe::jobs::table::TableSpec;
use kufe::results::LateralFitDocument;
use kufe_discover::read_map_bytes;
use kufe_lut::{Axes, Figures, Quantity, Table, read_fmu};
use kufe_mesh::{HeightMap, TensorGrid, read_gmsh, read_vtu, write_vtu};
use kufe_sled::MODEL_EXAMPLE;
use kufe_sled::friction::{read_experiments, read_glide, read_glide_index};
use kufe_sled::{COLUMNS, Model, Track, Vehicle, read_columns, read_csv, read_index};
use kufe_telemetry::{MAPPING_EXAMPLE, Mapping, TextOptions, guess_mapping, read_text};

use crate::input::damage::rounds;

/// A reader of paths as a reader of bytes.
fn through_file(name: &str, read: impl Fn(&Path) -> bool) -> impl Fn(&[u8]) -> bool {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    move |bytes| {
        let _folder = &folder;
        std::fs::write(&path, bytes).expect("a file");
        read(&path)
    }
}

fn table() -> Table {
    let axes = Axes::new(vec![500.0, 1000.0, 2000.0], vec![-0.01, 0.0, 0.02]).expect("axes");
    let nodes = axes.points().into_iter().map(|point| {
        let root = point.fz.cbrt();
        let figures = Figures::at_rest([1e7 * root, 1e6 * root, 1e-5, 0.05, 3e-4, 1e-5]);
        let errors = [1e4, 1e4, 1e-7, 1e-4, 1e-6, 1e-8];
        let pairs = Quantity::of(false).iter().zip(errors);
        pairs.fold(figures, |figures, (&q, error)| figures.with_error(q, error))
    });
    let nodes: Vec<Figures> = nodes.collect();
    Table::new(axes, &nodes, vec![]).expect("a table")
}

#[test]
fn damaged_tables_are_tables_or_errors() {
    let mut seed = Vec::new();
    table().write(&mut seed).expect("memory");
    rounds("lut", &[seed], |mut bytes| Table::read(&mut bytes).is_ok());
}

#[test]
fn damaged_fmus_are_described_or_errors() {
    let mut seed = Vec::new();
    table()
        .write_fmu("front", None, kufe_lut::Fmi::V3, &mut seed)
        .expect("memory");
    rounds("fmu", &[seed], |bytes| {
        read_fmu(std::io::Cursor::new(bytes)).is_ok()
    });
}

#[test]
fn damaged_fits_are_fits_or_errors() {
    let fit = include_bytes!("../../data/fit.json");
    rounds("fit.json", &[fit.to_vec()], |bytes| {
        serde_json::from_slice::<LateralFitDocument>(bytes).is_ok()
    });
}

#[test]
fn damaged_table_specifications_are_read_or_refused() {
    let read = through_file("table.toml", |path| TableSpec::read(path).is_ok());
    rounds("table.toml", &[TABLE_EXAMPLE.into()], read);
}

#[test]
fn damaged_models_are_models_or_errors() {
    let own = "\n[effects.mine]\nexpression = \"v_mps^2 * abs(delta_rad)\"\nchannel = \"longitudinal\"\nvalue = 0.5\n";
    let known = "\n[effects.temperature-grip]\nslope_per_k = -0.01\n";
    let seed = format!("{MODEL_EXAMPLE}{own}{known}");
    rounds("model.toml", &[seed.into()], |bytes| {
        Model::from_toml(&String::from_utf8_lossy(bytes), "model.toml")
            .is_ok_and(|model| Vehicle::with_effects(&model).is_ok())
    });
}

/// Thirty samples of a straight glide.
fn run_csv() -> String {
    let mut text = String::from(
        "t_s,ax_mps2,ay_mps2,az_mps2,roll_rate_radps,pitch_rate_radps,yaw_rate_radps,v_mps,alpha_rad,delta_rad,gamma_rad\n",
    );
    for k in 0..30 {
        let t = 0.01 * f64::from(k);
        text += &format!("{t},-0.1,0,9.81,0,0,0,{},0.001,0,0\n", 30.0 - 0.1 * t);
    }
    text
}

#[test]
fn damaged_runs_are_columns_or_errors() {
    rounds("run.csv", &[run_csv().into()], |bytes| {
        read_csv(bytes, &COLUMNS, "run.csv").is_ok()
    });
}

#[test]
fn damaged_recordings_are_logs_or_errors() {
    let plain = run_csv();
    let german = plain
        .replace(',', ";")
        .replace('.', ",")
        .replace("t_s", "Fahrt 3\n\nZeit [ms]");
    let units = "Time,GPS Speed,Lateral Acc\ns,km/h,g\n\n0.0,91.5,0.1\n0.1,91.25,\n0.2,9e1,-\n";
    let seeds: Vec<Vec<u8>> = [plain.as_str(), german.as_str(), units]
        .map(Vec::from)
        .into();
    rounds("recording.csv", &seeds, |bytes| {
        read_text(
            bytes,
            TextOptions::default(),
            None,
            1_000_000,
            "recording.csv",
        )
        .is_ok_and(|log| !guess_mapping(&[("recording.csv".into(), log)]).is_empty())
    });
}

#[test]
fn damaged_mappings_are_mappings_or_errors() {
    rounds("mapping.toml", &[MAPPING_EXAMPLE.into()], |bytes| {
        Mapping::parse(&String::from_utf8_lossy(bytes), "mapping.toml").is_ok()
    });
}

#[test]
fn damaged_parquet_files_are_columns_or_errors() {
    let run = read_csv(run_csv().as_bytes(), &COLUMNS, "run.csv").expect("columns");
    let columns: Vec<(&str, &[f64])> = run
        .columns
        .iter()
        .map(|(name, values)| (name.as_str(), values.as_slice()))
        .collect();
    let mut seed = Vec::new();
    kufe_sled::write_parquet(&mut seed, &columns).expect("memory");
    let read = through_file("run.parquet", |path| read_columns(path, &COLUMNS).is_ok());
    rounds("run.parquet", &[seed], read);
}

#[test]
fn damaged_matlab_files_are_columns_or_errors() {
    // A table's axes are vectors of double precision, as the columns of a run are.
    let mut seed = Vec::new();
    table().write_mat(&mut seed).expect("memory");
    let read = through_file("run.mat", |path| read_columns(path, &[]).is_ok());
    rounds("run.mat", &[seed], read);
}

#[test]
fn damaged_indices_of_runs_are_entries_or_errors() {
    let seed = "run,file,track,driver,driver_class,session,ice_c,air_c,air_pa\n\
                one,one.csv,East,A1,A,s1,-8.0,-2.0,95000\ntwo,two.csv,East,B1,B,s2,-7.5,0.0,95000\n";
    let read = through_file("runs.csv", |path| read_index(path).is_ok());
    rounds("runs.csv", &[seed.into()], read);
}

#[test]
fn damaged_tracks_are_tracks_or_errors() {
    let mut seed = String::from("s_m,slope_rad,curvature_1pm,bank_rad\n");
    for k in 0..30 {
        seed += &format!("{},0.08,{},0.1\n", 10 * k, 0.001 * f64::from(k % 7));
    }
    rounds("track.csv", &[seed.into()], |bytes| {
        Track::from_csv(bytes, "east", "track.csv").is_ok()
    });
}

#[test]
fn damaged_experiments_and_glides_are_rows_or_errors() {
    let experiments = "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd,session,ice_c\n\
                       a,8.0e6,3e5,0.0048,0.0002,s1,-5\nb,1.1e7,3e5,0.0043,0.0002,s2,-4\n";
    rounds("experiments.csv", &[experiments.into()], |bytes| {
        read_experiments("experiments.csv", bytes).is_ok()
    });
    let index = "run,file,specimen,direction,mass_kg,cda_m2,air_c,air_pa\n\
                 1,1.csv,a,1,100,0.05,-2,95000\n2,2.csv,a,-1,100,0.05,-2,95000\n";
    rounds("glides.csv", &[index.into()], |bytes| {
        read_glide_index("glides.csv", bytes).is_ok()
    });
    let mut glide = String::from("t_s,v_mps\n");
    for k in 0..60 {
        glide += &format!("{},{}\n", 0.05 * f64::from(k), 5.0 - 0.01 * f64::from(k));
    }
    rounds("glide.csv", &[glide.into()], |bytes| {
        read_glide("glide.csv", bytes).is_ok()
    });
}

#[test]
fn damaged_height_maps_are_surfaces_or_errors() {
    let mut seed = String::from("x_m,y_m,z_m\n");
    for k in 0..12 {
        seed += &format!(
            "{},{},{}\n",
            0.01 * f64::from(k % 4),
            0.01 * f64::from(k / 4),
            1e-6 * f64::from(k)
        );
    }
    rounds("heights.csv", &[seed.into()], |bytes| {
        HeightMap::from_csv(bytes).is_ok()
    });
}

#[test]
fn damaged_meshes_are_meshes_or_errors() {
    let gmsh = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n$EndEntities\n$Nodes\n1 8 1 18\n3 1 0 8\n\
                1\n2\n3\n4\n15\n16\n17\n18\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 2\n1 0 2\n1 1 2\n0 1 2\n$EndNodes\n\
                $Elements\n2 2 1 2\n2 1 3 1\n1 1 2 3 4\n3 1 5 1\n2 1 2 3 4 15 16 17 18\n$EndElements\n";
    rounds("msh", &[gmsh.into()], |bytes| read_gmsh(bytes).is_ok());
    let axis = || vec![0.0, 1.0, 2.0];
    let grid = TensorGrid {
        x: axis(),
        y: axis(),
        z: axis(),
    };
    let mut vtu = Vec::new();
    write_vtu(&grid.hex_mesh(), &[], &[], &[], &mut vtu).expect("memory");
    rounds("vtu", &[vtu], |bytes| read_vtu(bytes).is_ok());
}

fn map() -> Vec<u8> {
    let mut attributes = LayerAttributes::default();
    for name in ["origin_x_m", "origin_y_m", "pixel_x_m", "pixel_y_m"] {
        attributes
            .other
            .insert(Text::from(name), AttributeValue::F64(1e-3));
    }
    let samples: Vec<f32> = (0..48).map(|k| 1e5 * k as f32).collect();
    let channel = AnyChannel::new("p", FlatSamples::F32(samples));
    let channels = AnyChannels::sort(SmallVec::from_vec(vec![channel]));
    let layer = Layer::new((8, 6), attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut file = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut file)
        .expect("memory");
    file.into_inner()
}

#[test]
fn damaged_maps_are_maps_or_errors() {
    rounds("exr", &[map()], |bytes| {
        read_map_bytes(bytes, "map.exr").is_ok()
    });
}

#[test]
fn a_map_that_claims_more_than_the_limit_is_refused_by_its_header() {
    let mut bytes = map();
    // The data window follows its name and type: four numbers, the last two the largest column and row.
    let name = b"dataWindow\0box2i\0";
    let at = bytes
        .windows(name.len())
        .position(|w| w == name)
        .expect("an EXR header");
    let largest = at + name.len() + 4 + 8;
    bytes[largest..largest + 4].copy_from_slice(&99_999i32.to_le_bytes());
    bytes[largest + 4..largest + 8].copy_from_slice(&99_999i32.to_le_bytes());
    let reported = read_map_bytes(&bytes, "map.exr")
        .expect_err("too large")
        .to_string();
    assert!(reported.contains("100000 x 100000 pixels"), "{reported}");
}

/// Logs that other programs wrote, by a script that is given the folder.
fn logs(modules: &str, script: &str, ending: &str) -> Vec<Vec<u8>> {
    let Some(interpreter) = kufe_outside::python(modules) else {
        return Vec::new();
    };
    let folder = tempfile::tempdir().expect("a folder");
    let made = std::process::Command::new(interpreter)
        .args(["-c", script])
        .arg(folder.path())
        .status();
    assert!(made.expect("it runs").success(), "{modules}");
    ["a", "b"]
        .map(|name| std::fs::read(folder.path().join(format!("{name}.{ending}"))).expect("a log"))
        .into()
}

#[test]
fn damaged_mdf4_logs_are_channels_or_errors() {
    let script = "import sys, numpy as np\nfrom asammdf import MDF, Signal\nt = np.arange(40) / 20.0\n\
        for name, packed in (('a', 0), ('b', 2)):\n    log = MDF(version='4.10')\n    \
        log.append([Signal(np.sin(t), t, name='a', unit='g'), Signal(np.arange(40).astype('i2'), t, name='n')])\n    \
        log.save(sys.argv[1] + f'/{name}.mf4', compression=packed, overwrite=True)\n";
    let seeds = logs("asammdf, numpy", script, "mf4");
    if !seeds.is_empty() {
        rounds("log.mf4", &seeds, |bytes| {
            kufe_telemetry::read_mdf4(std::io::Cursor::new(bytes.to_vec()), None, "log.mf4").is_ok()
        });
    }
}

#[test]
fn damaged_matlab73_files_are_channels_or_errors() {
    let script = "import sys, h5py, numpy as np\nt = np.arange(40) / 20.0\n\
        for name, filters in (('a', {}), ('b', {'chunks': (1, 20), 'compression': 'gzip'})):\n    \
        with h5py.File(sys.argv[1] + f'/{name}.mat', 'w', userblock_size=512, libver=('earliest', 'latest')) as f:\n        \
        f.create_dataset('t', data=t[None], **filters)\n        f.create_dataset('acc', data=np.array([t, t]))\n        f.create_group('gps').create_dataset('v', data=np.cos(t)[None])\n";
    let seeds = logs("h5py, numpy", script, "mat");
    if !seeds.is_empty() {
        rounds("log.mat", &seeds, |bytes| {
            kufe_telemetry::read_matlab73(std::io::Cursor::new(bytes.to_vec()), None, "log.mat")
                .is_ok()
        });
    }
}
