//! The gap between the undeformed runner and the ice.

use crate::error::plain;
use crate::{Error, Load, Problem, Tilt};

/// Undeformed gap g(x, y) = height of the underside - height of the track - height of the ice over
/// the track, including the fixed part of the tilt, and its change by the runner's rigid motion.
///
/// gap(q) = g - N q with q = (approach, pitch, roll) and the row N = (1, x - x0, -(y - y0)):
/// approach lowers the runner, positive pitch lowers its nose, positive roll lifts its left side.
/// (x0, y0) is the line of action, so that the moments of the pressure about it are zero.
pub(crate) struct Gap<'a> {
    problem: &'a Problem,
    /// Line of action [m].
    pub line_of_action: [f64; 2],
    /// Fixed pitch and roll, which are part of g [rad].
    fixed_tilt: [f64; 2],
    /// Which of approach, pitch and roll follow from balance.
    pub free_motion: [bool; 3],
    /// Rotation subtracted from g when pitch and roll are free, so that g is level at the line of
    /// action [rad].
    pub levelling: [f64; 2],
    /// Mirror planes x = 0 and y = 0 that may be used if hull, ice and load have them; x = 0 is
    /// excluded in sliding.
    pub mirrored: [bool; 2],
}

impl<'a> Gap<'a> {
    /// Checks that the runner fits the track and that the load acts on the hull.
    pub fn new(problem: &'a Problem) -> Result<Self, Error> {
        let (line_of_action, fixed_tilt, free_motion) = match problem.load {
            Load::Force {
                offset_x,
                offset_y,
                tilt: Tilt::Free,
                ..
            } => ([offset_x, offset_y], [0.0; 2], [true; 3]),
            Load::Force {
                offset_x,
                offset_y,
                tilt: Tilt::Fixed { pitch, roll },
                ..
            } => ([offset_x, offset_y], [pitch, roll], [true, false, false]),
            Load::Approach { pitch, roll, .. } => ([0.0; 2], [pitch, roll], [false; 3]),
        };
        let extent = problem.runner.underside.extent();
        let [x0, y0] = line_of_action;
        if free_motion[0]
            && !(extent[0] <= x0 && x0 <= extent[1] && extent[2] <= y0 && y0 <= extent[3])
        {
            let [x_min, x_max, y_min, y_max] = extent;
            return Err(Error::Unsuitable(format!(
                "the load's line of action at x = {x0:.4} m, y = {y0:.4} m misses the hull, which \
                 spans x {x_min:.4} to {x_max:.4} m and y {y_min:.4} to {y_max:.4} m"
            )));
        }
        // Hexahedra that end at the load are half a runner, whatever holds its tilt.
        let elastic = problem.runner.elastic.as_ref();
        let solid = elastic.is_some_and(|elastic| elastic.solid.is_some());
        if free_motion[1] || (free_motion[0] && solid) {
            off_the_rim("x", x0, extent[0], extent[1])?;
            off_the_rim("y", y0, extent[2], extent[3])?;
        }
        let reach = extent[0].abs().max(extent[1].abs());
        let curvature = problem.track_curvature;
        if reach.is_finite() && reach * curvature.abs() >= 0.5 {
            return Err(Error::Unsuitable(format!(
                "a track of radius {} m does not take a hull that reaches to x = {reach} m",
                plain(1.0 / curvature)
            )));
        }
        let mut gap = Gap {
            problem,
            line_of_action,
            fixed_tilt,
            free_motion,
            levelling: [0.0; 2],
            mirrored: [true; 2],
        };
        if free_motion[1] {
            gap.levelling = gap.slope();
        }
        Ok(gap)
    }

