//! Accelerated projective SOR on the contact plane.

use faer::Mat;

use crate::active_set::balance::{Balance, BalancedForces};
use crate::active_set::contact_set::Counts;
use crate::green::closed_set::{ClosedSet, ITERATIONS};
use crate::green::matrix::Green;
use crate::mesh::contact_mesh::{Sets, clip};
use crate::motion::{Motion, dot, forces_and_motion};
use crate::precondition::dense::DenseCholesky;

/// The contact problem on the contact plane alone.
///
/// Minimise the complementary energy D(f) = 1/2 f^T G f + g^T f over 0 <= f_i <= bound_i and N^T
/// f = balance (for the free columns of N). Then gap = g - N q + G f with q the multipliers of the
/// balance, gap_i >= 0 where f_i = 0, gap_i = 0 inside the bounds and gap_i <= 0 at the upper one.
/// At the solution D is minus the total potential energy, the load's work in it.
pub(crate) struct PlaneProblem<'a> {
    /// G, symmetric positive definite [m/N].
    pub green: &'a Green<'a>,
    /// Gap without motion and forces [m].
    pub gap: &'a [f64],
    /// Rows N.
    pub rows: &'a [[f64; 3]],
    /// Largest force of each node [N]; infinite where the ice has no hardness.
    pub bound: &'a [f64],
    /// Motion: its free parts and their balance.
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
    /// What it took.
    pub counts: Counts,
    /// D after each step that was accepted [J].
    pub energies: Vec<f64>,
}

impl PlaneState {
    /// Forces and motion to begin with.
    pub fn new(force: Vec<f64>, motion: [f64; 3]) -> Self {
        PlaneState {
            force,
            motion,
            settled: false,
            counts: Counts::default(),
            energies: Vec::new(),
        }
    }
}

const RELAXATION: f64 = 1.4;

/// Sweeps at the first motion.
const FIRST_SWEEPS: usize = 3;

/// Rounds with sweeps between accelerations; later ones sweep only from the minimiser of
/// a set.
const FREE_ROUNDS: usize = 60;

/// Most rounds in all.
const ROUNDS: usize = 400;

/// How an acceleration ended.
#[derive(PartialEq)]
enum Acceleration {
    /// At the minimiser of its set.
    Arrived,
    /// On the way, with a smaller set.
    Short,
    /// Nothing lowered the energy.
    Refused,
}

