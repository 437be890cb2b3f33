//! Conditions, materials and patches that the tests share.

use kufe_sled::friction::film::{Film, FilmConditions, FilmOptions, Properties, Strip, film};

/// Water and ice.
pub const WATER: Properties = Properties::WATER_AND_ICE;

/// Walls that take no heat.
pub const INSULATED: Properties = Properties {
    ice_conductivity: 0.0,
    steel_conductivity: 0.0,
    ..WATER
};

/// Ice as it is, steel that takes no heat.
pub const STEEL_INSULATED: Properties = Properties {
    steel_conductivity: 0.0,
    ..WATER
};

/// The film with the default accuracy.
pub fn solved(strip: &Strip, conditions: &FilmConditions, properties: &Properties) -> Film {
    film(strip, conditions, properties, &FilmOptions::default()).expect("a film")
}

/// A strip of `n` segments, closer towards both ends, with width and pressure as functions of the
/// share of the length.
pub fn strip(
    length: f64,
    n: usize,
    width: impl Fn(f64) -> f64,
    pressure: impl Fn(f64) -> f64,
) -> Strip {
    let share = |k: usize| 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / n as f64).cos();
    let shares: Vec<f64> = (0..=n)
        .map(|k| if k == n { 1.0 } else { share(k) })
        .collect();
    Strip::new(
        shares.iter().map(|at| at * length).collect(),
        shares.iter().map(|at| width(*at)).collect(),
        shares.iter().map(|at| pressure(*at)).collect(),
    )
    .expect("a strip")
}

/// The rounding of an ellipse: 0 at both ends, 1 in the middle.
pub fn rounding(share: f64) -> f64 {
    (4.0 * share * (1.0 - share)).max(0.0).sqrt()
}

/// A Hertzian patch: `width` in the middle, mean pressure `pi/4` of `peak` there.
pub fn hertz(length: f64, n: usize, width: f64, peak: f64) -> Strip {
    let mean = 0.25 * std::f64::consts::PI * peak;
    strip(
        length,
        n,
        |at| width * rounding(at),
        |at| mean * rounding(at),
    )
}
