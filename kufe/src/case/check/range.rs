//! What a number may be, and what is said where it is not.

use crate::case::CaseError;

pub(crate) type Checked = Result<(), CaseError>;

/// What the values of a key may be: beyond it there is no runner on ice, or none that this solver is made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The key, dotted.
    pub key: &'static str,
    /// What its value is, with its unit.
    pub what: &'static str,
    /// Smallest value.
    pub low: f64,
    /// Largest value; infinite where `inf` is one.
    pub high: f64,
}

impl Range {
    const fn of(key: &'static str, what: &'static str, low: f64, high: f64) -> Range {
        Range {
            key,
            what,
            low,
            high,
        }
    }

    /// The range in words, as `0.001 to 100` or `0.05 to inf`.
    pub fn words(&self) -> String {
        format!("{} to {}", plain(self.low), plain(self.high))
    }

    /// Whether a value is in it; what is no number is not.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// The ranges of a case's numbers. Two keys have ranges of their own: `track.radius_m` is 1 m or more in size, or `inf`, and what
/// is stated of a runner's shape must fit together.
pub const RANGES: [Range; 44] = [
    Range::of("runner.scale", "a scale", 1e-6, 1000.0),
    Range::of(
        "runner.noise_m",
        "a standard deviation in metres",
        0.0,
        0.001,
    ),
    Range::of("runner.height_m", "a height in metres", 0.001, 1.0),
    Range::of(
        "runner.youngs_modulus_pa",
        "a modulus in pascals",
        1e6,
        1e13,
    ),
    Range::of("runner.poissons_ratio", "a Poisson's ratio", 0.0, 0.499),
    Range::of("runner.shape.length_m", "a length in metres", 0.01, 10.0),
    Range::of(
        "runner.shape.rocker_radius_m",
        "a radius in metres",
        0.05,
        f64::INFINITY,
    ),
    Range::of(
        "runner.shape.section_radius_m",
        "a radius in metres",
        1e-4,
        f64::INFINITY,
    ),
    Range::of(
        "runner.shape.edge_radius_m",
        "a radius in metres",
        1e-4,
        1.0,
    ),
    Range::of("runner.shape.tilt_rad", "an angle in radians", -1.0, 1.0),
    Range::of("runner.shape.width_m", "a width in metres", 1e-4, 1.0),
    Range::of("runner.shape.height_m", "a height in metres", 0.001, 1.0),
    Range::of("runner.section.worn_m", "a depth in metres", 0.0, 0.01),
    Range::of(
        "runner.section.worn_edge",
        "a part of the section's radius",
        0.0,
        1.0,
    ),
    Range::of("runner.mount.held.x_m", "a place in metres", -10.0, 10.0),
    Range::of(
        "runner.mount.held.length_m",
        "a length in metres",
        0.001,
        10.0,
    ),
    Range::of("runner.mount.carries.x_m", "a place in metres", -10.0, 10.0),
    Range::of(
        "runner.mount.carries.length_m",
        "a length in metres",
        0.001,
        10.0,
    ),
    Range::of(
        "runner.mount.carries.share",
        "a part of the load",
        1e-6,
        1.0,
    ),
    Range::of(
        "ice.temperature_c",
        "a temperature in degrees Celsius",
        -50.0,
        0.0,
    ),
    Range::of("ice.youngs_modulus_pa", "a modulus in pascals", 1e6, 1e13),
    Range::of("ice.poissons_ratio", "a Poisson's ratio", 0.0, 0.499),
    Range::of("ice.thickness_m", "a thickness in metres", 0.001, 100.0),
    Range::of("ice.hardness_pa", "a pressure in pascals", 1e5, 1e10),
    Range::of(
        "ice.bed.youngs_modulus_pa",
        "a modulus in pascals",
        1e6,
        1e13,
    ),
    Range::of("ice.bed.poissons_ratio", "a Poisson's ratio", 0.0, 0.499),
    Range::of("ice.bed.thickness_m", "a thickness in metres", 0.001, 100.0),
    Range::of(
        "ice.waviness.amplitude_m",
        "an amplitude in metres",
        -0.01,
        0.01,
    ),
    Range::of(
        "ice.waviness.wavelength_m",
        "a wavelength in metres",
        0.001,
        1000.0,
    ),
    Range::of(
        "ice.waviness.direction_rad",
        "an angle in radians",
        -10.0,
        10.0,
    ),
    Range::of(
        "ice.waviness.phase_rad",
        "an angle in radians",
        -100.0,
        100.0,
    ),
    Range::of("track.curvature_1pm", "a curvature in 1/m", -1.0, 1.0),
    Range::of("sliding.v_mps", "a speed in m/s", 0.01, 100.0),
    Range::of(
        "sliding.ice_c",
        "a temperature in degrees Celsius below the melting point",
        -50.0,
        -0.1,
    ),
    Range::of("sliding.viscosity_factor", "a factor", 0.01, 1000.0),
    Range::of(
        "sliding.hardness.pressure_pa",
        "a pressure in pascals",
        1e5,
        1e9,
    ),
    Range::of(
        "sliding.hardness.ice_c",
        "a temperature in degrees Celsius",
        -50.0,
        0.0,
    ),
    Range::of(
        "sliding.hardness.contact_time_s",
        "a time in seconds",
        1e-6,
        1e6,
    ),
    Range::of("load.fz_n", "a force in newtons", 0.001, 1e7),
    Range::of("load.offset_x_m", "a place in metres", -10.0, 10.0),
    Range::of("load.offset_y_m", "a place in metres", -10.0, 10.0),
    Range::of("load.pitch_rad", "an angle in radians", -0.1, 0.1),
    Range::of("load.roll_rad", "an angle in radians", -0.1, 0.1),
    Range::of("accuracy.p_max", "a relative error", 1e-4, 0.5),
];

/// A number as people write it: no more digits than it needs.
fn plain(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-4..1e5).contains(&value.abs()) {
        return value.to_string();
    }
    format!("{value:e}")
}

/// Checks a value against the range of its key.
///
/// # Panics
/// Where the key has no range.
pub(crate) fn in_range(key: &'static str, value: f64) -> Checked {
    let range = RANGES.iter().find(|range| range.key == key);
    let range = range.unwrap_or_else(|| panic!("{key} has no range"));
    let expected = || format!("{} from {}", range.what, range.words());
    require_else(range.holds(value), key, value, expected)
}

pub(crate) fn require(
    holds: bool,
    key: &'static str,
    value: f64,
    expected: &'static str,
) -> Checked {
    require_else(holds, key, value, || expected.to_owned())
}

fn require_else(
    holds: bool,
    key: &'static str,
    value: f64,
    expected: impl Fn() -> String,
) -> Checked {
    if holds {
        return Ok(());
    }
    Err(CaseError::OutOfRange {
        line: 0,
        key,
        value: plain(value),
        expected: expected(),
    })
}

pub(crate) fn combination(key: &'static str, expected: &'static str) -> CaseError {
    CaseError::Combination {
        line: 0,
        key,
        expected,
    }
}