impl PlaneProblem<'_> {
    /// Sweeps and accelerations until the contact set confirms itself, from `state`.
    ///
    /// After the first sweeps, which search a beginning at the motion given, forces keep their
    /// bounds and the balance, and every step is taken only where D falls. An acceleration goes to
    /// the minimiser of D on the set of the forces: forces outside their bounds are put back and
    /// the load is balanced anew where that lowers D, and otherwise the step ends where the first
    /// force meets its bound, which lowers D since D is convex. From the minimiser of a set that
    /// gaps contradict, a sweep lowers D: along the change of an SOR sweep at fixed motion,
    /// balanced anew, where D falls that way, and else along the projected gradient, where it must.
    /// So no set's minimiser is met twice, and there are finitely many: it ends, from wherever it
    /// begins (L. Banz and A. Schroeder, Comp. Appl. Math. 2024, doi 10.1007/s40314-024-03066-x,
    /// for the scheme without the balance).
    pub fn solve(&self, mut state: PlaneState) -> PlaneState {
        let mut deflection = self.deflection(&state.force);
        for _ in 0..FIRST_SWEEPS {
            self.sweep(&mut state, &mut deflection);
        }
        let everyone = vec![true; self.gap.len()];
        let precision = self.green.precision();
        let gaps = self.open_gaps(&state, &deflection);
        let begun = self.balanced(&state.force, &gaps, &everyone);
        let feasible = begun.met;
        state.force = begun.force;
        state.motion = [0, 1, 2].map(|a| state.motion[a] + begun.turn[a]);
        deflection = self.deflection(&state.force);
        if !feasible {
            // What may touch cannot bear the load: these forces show where more is needed.
            return state;
        }
        state.energies.push(self.energy(&state, &deflection));
        for round in 0..ROUNDS {
            let way = self.accelerate(&mut state, &mut deflection);
            if way == Acceleration::Arrived && self.confirmed(&state, &deflection, precision) {
                state.settled = true;
                break;
            }
            let falls = (way == Acceleration::Short && round >= FREE_ROUNDS)
                || self.balanced_sweep(&mut state, &mut deflection);
            if !falls && way != Acceleration::Short {
                // The energy falls no more in this precision.
                state.settled = self.confirmed(&state, &deflection, 1e3 * precision);
                break;
            }
        }
        state
    }

    /// One projected SOR sweep at fixed motion; `deflection` = G f is updated with it.
    ///
    /// It lowers D - q^T N^T f over the bounds, whatever the motion q.
    fn sweep(&self, state: &mut PlaneState, deflection: &mut [f64]) {
        state.counts.sweeps += 1;
        let motion = state.motion;
        let wanted = |i: usize, force: f64, deflection: f64| {
            let gap = self.gap[i] - dot(self.rows[i], motion) + deflection;
            (force - RELAXATION * gap / self.green.own(i)).clamp(0.0, self.bound[i])
        };
        self.green.sweep(&mut state.force, deflection, wanted);
    }

    /// A sweep whose outcome keeps the balance; returns whether D fell.
    fn balanced_sweep(&self, state: &mut PlaneState, deflection: &mut Vec<f64>) -> bool {
        let everyone = vec![true; self.gap.len()];
        let mut swept = state.clone();
        let mut swept_deflection = deflection.clone();
        self.sweep(&mut swept, &mut swept_deflection);
        state.counts = swept.counts;
        let gaps = self.open_gaps(&swept, &swept_deflection);
        let along_sweep = self.balanced(&swept.force, &gaps, &everyone);
        if along_sweep.met && self.descend(state, deflection, along_sweep) {
            return true;
        }
        let gaps = self.gaps(state, deflection);
        let along_gradient = self.balanced(&state.force, &gaps, &everyone);
        along_gradient.met && self.descend(state, deflection, along_gradient)
    }

    /// Goes to the least D on the way to `answer`, or all of it; returns whether D fell.
    fn descend(
        &self,
        state: &mut PlaneState,
        deflection: &mut Vec<f64>,
        answer: BalancedForces,
    ) -> bool {
        let pairs = answer.force.iter().zip(&state.force);
        let change: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
        let image = self.deflection(&change);
        let gaps = self.gaps(state, deflection);
        let slope: f64 = gaps.iter().zip(&change).map(|(g, c)| g * c).sum();
        let curvature: f64 = image.iter().zip(&change).map(|(i, c)| i * c).sum();
        if slope >= 0.0 || curvature <= 0.0 {
            return false;
        }
        let part = (-slope / curvature).min(1.0);
        let fall = part * (slope + 0.5 * part * curvature);
        if part < 1.0 {
            for (force, change) in state.force.iter_mut().zip(&change) {
                *force += part * change;
            }
            for (d, i) in deflection.iter_mut().zip(&image) {
                *d += part * i;
            }
        } else {
            state.force = answer.force;
            *deflection = self.deflection(&state.force);
        }
        let before = state.energies.last().copied().unwrap_or(0.0);
        state.energies.push(before + fall);
        before + fall < before
    }

    /// Gaps in a state.
    fn gaps(&self, state: &PlaneState, deflection: &[f64]) -> Vec<f64> {
        (0..self.gap.len())
            .map(|i| self.gap[i] - dot(self.rows[i], state.motion) + deflection[i])
            .collect()
    }

    /// The gaps after a sweep: 0 at nodes where it set a force, the positive gaps elsewhere.
    fn open_gaps(&self, state: &PlaneState, deflection: &[f64]) -> Vec<f64> {
        let gaps = self.gaps(state, deflection).into_iter().zip(&state.force);
        gaps.zip(self.bound)
            .map(|((gap, &f), &bound)| match f {
                f if f >= bound => gap.min(0.0),
                f if f > 0.0 => 0.0,
                _ => gap.max(0.0),
            })
            .collect()
    }

    /// What the nodes that `may` answer to the motion that balances the load, each on its own
    /// stiffness.
    fn balanced(&self, force: &[f64], gaps: &[f64], may: &[bool]) -> BalancedForces {
        let softness = (0..gaps.len()).map(|i| RELAXATION / self.green.own(i));
        let softness: Vec<f64> = softness.collect();
        Balance {
            force,
            gap: gaps,
            softness: &softness,
            rows: self.rows,
            bound: self.bound,
            may,
            motion: self.motion,
        }
        .solve()
    }

    /// D of forces that keep the balance; motions that are fixed belong to the gap.
    fn energy(&self, state: &PlaneState, deflection: &[f64]) -> f64 {
        let fixed = |a: usize| {
            if self.motion.free[a] {
                0.0
            } else {
                state.motion[a]
            }
        };
        let fixed = [0, 1, 2].map(fixed);
        let work = |i: usize| {
            let gap = self.gap[i] - dot(self.rows[i], fixed);
            state.force[i] * (gap + 0.5 * deflection[i])
        };
        (0..self.gap.len()).map(work).sum()
    }

    /// G f.
    fn deflection(&self, force: &[f64]) -> Vec<f64> {
        let mut deflection = vec![0.0; force.len()];
        self.green.add_times(force, &mut deflection);
        deflection
    }

    /// Towards the minimiser of D on the set of the state's forces.
    fn accelerate(&self, state: &mut PlaneState, deflection: &mut Vec<f64>) -> Acceleration {
        let set = Sets::of(&state.force, self.bound);
        let Some((force, motion)) = self.minimiser(&set, state) else {
            return Acceleration::Refused;
        };
        state.counts.accelerations += 1;
        let largest = force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let slack = self.green.precision();
        let out_of_bounds =
            |i: &usize| force[*i] < -slack * largest || force[*i] > self.bound[*i] * (1.0 + slack);
        let clamped = force.iter().zip(self.bound).map(|(f, b)| f.clamp(0.0, *b));
        let clamped: Vec<f64> = clamped.collect();
        if !set.inside.iter().any(out_of_bounds) {
            // D is no higher there: the forces before are of this set.
            let step = self.step(state, deflection, clamped, motion);
            step.take(state, deflection);
            return Acceleration::Arrived;
        }
        // Back to the bounds and to balance, with the forces of this set alone.
        let mut may = vec![false; force.len()];
        set.inside.iter().for_each(|&i| may[i] = true);
        let answer = self.balanced(&clamped, &vec![0.0; force.len()], &may);
        if answer.met {
            let turned = [0, 1, 2].map(|a| motion[a] + answer.turn[a]);
            let step = self.step(state, deflection, answer.force, turned);
            if step.fall < 0.0 {
                step.take(state, deflection);
                return Acceleration::Short;
            }
        }
        let (part, force) = clip(&state.force, &force, self.bound);
        let motion = [0, 1, 2].map(|a| state.motion[a] + part * (motion[a] - state.motion[a]));
        let step = self.step(state, deflection, force, motion);
        step.take(state, deflection);
        Acceleration::Short
    }

    /// From balanced forces to others.
    fn step(
        &self,
        from: &PlaneState,
        deflection: &[f64],
        force: Vec<f64>,
        motion: [f64; 3],
    ) -> Step {
        let image = self.deflection(&force);
        let fall = |i: usize| {
            let gap = self.gap[i] - dot(self.rows[i], from.motion);
            (force[i] - from.force[i]) * (gap + 0.5 * (deflection[i] + image[i]))
        };
        Step {
            fall: (0..force.len()).map(fall).sum(),
            force,
            motion,
            image,
        }
    }

    /// Exact forces and motion for a fixed set: the gap is 0 inside, the force at its bound where
    /// full.
    fn minimiser(&self, set: &Sets, state: &PlaneState) -> Option<(Vec<f64>, [f64; 3])> {
        let mut force = vec![0.0; self.gap.len()];
        for &i in &set.full {
            force[i] = self.bound[i];
        }
        let pressed = self.deflection(&force);
        let inside = &set.inside;
        let n = inside.len();
        if n == 0 {
            return Some((force, state.motion));
        }
        let mut balance = self.motion.balance;
        for &i in &set.full {
            for (b, row) in balance.iter_mut().zip(self.rows[i]) {
                *b -= row * self.bound[i];
            }
        }
        let rows: Vec<[f64; 3]> = inside.iter().map(|&i| self.rows[i]).collect();
        let gap: Vec<f64> = inside.iter().map(|&i| self.gap[i] + pressed[i]).collect();
        let (found, motion) = match self.green {
            Green::Dense(green) => {
                let matrix = Mat::from_fn(n, n, |i, j| green[(inside[i], inside[j])]);
                let sides = Mat::from_fn(n, 4, |i, j| match j {
                    0 => gap[i],
                    _ => rows[i][j - 1],
                });
                let solved = DenseCholesky::new(&matrix)?.solve(&sides);
                forces_and_motion(self.motion, &rows, &solved, balance, state.motion)
            }
            Green::Modal(green) => {
                let near: Vec<f64> = inside.iter().map(|&i| state.force[i]).collect();
                let set = ClosedSet::new(green, inside, &rows, self.motion.free);
                set.solve(ITERATIONS, &gap, [balance, state.motion], &near)?
            }
        };
        for (&node, f) in inside.iter().zip(found) {
            force[node] = f;
        }
        Some((force, motion))
    }

    /// Whether gaps are open where forces are 0 and pressed in where they are at their bound, to
    /// `slack` of the depth.
    fn confirmed(&self, state: &PlaneState, deflection: &[f64], slack: f64) -> bool {
        let gaps = self.gaps(state, deflection);
        let depth = (0..self.gap.len())
            .filter(|&i| state.force[i] > 0.0)
            .map(|i| deflection[i].abs())
            .fold(0.0, f64::max);
        (0..self.gap.len()).all(|i| match state.force[i] {
            f if f >= self.bound[i] => gaps[i] <= slack * depth,
            f if f > 0.0 => true,
            _ => gaps[i] >= -slack * depth,
        })
    }
}

