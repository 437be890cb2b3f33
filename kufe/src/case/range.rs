//! The ranges of a case's numbers, stated once.

use schemars::Schema;
use schemars::transform::Transform;
use serde_json::{Map, Value};

use crate::case::{Case, CaseError};

pub(crate) type Checked = Result<(), CaseError>;

/// The range of a key's value.
///
/// This table is the only place that states it: the reader, the JSON schema and the page of keys
/// take it from here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The key, dotted.
    pub key: &'static str,
    /// Description of the value with its unit.
    pub what: &'static str,
    /// Smallest value.
    pub low: f64,
    /// Largest value; infinite for a radius of at most [`LARGEST_RADIUS`] or `inf`.
    pub high: f64,
}

/// Largest finite radius [m]; a runner or a track of this radius is practically straight.
pub const LARGEST_RADIUS: f64 = 1e6;

const ANY_RADIUS: f64 = f64::INFINITY;

impl Range {
    /// The range of a key; `None` for a key without a range.
    pub(crate) fn find(key: &str) -> Option<&'static Range> {
        RANGES.iter().find(|range| range.key == key)
    }

    /// Description and range, for messages.
    pub(crate) fn expected(&self) -> String {
        format!("{} from {}", self.what, self.words())
    }

    /// The range in words, as `0.001 to 100` or `0.05 to 1e6, or inf`.
    pub fn words(&self) -> String {
        let low = plain(self.low);
        if self.high.is_finite() {
            format!("{low} to {}", plain(self.high))
        } else {
            format!("{low} to {}, or inf", plain(LARGEST_RADIUS))
        }
    }

    /// Whether the range contains a value; false for NaN.
    pub fn holds(&self, value: f64) -> bool {
        let infinite = value == f64::INFINITY || value <= LARGEST_RADIUS;
        (self.low..=self.high).contains(&value) && (self.high.is_finite() || infinite)
    }
}