    /// g at (x, y) [m]; infinite where there is no hull.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let [x0, y0] = self.line_of_action;
        let [pitch, roll] = self.levelling;
        let height = self.tilted_height([x - x0, y - y0]);
        let surface = self.problem.ice_surface.as_ref();
        let ice = surface.map_or(0.0, |surface| surface.height(x, y));
        height - ice - track_height(self.problem.track_curvature, x) - pitch * (x - x0)
            + roll * (y - y0)
    }

    /// Height [m] of the tilted underside at (x, y), relative to the line of action [m]: the hull
    /// is rotated about the line of action on the contact plane by the fixed roll about x, then by
    /// the fixed pitch about y.
    ///
    /// The point of the underside that is rotated to (x, y) is found by fixed-point iteration. It
    /// contracts where slope times tilt is below 1; steeper flanks are not near the ice.
    fn tilted_height(&self, [x, y]: [f64; 2]) -> f64 {
        let [pitch, roll] = self.fixed_tilt;
        let [x0, y0] = self.line_of_action;
        let height = |[u, v]: [f64; 2]| self.problem.runner.underside.height(x0 + u, y0 + v);
        if [pitch, roll] == [0.0; 2] {
            return height([x, y]);
        }
        let ([sp, cp], [sr, cr]) = ([pitch.sin(), pitch.cos()], [roll.sin(), roll.cos()]);
        let mut place = [x, y];
        for _ in 0..MAX_ITERATIONS {
            let z = height(place);
            let v = (y + sr * z) / cr;
            let rolled = sr * v + cr * z;
            let u = (x - sp * rolled) / cp;
            let moved = (u - place[0]).abs().max((v - place[1]).abs());
            if moved <= TOLERANCE {
                return cp * rolled - sp * u;
            }
            place = [u, v];
        }
        f64::INFINITY
    }

    /// Local minima of the gap between measured surfaces of runner and ice, as places (x, y) [m].
    pub fn lows(&self) -> impl Iterator<Item = [f64; 2]> {
        let highs = self.problem.ice_surface.iter().flat_map(|ice| ice.highs());
        let lows = self.problem.runner.underside.lows().iter();
        lows.chain(highs).copied()
    }

    /// The row N of a node.
    pub fn motion_row(&self, x: f64, y: f64) -> [f64; 3] {
        [
            1.0,
            x - self.line_of_action[0],
            -(y - self.line_of_action[1]),
        ]
    }

    /// Pitch and roll of the result from those of the solved motion.
    pub fn tilt(&self, pitch: f64, roll: f64) -> [f64; 2] {
        [
            self.fixed_tilt[0] + self.levelling[0] + pitch,
            self.fixed_tilt[1] + self.levelling[1] + roll,
        ]
    }

    /// The mirror planes x = 0 and y = 0 that hull, ice, track and load share.
    pub fn symmetry(&self) -> [bool; 2] {
        let mut hull = self.problem.runner.underside.mirror_symmetric();
        if let Some(elastic) = &self.problem.runner.elastic {
            let own = elastic.solid.is_some();
            hull = [
                hull[0] && !own && elastic.mount.mirror_symmetric(),
                hull[1] && !own,
            ];
        }
        let surface = self.problem.ice_surface.as_ref();
        let ice = surface.map_or([true; 2], |surface| surface.mirror_symmetric());
        [0, 1].map(|axis| {
            let load = self.line_of_action[axis] == 0.0 && self.fixed_tilt[axis] == 0.0;
            self.mirrored[axis] && hull[axis] && ice[axis] && load
        })
    }

    /// The rotation (pitch, roll) that levels a smooth hull at the line of action; 0 where the hull
    /// has a mirror plane there.
    fn slope(&self) -> [f64; 2] {
        let [x0, y0] = self.line_of_action;
        let extent = self.problem.runner.underside.extent();
        let symmetric = self.symmetry();
        let along = |d: f64| self.at(x0 + d, y0);
        let across = |d: f64| self.at(x0, y0 + d);
        let slope = |axis: usize, step: f64, at: &dyn Fn(f64) -> f64| {
            let [low, high] = [0, 1].map(|end| extent[2 * axis + end] - self.line_of_action[axis]);
            let (from, to) = (low.max(-step), high.min(step));
            let slope = (at(to) - at(from)) / (to - from);
            if symmetric[axis] || !slope.is_finite() {
                0.0
            } else {
                slope
            }
        };
        [slope(0, 1e-3, &along), -slope(1, 1e-5, &across)]
    }
}

/// Largest number of fixed-point iterations for a point of a tilted underside, and the change at
/// which they end [m].
const MAX_ITERATIONS: usize = 100;
const TOLERANCE: f64 = 1e-13;

/// Fraction of a hull's length or width next to its rim in which no force-controlled load may act.
const RIM: f64 = 2e-3;

fn off_the_rim(axis: &'static str, at: f64, low: f64, high: f64) -> Result<(), Error> {
    // An unbounded hull has no rim.
    let near = RIM * (high - low);
    if near.is_finite() && (at - low < near || high - at < near) {
        return Err(Error::Unsuitable(format!(
            "the load's line of action at {axis} = {at} m runs along the rim of the hull, which spans \
             {low} to {high} m: expected it within the hull; half a runner is mirrored first"
        )));
    }
    Ok(())
}

/// Height of a track of curvature `curvature` [1/m] above its lowest point, at `x` [m].
///
/// The arc R - sqrt(R^2 - x^2) written so that R may be infinite.
pub fn track_height(curvature: f64, x: f64) -> f64 {
    let sine = curvature * x;
    curvature * x * x / (1.0 + (1.0 - sine * sine).max(0.0).sqrt())
}
