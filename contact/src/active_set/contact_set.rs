//! The contact set: projected SOR with minimisation on the active set, on the bodies' stiffness.

use crate::Options;
use crate::active_set::constrained_cg::SetProblem;
use crate::active_set::plane_problem::{PlaneProblem, PlaneState};
use crate::green::matrix::Green;
use crate::mesh::contact_mesh::{ContactMesh, Sets, State, clip};
use crate::motion::dot;

/// Largest number of contact sets of one solve.
const MAX_SETS: usize = 200;
/// Number of sets in a batch: with each further batch, signs are first checked at a ten times
/// smaller residual.
const BATCH: usize = 10;
/// Tension relative to the largest force, and penetration relative to the depth, that a converged
/// set may have: rounding. From batch `SLACK_BATCH` on it grows tenfold per batch, up to
/// `MAX_SLACK_FACTOR` times: forces that small then make sets cycle and are no contact.
const SLACK: f64 = 1e-10;
const SLACK_BATCH: i32 = 2;
const MAX_SLACK_FACTOR: f64 = 1e5;
/// Number of sets after which the plain active-set method takes over: without prediction, and with
/// forces that stop at the first bound they meet.
const PLAIN: usize = 30;

impl ContactMesh {
    /// Iterates from `state` until the energy-norm residual is below the tolerance and the contact
    /// set is confirmed; `begun` counts the sweeps and accelerations behind the initial forces.
    pub fn solve(
        &self,
        state: &mut State,
        greens: &[Green; 2],
        begun: Counts,
        control: &Control,
    ) -> Progress {
        let mut work = self.workspace();
        self.solve_by(state, greens, begun, control, |set, state, progress| {
            self.iterate(set, state, &mut work, progress)
        })
    }

