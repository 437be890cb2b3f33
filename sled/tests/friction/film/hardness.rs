//! Ice hardness as a function of temperature and contact time.

use super::patches::WATER;
use kufe_sled::Error;
use kufe_sled::friction::film::{
    HARDNESS_EXPONENT, IceHardness, Properties, pressure_melting_bound,
};

/// Without pressure melting: the hardness is that of creep alone.
const NO_MELTING: Properties = Properties {
    melting_slope: 0.0,
    ..WATER
};

#[test]
fn hardness_equals_the_reference_and_follows_the_power_law_in_time() {
    let hardness = IceHardness::new(17.7e6, -5.0, 2.0e-3).expect("an anchor");
    let at = |t: f64, time: f64| hardness.at(t, time, &NO_MELTING).expect("a hardness");
    assert!((at(-5.0, 2.0e-3) / 17.7e6 - 1.0).abs() < 1e-14);
    let exponent = (at(-5.0, 2.0e-3) / at(-5.0, 0.2)).ln() / 100.0_f64.ln();
    assert!((exponent - 1.0 / HARDNESS_EXPONENT).abs() < 1e-12);
}

#[test]
fn arrhenius_slopes_are_the_two_activation_energies() {
    let hardness = IceHardness::new(15.0e6, -8.0, 1.0e-3).expect("an anchor");
    let at = |t: f64| hardness.at(t, 1.0e-3, &NO_MELTING).expect("a hardness");
    let energy = |warm: f64, cold: f64| {
        let inverse = 1.0 / (cold + 273.15) - 1.0 / (warm + 273.15);
        3.0 * 8.314_462_618 * (at(cold) / at(warm)).ln() / inverse
    };
    assert!((energy(-1.0, -7.0) / 120.0e3 - 1.0).abs() < 1e-9);
    assert!((energy(-9.0, -30.0) / 78.0e3 - 1.0).abs() < 1e-9);
    assert!((at(-8.0 - 1e-9) / at(-8.0 + 1e-9) - 1.0).abs() < 1e-9);
    assert!(at(-3.0) < at(-5.0) && at(-5.0) < at(-12.0));
}

#[test]
fn hardness_is_at_most_the_melting_pressure() {
    let hardness = IceHardness::new(17.7e6, -5.0, 2.0e-3).expect("an anchor");
    let bound = pressure_melting_bound(-0.5, &WATER);
    assert!((bound / (0.5 / 7.4e-8) - 1.0).abs() < 1e-12);
    assert_eq!(
        hardness.at(-0.5, 2.0e-3, &WATER).expect("a hardness"),
        bound
    );
    assert_eq!(hardness.at(0.0, 2.0e-3, &WATER).expect("a hardness"), 0.0);
    assert!(WATER.melting_temperature(bound) - (-0.5) < 1e-12);
    assert_eq!(pressure_melting_bound(-5.0, &NO_MELTING), f64::INFINITY);
}

#[test]
fn values_out_of_range_are_named() {
    let name = |result: Result<f64, Error>| match result {
        Err(Error::OutOfRange { name, .. }) => name,
        other => panic!("{other:?}"),
    };
    let hardness = IceHardness::new(17.7e6, -5.0, 2.0e-3).expect("an anchor");
    assert_eq!(name(hardness.at(1.0, 1.0, &WATER)), "temperature");
    assert_eq!(name(hardness.at(f64::NAN, 1.0, &WATER)), "temperature");
    assert_eq!(name(hardness.at(-1.0, 0.0, &WATER)), "contact_time");
    assert_eq!(
        name(IceHardness::new(-1.0, -5.0, 1.0).map(|_| 0.0)),
        "pressure"
    );
    assert_eq!(
        name(IceHardness::new(1.0e6, -5.0, f64::INFINITY).map(|_| 0.0)),
        "contact_time"
    );
}
