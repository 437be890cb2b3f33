//! From a run's own distance to that along the track.

/// A run's own distance and what is added to it: straight lines between knots, level shifts beyond them.
#[derive(Clone, Debug, PartialEq)]
pub struct Warp {
    /// Own distance of each knot [m], increasing.
    pub own_m: Vec<f64>,
    /// What is added there [m].
    pub shift_m: Vec<f64>,
    /// Standard error of that [m].
    pub sd_m: Vec<f64>,
}

impl Warp {
    /// The two knots about a place and the share of the later one.
    pub(crate) fn between(&self, own: f64) -> (usize, f64) {
        let last = self.own_m.len() - 1;
        let after = self.own_m.partition_point(|knot| *knot <= own);
        let i = after.clamp(1, last) - 1;
        let share = (own - self.own_m[i]) / (self.own_m[i + 1] - self.own_m[i]);
        (i, share.clamp(0.0, 1.0))
    }

    /// The distance along the track [m] of an own distance [m].
    pub fn at(&self, own: f64) -> f64 {
        let (i, share) = self.between(own);
        own + self.shift_m[i] + share * (self.shift_m[i + 1] - self.shift_m[i])
    }

    /// Mean growth of the distance along the track by the own one.
    pub fn stretch(&self) -> f64 {
        let last = self.own_m.len() - 1;
        let way = self.own_m[last] - self.own_m[0];
        1.0 + (self.shift_m[last] - self.shift_m[0]) / way
    }
}
