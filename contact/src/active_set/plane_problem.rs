//! Projective SOR on the contact forces, accelerated by exact solves on the contact set.

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

use crate::active_set::motion::{Motion, dot, solve_motion};
use crate::active_set::sets::Sets;

/// The contact problem on the contact plane alone.
///
/// Minimise 1/2 f^T G f + g^T f over 0 <= f_i <= bound_i and N^T f = balance (for the free columns of N).
/// Then gap = g - N q + G f with q the multipliers of the balance, gap_i >= 0 where f_i = 0 and gap_i = 0
/// inside the bounds.
pub(crate) struct PlaneProblem<'a> {
    /// G, symmetric positive definite [m/N].
    pub green: &'a Mat<f64>,
    /// Gap without motion and forces [m].
    pub gap: &'a [f64],
    /// Rows N.
    pub rows: &'a [[f64; 3]],
    /// Largest force of each node [N]; infinite where the ice has no hardness.
    pub bound: &'a [f64],
    /// Motion, its free parts and the balance they answer to.
    pub motion: &'a Motion,
}

/// Forces and rigid motion.
#[derive(Clone, Debug)]
pub(crate) struct PlaneState {
    /// Contact forces [N].
    pub force: Vec<f64>,
    /// Approach [m], pitch and roll [rad].
    pub motion: [f64; 3],
    /// Whether the last set was confirmed.
    pub settled: bool,
}

const RELAXATION: f64 = 1.4;

impl PlaneProblem<'_> {
    /// One projected SOR sweep at fixed motion; `deflection` = G f is kept up to date.
    pub fn sweep(&self, state: &mut PlaneState, deflection: &mut [f64]) {
        for i in 0..self.gap.len() {
            let gap = self.gap[i] - dot(self.rows[i], state.motion) + deflection[i];
            let wanted = state.force[i] - RELAXATION * gap / self.green[(i, i)];
            let force = wanted.clamp(0.0, self.bound[i]);
            let change = force - state.force[i];
            if change != 0.0 {
                state.force[i] = force;
                for (d, g) in deflection.iter_mut().zip(self.green.col(i).iter()) {
                    *d += change * g;
                }
            }
        }
    }

    /// Sweeps and accelerations until the contact set confirms itself, from `state`.
    pub fn solve(&self, mut state: PlaneState) -> PlaneState {
        let n = self.gap.len();
        let mut deflection = self.deflection(&state.force);
        for _ in 0..3 {
            self.sweep(&mut state, &mut deflection);
        }
        let mut set = Sets::of(&state.force, self.bound);
        if set.inside.is_empty() && set.full.is_empty() {
            // Nothing touches at this motion: begin with the node that would touch first.
            let nearest = (0..n).min_by(|&i, &j| {
                let gap = |i: usize| self.gap[i] - dot(self.rows[i], state.motion);
                gap(i).total_cmp(&gap(j))
            });
            set.inside.extend(nearest);
        }
        let mut seen: Vec<Sets> = Vec::new();
        for _ in 0..200 {
            self.accelerate(&set, &mut state);
            let deflection_now = self.deflection(&state.force);
            let next = self.next_set(&set, &mut state, &deflection_now);
            if next == set {
                state.settled = true;
                break;
            }
            if seen.contains(&next) {
                // A cycle: sweeps lower the energy at this motion and lead out of it.
                let mut deflection = self.deflection(&state.force);
                for _ in 0..5 {
                    self.sweep(&mut state, &mut deflection);
                }
                set = Sets::of(&state.force, self.bound);
                seen.clear();
            } else {
                seen.push(std::mem::replace(&mut set, next));
            }
        }
        state
    }

    /// G f.
    fn deflection(&self, force: &[f64]) -> Vec<f64> {
        let mut deflection = vec![0.0; force.len()];
        for (j, &f) in force.iter().enumerate().filter(|(_, f)| **f != 0.0) {
            for (d, g) in deflection.iter_mut().zip(self.green.col(j).iter()) {
                *d += f * g;
            }
        }
        deflection
    }

    /// Exact forces and motion for a fixed set: the gap is 0 inside, the force at its bound where full.
    fn accelerate(&self, set: &Sets, state: &mut PlaneState) {
        state.force.fill(0.0);
        for &i in &set.full {
            state.force[i] = self.bound[i];
        }
        let pressed = self.deflection(&state.force);
        let inside = &set.inside;
        let n = inside.len();
        let mut balance = self.motion.balance;
        for &i in &set.full {
            for (b, row) in balance.iter_mut().zip(self.rows[i]) {
                *b -= row * self.bound[i];
            }
        }
        if n == 0 {
            return;
        }
        let matrix = Mat::from_fn(n, n, |i, j| self.green[(inside[i], inside[j])]);
        let Ok(factor) = Llt::new(matrix.as_ref(), Side::Lower) else {
            return;
        };
        let sides = Mat::from_fn(n, 4, |i, j| match j {
            0 => self.gap[inside[i]] + pressed[inside[i]],
            _ => self.rows[inside[i]][j - 1],
        });
        let solved = factor.solve(&sides);
        let rows: Vec<[f64; 3]> = inside.iter().map(|&i| self.rows[i]).collect();
        state.motion = solve_motion(self.motion, &rows, &solved, balance, state.motion);
        for (i, &node) in inside.iter().enumerate() {
            state.force[node] = (1..4)
                .map(|j| solved[(i, j)] * state.motion[j - 1])
                .sum::<f64>()
                - solved[(i, 0)];
        }
    }

    /// The set that the signs of forces and gaps ask for; forces are projected onto their bounds.
    fn next_set(&self, set: &Sets, state: &mut PlaneState, deflection: &[f64]) -> Sets {
        let largest = state.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let depth = (0..self.gap.len())
            .filter(|&i| state.force[i] > 0.0)
            .map(|i| deflection[i].abs())
            .fold(0.0, f64::max);
        let mut next = Sets::default();
        let mut kind = vec![0u8; self.gap.len()];
        set.inside.iter().for_each(|&i| kind[i] = 1);
        set.full.iter().for_each(|&i| kind[i] = 2);
        for i in 0..self.gap.len() {
            let gap = self.gap[i] - dot(self.rows[i], state.motion) + deflection[i];
            let force = state.force[i];
            match kind[i] {
                1 if force >= self.bound[i] => next.full.push(i),
                1 if force >= -1e-12 * largest => next.inside.push(i),
                2 if gap <= 1e-12 * depth => next.full.push(i),
                2 => next.inside.push(i),
                0 if gap < -1e-12 * depth => next.inside.push(i),
                _ => {}
            }
            state.force[i] = force.clamp(0.0, self.bound[i]);
        }
        next.free_one(self.motion, self.bound, |i| {
            self.gap[i] - dot(self.rows[i], state.motion) + deflection[i]
        });
        next
    }
}
