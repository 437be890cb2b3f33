//! Contact on the contact plane alone: projected SOR (PSOR) with minimisation on the active set.

use faer::Mat;

use crate::active_set::balance::{Balance, BalancedForces};
use crate::active_set::contact_set::Counts;
use crate::green::closed_set::{ClosedSet, MAX_ITERATIONS};
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
    /// Rows of N: gap change of a node per unit of each rigid motion.
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
    /// Whether the signs of forces and gaps confirm the last set.
    pub converged: bool,
    /// Numbers of sweeps and accelerations.
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
            converged: false,
            counts: Counts::default(),
            energies: Vec::new(),
        }
    }
}

/// Over-relaxation factor of SOR.
const RELAXATION: f64 = 1.4;

/// Sweeps at the initial motion.
const FIRST_SWEEPS: usize = 3;

/// Rounds with a sweep after every acceleration; later rounds sweep only from the minimiser of a
/// set.
const FREE_ROUNDS: usize = 60;

/// Largest number of rounds.
const MAX_ROUNDS: usize = 400;

/// How an acceleration ended.
#[derive(PartialEq)]
enum Acceleration {
    /// At the minimiser of its set.
    Minimiser,
    /// At feasible forces before the minimiser, with another set.
    Shortened,
    /// The reduced system of the set could not be solved.
    Singular,
}

