//! Effects of a model act in the simulation, and the same model explains the simulated run.

use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    BalanceResidual, Driver, Model, PrepareOptions, Run, SimulateOptions, Simulated, TrackShape,
    Vehicle, prepare_all, record, simulate, simulated_entry, validate,
};

fn driven(vehicle: &Vehicle) -> (Simulated, Run) {
    let track = sample_track("west");
    let options = SimulateOptions::default();
    let driver = Driver::of_skill(0.5);
    let simulated = simulate(vehicle, &TrackShape::new(&track), &driver, &options).unwrap();
    let entry = simulated_entry("r", &track, "d", options.conditions);
    let run = record(&simulated, vehicle, None, entry, 1);
    (simulated, run)
}

#[test]
fn lateral_and_sensor_effects_are_explained_by_their_model() {
    for (name, keys) in [
        ("temperature-grip", "slope_per_k = -0.05"),
        ("camber-thrust", "coefficient_per_rad = 0.5"),
        ("lever-arm", "x_m = 0.3\nz_m = -0.2"),
        ("slip-offset", "offset_rad = 0.004"),
        ("slip-lag", "time_s = 0.03"),
        ("relaxation-length", "length_m = 0.5"),
        ("mass", "excess_kg = 40.0"),
    ] {
        let text = format!(
            "{}\n[effects.{name}]\n{keys}\n",
            Model::published().to_toml()
        );
        let model = Model::from_toml(&text, "m.toml").unwrap();
        let with = Vehicle::with_effects(&model).unwrap();
        let without = Vehicle::new(&model).unwrap();
        let (simulated, run) = driven(&with);
        assert!(simulated.energy.relative_error() < 1e-6);
        let rmse = |vehicle: &Vehicle| {
            let prepared = prepare_all(
                std::slice::from_ref(&run),
                vehicle,
                model.noise.as_ref(),
                &PrepareOptions::default(),
            )
            .unwrap();
            validate(&prepared, vehicle)[0].rmse_n
        };
        let (explained, unexplained) = (rmse(&with), rmse(&without));
        println!("{name}: {explained:.2} N with the effect, {unexplained:.2} N without");
        // A lag is corrected only to first order in its time; all other effects are corrected far
        // better.
        let share = if name == "slip-lag" { 0.25 } else { 0.02 };
        assert!(
            explained < share * unexplained,
            "{name}: {explained} against {unexplained}"
        );
        assert!(unexplained > 2.0, "{name} has no influence: {unexplained}");
    }
}

/// RMS residuals of the balances of a run, with the effects of `tables` in the model and without.
fn residuals_with_and_without(tables: &str) -> [BalanceResidual; 2] {
    let text = format!("{}\n{tables}\n", Model::published().to_toml());
    let model = Model::from_toml(&text, "m.toml").unwrap();
    let with = Vehicle::with_effects(&model).unwrap();
    let (simulated, run) = driven(&with);
    assert!(simulated.energy.relative_error() < 1e-6, "{tables}");
    [with, Vehicle::new(&model).unwrap()].map(|vehicle| {
        let runs = std::slice::from_ref(&run);
        let noise = model.noise.as_ref();
        let prepared = prepare_all(runs, &vehicle, noise, &PrepareOptions::default());
        validate(&prepared.unwrap(), &vehicle)[0].left_rms
    })
}

#[test]
fn sensor_faults_and_inertia_are_explained_in_their_balance() {
    let side: fn(&BalanceResidual) -> f64 = |residual| residual.side_n;
    let along: fn(&BalanceResidual) -> f64 = |residual| residual.along_n;
    let yaw: fn(&BalanceResidual) -> f64 = |residual| residual.yaw_nm;
    let own = "[effects.mine]\nvalue = 1.0\n";
    // Residual of filters and differences without a hidden effect.
    let [baseline, _] = residuals_with_and_without("");
    for (tables, balance, share) in [
        (
            "[effects.yaw-rate-scale]\nfactor = 0.1".to_owned(),
            side,
            0.02,
        ),
        (
            "[effects.yaw-rate-bias]\noffset_radps = 0.02".to_owned(),
            side,
            0.02,
        ),
        // A lag is corrected only to first order in its time.
        ("[effects.steer-lag]\ntime_s = 0.03".to_owned(), side, 0.25),
        (
            "[effects.speed-scale]\nfactor = 0.05".to_owned(),
            along,
            0.02,
        ),
        ("[effects.yaw-inertia]\nfactor = 0.3".to_owned(), yaw, 0.1),
        (
            format!(
                "{own}channel = \"sensor:yaw_rate_radps\"\nexpression = \"0.1 * yaw_rate_radps\""
            ),
            side,
            0.02,
        ),
        (
            format!(
                "{own}channel = \"sensor:ay_mps2\"\nexpression = \"0.02 * az_mps2 + 0.001 * v_mps\""
            ),
            side,
            0.02,
        ),
        (
            format!("{own}channel = \"yaw\"\nexpression = \"v_mps^2 * delta_rad\""),
            yaw,
            0.1,
        ),
    ] {
        let [explained, unexplained] =
            residuals_with_and_without(&tables).map(|residual| balance(&residual));
        println!("{tables}: {explained:.3} with the effect, {unexplained:.3} without");
        assert!(
            unexplained > 2.0,
            "{tables} has no influence: {unexplained}"
        );
        assert!(
            explained < balance(&baseline) + share * unexplained,
            "{tables}: {explained} against {unexplained}"
        );
    }
}

#[test]
fn longitudinal_effects_and_the_slope_change_the_speed() {
    let end = |table: &str| {
        let text = format!("{}\n{table}\n", Model::published().to_toml());
        let model = Model::from_toml(&text, "m.toml").unwrap();
        let (simulated, _) = driven(&Vehicle::with_effects(&model).unwrap());
        simulated.instants.last().unwrap().state.v_mps
    };
    let base = end("");
    for table in [
        "[effects.drag-area]\ncda_m2 = 0.05",
        "[effects.headwind]\nspeed_mps = 3.0",
        "[effects.slope]\noffset_rad = -0.005",
    ] {
        assert!(
            end(table) < base - 0.2,
            "{table}: {} against {base}",
            end(table)
        );
    }
    // An effect bound to another track has no influence.
    let other_track = end("[effects.slope]\noffset_rad = -0.005\ntrack = \"east\"");
    assert_eq!(other_track.to_bits(), base.to_bits());
}

#[test]
fn an_unknown_effect_is_refused_by_name() {
    let text = format!(
        "{}\n[effects.magic]\nsize = 1.0\n",
        Model::published().to_toml()
    );
    let model = Model::from_toml(&text, "m.toml").unwrap();
    let message = Vehicle::with_effects(&model).unwrap_err().to_string();
    assert!(
        message.contains("effects.magic") && message.contains("temperature-grip"),
        "{message}"
    );
}
