//! Which nodes touch: accelerated projective SOR on the bodies' own stiffness.

use std::convert::Infallible;

use crate::active_set::constrained_cg::OneSet;
use crate::active_set::energy::Feasible;
use crate::active_set::motion::dot;
use crate::active_set::plane_problem::{PlaneProblem, PlaneState};
use crate::active_set::progress::{Control, Counts, Progress, SetUpdate};
use crate::active_set::sets::Sets;
use crate::green::matrix::Green;
use crate::grid::contact_mesh::{ContactMesh, State};

/// Most contact sets of one solve.
const UPDATES: usize = 200;
/// After so many sets each further lot is looked at ten times more closely.
const UNHURRIED: usize = 10;
/// Tension over the largest force, and penetration over the depth, that a converged set may have: rounding. After `PATIENT` lots of
/// sets it is ten times more with each further lot, up to `MOST_SLACK` times: what then sends a set in circles is no contact.
const SLACK: f64 = 1e-10;
const PATIENT: i32 = 2;
/// After so many sets the plain active set takes over: no prediction, and forces only on the way to those of a set.
const PLAIN: usize = 30;
const MOST_SLACK: f64 = 1e5;

impl ContactMesh {
    /// Iterates from `state`, whose forces took `begun`, until the energy-norm residual is below the tolerance and the contact
    /// set stays.
    pub fn solve(
        &self,
        state: &mut State,
        greens: &[Green; 2],
        begun: Counts,
        control: &Control,
    ) -> Progress {
        let mut work = self.workspace();
        let Ok(progress) = self.solve_by(state, greens, begun, control, |set, state, progress| {
            Ok::<_, Infallible>(self.iterate(set, state, &mut work, progress))
        });
        progress
    }

    /// As [`ContactMesh::solve`] with an iteration within one contact set, which returns whether tolerance and set were
    /// reached.
    ///
    /// The scheme is that of [`PlaneProblem::solve`] on the bodies' own stiffness: sweeps on the contact plane, corrected to
    /// what the bodies answered last, find a set, and the iteration on that set is the acceleration. It is accepted where the
    /// energy of the contact forces falls: that of the forces put back to their bounds, or that of the point on the way
    /// where the first force meets its bound. Where it does not fall the next set is that of the forces accepted last with
    /// the nodes whose gaps contradict it: its minimiser lies lower, since those forces are among its own.
    pub fn solve_by<E>(
        &self,
        state: &mut State,
        greens: &[Green; 2],
        begun: Counts,
        control: &Control,
        mut iterate: impl FnMut(&OneSet, &mut State, &mut Progress) -> Result<bool, E>,
    ) -> Result<Progress, E> {
        let mut progress = Progress {
            iterations: 0,
            residual: f64::INFINITY,
            converged: false,
        };
        let bound: Vec<f64> = self.candidates.iter().map(|&n| self.bound[n]).collect();
        let force: Vec<f64> = self.candidates.iter().map(|&n| state.force[n]).collect();
        let mut sets = Sets::of(&force, &bound);
        let mut counts = begun;
        let mut accepted: Option<Feasible> = None;
        for update in 0..UPDATES {
            let gaps = self.gaps(state);
            sets.free_one(&self.motion, &bound, |i| gaps[self.candidates[i]]);
            let Some(constraint) = self.constrain(&sets, &greens[0]) else {
                break;
            };
            let before = progress.iterations;
            let set = OneSet {
                sets: &sets,
                constraint: &constraint,
                control,
                first_check: 1e-2 * 0.1f64.powi((update / UNHURRIED) as i32),
                slack: SLACK
                    * 10f64
                        .powi((update / UNHURRIED) as i32 - PATIENT)
                        .clamp(1.0, MOST_SLACK),
            };
            let confirmed = iterate(&set, state, &mut progress)?;
            counts.accelerations += 1;
            let trial = self.feasible(state, &greens[1], accepted.as_ref());
            // Forces put back to their bounds leave gaps that are only predicted: not good enough where sets go in circles.
            let plain = update >= PLAIN;
            let exact = !plain || self.within_bounds(state);
            let falls = match &accepted {
                None => true,
                Some(last) => confirmed || (exact && (plain || trial.energy < last.energy)),
            };
            let clipped = match &accepted {
                Some(last) if !falls => Some(self.on_the_way(last, state))
                    .filter(|way| plain || way.energy < last.energy)
                    .map(|way| way.not_above(Some(last))),
                _ => None,
            };
            if falls {
                accepted = Some(trial.not_above(accepted.as_ref()));
            } else if clipped.is_some() {
                accepted = clipped;
            }
            let update = SetUpdate {
                contact_nodes: sets.inside.len() + sets.full.len(),
                iterations: progress.iterations - before,
                residual: progress.residual,
                counts: std::mem::take(&mut counts),
                energy: accepted.as_ref().map_or(0.0, |a| a.energy),
            };
            (control.tell)(&update, state);
            if confirmed || control.reached(progress.iterations) {
                progress.converged = confirmed;
                break;
            }
            sets = match &accepted {
                Some(last) if plain && falls => last.released_one(&bound),
                Some(last) if plain => Sets::of(&last.force, &bound),
                Some(last) if !falls => last.released(&bound),
                _ => {
                    let found = self.predict(state, &greens[1]);
                    counts = found.counts;
                    Sets::of(&found.force, &bound)
                }
            };
        }
        Ok(progress)
    }

