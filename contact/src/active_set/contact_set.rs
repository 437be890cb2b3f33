//! Which nodes touch: prediction by projected SOR, confirmation by the signs of forces and gaps.

use std::convert::Infallible;

use faer::Mat;

use crate::active_set::constrained_cg::Constraint;
use crate::active_set::motion::dot;
use crate::active_set::plane_problem::{PlaneProblem, PlaneState};
use crate::active_set::progress::{Limit, Progress, SetUpdate};
use crate::active_set::sets::Sets;
use crate::grid::contact_mesh::{ContactMesh, State};

impl ContactMesh {
    /// Iterates from `state` until the energy-norm residual is below `tolerance` and the contact set stays.
    pub fn solve(
        &self,
        state: &mut State,
        greens: &[Mat<f64>; 2],
        tolerance: f64,
        limit: &Limit,
    ) -> Progress {
        let mut work = self.workspace();
        let Ok(progress) =
            self.solve_by(state, greens, limit, |sets, constraint, state, progress| {
                let work = &mut work;
                Ok::<_, Infallible>(
                    self.iterate(sets, constraint, state, work, tolerance, limit, progress),
                )
            });
        progress
    }

    /// As [`ContactMesh::solve`] with an iteration within one contact set, which returns whether tolerance and set were reached.
    pub fn solve_by<E>(
        &self,
        state: &mut State,
        greens: &[Mat<f64>; 2],
        limit: &Limit,
        mut iterate: impl FnMut(&Sets, &Constraint, &mut State, &mut Progress) -> Result<bool, E>,
    ) -> Result<Progress, E> {
        let mut progress = Progress {
            iterations: 0,
            updates: Vec::new(),
            residual: f64::INFINITY,
            converged: false,
        };
        let bound: Vec<f64> = self.candidates.iter().map(|&n| self.bound[n]).collect();
        let force: Vec<f64> = self.candidates.iter().map(|&n| state.force[n]).collect();
        let mut sets = Sets::of(&force, &bound);
        for update in 0..60 {
            let gaps = self.gaps(state);
            sets.free_one(&self.motion, &bound, |i| gaps[self.candidates[i]]);
            let Some(constraint) = self.constrain(&sets, &greens[0]) else {
                break;
            };
            let before = progress.iterations;
            let confirmed = iterate(&sets, &constraint, state, &mut progress)?;
            progress.updates.push(SetUpdate {
                contact_nodes: sets.inside.len() + sets.full.len(),
                iterations: progress.iterations - before,
                residual: progress.residual,
            });
            if confirmed || limit.reached(progress.iterations) {
                progress.converged = confirmed;
                break;
            }
            let next = if update < 20 {
                self.predict(state, &greens[1])
            } else {
                self.signs(state, &sets, 1e-9)
                    .unwrap_or_else(|| sets.clone())
            };
            sets = next;
        }
        Ok(progress)
    }

    /// The next contact set: projected SOR and accelerations on the plane, from the gaps as they are now.
    fn predict(&self, state: &State, scaled: &Mat<f64>) -> Sets {
        let gaps = self.gaps(state);
        let n = self.candidates.len();
        let force: Vec<f64> = self.candidates.iter().map(|&c| state.force[c]).collect();
        let mut base: Vec<f64> = self
            .candidates
            .iter()
            .map(|&c| gaps[c] + dot(self.rows[c], state.motion))
            .collect();
        for (j, &f) in force.iter().enumerate().filter(|(_, f)| **f != 0.0) {
            for (b, g) in base.iter_mut().zip(scaled.col(j).iter()) {
                *b -= f * g;
            }
        }
        let bound: Vec<f64> = self.candidates.iter().map(|&c| self.bound[c]).collect();
        let clamped = (0..n).map(|i| force[i].clamp(0.0, bound[i])).collect();
        let start = PlaneState {
            force: clamped,
            motion: state.motion,
            settled: false,
        };
        let found = self.plane_contact(scaled, &base, start);
        Sets::of(&found.force, &bound)
    }

    /// The set that forces and gaps ask for, where it differs from `sets` by more than rounding.
    pub fn signs(&self, state: &State, sets: &Sets, slack: f64) -> Option<Sets> {
        let gaps = self.gaps(state);
        let largest = state.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let depth = self.depth(state);
        let mut kind = vec![0u8; self.candidates.len()];
        sets.inside.iter().for_each(|&i| kind[i] = 1);
        sets.full.iter().for_each(|&i| kind[i] = 2);
        let mut next = Sets::default();
        let mut changed = false;
        for (i, &node) in self.candidates.iter().enumerate() {
            let (force, gap) = (state.force[node], gaps[node]);
            let wanted = match kind[i] {
                1 if force > self.bound[node] * (1.0 + slack) => 2,
                1 if force < -slack * largest => 0,
                2 if gap > slack * depth => 1,
                0 if gap < -slack * depth => 1,
                same => same,
            };
            changed |= wanted != kind[i];
            match wanted {
                1 => next.inside.push(i),
                2 => next.full.push(i),
                _ => {}
            }
        }
        changed.then_some(next)
    }

    /// Solves the contact on the plane alone, with the scaled Green's matrix.
    ///
    /// `base` is the gap of the candidates without motion and forces, `start` the forces and motion to begin with.
    pub fn plane_contact(&self, scaled: &Mat<f64>, base: &[f64], start: PlaneState) -> PlaneState {
        let rows: Vec<[f64; 3]> = self.candidates.iter().map(|&n| self.rows[n]).collect();
        let bound: Vec<f64> = self.candidates.iter().map(|&n| self.bound[n]).collect();
        PlaneProblem {
            green: scaled,
            gap: base,
            rows: &rows,
            bound: &bound,
            motion: &self.motion,
        }
        .solve(start)
    }
}
