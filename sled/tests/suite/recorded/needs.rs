//! Columns that a computation does not need may be absent. A missing column is reported with the
//! computation that needs it.

use std::path::Path;

use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Driver, Error, Examination, IceAlong, Model, Needs, OnGaps, PrepareOptions, Prepared, Run,
    RunFormat, SimulateOptions, TrackShape, Vehicle, examine, fit, prepare, prepare_all,
    read_index, read_runs, record, simulate, simulated_entry, write_index, write_run,
};

/// Writes two runs to a folder, without the columns `without`, and an index with `rows` appended to
/// each row.
fn written(folder: &Path, without: &[&str], header: &str, rows: &str) {
    let (vehicle, track) = (vehicle(""), sample_track("west"));
    for seed in 1..=2 {
        let options = SimulateOptions {
            seed,
            rate_hz: 100.0,
            ..SimulateOptions::default()
        };
        let driver = Driver::of_skill(0.4);
        let simulated = simulate(&vehicle, &TrackShape::new(&track), &driver, &options).unwrap();
        let entry = simulated_entry("r", &track, "d", options.conditions);
        let mut run = record(&simulated, &vehicle, None, entry, seed);
        for name in without {
            run.columns.remove(*name);
        }
        let mut file = std::fs::File::create(folder.join(format!("{seed}.csv"))).unwrap();
        write_run(&run, &mut file, RunFormat::Csv).unwrap();
    }
    let text = format!("{header}\n1,1.csv{rows}\n2,2.csv{rows}\n");
    std::fs::write(folder.join("runs.csv"), text).unwrap();
}

fn vehicle(effects: &str) -> Vehicle {
    let text = Model::published().to_toml() + effects;
    Vehicle::with_effects(&Model::from_toml(&text, "model.toml").unwrap()).unwrap()
}

fn runs(folder: &Path) -> Vec<Run> {
    read_runs(&folder.join("runs.csv"), &Needs::FORCES, OnGaps::LeaveOut).unwrap()
}

fn prepared(folder: &Path, vehicle: &Vehicle) -> Result<Vec<Prepared>, Error> {
    prepare_all(&runs(folder), vehicle, None, &PrepareOptions::default())
}

#[test]
fn a_lateral_fit_does_not_depend_on_unused_columns() {
    let folder = tempfile::tempdir().unwrap();
    let fitted = |without: &[&str], header: &str, rows: &str| {
        written(folder.path(), without, header, rows);
        let vehicle = vehicle("");
        let runs = prepared(folder.path(), &vehicle).unwrap();
        fit(&runs, &vehicle, true).unwrap()
    };
    let header = "run,file,track,driver,driver_class,session,ice_c,air_c,air_pa";
    let whole = fitted(&[], header, ",west,A,b,c,-8,0,95000");
    let bare = fitted(&["ax_mps2", "s_m"], "run,file,air_pa,air_c", ",95000,0");
    assert_eq!(whole.front.law(), bare.front.law());
    assert_eq!(whole.rear.law(), bare.rear.law());
    let [whole, bare] = [whole, bare].map(|fit| fit.balances_left_rms);
    assert_eq!(whole.side_n, bare.side_n);
    assert!(whole.along_n.is_finite() && bare.along_n.is_nan());
}

#[test]
fn missing_columns_are_reported_with_the_computation() {
    let folder = tempfile::tempdir().unwrap();
    let reported = |vehicle: &Vehicle| prepared(folder.path(), vehicle).unwrap_err().to_string();
    written(folder.path(), &["gamma_rad"], "run,file", "");
    let index = folder.path().join("runs.csv");
    let error = read_runs(&index, &Needs::FORCES, OnGaps::LeaveOut).unwrap_err();
    let message = error.to_string();
    assert!(
        message.contains(
            "1.csv: column gamma_rad is missing, which is needed for the forces on the runners"
        ),
        "{message}"
    );
    // The examination notes the missing column, although the run has no fault.
    let examined = examine(&index).unwrap();
    let noted = |run: &Examination| {
        run.notes
            .iter()
            .any(|note| note.column == "gamma_rad" && note.what.contains("not recorded"))
    };
    let (first, _) = &examined[0];
    assert!(!first.is_wrong() && noted(first));
    // The position along the track needs no roll split and no weather.
    let runs = read_runs(&index, &Needs::PLACE, OnGaps::LeaveOut).unwrap();
    let options = PrepareOptions {
        needs: Needs::PLACE,
        ..PrepareOptions::default()
    };
    prepare(&runs[0], &vehicle(""), None, &options).unwrap();
    written(folder.path(), &["ax_mps2"], "run,file", "");
    let message = reported(&vehicle(""));
    assert!(
        message.contains("air_c, which the drag of sled.cda_m2 = 0.28 needs, is not stated"),
        "{message}"
    );
    let mut flat = vehicle("");
    flat.sled.cda_m2 = 0.0;
    let runs = prepared(folder.path(), &flat).unwrap();
    assert!(runs[0].states.iter().all(|state| state.fz_r_n.is_finite()));
    // An effect of a column that was not recorded is refused by its name.
    let message = reported(&vehicle(
        "\n[effects.own]\nexpression = \"ax_mps2\"\nchannel = \"lateral\"\nvalue = 1e-3\n",
    ));
    assert!(
        message.contains("own") && message.contains("ax_mps2"),
        "{message}"
    );
}

