//! Conditions of a run: its mass, and its ice temperature stated, not stated, or measured along the
//! track.

use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Driver, Model, PrepareOptions, Run, SimulateOptions, Track, TrackShape, Vehicle, prepare,
    read_index, record, residuals, root_mean_square, simulate, simulated_entry, write_index,
};

/// The published sled with these lines appended.
fn model(more: &str) -> Model {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    std::fs::write(&path, Model::published().to_toml() + more).unwrap();
    Model::load(&path).unwrap()
}

fn driven(vehicle: &Vehicle, options: &SimulateOptions) -> Run {
    let track = sample_track("east");
    let driver = Driver::of_skill(0.6);
    let simulated = simulate(vehicle, &TrackShape::new(&track), &driver, options).unwrap();
    let entry = simulated_entry("r", &track, "d", options.conditions);
    record(&simulated, vehicle, None, entry, 1)
}

fn options() -> SimulateOptions {
    SimulateOptions {
        rate_hz: 100.0,
        most_s: 25.0,
        ..SimulateOptions::default()
    }
}

/// Residuals of the longitudinal and the lateral force balance [N].
fn balance_rms(run: &Run, vehicle: &Vehicle) -> [f64; 2] {
    let prepared = prepare(run, vehicle, None, &PrepareOptions::default()).unwrap();
    let residuals = root_mean_square(&residuals(&prepared, vehicle));
    [residuals.along_n, residuals.side_n]
}

#[test]
fn forces_use_the_mass_of_the_run() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let mut heavy = vehicle.clone();
    heavy.sled.mass_kg = 450.0;
    let mut run = driven(&heavy, &options());
    let [along, side] = balance_rms(&run, &vehicle);
    // The drag is not proportional to the mass, and the stiffnesses do not grow with it. A mass
    // that is 60 kg too small leaves a residual.
    assert!(along > 5.0 && side > 10.0, "{along} N, {side} N");
    run.entry.conditions.mass_kg = 450.0;
    let own = balance_rms(&run, &vehicle);
    let truth = balance_rms(&run, &heavy);
    for k in 0..2 {
        assert!(
            (own[k] - truth[k]).abs() < 1e-9,
            "{own:?} against {truth:?}"
        );
    }
    assert!(own[0] < 0.2 * along && own[1] < 0.2 * side, "{own:?}");
    // The simulator uses the same mass: the results are identical bit for bit.
    let mut with = options();
    with.conditions.mass_kg = 450.0;
    assert_eq!(driven(&vehicle, &with).columns, run.columns);
    // The effect adds the same mass to the run's mass as to the model's.
    let loaded = Vehicle::with_effects(&model("\n[effects.mass]\nexcess_kg = 10.0\n")).unwrap();
    assert_eq!(loaded.on_run("east", &with.conditions).sled.mass_kg, 460.0);
}

#[test]
fn effects_with_nan_or_an_unknown_track_are_named() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let run = driven(&vehicle, &options());
    // The square root of a negative number above 15 m/s, in a friction effect and in a sensor
    // effect.
    for channel in ["friction", "sensor:yaw_rate_radps"] {
        let effect = format!(
            "\n[effects.mine]\nexpression = \"0.001 * sqrt(15.0 - v_mps)\"\nchannel = {channel:?}\nvalue = 1.0\n"
        );
        let broken = Vehicle::with_effects(&model(&effect)).unwrap();
        let error = prepare(&run, &broken, None, &PrepareOptions::default());
        let error = error.unwrap_err().to_string();
        for part in ["r.csv", "[effects.mine]", "NaN at t = ", "a number"] {
            assert!(error.contains(part), "{channel}: {error}");
        }
    }
    let other_track = "\n[effects.temperature]\nslope_per_k = 0.02\ntrack = \"igls\"\n";
    let other_track = Vehicle::with_effects(&model(other_track)).unwrap();
    let reported = other_track.effects_elsewhere(&["east", "west"]);
    assert_eq!(reported.len(), 1);
    for part in ["[effects.temperature]", "\"igls\"", "east, west"] {
        assert!(reported[0].contains(part), "{reported:?}");
    }
    assert!(other_track.effects_elsewhere(&["igls"]).is_empty());
    // Two effects of one track are reported in one line.
    let both = "\n[effects.temperature]\nslope_per_k = 0.02\ntrack = \"igls\"\n[effects.speed]\nexponent = 0.5\ntrack = \"igls\"\n";
    let both = Vehicle::with_effects(&model(both)).unwrap();
    let reported = both.effects_elsewhere(&["east"]);
    assert_eq!(reported.len(), 1, "{reported:?}");
    assert!(
        reported[0].contains("[effects.temperature]") && reported[0].contains("[effects.speed]"),
        "{reported:?}"
    );
}

