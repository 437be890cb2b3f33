//! The motion under which a plane with plastic memory carries the load.

use nalgebra::{Matrix3, Vector3};

use crate::Options;
use crate::active_set::motion::{Motion, dot};
use crate::groove::memory::{Kind, Memory, MemoryState};

/// A plane with memory and what the runner's motion has to answer to.
///
/// Force and moments rise with approach and turn, in steps: a node at the front goes from open to full within the little that its
/// own response gives. Newton's steps lead near the balance where they can; from there each motion is bracketed (bisection with the secant of Illinois: M. Dowell, P. Jarratt, BIT 11 (1971)
/// 168-174), the approach within the pitch and the pitch within the roll.
pub(crate) struct LoadBalance<'a> {
    pub memory: &'a Memory<'a>,
    /// The free motions and the balance they answer to.
    pub motion: &'a Motion,
    pub options: &'a Options,
}

/// What may be out of balance, over the load and the load's moment over the contact.
const SLACK: f64 = 1e-10;
/// Most motions tried for one balance.
const TRIALS: usize = 120;
/// First step of a motion over the depth of the contact.
const FIRST: f64 = 0.02;
/// Most steps of all motions at once, and the largest that is trusted, over the depth of the contact.
const NEWTON_STEPS: usize = 12;
const LARGEST: f64 = 0.5;

impl LoadBalance<'_> {
    /// Solves from a motion and sets near the solution; `None` where none is found.
    pub fn from(&self, motion: [f64; 3], kinds: Vec<Kind>) -> Option<MemoryState> {
        let start = self.memory.at(motion, &kinds)?;
        let free: Vec<usize> = (0..3).filter(|&axis| self.motion.free[axis]).collect();
        let near = self.near(start, &free);
        self.balanced(near, &free)
    }

    /// Towards the balance of all motions at once, by Newton's method on the sets as they are, for as long as that leads there.
    fn near(&self, start: MemoryState, free: &[usize]) -> MemoryState {
        let mut at = start;
        for _ in 0..NEWTON_STEPS {
            let missing = self.missing(&at, free);
            if missing <= SLACK {
                break;
            }
            let slopes = self.memory.slopes(&at.kinds);
            let held = |a: usize, b: usize| if a == b { 1.0 } else { 0.0 };
            let is_free = |a: usize| free.contains(&a);
            let matrix = Matrix3::from_fn(|a, b| match is_free(a) && is_free(b) {
                true => slopes[a][b] / self.size(a) * self.unit(b, &at),
                false => held(a, b),
            });
            let out = Vector3::from_fn(|a, _| match is_free(a) {
                true => self.out(&at, a) / self.size(a),
                false => 0.0,
            });
            let Some(inverse) = matrix.try_inverse() else {
                break;
            };
            let step = -(inverse * out);
            // A step that is no number is not trusted either.
            if step
                .iter()
                .any(|part| part.is_nan() || part.abs() > LARGEST)
            {
                break;
            }
            let motion = [0, 1, 2].map(|a| at.motion[a] + step[a] * self.unit(a, &at));
            match self.memory.at(motion, &at.kinds) {
                Some(next) if self.missing(&next, free) < 0.7 * missing => at = next,
                _ => break,
            }
        }
        at
    }

    /// Largest part that is out of balance.
    fn missing(&self, state: &MemoryState, free: &[usize]) -> f64 {
        let parts = free
            .iter()
            .map(|&axis| self.out(state, axis).abs() / self.size(axis));
        parts.fold(0.0, f64::max)
    }

    /// The motion that moves the farthest node by the contact's depth.
    fn unit(&self, axis: usize, state: &MemoryState) -> f64 {
        self.deep(state) / self.scale(axis)
    }

    /// Balances the last of the `free` motions with those before it.
    fn balanced(&self, start: MemoryState, free: &[usize]) -> Option<MemoryState> {
        let Some((&axis, inner)) = free.split_last() else {
            return Some(start);
        };
        let scale = self.scale(axis);
        let slack = SLACK * 10f64.powi(axis.min(1) as i32) * self.size(axis);
        let mut at = self.balanced(start, inner)?;
        let mut out = self.out(&at, axis);
        let mut step = FIRST * self.deep(&at) / scale * if out > 0.0 { -1.0 } else { 1.0 };
        // A state on the other side of the balance, once there is one, with the weight that the secant gives it.
        let mut other: Option<(f64, f64)> = None;
        for _ in 0..TRIALS {
            if self.options.stopped() {
                return None;
            }
            if out.abs() <= slack {
                return Some(at);
            }
            let here = at.motion[axis];
            let next = match other {
                None => here + step,
                Some((there, beyond)) => {
                    let share = (out / (out - beyond)).clamp(0.05, 0.95);
                    here + share * (there - here)
                }
            };
            if next == here || other.is_some_and(|(there, _)| next == there) {
                return Some(at);
            }
            let mut motion = at.motion;
            motion[axis] = next;
            let moved = self.balanced(self.memory.at(motion, &at.kinds)?, inner)?;
            let now = self.out(&moved, axis);
            if now * out <= 0.0 {
                other = Some((here, out));
            } else {
                other = other.map(|(there, beyond)| (there, 0.5 * beyond));
                step *= 2.0;
            }
            (at, out) = (moved, now);
        }
        None
    }

    /// What a state carries too much along a motion.
    fn out(&self, state: &MemoryState, axis: usize) -> f64 {
        self.memory.resultant(&state.force)[axis] - self.motion.balance[axis]
    }

    /// The load, or its moment at the farthest node.
    fn size(&self, axis: usize) -> f64 {
        self.scale(axis) * self.motion.balance[0].abs()
    }

    /// What a unit of a motion moves the farthest node.
    fn scale(&self, axis: usize) -> f64 {
        let reach = self.memory.rows.iter().map(|row| row[axis].abs());
        reach.fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Deepest place of the runner in the undeformed ice [m].
    fn deep(&self, state: &MemoryState) -> f64 {
        let below = |i: usize| dot(self.memory.rows[i], state.motion) - self.memory.gap[i];
        (0..state.force.len())
            .filter(|&i| state.force[i] > 0.0)
            .map(|i| below(i).abs())
            .fold(1e-9, f64::max)
    }
}