/// Balanced forces and their motion, to be taken.
struct Step {
    force: Vec<f64>,
    motion: [f64; 3],
    /// G f.
    image: Vec<f64>,
    /// The change of D.
    fall: f64,
}

impl Step {
    fn take(self, state: &mut PlaneState, deflection: &mut Vec<f64>) {
        state.force = self.force;
        state.motion = self.motion;
        *deflection = self.image;
        if let Some(&before) = state.energies.last().filter(|_| self.fall < 0.0) {
            state.energies.push(before + self.fall);
        }
    }
}

#[cfg(test)]
mod tests {
    //! Claims on accelerated projective SOR on the contact plane.

    use std::borrow::Cow;

    use super::*;

    /// Nodes on a square under a round bottom: point loads on a half-space, and a stiff spring
    /// under each.
    struct Square {
        green: Mat<f64>,
        gap: Vec<f64>,
        rows: Vec<[f64; 3]>,
    }

    impl Square {
        fn new(n: usize, lean: f64) -> Self {
            let place = |i: usize| {
                let at = |k: usize| 2.0 * k as f64 / (n - 1) as f64 - 1.0;
                [at(i % n), at(i / n)]
            };
            let green = Mat::from_fn(n * n, n * n, |i, j| {
                let ([x, y], [s, t]) = (place(i), place(j));
                let spacing = 2.0 / (n - 1) as f64;
                1.0 / (x - s).hypot(y - t).max(0.28 * spacing)
            });
            let gap = (0..n * n).map(|i| {
                let [x, y] = place(i);
                0.5 * (x * x + y * y) + lean * x
            });
            let rows = (0..n * n).map(|i| [1.0, place(i)[0], -place(i)[1]]);
            Square {
                green,
                gap: gap.collect(),
                rows: rows.collect(),
            }
        }

