//! Effects that can be hidden in a measured pressure map: parts of the problem with a switch and one parameter.
//!
//! An effect changes the [`Problem`] before it is solved ([`Effect::alter`]) or the map after it ([`Effect::sense`]). At 0
//! it changes nothing. A new one is a file and a line in [`CATALOGUE`].

mod hardness;
mod ice_modulus;
mod ice_thickness;
mod pitch_offset;
mod rocker_radius;
mod roll_tilt;
mod runner_compliance;
pub(crate) mod schema;
mod section_wear;
mod sensor_blur;
mod sensor_gain;
mod shaped;
mod turned;
mod waviness;

use std::collections::BTreeMap;

use crate::CaseError;
use kufe_contact::Problem;

/// Name, parameter and bounds of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Info {
    /// Name as in `[effects.NAME]`.
    pub name: &'static str,
    /// Key of its parameter, with the unit as suffix.
    pub key: &'static str,
    /// Unit as printed.
    pub unit: &'static str,
    /// Smallest admissible value.
    pub low: f64,
    /// Largest admissible value.
    pub high: f64,
    /// A noticeable size, from which steps of differences are taken.
    pub typical: f64,
    /// What would tell it from its rivals.
    pub decides: &'static str,
}

/// A pressure map on a regular grid, `ny` rows of `nx`, as a film or sensor array gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Columns.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
    /// Centre of the first pixel along the runner [m].
    pub x0: f64,
    /// Centre of the first pixel across [m].
    pub y0: f64,
    /// Pixel along [m].
    pub dx: f64,
    /// Pixel across [m].
    pub dy: f64,
    /// Pressure [Pa].
    pub pressure: Vec<f64>,
}

/// A switchable part of a contact problem or of its measurement.
pub trait Effect: Sync {
    /// What it is called.
    fn info(&self) -> &'static Info;
    /// Changes the problem before it is solved.
    fn alter(&self, _value: f64, _problem: &mut Problem) {}
    /// Changes the map as the sensor would.
    fn sense(&self, _value: f64, _map: &mut Map) {}
    /// Relative standard deviation of its size that its own form leaves open, whatever the noise.
    fn form_error(&self) -> f64 {
        0.0
    }
    /// Whether it leaves the problem as it is.
    fn is_of_the_sensor(&self) -> bool {
        false
    }
}

/// All effects on pressure maps.
pub static CATALOGUE: &[&dyn Effect] = &[
    &hardness::Hardness,
    &ice_modulus::IceModulus,
    &ice_thickness::IceThickness,
    &runner_compliance::RunnerCompliance,
    &roll_tilt::RollTilt,
    &pitch_offset::PitchOffset,
    &rocker_radius::RockerRadius,
    &section_wear::SectionWear,
    &waviness::Waviness,
    &sensor_gain::SensorGain,
    &sensor_blur::SensorBlur,
];

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static dyn Effect> {
    CATALOGUE
        .iter()
        .copied()
        .find(|effect| effect.info().name == name)
}

/// Changes a problem by the effects of a case's `[effects]` tables; those of the sensor leave it as it is.
///
/// # Errors
/// [`CaseError::Effect`] with the effect, what was found and what was expected.
pub fn switch_on(
    tables: &BTreeMap<String, toml::Table>,
    problem: &mut Problem,
) -> Result<(), CaseError> {
    for (name, table) in tables {
        let told = |found: String, expected: String| CaseError::Effect {
            name: name.clone(),
            found,
            expected,
        };
        let Some(effect) = find(name) else {
            let known: Vec<&str> = CATALOGUE.iter().map(|e| e.info().name).collect();
            return Err(told("an unknown effect".to_owned(), known.join(", ")));
        };
        let info = effect.info();
        if let Some(key) = table.keys().find(|key| *key != info.key) {
            return Err(told(format!("the key `{key}`"), format!("`{}`", info.key)));
        }
        let value = match table.get(info.key) {
            None => 0.0,
            Some(toml::Value::Float(value)) => *value,
            Some(toml::Value::Integer(value)) => *value as f64,
            Some(_) => f64::NAN,
        };
        if !(value >= info.low && value <= info.high) {
            let found = table
                .get(info.key)
                .map_or(String::new(), ToString::to_string);
            return Err(told(
                format!("`{}` = {found}", info.key),
                format!("a number from {} to {} {}", info.low, info.high, info.unit),
            ));
        }
        effect.alter(value, problem);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blurred_map_keeps_its_sum_and_loses_its_peak() {
        let mut map = Map {
            nx: 41,
            ny: 31,
            x0: 0.0,
            y0: 0.0,
            dx: 1e-3,
            dy: 1e-3,
            pressure: vec![0.0; 41 * 31],
        };
        map.pressure[15 * 41 + 20] = 1e6;
        let Some(blur) = find("sensor-blur") else {
            panic!("in the catalogue");
        };
        blur.sense(2e-3, &mut map);
        let sum: f64 = map.pressure.iter().sum();
        assert!((sum / 1e6 - 1.0).abs() < 1e-9, "{sum}");
        // A Gaussian of two pixels: peak 1/(2 pi 4).
        let peak = map.pressure.iter().copied().fold(0.0, f64::max);
        assert!(
            (peak / 1e6 * std::f64::consts::TAU * 4.0 - 1.0).abs() < 0.01,
            "{peak}"
        );
    }

    #[test]
    fn names_are_unique_and_bounds_hold_zero() {
        for effect in CATALOGUE {
            let info = effect.info();
            assert_eq!(find(info.name).map(|e| e.info().key), Some(info.key));
            assert!(info.low <= 0.0 && info.high > info.typical && info.typical > 0.0);
        }
    }
}