/// Writes the ranges of a table's keys into its schema.
pub(crate) struct Bounds(pub &'static str);

impl Transform for Bounds {
    fn transform(&mut self, schema: &mut Schema) {
        if let Some(object) = schema.as_object_mut() {
            self.bound(object);
        }
    }
}

impl Bounds {
    fn bound(&self, object: &mut Map<String, Value>) {
        let variants = object.get_mut("oneOf").and_then(Value::as_array_mut);
        let variants = variants.into_iter().flatten();
        variants
            .filter_map(Value::as_object_mut)
            .for_each(|variant| self.bound(variant));
        let properties = object.get_mut("properties").and_then(Value::as_object_mut);
        for (name, property) in properties.into_iter().flatten() {
            // A key that takes a number or a word has a schema with bounds already.
            let property = property.as_object_mut().filter(|p| p.contains_key("type"));
            let range = Range::find(&format!("{}.{name}", self.0));
            let (Some(range), Some(property)) = (range, property) else {
                continue;
            };
            property.insert("minimum".into(), range.low.into());
            if range.high.is_finite() {
                property.insert("maximum".into(), range.high.into());
            }
        }
    }
}

macro_rules! ranges {
    ($($key:literal $what:literal $low:expr, $high:expr;)*) => {
        /// The ranges of a case's numbers.
        ///
        /// `track.radius_m` is not listed: its magnitude is 1 m to [`LARGEST_RADIUS`], or `inf`.
        /// The numbers of a runner's shape must fulfil further conditions.
        pub const RANGES: &[Range] = &[
            $(Range { key: $key, what: $what, low: $low, high: $high }),*
        ];
    };
}

ranges! {
    "runner.scale" "a scale" 1e-6, 1000.0;
    "runner.yaw_rad" "an angle in radians" -1.6, 1.6;
    "runner.pitch_rad" "an angle in radians" -1.6, 1.6;
    "runner.roll_rad" "an angle in radians" -1.6, 1.6;
    "runner.noise_m" "a standard deviation in metres" 0.0, 0.001;
    "runner.height_m" "a height in metres" 0.001, 1.0;
    "runner.youngs_modulus_pa" "a modulus in pascals" 1e6, 1e13;
    "runner.poissons_ratio" "a Poisson's ratio" 0.0, 0.499;
    "runner.shape.length_m" "a length in metres" 0.01, 10.0;
    "runner.shape.rocker_radius_m" "a radius in metres" 0.05, ANY_RADIUS;
    "runner.shape.section_radius_m" "a radius in metres" 1e-4, LARGEST_RADIUS;
    "runner.shape.edge_radius_m" "a radius in metres" 1e-4, 1.0;
    "runner.shape.tilt_rad" "an angle in radians" 0.0, 0.8;
    "runner.shape.width_m" "a width in metres" 1e-4, 1.0;
    "runner.shape.height_m" "a height in metres" 0.001, 1.0;
    "runner.section.worn_m" "a depth in metres" 0.0, 0.01;
    "runner.section.worn_edge" "a part of the section's radius" 0.0, 1.0;
    "runner.mount.held.x_m" "a place in metres" -10.0, 10.0;
    "runner.mount.held.length_m" "a length in metres" 0.001, 10.0;
    "runner.mount.carries.x_m" "a place in metres" -10.0, 10.0;
    "runner.mount.carries.length_m" "a length in metres" 0.001, 10.0;
    "runner.mount.carries.share" "a part of the load" 1e-6, 1.0;
    "ice.temperature_c" "a temperature in degrees Celsius" -50.0, 0.0;
    "ice.youngs_modulus_pa" "a modulus in pascals" 1e6, 1e13;
    "ice.poissons_ratio" "a Poisson's ratio" 0.0, 0.499;
    "ice.thickness_m" "a thickness in metres" 0.001, 100.0;
    "ice.hardness_pa" "a pressure in pascals" 1e5, 1e10;
    "ice.bed.youngs_modulus_pa" "a modulus in pascals" 1e6, 1e13;
    "ice.bed.poissons_ratio" "a Poisson's ratio" 0.0, 0.499;
    "ice.bed.thickness_m" "a thickness in metres" 0.001, 100.0;
    "ice.waviness.amplitude_m" "an amplitude in metres" -0.01, 0.01;
    "ice.waviness.wavelength_m" "a wavelength in metres" 0.001, 1000.0;
    "ice.waviness.direction_rad" "an angle in radians" -10.0, 10.0;
    "ice.waviness.phase_rad" "an angle in radians" -100.0, 100.0;
    "track.curvature_1pm" "a curvature in 1/m" -1.0, 1.0;
    "sliding.v_mps" "a speed in m/s" 0.01, 100.0;
    "sliding.ice_c" "a temperature in degrees Celsius below the melting point" -50.0, -0.1;
    "sliding.viscosity_factor" "a factor" 0.01, 1000.0;
    "sliding.roughness_m" "a standard deviation in metres" 0.0, 1e-4;
    "sliding.boundary_shear_pa" "a shear stress in pascals" 0.0, 1e7;
    "sliding.hardness.pressure_pa" "a pressure in pascals" 1e5, 1e9;
    "sliding.hardness.ice_c" "a temperature in degrees Celsius" -50.0, 0.0;
    "sliding.hardness.contact_time_s" "a time in seconds" 1e-6, 1e6;
    "load.fz_n" "a force in newtons" 0.001, 1e7;
    "load.offset_x_m" "a place in metres" -10.0, 10.0;
    "load.offset_y_m" "a place in metres" -10.0, 10.0;
    "load.pitch_rad" "an angle in radians" -0.1, 0.1;
    "load.roll_rad" "an angle in radians" -0.1, 0.1;
    "accuracy.p_max" "a relative error" 1e-4, 0.5;
}

/// The shortest usual notation of a number.
fn plain(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-4..1e5).contains(&value.abs()) {
        return value.to_string();
    }
    format!("{value:e}")
}

/// Checks every number of a case that has a range.
pub(crate) fn check_ranges(case: &Case) -> Checked {
    let written = toml::Value::try_from(case).map_err(|error| CaseError::Unwritable {
        reason: error.to_string(),
    })?;
    check_under("", &written)
}

/// Checks all numbers in the value of a dotted key; numbers in a list have the key of the list.
fn check_under(key: &str, value: &toml::Value) -> Checked {
    match value {
        toml::Value::Float(number) => match Range::find(key) {
            Some(range) => require(range.holds(*number), range.key, *number, range.expected()),
            None => Ok(()),
        },
        toml::Value::Array(items) => items.iter().try_for_each(|item| check_under(key, item)),
        toml::Value::Table(table) => table.iter().try_for_each(|(name, value)| {
            let dot = if key.is_empty() { "" } else { "." };
            check_under(&format!("{key}{dot}{name}"), value)
        }),
        _ => Ok(()),
    }
}