impl PlaneProblem<'_> {
    /// Sweeps and accelerations until the contact set confirms itself, from `state`.
    ///
    /// The first sweeps, at the initial motion, give initial forces. From then on forces keep their
    /// bounds and the balance, and a step is taken only where D falls.
    ///
    /// - An acceleration goes to the minimiser of D on the set of the forces. Forces outside their
    ///   bounds are projected onto the bounds and the balance where that lowers D. Otherwise the
    ///   step ends where the first force meets its bound, which lowers D since D is convex.
    /// - From the minimiser of a set that gaps contradict, a sweep lowers D: along the projected
    ///   change of an SOR sweep at fixed motion where D falls in that direction, otherwise along
    ///   the projected gradient, where it must fall.
    ///
    /// So no set's minimiser occurs twice. There are finitely many sets, so the iteration ends from
    /// any initial state (L. Banz and A. Schroeder, Comp. Appl. Math. 2024, doi
    /// 10.1007/s40314-024-03066-x, for the scheme without the balance).
    pub fn solve(&self, mut state: PlaneState) -> PlaneState {
        let mut deflection = self.deflection(&state.force);
        for _ in 0..FIRST_SWEEPS {
            self.sweep(&mut state, &mut deflection);
        }
        let all_nodes = vec![true; self.gap.len()];
        let precision = self.green.precision();
        let gaps = self.open_gaps(&state, &deflection);
        let initial = self.balanced(&state.force, &gaps, &all_nodes);
        let feasible = initial.feasible;
        state.force = initial.force;
        state.motion = [0, 1, 2].map(|a| state.motion[a] + initial.motion_step[a]);
        deflection = self.deflection(&state.force);
        if !feasible {
            // The candidates cannot bear the load: these forces show where more are needed.
            return state;
        }
        state.energies.push(self.energy(&state, &deflection));
        for round in 0..MAX_ROUNDS {
            let outcome = self.accelerate(&mut state, &mut deflection);
            let shortened = outcome == Acceleration::Shortened;
            if outcome == Acceleration::Minimiser && self.confirmed(&state, &deflection, precision)
            {
                state.converged = true;
                break;
            }
            if shortened && round >= FREE_ROUNDS {
                continue;
            }
            if !self.balanced_sweep(&mut state, &mut deflection) && !shortened {
                // The energy falls no more in this precision.
                state.converged = self.confirmed(&state, &deflection, 1e3 * precision);
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
        let update = |i: usize, force: f64, deflection: f64| {
            let gap = self.gap[i] - dot(self.rows[i], motion) + deflection;
            (force - RELAXATION * gap / self.green.diagonal(i)).clamp(0.0, self.bound[i])
        };
        self.green.sweep(&mut state.force, deflection, update);
    }

    /// A sweep followed by projection onto the balance, or a projected gradient step; returns
    /// whether D fell.
    fn balanced_sweep(&self, state: &mut PlaneState, deflection: &mut Vec<f64>) -> bool {
        let all_nodes = vec![true; self.gap.len()];
        let mut swept = state.clone();
        let mut swept_deflection = deflection.clone();
        self.sweep(&mut swept, &mut swept_deflection);
        state.counts = swept.counts;
        let gaps = self.open_gaps(&swept, &swept_deflection);
        let along_sweep = self.balanced(&swept.force, &gaps, &all_nodes);
        if along_sweep.feasible && self.line_search(state, deflection, along_sweep) {
            return true;
        }
        let gaps = self.gaps(state, deflection);
        let along_gradient = self.balanced(&state.force, &gaps, &all_nodes);
        along_gradient.feasible && self.line_search(state, deflection, along_gradient)
    }

    /// Exact line search of D along `target.force - state.force`, with a step length of at most 1;
    /// returns whether D fell.
    fn line_search(
        &self,
        state: &mut PlaneState,
        deflection: &mut Vec<f64>,
        target: BalancedForces,
    ) -> bool {
        let pairs = target.force.iter().zip(&state.force);
        let direction: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
        let g_direction = self.deflection(&direction);
        let gaps = self.gaps(state, deflection);
        let slope: f64 = gaps.iter().zip(&direction).map(|(g, d)| g * d).sum();
        let curvature: f64 = g_direction.iter().zip(&direction).map(|(i, d)| i * d).sum();
        if slope >= 0.0 || curvature <= 0.0 {
            return false;
        }
        let step = (-slope / curvature).min(1.0);
        let energy_change = step * (slope + 0.5 * step * curvature);
        if step < 1.0 {
            for (force, d) in state.force.iter_mut().zip(&direction) {
                *force += step * d;
            }
            for (d, i) in deflection.iter_mut().zip(&g_direction) {
                *d += step * i;
            }
        } else {
            state.force = target.force;
            *deflection = self.deflection(&state.force);
        }
        let before = state.energies.last().copied().unwrap_or(0.0);
        state.energies.push(before + energy_change);
        before + energy_change < before
    }

    /// gap - N q + G f of a state.
    fn gaps(&self, state: &PlaneState, deflection: &[f64]) -> Vec<f64> {
        (0..self.gap.len())
            .map(|i| self.gap[i] - dot(self.rows[i], state.motion) + deflection[i])
            .collect()
    }

    /// Gaps after a sweep: 0 at nodes with a force inside the bounds, positive gaps without force,
    /// negative gaps at the upper bound.
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

    /// Projects the forces after a step along the gaps onto the bounds and the load balance, in the
    /// norm of the diagonal of G; only nodes with `may_change` change.
    fn balanced(&self, force: &[f64], gaps: &[f64], may_change: &[bool]) -> BalancedForces {
        let stiffness = (0..gaps.len()).map(|i| RELAXATION / self.green.diagonal(i));
        let stiffness: Vec<f64> = stiffness.collect();
        Balance {
            force,
            gap: gaps,
            stiffness: &stiffness,
            rows: self.rows,
            bound: self.bound,
            may_change,
            motion: self.motion,
        }
        .solve()
    }

    /// D of balanced forces; prescribed motions belong to the gap.
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

    /// Step towards the minimiser of D on the set of the state's forces.
    fn accelerate(&self, state: &mut PlaneState, deflection: &mut Vec<f64>) -> Acceleration {
        let set = Sets::of(&state.force, self.bound);
        let Some((force, motion)) = self.minimiser(&set, state) else {
            return Acceleration::Singular;
        };
        state.counts.accelerations += 1;
        let largest = force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let slack = self.green.precision();
        let out_of_bounds =
            |i: &usize| force[*i] < -slack * largest || force[*i] > self.bound[*i] * (1.0 + slack);
        let clamped = force.iter().zip(self.bound).map(|(f, b)| f.clamp(0.0, *b));
        let clamped: Vec<f64> = clamped.collect();
        if !set.inside.iter().any(out_of_bounds) {
            // D is no higher there: the previous forces belong to this set.
            let step = self.step(state, deflection, clamped, motion);
            step.apply(state, deflection);
            return Acceleration::Minimiser;
        }
        // Projection onto bounds and balance, with the forces of this set alone.
        let mut may_change = vec![false; force.len()];
        set.inside.iter().for_each(|&i| may_change[i] = true);
        let projected = self.balanced(&clamped, &vec![0.0; force.len()], &may_change);
        if projected.feasible {
            let projected_motion = [0, 1, 2].map(|a| motion[a] + projected.motion_step[a]);
            let step = self.step(state, deflection, projected.force, projected_motion);
            if step.energy_change < 0.0 {
                step.apply(state, deflection);
                return Acceleration::Shortened;
            }
        }
        let (length, force) = clip(&state.force, &force, self.bound);
        let motion = [0, 1, 2].map(|a| state.motion[a] + length * (motion[a] - state.motion[a]));
        let step = self.step(state, deflection, force, motion);
        step.apply(state, deflection);
        Acceleration::Shortened
    }

    /// The step from the balanced forces of a state to others.
    fn step(
        &self,
        from: &PlaneState,
        deflection: &[f64],
        force: Vec<f64>,
        motion: [f64; 3],
    ) -> Step {
        let g_force = self.deflection(&force);
        let energy_change = |i: usize| {
            let gap = self.gap[i] - dot(self.rows[i], from.motion);
            (force[i] - from.force[i]) * (gap + 0.5 * (deflection[i] + g_force[i]))
        };
        Step {
            energy_change: (0..force.len()).map(energy_change).sum(),
            force,
            motion,
            g_force,
        }
    }

    /// Exact forces and motion of a fixed set: gap 0 at nodes inside the bounds, the bound's force
    /// at full ones; `None` where the reduced system cannot be solved.
    fn minimiser(&self, set: &Sets, state: &PlaneState) -> Option<(Vec<f64>, [f64; 3])> {
        let mut force = vec![0.0; self.gap.len()];
        for &i in &set.full {
            force[i] = self.bound[i];
        }
        let bound_deflection = self.deflection(&force);
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
        let gap = inside.iter().map(|&i| self.gap[i] + bound_deflection[i]);
        let gap: Vec<f64> = gap.collect();
        let (inside_force, motion) = match self.green {
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
                let initial: Vec<f64> = inside.iter().map(|&i| state.force[i]).collect();
                let set = ClosedSet::new(green, inside, &rows, self.motion.free);
                set.solve(MAX_ITERATIONS, &gap, [balance, state.motion], &initial)?
            }
        };
        for (&node, f) in inside.iter().zip(inside_force) {
            force[node] = f;
        }
        Some((force, motion))
    }

    /// Whether gaps are not negative where forces are 0 and not positive where forces are at their
    /// bound, to within `slack` times the largest deflection of a loaded node.
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

/// Balanced forces and motion at the end of a step.
struct Step {
    force: Vec<f64>,
    motion: [f64; 3],
    /// G f.
    g_force: Vec<f64>,
    /// Change of D over the step.
    energy_change: f64,
}

impl Step {
    fn apply(self, state: &mut PlaneState, deflection: &mut Vec<f64>) {
        state.force = self.force;
        state.motion = self.motion;
        *deflection = self.g_force;
        if let Some(&before) = state.energies.last().filter(|_| self.energy_change < 0.0) {
            state.energies.push(before + self.energy_change);
        }
    }
}

#[cfg(test)]
mod tests {
    //! Claims on projected SOR with minimisation on the active set.

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
                assert!(s.converged, "{load} {bound} {start}: {:?}", s.counts);
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
        assert!(!s.converged && s.energies.is_empty());
        assert!(s.force.iter().all(|&f| f == 1e-3));
    }
}