    /// [`ContactMesh::solve`] with `iterate`, the iteration on one contact set, which returns
    /// whether the tolerance is reached and the set confirmed.
    ///
    /// The scheme is that of [`PlaneProblem::solve`] on the bodies' stiffness. Sweeps on the
    /// contact plane, corrected to the bodies' last displacements, predict a set; the iteration on
    /// that set is the acceleration. Its forces are accepted where their energy falls: clamped to
    /// the bounds, or else where the first force meets its bound. Where the energy does not fall,
    /// the next set is that of the last accepted forces with the nodes whose gaps contradict it.
    /// Its minimiser has a lower energy, since the accepted forces are feasible for it.
    fn solve_by(
        &self,
        state: &mut State,
        greens: &[Green; 2],
        begun: Counts,
        control: &Control,
        mut iterate: impl FnMut(&SetProblem, &mut State, &mut Progress) -> bool,
    ) -> Progress {
        let mut progress = Progress {
            iterations: 0,
            residual: f64::INFINITY,
            converged: false,
        };
        let bound = self.on_candidates(&self.bound);
        let mut sets = Sets::of(&self.on_candidates(&state.force), &bound);
        let mut counts = begun;
        let mut accepted: Option<Feasible> = None;
        for update in 0..MAX_SETS {
            let gaps = self.gaps(state);
            sets.free_one(&self.motion, &bound, |i| gaps[self.candidates[i]]);
            let Some(constraint) = self.constrain(&sets, &greens[0]) else {
                break;
            };
            let before = progress.iterations;
            let set = SetProblem {
                sets: &sets,
                constraint: &constraint,
                control,
                first_check: 1e-2 * 0.1f64.powi((update / BATCH) as i32),
                slack: SLACK
                    * 10f64
                        .powi((update / BATCH) as i32 - SLACK_BATCH)
                        .clamp(1.0, MAX_SLACK_FACTOR),
            };
            let confirmed = iterate(&set, state, &mut progress);
            counts.accelerations += 1;
            let trial = self.feasible(state, &greens[1], accepted.as_ref());
            // The gaps of clamped forces are only predicted: not accurate enough where sets cycle.
            let plain = update >= PLAIN;
            let exact = !plain || self.within_bounds(state);
            let falls = match &accepted {
                None => true,
                Some(last) => confirmed || (exact && (plain || trial.energy < last.energy)),
            };
            let clipped = match &accepted {
                Some(last) if !falls => Some(self.clipped(last, state))
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
            (control.report)(&update, state);
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
        progress
    }

    /// Whether all forces are within their bounds, by more than rounding.
    fn within_bounds(&self, state: &State) -> bool {
        let largest = state.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        self.candidates.iter().all(|&node| {
            let force = state.force[node];
            force >= -SLACK * largest && force <= self.bound[node] * (1.0 + SLACK)
        })
    }

    /// The candidates' forces, clamped to their bounds.
    fn clamped_forces(&self, state: &State) -> Vec<f64> {
        let nodes = self.candidates.iter();
        nodes
            .map(|&c| state.force[c].clamp(0.0, self.bound[c]))
            .collect()
    }

    /// Solves the contact on the plane from the gaps of the state.
    fn predict(&self, state: &State, scaled: &Green) -> PlaneState {
        let gaps = self.gaps(state);
        let nodes = || self.candidates.iter();
        let mut base: Vec<f64> = nodes()
            .map(|&c| gaps[c] + dot(self.rows[c], state.motion))
            .collect();
        let removed: Vec<f64> = nodes().map(|&c| -state.force[c]).collect();
        scaled.add_times(&removed, &mut base);
        let clamped = self.clamped_forces(state);
        self.plane_contact(scaled, &base, PlaneState::new(clamped, state.motion))
    }

    /// Whether forces and gaps require a set other than `sets`, by more than rounding.
    pub fn contradicts(&self, state: &State, sets: &Sets, slack: f64) -> bool {
        let gaps = self.gaps(state);
        let largest = state.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let depth = self.depth(state);
        // 0 open, 1 inside the bounds, 2 at the upper bound.
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

    /// Solves the contact on the plane alone, from no forces at this approach [m].
    pub fn plane_contact_from_rest(&self, scaled: &Green, approach: f64) -> PlaneState {
        let none = vec![0.0; self.candidates.len()];
        let start = PlaneState::new(none, [approach, 0.0, 0.0]);
        self.plane_contact(scaled, &self.unpressed_gap(), start)
    }

    /// Solves the contact on the plane alone, with the scaled Green's matrix.
    ///
    /// `base` is the gap of the candidates without motion and forces, `start` the initial forces
    /// and motion.
    pub fn plane_contact(&self, scaled: &Green, base: &[f64], start: PlaneState) -> PlaneState {
        PlaneProblem {
            green: scaled,
            gap: base,
            rows: &self.on_candidates(&self.rows),
            bound: &self.on_candidates(&self.bound),
            motion: &self.motion,
        }
        .solve(start)
    }
}

// The energy of contact forces on the bodies' stiffness, from one contact set to the next.

/// Forces within their bounds, their gaps and their energy.
///
/// The complementary energy is D(f) = 1/2 f^T S f + g^T f with S = B K^-1 B^T and g the gap without
/// forces. At the solution it is minus the total potential energy, which includes the load's work.
/// Its gradient is the gap plus the rigid motion's part, which does no work on balanced changes.
/// Between two states D therefore changes by 1/2 (gap + gap') . (f' - f), exactly since S is
/// linear. Only nodes that enter or leave the set contribute.
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

    /// The set of these forces, after release of the nodes whose gaps contradict it.
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

    /// The set of these forces, after release of the one node whose gap contradicts it most; of
    /// several released nodes some might have to return.
    pub fn released_one(&self, bound: &[f64]) -> Sets {
        let mut sets = Sets::of(&self.force, bound);
        let violation = |i: usize| match self.force[i] {
            f if f >= bound[i] => self.gap[i],
            f if f > 0.0 => 0.0,
            _ => -self.gap[i],
        };
        let worst = (0..bound.len()).max_by(|&i, &j| violation(i).total_cmp(&violation(j)));
        if let Some(worst) = worst.filter(|&i| violation(i) > 0.0) {
            sets.full.retain(|&i| i != worst);
            let place = sets.inside.partition_point(|&i| i < worst);
            sets.inside.insert(place, worst);
        }
        sets
    }

    /// Change of D from these forces to others.
    fn change(&self, force: &[f64], gap: &[f64]) -> f64 {
        (0..force.len())
            .map(|i| 0.5 * (self.gap[i] + gap[i]) * (force[i] - self.force[i]))
            .sum()
    }
}

impl ContactMesh {
    /// The forces of a state clamped to their bounds, with gaps corrected for the change on the
    /// contact plane.
    ///
    /// Without a previous state (`last`), the energy is relative to the bodies under outer loads
    /// alone, and the work of the contact load counts from first touch. Under a prescribed approach
    /// no load does work, and the energy is minus the strain energy of the bodies.
    pub fn feasible(&self, state: &State, scaled: &Green, last: Option<&Feasible>) -> Feasible {
        let mut gap = self.on_candidates(&self.gaps(state));
        let force = self.clamped_forces(state);
        let nodes = self.candidates.iter().zip(&force);
        let change: Vec<f64> = nodes.map(|(&c, f)| f - state.force[c]).collect();
        scaled.add_times(&change, &mut gap);
        let energy = match last {
            Some(last) => last.energy + last.change(&force, &gap),
            None => {
                // Prescribed motions belong to the gap without forces.
                let sign = |a: usize| if self.motion.free[a] { 1.0 } else { -1.0 };
                let motion = [0, 1, 2].map(|a| sign(a) * state.motion[a]);
                let unpressed = self.unpressed_gap();
                // The origin of a load's work is first touch.
                let lowest = if self.motion.free[0] {
                    unpressed.iter().copied().fold(f64::INFINITY, f64::min)
                } else {
                    0.0
                };
                let work = |i: usize| {
                    let row = self.rows[self.candidates[i]];
                    force[i] * (0.5 * (unpressed[i] + gap[i] + dot(row, motion)) - lowest)
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

    /// The forces between the accepted ones and those of a state at which the first force meets its
    /// bound.
    pub fn clipped(&self, last: &Feasible, state: &State) -> Feasible {
        let to = self.on_candidates(&state.force);
        let (step, force) = clip(&last.force, &to, &self.on_candidates(&self.bound));
        let gaps = self.on_candidates(&self.gaps(state));
        let pairs = gaps.iter().zip(&last.gap);
        let gap: Vec<f64> = pairs.map(|(gap, b)| b + step * (gap - b)).collect();
        let energy = last.energy + last.change(&force, &gap);
        Feasible {
            force,
            gap,
            depth: last.depth,
            energy,
        }
    }
}

// Progress and limits of an iteration.

/// Sweeps and accelerations of projected SOR.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub sweeps: usize,
    pub accelerations: usize,
}

/// Outcome of an iteration.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    /// Total number of conjugate-gradient iterations.
    pub iterations: usize,
    /// Energy-norm residual relative to the energy norm of the solution.
    pub residual: f64,
    /// Whether the tolerance was reached and the set confirmed.
    pub converged: bool,
}

/// The limits of an iteration and its callback.
pub(crate) struct Control<'a> {
    /// Largest number of iterations.
    pub iterations: usize,
    /// The residual tolerance, and the flag that stops the iteration.
    pub options: &'a Options,
    /// Called at every update of the contact set, with the present state.
    pub report: &'a dyn Fn(&SetUpdate, &State),
}

impl Control<'_> {
    /// Whether the iteration ends after this number of iterations.
    pub fn reached(&self, iterations: usize) -> bool {
        iterations >= self.iterations || self.options.stopped()
    }
}

/// Report on one contact set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SetUpdate {
    /// Nodes in contact.
    pub contact_nodes: usize,
    /// Conjugate-gradient iterations on this set.
    pub iterations: usize,
    /// Residual after them.
    pub residual: f64,
    /// Counts of the prediction of this set; the iteration on the set is one more acceleration.
    pub counts: Counts,
    /// Energy of the last accepted forces, of the part that is solved [J].
    pub energy: f64,
}

#[cfg(test)]
mod tests {
    //! Claims on accelerations whose energy rises.

