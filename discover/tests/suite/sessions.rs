//! Friction experiments of several days, each with an offset of its own.

use std::fmt::Write as _;

use kufe_discover::{Options, discover};
use kufe_sled::Model;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const MU: f64 = 0.0045;
/// Relative standard deviations: of a measurement, and of what differs from day to day.
const SCATTER: f64 = 0.03;
const BY_DAY: f64 = 0.06;

/// Twelve rows on each of five days. The thermometer reads the day's temperature to 0.1 K; no
/// column changes friction, but for a power of the speed.
fn table(seed: u64, exponent: f64) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = |random: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(random) };
    let mut text =
        String::from("specimen,session,p_max_pa,p_max_sd_pa,mu,mu_sd,v_mps,fz_n,ice_c\n");
    for day in 0..5 {
        let (ice_c, offset) = (
            random.random_range(-13.0..-2.0),
            BY_DAY * normal(&mut random),
        );
        for row in 0..12 {
            let v_mps: f64 = random.random_range(2.0..10.0);
            let change = offset + SCATTER * normal(&mut random);
            let mu = MU * (v_mps / 6.0).powf(exponent) * (1.0 + change);
            let (fz_n, read) = (random.random_range(300.0..900.0), 0.1 * normal(&mut random));
            writeln!(
                text,
                "s{},d{day},{:.3e},0.1e6,{mu:.7},{:.7},{v_mps:.2},{fz_n:.0},{:.2}",
                row % 6,
                random.random_range(8e6..14e6),
                MU * SCATTER,
                ice_c + read
            )
            .unwrap();
        }
    }
    text
}

/// Names of the effects found in a table, with those that explain it as well.
fn found(text: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("experiments.csv");
    std::fs::write(&path, text).unwrap();
    let model = folder.path().join("model.toml");
    std::fs::write(&model, Model::published().to_toml()).unwrap();
    let found = discover(&path, Some(&model), &Options::default(), &|_| {}).unwrap();
    let steps = found.report.steps.into_iter();
    steps.flat_map(|step| step.class).collect()
}

/// Without a random effect of the days, 15 of 20 such tables named the temperature or the order of
/// the rows.
#[test]
fn days_that_differ_are_no_effect_of_their_temperature() {
    let named = (1..=20).filter(|seed| !found(&table(*seed, 0.0)).is_empty());
    assert!(named.count() <= 2);
}

#[test]
fn a_power_of_the_speed_is_found_although_days_differ() {
    let is_found = |seed: &u64| found(&table(*seed, 0.2)).iter().any(|name| name == "speed");
    let hits = (1..=5).filter(is_found).count();
    assert!(hits >= 4, "{hits}");
}