        fn solve(&self, bound: f64, motion: &Motion, start: f64) -> PlaneState {
            let bound = vec![bound; self.gap.len()];
            let green = Green::Dense(Cow::Borrowed(&self.green));
            let problem = PlaneProblem {
                green: &green,
                gap: &self.gap,
                rows: &self.rows,
                bound: &bound,
                motion,
            };
            let none = vec![0.0; self.gap.len()];
            problem.solve(PlaneState::new(none, [start, 0.0, 0.0]))
        }
    }

    fn free(motions: [bool; 3], balance: [f64; 3]) -> Motion {
        Motion {
            free: motions,
            balance,
        }
    }

    #[test]
    fn energy_falls_step_by_step_to_a_state_that_meets_every_condition() {
        let square = Square::new(15, 0.1);
        for (load, bound) in [
            (0.3, f64::INFINITY),
            (0.02, f64::INFINITY),
            (0.3, 0.006),
            (0.3, 0.0021),
        ] {
            for start in [0.0, 0.4, 30.0] {
                let motion = free([true; 3], [load, 0.1 * load, 0.05 * load]);
                let s = square.solve(bound, &motion, start);
                assert!(s.settled, "{load} {bound} {start}: {:?}", s.counts);
                assert!(
                    s.energies.windows(2).all(|e| e[1] <= e[0]),
                    "{:?}",
                    s.energies
                );
                for a in 0..3 {
                    let sum: f64 = s
                        .force
                        .iter()
                        .zip(&square.rows)
                        .map(|(f, r)| f * r[a])
                        .sum();
                    assert!((sum - motion.balance[a]).abs() < 1e-9 * load, "{a}: {sum}");
                }
                assert!(s.force.iter().all(|f| (0.0..=bound).contains(f)));
                for i in 0..s.force.len() {
                    let deflection: f64 = (0..s.force.len())
                        .map(|j| square.green[(i, j)] * s.force[j])
                        .sum();
                    let gap = square.gap[i] - dot(square.rows[i], s.motion) + deflection;
                    let wrong = match s.force[i] {
                        0.0 => gap.min(0.0),
                        f if f >= bound => gap.max(0.0),
                        _ => gap,
                    };
                    assert!(wrong.abs() < 1e-9, "{load} {bound} {start}, {i}: {gap}");
                }
            }
        }
    }

