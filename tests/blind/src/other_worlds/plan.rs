//! What is drawn for a run: its driver's way, its session, and what it meets.

use super::walls::Bumper;
use crate::world::noise::{Smooth, Source};

/// What is drawn for one run before it starts.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Speed at the start [m/s].
    pub start_mps: f64,
    /// Steering besides the line's [rad] over time.
    pub steer: Smooth,
    /// The driver's own line, left positive [m] over distance.
    pub line: Smooth,
    /// Roll split besides the road's twist [rad] over time.
    pub split: Smooth,
    /// Roll and pitch rate of a rough surface [rad/s] over time.
    pub rough: [Smooth; 2],
    /// Factors on friction and grip.
    pub factors: [f64; 2],
    /// A wall of this run: from, to [m], force [N].
    pub wall: Option<[f64; 3]>,
    /// What the bumper meets in this run.
    pub bumps: Vec<Bumper>,
    /// Ice temperature [deg C].
    pub ice_c: f64,
    /// Air density [kg/m3].
    pub air: f64,
    /// Whether a way up the bank costs height.
    pub climbs: bool,
}

impl Plan {
    /// Draws the run's own steering and roughness; the rest is the campaign's.
    pub fn draw(line_m: f64, driver: &mut Source, source: &mut Source) -> Plan {
        Plan {
            start_mps: 12.0 + 0.5 * source.normal(),
            steer: Smooth::new(0.006, 0.2, 1.5, source),
            line: Smooth::new(line_m, 0.004, 0.012, driver),
            split: Smooth::new(0.010, 0.2, 2.0, source),
            rough: [
                Smooth::new(0.05, 0.3, 2.0, source),
                Smooth::new(0.02, 0.3, 2.5, source),
            ],
            factors: [1.0; 2],
            wall: None,
            bumps: Vec::new(),
            ice_c: -6.0,
            air: 1.25,
            climbs: line_m > 0.0,
        }
    }
}
