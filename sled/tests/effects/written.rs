//! A model with any effect of the catalogue is written, read and simulated.

use kufe_sled::effects::{CATALOGUE, Edge, Info};
use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Conditions, Driver, Error, Model, SimulateOptions, TrackShape, Vehicle, record, simulate,
    simulated_entry,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Models with each effect.
const DRAWS: usize = 12;

/// Values within the ranges of the parameters, both ends among them; a stretch begins before it
/// ends.
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
    let place = |edge| info.parameters.iter().position(|p| p.edge == Some(edge));
    if let (Some(from), Some(to)) = (place(Edge::From), place(Edge::To))
        && values[from] > values[to]
    {
        values.swap(from, to);
    }
    values
}

#[test]
fn every_effect_within_its_ranges_is_written_read_and_simulated() {
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
    let mut undriven = Vec::new();
    for effect in CATALOGUE.iter() {
        let info = effect.info();
        let mut driven = 0;
        for _ in 0..DRAWS {
            let values = draw(info, &mut random);
            let mut table = toml::Table::new();
            for (parameter, value) in info.parameters.iter().zip(&values) {
                table.insert(parameter.name.to_owned(), (*value).into());
            }
            let mut model = Model::published();
            model.effects.insert(info.name.to_owned(), table);
            let text = model.to_toml();
            let place = format!("{} {values:?}", info.name);
            let read = Model::from_toml(&text, "model.toml");
            let read = read.unwrap_or_else(|error| panic!("{place}: {error}\n{text}"));
            assert_eq!(read.effects, model.effects, "{place}");
            let vehicle = Vehicle::with_effects(&read);
            let vehicle = match vehicle {
                Ok(vehicle) => vehicle,
                // What a table of sliding contacts alone gives.
                Err(error) => {
                    let reported = error.to_string();
                    let mut needs = info.needs.iter().map(|column| column.name());
                    let named =
                        needs.any(|name| reported.contains(&format!("needs the column {name}")));
                    assert!(named, "{place}: {reported}");
                    continue;
                }
            };
            match simulate(&vehicle, &shape, &driver, &options) {
                Ok(simulated) => {
                    let entry = simulated_entry("r", &track, "d", options.conditions);
                    let run = record(&simulated, &vehicle, None, entry, 1);
                    for (column, values) in &run.columns {
                        let finite = values.iter().all(|value| value.is_finite());
                        assert!(finite, "{place}: {column}");
                    }
                    driven += 1;
                }
                // At the ends of the ranges a sled may come to rest or leave the track.
                Err(Error::Stopped { .. }) => {}
                Err(error) => panic!("{place}: {error}"),
            }
        }
        if driven == 0 {
            undriven.push(info.name);
        }
    }
    // The film and what it leaves to the solid contact come from a table of sliding contacts.
    let of_tables = |name: &&str| ["film", "boundary"].contains(name);
    assert!(undriven.iter().all(of_tables), "{undriven:?}");
}