    /// Thousands of plain sweeps at the motion that was found come to the same forces.
    #[test]
    fn plain_projected_sor_at_the_motion_found_gives_the_same_forces() {
        let square = Square::new(11, 0.05);
        let motion = free([true, true, false], [0.2, 0.0, 0.0]);
        let s = square.solve(f64::INFINITY, &motion, 0.1);
        let bound = vec![f64::INFINITY; square.gap.len()];
        let green = Green::Dense(Cow::Borrowed(&square.green));
        let plain = PlaneProblem {
            green: &green,
            gap: &square.gap,
            rows: &square.rows,
            bound: &bound,
            motion: &motion,
        };
        let mut state = PlaneState::new(vec![0.0; bound.len()], s.motion);
        let mut deflection = vec![0.0; bound.len()];
        for _ in 0..5000 {
            plain.sweep(&mut state, &mut deflection);
        }
        for (a, b) in state.force.iter().zip(&s.force) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }

    #[test]
    fn a_load_that_the_nodes_cannot_bear_is_not_settled_and_presses_all_of_them() {
        let square = Square::new(7, 0.0);
        let s = square.solve(1e-3, &free([true, false, false], [1.0, 0.0, 0.0]), 0.1);
        assert!(!s.settled && s.energies.is_empty());
        assert!(s.force.iter().all(|&f| f == 1e-3));
    }
}