    /// Whether all forces are within their bounds, by more than rounding.
    fn within_bounds(&self, state: &State) -> bool {
        let largest = state.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        self.candidates.iter().all(|&node| {
            let force = state.force[node];
            force >= -SLACK * largest && force <= self.bound[node] * (1.0 + SLACK)
        })
    }

    /// Projected SOR on the plane, from the gaps as they are now.
    fn predict(&self, state: &State, scaled: &Green) -> PlaneState {
        let gaps = self.gaps(state);
        let n = self.candidates.len();
        let force: Vec<f64> = self.candidates.iter().map(|&c| state.force[c]).collect();
        let mut base: Vec<f64> = self
            .candidates
            .iter()
            .map(|&c| gaps[c] + dot(self.rows[c], state.motion))
            .collect();
        let taken: Vec<f64> = force.iter().map(|f| -f).collect();
        scaled.add_times(&taken, &mut base);
        let bound: Vec<f64> = self.candidates.iter().map(|&c| self.bound[c]).collect();
        let clamped = (0..n).map(|i| force[i].clamp(0.0, bound[i])).collect();
        self.plane_contact(scaled, &base, PlaneState::new(clamped, state.motion))
    }

    /// Whether forces and gaps ask for another set than `sets`, by more than rounding.
    pub fn contradicts(&self, state: &State, sets: &Sets, slack: f64) -> bool {
        let gaps = self.gaps(state);
        let largest = state.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let depth = self.depth(state);
        let mut kind = vec![0u8; self.candidates.len()];
        sets.inside.iter().for_each(|&i| kind[i] = 1);
        sets.full.iter().for_each(|&i| kind[i] = 2);
        let contradicts = |(&node, kind): (&usize, u8)| {
            let (force, gap) = (state.force[node], gaps[node]);
            match kind {
                1 => force > self.bound[node] * (1.0 + slack) || force < -slack * largest,
                2 => gap > slack * depth,
                _ => gap < -slack * depth,
            }
        };
        self.candidates.iter().zip(kind).any(contradicts)
    }

    /// Solves the contact on the plane alone, with the scaled Green's matrix.
    ///
    /// `base` is the gap of the candidates without motion and forces, `start` the forces and motion to begin with.
    pub fn plane_contact(&self, scaled: &Green, base: &[f64], start: PlaneState) -> PlaneState {
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
