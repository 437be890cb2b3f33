//! The energy of contact forces on the bodies' own stiffness, from one contact set to the next.

use crate::active_set::motion::dot;
use crate::active_set::sets::{Sets, clip};
use crate::green::matrix::Green;
use crate::grid::contact_mesh::{ContactMesh, State};

/// Forces within their bounds, the gaps under them, and their energy.
///
/// The energy is D(f) = 1/2 f^T S f + g^T f with S = B K^-1 B^T and g the gap without forces, the complementary one; at the
/// solution it is minus the total potential energy, the load's work in it. Its gradient is the gap plus the motion's part, which
/// does no work on balanced changes, so that between two states D changes by 1/2 (gap + gap') . (f' - f), exactly since S is
/// linear: only nodes that enter or leave the set count, and the signs of their gaps and forces tell which way.
#[derive(Clone, Debug)]
pub(crate) struct Feasible {
    /// Forces on the candidates [N].
    pub force: Vec<f64>,
    /// Gaps of the candidates [m].
    gap: Vec<f64>,
    /// Deepest interpenetration of the undeformed shapes [m].
    depth: f64,
    /// D of the part that is solved [J].
    pub energy: f64,
}

impl Feasible {
    /// The same forces with an energy that does not exceed the last one by rounding.
    pub fn not_above(mut self, last: Option<&Feasible>) -> Self {
        if let Some(last) = last {
            self.energy = self.energy.min(last.energy);
        }
        self
    }

    /// The set of these forces, with the nodes whose gaps contradict it let go.
    pub fn released(&self, bound: &[f64]) -> Sets {
        let slack = 1e-10 * self.depth;
        let mut sets = Sets::default();
        for (i, (&f, &b)) in self.force.iter().zip(bound).enumerate() {
            match f {
                f if f >= b && self.gap[i] <= slack => sets.full.push(i),
                f if f > 0.0 || self.gap[i] < -slack => sets.inside.push(i),
                _ => {}
            }
        }
        sets
    }

    /// The set of these forces, with the one node let go whose gap contradicts it most: of several some may have to come back.
    pub fn released_one(&self, bound: &[f64]) -> Sets {
        let mut sets = Sets::of(&self.force, bound);
        let wrong = |i: usize| match self.force[i] {
            f if f >= bound[i] => self.gap[i],
            f if f > 0.0 => 0.0,
            _ => -self.gap[i],
        };
        let worst = (0..bound.len()).max_by(|&i, &j| wrong(i).total_cmp(&wrong(j)));
        if let Some(worst) = worst.filter(|&i| wrong(i) > 0.0) {
            sets.full.retain(|&i| i != worst);
            let place = sets.inside.partition_point(|&i| i < worst);
            sets.inside.insert(place, worst);
        }
        sets
    }

    /// The change of D on the way to other forces.
    fn change(&self, force: &[f64], gap: &[f64]) -> f64 {
        (0..force.len())
            .map(|i| 0.5 * (self.gap[i] + gap[i]) * (force[i] - self.force[i]))
            .sum()
    }
}

impl ContactMesh {
    /// The forces of a state put back to their bounds, with gaps corrected for that on the contact plane.
    ///
    /// Without a state before, energies count from no forces on the bodies as they lie under outer loads, and the work of a
    /// load from first touch. Under a given approach no load works, and the energy is minus what the bodies have stored.
    pub fn feasible(&self, state: &State, scaled: &Green, last: Option<&Feasible>) -> Feasible {
        let gaps = self.gaps(state);
        let mut gap: Vec<f64> = self.candidates.iter().map(|&c| gaps[c]).collect();
        let force: Vec<f64> = self
            .candidates
            .iter()
            .map(|&c| state.force[c].clamp(0.0, self.bound[c]))
            .collect();
        let nodes = self.candidates.iter().zip(&force);
        let change: Vec<f64> = nodes.map(|(&c, f)| f - state.force[c]).collect();
        scaled.add_times(&change, &mut gap);
        let energy = match last {
            Some(last) => last.energy + last.change(&force, &gap),
            None => {
                // Motions that are held belong to the gap without forces.
                let moved = [0, 1, 2].map(|a| match self.motion.free[a] {
                    true => state.motion[a],
                    false => -state.motion[a],
                });
                let unpressed = self.unpressed_gap();
                // A load is at no height of its own: its work counts from first touch.
                let lowest = match self.motion.free[0] {
                    true => unpressed.iter().copied().fold(f64::INFINITY, f64::min),
                    false => 0.0,
                };
                let work = |i: usize| {
                    let row = self.rows[self.candidates[i]];
                    force[i] * (0.5 * (unpressed[i] + gap[i] + dot(row, moved)) - lowest)
                };
                (0..force.len()).map(work).sum()
            }
        };
        Feasible {
            force,
            gap,
            depth: self.depth(state),
            energy,
        }
    }

    /// The forces on the way from accepted ones to those of a state where the first one meets its bound.
    pub fn on_the_way(&self, last: &Feasible, state: &State) -> Feasible {
        let bound: Vec<f64> = self.candidates.iter().map(|&c| self.bound[c]).collect();
        let to: Vec<f64> = self.candidates.iter().map(|&c| state.force[c]).collect();
        let (part, force) = clip(&last.force, &to, &bound);
        let gaps = self.gaps(state);
        let gap: Vec<f64> = self
            .candidates
            .iter()
            .zip(&last.gap)
            .map(|(&c, before)| before + part * (gaps[c] - before))
            .collect();
        let energy = last.energy + last.change(&force, &gap);
        Feasible {
            force,
            gap,
            depth: last.depth,
            energy,
        }
    }
}
