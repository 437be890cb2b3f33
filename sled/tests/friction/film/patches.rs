//! Conditions, materials and patches shared by the tests.

use kufe_sled::friction::film::{Film, FilmConditions, FilmOptions, Properties, Strip, film};

/// Water and ice.
pub const WATER: Properties = Properties::WATER_AND_ICE;

/// Ice and steel without heat conduction.
pub const INSULATED: Properties = Properties {
    ice_conductivity: 0.0,
    steel_conductivity: 0.0,
    ..WATER
};

/// Real ice, and steel without heat conduction.
pub const STEEL_INSULATED: Properties = Properties {
    steel_conductivity: 0.0,
    ..WATER
};

/// The film with the default accuracy.
pub fn solved(strip: &Strip, conditions: &FilmConditions, properties: &Properties) -> Film {
    film(strip, conditions, properties, &FilmOptions::default()).expect("a film")
}

/// A strip of `n` segments, refined towards both ends; width and pressure are functions of the
/// relative position.
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

/// The relative half-width of an ellipse: 0 at both ends, 1 in the middle.
pub fn rounding(share: f64) -> f64 {
    (4.0 * share * (1.0 - share)).max(0.0).sqrt()
}

/// A Hertzian patch: the middle has the width `width` and the mean pressure `pi/4 peak`.
pub fn hertz(length: f64, n: usize, width: f64, peak: f64) -> Strip {
    let mean = 0.25 * std::f64::consts::PI * peak;
    strip(
        length,
        n,
        |at| width * rounding(at),
        |at| mean * rounding(at),
    )
}
