//! Models with any effect of the catalogue are written, read and simulated.

use kufe_sled::effects::{CATALOGUE, Edge, Info};
use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Conditions, Driver, Error, Model, SimulateOptions, TrackShape, Vehicle, record, simulate,
    simulated_entry,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Number of models with each effect.
const DRAWS: usize = 12;

/// Values within the ranges of the parameters, including both ends. A window begins before it ends.
fn draw(info: &Info, random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut values: Vec<f64> = info
        .parameters
        .iter()
        .map(|parameter| match random.random_range(0..8) {
            0 => parameter.low,
            1 => parameter.high,
            2 => parameter.typical.clamp(parameter.low, parameter.high),
            _ => random.random_range(parameter.low..=parameter.high),
        })
        .collect();
    let position = |edge| info.parameters.iter().position(|p| p.edge == Some(edge));
    if let (Some(from), Some(to)) = (position(Edge::From), position(Edge::To))
        && values[from] > values[to]
    {
        values.swap(from, to);
    }
    values
}

#[test]
fn every_effect_within_its_ranges_round_trips_and_simulates() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let track = sample_track("west");
    let shape = TrackShape::new(&track);
    let driver = Driver::of_skill(0.9);
    let options = SimulateOptions {
        most_s: 1.0,
        conditions: Conditions {
            ice_c: -6.0,
            air_c: -2.0,
            air_pa: 94_000.0,
            humidity_pct: 70.0,
            distance_m: 3000.0,
            mass_kg: 400.0,
        },
        ..SimulateOptions::default()
    };
    let mut not_simulated = Vec::new();
    for effect in CATALOGUE.iter() {
        let info = effect.info();
        let mut simulated_count = 0;
        for _ in 0..DRAWS {
            let values = draw(info, &mut random);
            let mut table = toml::Table::new();
            for (parameter, value) in info.parameters.iter().zip(&values) {
                table.insert(parameter.name.to_owned(), (*value).into());
            }
            let mut model = Model::published();
            model.effects.insert(info.name.to_owned(), table);
            let text = model.to_toml();
            let context = format!("{} {values:?}", info.name);
            let read = Model::from_toml(&text, "model.toml");
            let read = read.unwrap_or_else(|error| panic!("{context}: {error}\n{text}"));
            assert_eq!(read.effects, model.effects, "{context}");
            let vehicle = Vehicle::with_effects(&read);
            let vehicle = match vehicle {
                Ok(vehicle) => vehicle,
                // Needs a table of sliding contacts.
                Err(error) => {
                    let reported = error.to_string();
                    let mut needs = info.needs.iter().map(|column| column.name());
                    let named =
                        needs.any(|name| reported.contains(&format!("needs the column {name}")));
                    assert!(named, "{context}: {reported}");
                    continue;
                }
            };
            match simulate(&vehicle, &shape, &driver, &options) {
                Ok(simulated) => {
                    let entry = simulated_entry("r", &track, "d", options.conditions);
                    let run = record(&simulated, &vehicle, None, entry, 1);
                    for (column, values) in &run.columns {
                        let finite = values.iter().all(|value| value.is_finite());
                        assert!(finite, "{context}: {column}");
                    }
                    simulated_count += 1;
                }
                // At the ends of the ranges a sled may stop or leave the track.
                Err(Error::Stopped { .. }) => {}
                Err(error) => panic!("{context}: {error}"),
            }
        }
        if simulated_count == 0 {
            not_simulated.push(info.name);
        }
    }
    // The film and its boundary friction need a table of sliding contacts.
    let of_tables = |name: &&str| ["film", "boundary"].contains(name);
    assert!(not_simulated.iter().all(of_tables), "{not_simulated:?}");
}