    use std::cell::RefCell;
    use std::sync::Arc;

    use kufe_mesh::Paraboloid;

    use crate::accuracy::mesh_solve::tests::MeshProblem;
    use crate::active_set::constrained_cg::SetProblem;
    use crate::active_set::contact_set::{Control, Counts, SetUpdate};
    use crate::green::matrix::StorageLimit;
    use crate::mesh::contact_mesh::{Sets, State};
    use crate::{Foundation, Ice, Load, Options, Problem, Runner, Tilt};

    /// Share of the touching nodes that the bad acceleration keeps.
    const KEPT: f64 = 0.3;

    #[test]
    fn an_acceleration_that_raises_the_energy_is_put_back_and_the_contact_found_all_the_same()
    -> Result<(), Box<dyn std::error::Error>> {
        let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?));
        let ice = Ice {
            foundation: Foundation::RigidBed { thickness: 0.005 },
            ..Ice::half_space(9e9, 0.33)
        };
        let problem = Problem::new(runner, ice, Load::central(1000.0, Tilt::Free));
        let options = Options::default();
        let MeshProblem { mesh, patch, .. } = MeshProblem::new(problem, 5.0)?;
        let contact = &mesh.contact;
        let greens = contact.greens(StorageLimit::USUAL);
        // Energies and sweeps as the callback reports them after every update of the set; the bad
        // acceleration is compared with the update before it.
        let solve = |disturbed: Option<usize>| {
            let found = contact.plane_contact_from_rest(&greens[1], patch.motion);
            let mut state = contact.state_of(&found.force, found.motion);
            state.displacement = vec![0.0; contact.len()];
            let reported = RefCell::new(Vec::new());
            let report = |update: &SetUpdate, _: &State| {
                reported
                    .borrow_mut()
                    .push((update.energy, update.counts.sweeps));
            };
            let control = Control {
                iterations: 1000,
                options: &options,
                report: &report,
            };
            let mut work = contact.workspace();
            let (mut number, mut before, mut risen) = (0, None, None);
            let progress = contact.solve_by(
                &mut state,
                &greens,
                Counts::default(),
                &control,
                |set, state, progress| {
                    number += 1;
                    let Some(at) = disturbed.filter(|at| number <= *at) else {
                        return contact.iterate(set, state, &mut work, progress);
                    };
                    if number < at {
                        contact.iterate(set, state, &mut work, progress);
                        before = Some(contact.feasible(state, &greens[1], None));
                        return false;
                    }
                    let mut inside = set.sets.inside.clone();
                    let force = |i: &usize| state.force[contact.candidates[*i]];
                    inside.sort_by(|a, b| force(b).total_cmp(&force(a)));
                    inside.truncate((KEPT * inside.len() as f64) as usize);
                    inside.sort_unstable();
                    let sets = Sets {
                        inside,
                        full: Vec::new(),
                    };
                    let constraint = contact.constrain(&sets, &greens[0]).expect("independent");
                    let bad = SetProblem {
                        sets: &sets,
                        constraint: &constraint,
                        ..*set
                    };
                    contact.iterate(&bad, state, &mut work, progress);
                    let last = before.as_ref().expect("one before");
                    let now = contact.feasible(state, &greens[1], Some(last));
                    risen = Some([last.energy, now.energy]);
                    false
                },
            );
            (progress, state, reported.into_inner(), risen)
        };
        let (straight, expected, ..) = solve(None);
        let (progress, state, reported, risen) = solve(Some(2));
        assert!(straight.converged && progress.converged);
        let [last, bad] = risen.expect("a second update");
        assert!(bad > last + 1e-3 * last.abs(), "{last} {bad}");
        assert!(
            reported.windows(2).all(|pair| pair[1].0 <= pair[0].0),
            "{reported:?}"
        );
        // After an accepted acceleration, sweeps search for the next set; after a rejected one, it
        // is that of the forces accepted last.
        assert!(reported[1].1 > 0 && reported[2].1 == 0, "{reported:?}");
        let largest = expected.force.iter().copied().fold(0.0, f64::max);
        for (a, b) in state.force.iter().zip(&expected.force) {
            assert!((a - b).abs() < 1e-6 * largest, "{a} {b}");
        }
        Ok(())
    }
}