pub(crate) fn require(
    holds: bool,
    key: &'static str,
    value: f64,
    expected: impl Into<String>,
) -> Checked {
    if holds {
        return Ok(());
    }
    Err(CaseError::OutOfRange {
        line: 0,
        key,
        value: plain(value),
        expected: expected.into(),
    })
}

pub(crate) fn combination(key: &'static str, expected: &'static str) -> CaseError {
    CaseError::Combination {
        line: 0,
        key,
        expected,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOB: &str = "{ kind = \"bob\", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.005, \
                       width_m = 0.01, height_m = 0.03 }";
    const LUGE: &str = "{ kind = \"luge\", length_m = 0.6, rocker_radius_m = 25.0, edge_radius_m = 3e-4, \
                        tilt_rad = 0.02, width_m = 0.02, height_m = 0.008 }";

    /// A case with every key that has a number; which keys go together is not checked before the
    /// ranges.
    fn all_keys(shape: &str) -> toml::Table {
        let text = format!(
            "[runner]
             shape = {shape}
             elastic = true
             scale = 1.0
             yaw_rad = 0.0
             pitch_rad = 0.0
             roll_rad = 0.0
             noise_m = 0.0
             height_m = 0.03
             youngs_modulus_pa = 2.1e11
             poissons_ratio = 0.3
             [runner.section]
             worn_m = 0.0
             worn_edge = 0.5
             [runner.mount]
             held = [{{ x_m = 0.0, length_m = 0.1 }}]
             carries = [{{ x_m = 0.0, length_m = 0.1, share = 1.0 }}]
             [ice]
             temperature_c = -5.0
             youngs_modulus_pa = 9e9
             poissons_ratio = 0.33
             thickness_m = 0.05
             hardness_pa = 1e7
             bed = {{ youngs_modulus_pa = 3e10, poissons_ratio = 0.2, thickness_m = 0.2 }}
             waviness = {{ amplitude_m = 0.0, wavelength_m = 0.1, direction_rad = 0.0, phase_rad = 0.0 }}
             [track]
             curvature_1pm = 0.0
             [sliding]
             v_mps = 20.0
             ice_c = -5.0
             viscosity_factor = 1.0
             roughness_m = 0.0
             boundary_shear_pa = 0.0
             hardness = {{ pressure_pa = 1e7, ice_c = -5.0, contact_time_s = 1.0 }}
             [load]
             fz_n = 1000.0
             offset_x_m = 0.0
             offset_y_m = 0.0
             pitch_rad = 0.0
             roll_rad = 0.0
             [accuracy]
             p_max = 0.01
            "
        );
        text.parse().expect("TOML")
    }

    /// The number of a dotted key, in the first item of lists.
    fn number<'a>(table: &'a mut toml::Table, key: &str) -> Option<&'a mut toml::Value> {
        let (first, rest) = key.split_once('.').unwrap_or((key, ""));
        let mut value = table.get_mut(first)?;
        if let toml::Value::Array(items) = value {
            value = items.first_mut()?;
        }
        match value {
            toml::Value::Table(inner) => number(inner, rest),
            number => Some(number),
        }
    }

    #[test]
    fn every_range_refuses_what_is_below_and_above_it_by_its_key() {
        for range in RANGES {
            let mut tried = 0;
            let below = range.low - range.low.abs() - 1e-3;
            let above = if range.high.is_finite() {
                range.high
            } else {
                LARGEST_RADIUS
            };
            for wrong in [below, above + above.abs() + 1e-3, f64::NAN] {
                for shape in [BOB, LUGE] {
                    let mut case = all_keys(shape);
                    let Some(value) = number(&mut case, range.key) else {
                        continue;
                    };
                    *value = wrong.into();
                    let refused = Case::parse(&case.to_string());
                    let error = refused.expect_err(range.key).to_string();
                    let named = error.contains(&format!("{} = ", range.key));
                    assert!(named && error.contains(range.what), "{wrong}: {error}");
                    tried += 1;
                }
            }
            assert!(tried >= 3, "{}: no case has it", range.key);
        }
    }
}
