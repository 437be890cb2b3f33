//! Every effect of the catalogue changes the simulation. It also changes fit, validation and
//! evaluation, except for effects on the slope, which is in none of their force balances. An effect
//! that cannot act is refused by its name.

use std::path::Path;
use std::sync::LazyLock;

use kufe_sled::effects::{ActsOn, CATALOGUE, Effect, Experiments};
use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Driver, Model, Prepared, Run, SimulateOptions, Track, TrackShape, Vehicle, evaluate, fit,
    prepare_all, record, simulate, simulated_entry, validate,
};

use serde_json::Value;

use crate::tables_of_mu::write_table;

/// The first part of a sample track: a few seconds suffice to detect a change.
fn track() -> Track {
    let mut track = sample_track("west");
    let rows = track.s_m.iter().filter(|s| **s < 350.0).count();
    for column in [
        &mut track.s_m,
        &mut track.slope_rad,
        &mut track.curvature_1pm,
        &mut track.bank_rad,
    ] {
        column.truncate(rows);
    }
    track
}

/// A friction table for the effect that needs one.
static TABLE: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    write_table(&folder.path().join("mu.lut"), 50.0, true);
    folder
});

fn model(effect: &Effect, conditions: &str) -> Model {
    let table = TABLE.path().join("mu.lut");
    let tables = format!("mu = 0.004\nfront_table = {table:?}\nrear_table = {table:?}\n");
    let keys: Vec<String> = effect
        .info
        .parameters
        .iter()
        .filter(|p| p.is_amplitude())
        .map(|p| format!("{} = {:?}", p.name, p.default + p.typical))
        .collect();
    let text = format!(
        "{}\n{conditions}\n[effects.{}]\n{}\n",
        Model::published()
            .to_toml()
            .replace("mu = 0.004\n", &tables),
        effect.info.name,
        keys.join("\n")
    );
    Model::from_toml(&text, "model.toml").unwrap()
}

fn driven(vehicle: &Vehicle) -> Result<Run, kufe_sled::Error> {
    let track = track();
    let options = SimulateOptions::default();
    let shape = TrackShape::new(&track);
    let simulated = simulate(vehicle, &shape, &Driver::of_skill(0.4), &options)?;
    let entry = simulated_entry("r", &track, "d", options.conditions);
    Ok(record(&simulated, vehicle, None, entry, 1))
}

fn prepared(
    run: &Run,
    vehicle: &Vehicle,
    model: &Model,
) -> Result<Vec<Prepared>, kufe_sled::Error> {
    let runs = std::slice::from_ref(run);
    prepare_all(runs, vehicle, model.noise.as_ref(), &Default::default())
}

fn effects_on_runs() -> impl Iterator<Item = &'static &'static Effect> {
    CATALOGUE.iter().filter(|effect| {
        let info = &effect.info;
        let outside_runs = |on: &ActsOn| matches!(on, ActsOn::Contact | ActsOn::Map);
        info.experiments != Experiments::OverFilm && !info.acts_on.iter().all(outside_runs)
    })
}

const STATED: &str = "[conditions]\nhumidity_pct = 40.0\ndistance_m = 5000.0\n";

#[test]
fn every_effect_changes_a_simulated_run() {
    let plain = driven(&Vehicle::new(&Model::published()).unwrap()).unwrap();
    for effect in effects_on_runs() {
        let vehicle = Vehicle::with_effects(&model(effect, STATED)).unwrap();
        let run = driven(&vehicle).unwrap();
        assert!(run.len() > 64, "{}", effect.info.name);
        assert_ne!(
            run.columns, plain.columns,
            "{} has no influence",
            effect.info.name
        );
    }
}

#[test]
fn every_effect_except_slope_changes_fit_validation_and_evaluation() {
    let base = Model::published();
    let plain = Vehicle::new(&base).unwrap();
    let run = driven(&plain).unwrap();
    let results = |runs: &[Prepared], vehicle: &Vehicle| {
        let fitted = fit(runs, vehicle, true).unwrap();
        [
            serde_json::to_value(fitted).unwrap(),
            serde_json::to_value(validate(runs, vehicle)).unwrap(),
            serde_json::to_value(evaluate(runs, vehicle)).unwrap(),
        ]
    };
    let without = results(&prepared(&run, &plain, &base).unwrap(), &plain);
    for effect in effects_on_runs() {
        let (name, model) = (effect.info.name, model(effect, STATED));
        let vehicle = Vehicle::with_effects(&model).unwrap();
        let with = results(&prepared(&run, &vehicle, &model).unwrap(), &vehicle);
        let on_slope = effect.info.acts_on.contains(&ActsOn::Track);
        for (k, command) in ["fit", "validate", "evaluate"].iter().enumerate() {
            if on_slope {
                let same = nearly_equal(&with[k], &without[k]);
                assert!(same, "{name} changes {command}");
                continue;
            }
            assert_ne!(with[k], without[k], "{name} does not change {command}");
        }
    }
}

/// Whether two JSON values are equal, with numbers equal within rounding.
fn nearly_equal(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|x| x.as_f64().unwrap());
            (a - b).abs() <= 1e-6 * a.abs().max(b.abs()) + 1e-12
        }
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| nearly_equal(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len()
                && a.iter()
                    .all(|(key, a)| b.get(key).is_some_and(|b| nearly_equal(a, b)))
        }
        _ => a == b,
    }
}

#[test]
fn a_missing_column_of_an_effect_is_reported_with_effect_and_file() {
    for (name, column) in [("humidity", "humidity_pct"), ("wear", "distance_m")] {
        let effect = kufe_sled::effects::find(name).unwrap();
        let bare = model(effect, "");
        let vehicle = Vehicle::with_effects(&bare).unwrap();
        let message = driven(&vehicle).unwrap_err().to_string();
        assert!(
            message.contains(name) && message.contains(column),
            "{message}"
        );

        let base = Model::published();
        let mut run = driven(&Vehicle::new(&base).unwrap()).unwrap();
        run.entry.file = Path::new("somewhere/r.csv").to_path_buf();
        let message = prepared(&run, &vehicle, &bare).unwrap_err().to_string();
        for part in [name, column, "somewhere/r.csv"] {
            assert!(message.contains(part), "{message}");
        }

        // A value in the index and values per sample in the file of the run both act, with
        // different results.
        run.entry.conditions.humidity_pct = 30.0;
        run.entry.conditions.distance_m = 3000.0;
        let by_index = evaluate(&prepared(&run, &vehicle, &bare).unwrap(), &vehicle);
        let rising = (0..run.len()).map(|i| 50.0 + i as f64 / run.len() as f64);
        run.columns.insert(column.to_string(), rising.collect());
        let by_sample = evaluate(&prepared(&run, &vehicle, &bare).unwrap(), &vehicle);
        assert_ne!(by_index[0].e_tot_loss_j, by_sample[0].e_tot_loss_j);
    }
}
