//! How to drive: steps, start, conditions.

use crate::error::Error;
use crate::record::index::Conditions;
use crate::simulate::dynamics::WallContact;

/// How to drive.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulateOptions {
    /// Largest step [s]; the step taken divides the output interval.
    pub step_s: f64,
    /// Output rate [Hz].
    pub rate_hz: f64,
    /// Speed at the start [m/s].
    pub start_speed_mps: f64,
    /// Longest time simulated [s].
    pub most_s: f64,
    /// Ice and air.
    pub conditions: Conditions,
    /// Pushes from outside.
    pub contacts: Vec<WallContact>,
    /// Curvature of the channel's cross-section [1/m].
    pub cross_curvature_1pm: f64,
    /// Seed of the driver's noise and, apart from it, of the sensors'.
    pub seed: u64,
}

impl Default for SimulateOptions {
    fn default() -> Self {
        SimulateOptions {
            step_s: 1e-3,
            rate_hz: 500.0,
            start_speed_mps: 10.0,
            most_s: 600.0,
            conditions: Conditions {
                ice_c: -8.0,
                air_c: 0.0,
                air_pa: 95_000.0,
                humidity_pct: None,
                distance_m: None,
                mass_kg: None,
            },
            contacts: Vec::new(),
            cross_curvature_1pm: 0.25,
            seed: 1,
        }
    }
}

/// Steps an output interval.
pub(crate) fn steps_an_interval(options: &SimulateOptions) -> Result<usize, Error> {
    let ranges = [
        ("step_s", options.step_s, 1e-6, 0.01),
        ("rate_hz", options.rate_hz, 1.0, 10_000.0),
        ("start_speed_mps", options.start_speed_mps, 1.0, 60.0),
        ("most_s", options.most_s, 0.1, 3600.0),
        ("cross_curvature_1pm", options.cross_curvature_1pm, 0.0, 2.0),
    ];
    for (key, value, low, high) in ranges {
        if !(low..=high).contains(&value) {
            return Err(Error::KeyRange {
                file: "simulation".to_string(),
                key: format!("{key} (from {low} to {high})"),
                value,
                expected: "a number in that range",
            });
        }
    }
    Ok((1.0 / (options.rate_hz * options.step_s) - 1e-9)
        .ceil()
        .max(1.0) as usize)
}