#[test]
fn ice_temperatures_along_the_track_act_at_their_positions() {
    let folder = tempfile::tempdir().unwrap();
    let header = "run,file,track,ice_c,air_c,air_pa";
    written(folder.path(), &[], header, ",west,-8,0,95000");
    let grip = vehicle("\n[effects.temperature-grip]\nslope_per_k = -0.01\n");
    let check_ice = |at: &[(f64, f64)]| {
        for run in prepared(folder.path(), &grip).unwrap() {
            for state in &run.states {
                let ice = IceAlong::new(at.iter().map(|(s, c)| [*s, *c]));
                let expected = ice.at(state.s_m).unwrap();
                assert!(
                    (state.conditions.ice_c - expected).abs() < 1e-9,
                    "{} m",
                    state.s_m
                );
            }
        }
    };
    check_ice(&[(0.0, -8.0)]);
    // The table of the track, with thermometers in two of its rows.
    let track = "s_m,slope_rad,curvature_1pm,bank_rad,ice_c\n0,0.1,0,0,\n200,0.1,0,0,-9\n800,0.1,0,0,-5\n1500,0.1,0,0,\n";
    std::fs::write(folder.path().join("track_west.csv"), track).unwrap();
    check_ice(&[(200.0, -9.0), (800.0, -5.0)]);
    // Thermometers in the index take precedence over those of the track.
    let header = "run,file,track,ice_c,air_c,air_pa,ice_c@1000,ice_c@100";
    written(folder.path(), &[], header, ",west,-8,0,95000,-2,-12");
    check_ice(&[(100.0, -12.0), (1000.0, -2.0)]);
    let entries = read_index(&folder.path().join("runs.csv")).unwrap();
    let mut back = Vec::new();
    write_index(&mut back, &entries).unwrap();
    let back = String::from_utf8(back).unwrap();
    assert!(
        back.starts_with(
            "run,file,track,driver,driver_class,session,ice_c,air_c,air_pa,ice_c@100,ice_c@1000\n"
        ),
        "{back}"
    );
    assert!(back.contains(",-8,0,95000,-12,-2"), "{back}");
    // The simulation uses the local ice temperature, not that of the conditions.
    let warm = vehicle("\n[effects.temperature]\nslope_per_k = -0.02\n");
    let mut track = sample_track("west");
    let finish = |ice: IceAlong, ice_c: f64, track: &mut kufe_sled::Track| {
        track.ice = ice;
        let mut options = SimulateOptions::default();
        options.conditions.ice_c = ice_c;
        let shape = TrackShape::new(track);
        let driver = Driver::of_skill(1.0);
        let run = simulate(&warm, &shape, &driver, &options).unwrap();
        run.instants.last().unwrap().state.t_s
    };
    let one = finish(IceAlong::default(), -12.0, &mut track);
    assert_eq!(one, finish(IceAlong::new([[0.0, -12.0]]), -3.0, &mut track));
    let both = finish(
        IceAlong::new([[700.0, -12.0], [701.0, -3.0]]),
        f64::NAN,
        &mut track,
    );
    let other = finish(IceAlong::default(), -3.0, &mut track);
    let (low, high) = (one.min(other), one.max(other));
    assert!(low < both && both < high, "{low} {both} {high}");
}
