//! Thresholds of searches in pressure maps.

use serde::{Deserialize, Serialize};

use crate::procedure::rivals::RivalRule;

/// Pressure maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MapRules {
    /// Smallest decrease of chi2 by a selected effect. Chosen: a probability of e^-15 per effect
    /// under noise.
    pub least_drop: f64,
    /// Smallest relative decrease of chi2 by a selected effect. Chosen.
    pub least_share: f64,
    /// Rivals: t is the root of their excess of chi2, in units of the best fit's mean square.
    pub rivals: RivalRule,
    /// Mean square in units of the noise above which a residual is not clean. Chosen.
    pub unclean: f64,
    /// Mean square, and remaining share of the excess over the noise, above both of which a named
    /// effect is doubtful. Chosen.
    pub doubtful: [f64; 2],
    /// Cells over half the patch while searching. Chosen.
    pub searching_cells: usize,
    /// Cells of the solves from which sizes are reported. Chosen.
    pub reporting_cells: usize,
    /// Pixels in each direction that count as one independent value. Chosen.
    pub independent_pixels: f64,
    /// Standard deviation of a pixel's place given the film's place, in pixels. Chosen: without it
    /// 5 of 11 intervals of blind cases did not contain the hidden size.
    pub pixel_place: f64,
    /// Standard deviation of a film's shift against the runner in each direction, if not stated
    /// \[m\]. Chosen: a film is laid to a mark by hand.
    pub film_shift_m: f64,
    /// Standard deviation of a film's rotation, if not stated \[rad\]. Derived: each end of a film
    /// 0.14 m long is off by the shift.
    pub film_rotation_rad: f64,
    /// Error of the solves, relative to the peak pressure. Chosen.
    pub solves: f64,
}

impl Default for MapRules {
    fn default() -> Self {
        Self {
            least_drop: 30.0,
            least_share: 0.2,
            rivals: RivalRule {
                needed_t: 3.0,
                ..RivalRule::default()
            },
            unclean: 2.0,
            doubtful: [10.0, 0.1],
            searching_cells: 8,
            reporting_cells: 12,
            independent_pixels: 4.0,
            pixel_place: 1.0 / 3.0,
            film_shift_m: 5e-4,
            film_rotation_rad: 5e-3,
            solves: 0.003,
        }
    }
}