#[test]
fn a_track_in_kilometres_is_refused() {
    let mut track = sample_track("east");
    track.s_m.iter_mut().for_each(|s| *s /= 1000.0);
    let mut text = Vec::new();
    track.write_csv(&mut text).unwrap();
    let error = Track::from_csv(text.as_slice(), "east", "track_east.csv");
    let error = error.unwrap_err().to_string();
    for part in ["track_east.csv", "s_m", "1.25", "kilometres", "metres"] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn a_missing_ice_temperature_is_an_error_only_where_needed() {
    let folder = tempfile::tempdir().unwrap();
    let index = folder.path().join("runs.csv");
    std::fs::write(
        &index,
        "run,file,track,driver,driver_class,session,air_c,air_pa,mass_kg\nr,r.csv,east,d,c,1,-3,95000,412.5\n",
    )
    .unwrap();
    let entry = read_index(&index).unwrap().remove(0);
    assert!(entry.conditions.ice_c.is_nan());
    assert_eq!(entry.conditions.mass_kg, 412.5);
    let mut written = Vec::new();
    write_index(&mut written, std::slice::from_ref(&entry)).unwrap();
    std::fs::write(&index, &written).unwrap();
    let again = read_index(&index).unwrap().remove(0);
    assert!(again.conditions.ice_c.is_nan() && again.conditions.mass_kg == 412.5);
    std::fs::write(
        &index,
        String::from_utf8(written).unwrap().replace("412.5", "0"),
    )
    .unwrap();
    let error = read_index(&index).unwrap_err().to_string();
    assert!(
        error.contains("row 2, column mass_kg") && error.contains("from 1"),
        "{error}"
    );

    let vehicle = Vehicle::new(&Model::published()).unwrap();
    let mut run = driven(&vehicle, &options());
    run.entry.conditions.ice_c = f64::NAN;
    let [along, _] = balance_rms(&run, &vehicle);
    assert!(along.is_finite());
    let warm = Vehicle::with_effects(&model("\n[effects.temperature]\nslope_per_k = 0.02\n"));
    let warm = warm.unwrap();
    let error = prepare(&run, &warm, None, &PrepareOptions::default());
    let error = error.unwrap_err().to_string();
    assert!(
        ["r.csv", "temperature", "ice_c"]
            .iter()
            .all(|part| error.contains(part)),
        "{error}"
    );
    let mut unknown = options();
    unknown.conditions.ice_c = f64::NAN;
    let track = TrackShape::new(&sample_track("east"));
    let error = simulate(&warm, &track, &Driver::of_skill(0.9), &unknown).unwrap_err();
    assert!(error.to_string().contains("ice_c"), "{error}");
    // Sample by sample in the file of the run, as from thermometers along the track.
    let places = run.columns["s_m"].clone();
    let ice: Vec<f64> = places.iter().map(|s| -9.0 + 4.0 * s / 1250.0).collect();
    run.columns.insert("ice_c".to_string(), ice);
    let prepared = prepare(&run, &warm, None, &PrepareOptions::default()).unwrap();
    for state in &prepared.states {
        // Linear in the position. The low-pass filter changes a linear signal only at the ends.
        assert!(
            (state.conditions.ice_c - (-9.0 + 4.0 * state.s_m / 1250.0)).abs() < 1e-3,
            "{state:?}"
        );
    }
}
