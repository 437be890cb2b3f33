//! What to measure next, in numbers.

use serde::Serialize;

/// Runs that could be driven next, and what they are expected to tell.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextRuns {
    /// How many, in one session.
    pub runs: usize,
    /// Track.
    pub track: String,
    /// What differs from the runs there are.
    pub change: String,
    /// Speed at the start \[m/s\].
    pub start_speed_mps: f64,
    /// Mass of the sled with its crew \[kg\].
    pub mass_kg: f64,
    /// Ice temperature \[deg C\].
    pub ice_c: f64,
    /// Air temperature \[deg C\].
    pub air_c: f64,
    /// Air pressure \[Pa\].
    pub air_pa: f64,
    /// Relative humidity \[%\], where it is known.
    pub humidity_pct: Option<f64>,
    /// The sensors' noise, where one of them is a better one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<kufe_sled::Noise>,
    /// The two members of the class that they tell apart least.
    pub between: [String; 2],
    /// Logarithm of the likelihood ratio of these two that is to be expected.
    pub expected_evidence: f64,
    /// Whether that would tell them apart nine times in ten.
    pub splits: bool,
}
