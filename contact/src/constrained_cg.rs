//! Conjugate gradients that keep the contact closed.

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

use crate::contact_set::{Limit, Progress};
use crate::level::{Level, State};
use crate::motion::solve_motion;
use crate::psor::{Sets, dot};
use crate::vector;

/// The factorised constraint of one contact set.
pub(crate) struct Constraint {
    inside: Vec<usize>,
    rows: Vec<[f64; 3]>,
    factor: Llt<f64>,
    motion_columns: Mat<f64>,
}

/// Vectors that the iteration reuses.
pub(crate) struct Workspace {
    residual: Vec<f64>,
    step: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    modal: Vec<f64>,
}

impl Level {
    pub fn constrain(&self, sets: &Sets, green: &Mat<f64>) -> Option<Constraint> {
        let inside = &sets.inside;
        let n = inside.len();
        let matrix = Mat::from_fn(n, n, |i, j| green[(inside[i], inside[j])]);
        let factor = Llt::new(matrix.as_ref(), Side::Lower).ok()?;
        let rows: Vec<[f64; 3]> = inside
            .iter()
            .map(|&i| self.rows[self.candidates[i]])
            .collect();
        let columns = Mat::from_fn(n, 3, |i, j| rows[i][j]);
        let motion_columns = factor.solve(&columns);
        let inside = inside.iter().map(|&i| self.candidates[i]).collect();
        Some(Constraint {
            inside,
            rows,
            factor,
            motion_columns,
        })
    }

    pub fn workspace(&self) -> Workspace {
        let n = self.len();
        let modal = self
            .bodies
            .iter()
            .map(|b| b.preconditioner.mode_count())
            .sum();
        Workspace {
            residual: vec![0.0; n],
            step: vec![0.0; n],
            direction: vec![0.0; n],
            image: vec![0.0; n],
            modal: vec![0.0; modal],
        }
    }

    /// Conjugate gradients in the subspace where the nodes inside stay closed.
    ///
    /// Returns whether the tolerance was reached and the signs confirm the set.
    #[allow(clippy::too_many_arguments)]
    pub fn iterate(
        &self,
        sets: &Sets,
        constraint: &Constraint,
        state: &mut State,
        work: &mut Workspace,
        tolerance: f64,
        limit: &Limit,
        progress: &mut Progress,
    ) -> bool {
        self.project_forces(sets, state);
        // Enter the subspace: close what is open inside, balance the load.
        self.residual(state, &mut work.residual);
        let closing = self.closing(&state.displacement);
        let defect: Vec<f64> = constraint
            .inside
            .iter()
            .map(|&i| self.gap[i] - dot(self.rows[i], state.motion) - closing[i])
            .collect();
        let mut balance = self.motion.balance;
        for (row, force) in self
            .rows
            .iter()
            .zip(&state.force)
            .filter(|(_, f)| **f != 0.0)
        {
            for (b, r) in balance.iter_mut().zip(row) {
                *b -= r * force;
            }
        }
        let (turn, force) = self.precondition(constraint, &defect, balance, work);
        self.advance(1.0, turn, state, &work.step);
        self.add_forces(constraint, &force, state);
        self.residual(state, &mut work.residual);
        progress.iterations += 1;
        // Now the step's defect and imbalance are 0, and stay so.
        let none = vec![0.0; constraint.inside.len()];
        let mut rho_before = 0.0;
        let mut turn_direction = [0.0; 3];
        let mut next_check: f64 = 1e-2;
        loop {
            let (turn, force) = self.precondition(constraint, &none, [0.0; 3], work);
            let rho = vector::dot(&work.residual, &work.step).max(0.0);
            // The multiplier's increment leaves the residual what truly is out of equilibrium.
            self.add_forces(constraint, &force, state);
            self.subtract_forces(constraint, &force, &mut work.residual);
            let energy = self.energy(state).max(f64::MIN_POSITIVE);
            progress.residual = (rho / energy).sqrt();
            if progress.residual < next_check.max(tolerance) {
                if self
                    .signs(
                        state,
                        sets,
                        if progress.residual < tolerance {
                            1e-10
                        } else {
                            progress.residual
                        },
                    )
                    .is_some()
                {
                    return false;
                }
                if progress.residual < tolerance {
                    return true;
                }
                next_check *= 1e-2;
            }
            if limit.reached(progress.iterations) {
                return false;
            }
            let beta = if rho_before > 0.0 {
                rho / rho_before
            } else {
                0.0
            };
            rho_before = rho;
            vector::scale_add(&mut work.direction, beta, &work.step);
            turn_direction = [0, 1, 2].map(|a| turn[a] + beta * turn_direction[a]);
            self.apply(&work.direction, &mut work.image);
            let curvature = vector::dot(&work.direction, &work.image);
            if curvature <= 0.0 {
                return false;
            }
            let alpha = rho / curvature;
            for (q, t) in state.motion.iter_mut().zip(turn_direction) {
                *q += alpha * t;
            }
            vector::add_two(
                alpha,
                [&mut state.displacement, &mut work.residual],
                [&work.direction, &work.image],
            );
            progress.iterations += 1;
        }
    }

    fn add_forces(&self, constraint: &Constraint, force: &[f64], state: &mut State) {
        for (&node, f) in constraint.inside.iter().zip(force) {
            state.force[node] += f;
        }
    }

    fn subtract_forces(&self, constraint: &Constraint, force: &[f64], residual: &mut [f64]) {
        let mut start = 0;
        for body in &self.bodies {
            for (&node, f) in constraint.inside.iter().zip(force) {
                if let Some(entry) = self.entry(body, node) {
                    residual[start + entry] -= body.sign * f;
                }
            }
            start += body.len();
        }
    }

    fn advance(&self, factor: f64, turn: [f64; 3], state: &mut State, step: &[f64]) {
        for (q, t) in state.motion.iter_mut().zip(turn) {
            *q += factor * t;
        }
        vector::add(&mut state.displacement, factor, step);
    }

    /// Solves P z + B^T m = r, N^T m = `balance`, B z + N q = `defect` for the step z (into `work.step`),
    /// the turn q and the multipliers m of the nodes inside.
    fn precondition(
        &self,
        constraint: &Constraint,
        defect: &[f64],
        balance: [f64; 3],
        work: &mut Workspace,
    ) -> ([f64; 3], Vec<f64>) {
        let n = constraint.inside.len();
        let mut side = Mat::from_fn(n, 1, |i, _| defect[i]);
        let (mut start, mut modal_start) = (0, 0);
        for body in &self.bodies {
            let p = &body.preconditioner;
            let modal = &mut work.modal[modal_start..modal_start + p.mode_count()];
            p.gather(&work.residual[start..start + body.len()], modal);
            let gathered = p.gathered(modal);
            let trace = Mat::from_fn(gathered.nrows(), gathered.ncols(), |a, b| {
                gathered[(a, b)] * body.modes.table[(a, b)]
            });
            let trace = body.modes.to_nodes(trace.as_ref());
            for (i, &node) in constraint.inside.iter().enumerate() {
                if let Some(local) = body.columns.local([node % self.nx, node / self.nx]) {
                    let rows = body.columns.count[0];
                    side[(i, 0)] -= body.sign * trace[(local % rows, local / rows)];
                }
            }
            start += body.len();
            modal_start += p.mode_count();
        }
        let solved_side = constraint.factor.solve(&side);
        let solved = Mat::from_fn(n, 4, |i, j| {
            if j == 0 {
                solved_side[(i, 0)]
            } else {
                constraint.motion_columns[(i, j - 1)]
            }
        });
        let turn = solve_motion(&self.motion, &constraint.rows, &solved, balance, [0.0; 3]);
        let multipliers: Vec<f64> = (0..n)
            .map(|i| (1..4).map(|j| solved[(i, j)] * turn[j - 1]).sum::<f64>() - solved[(i, 0)])
            .collect();
        let (mut start, mut modal_start) = (0, 0);
        for body in &self.bodies {
            let p = &body.preconditioner;
            let modal = &mut work.modal[modal_start..modal_start + p.mode_count()];
            let [rows, cols] = body.columns.count;
            let mut plane = Mat::<f64>::zeros(rows, cols);
            for (&node, m) in constraint.inside.iter().zip(&multipliers) {
                if let Some(local) = body.columns.local([node % self.nx, node / self.nx]) {
                    plane[(local % rows, local / rows)] = *m;
                }
            }
            let load = body.modes.to_modes(plane.as_ref());
            let mut gathered = p.gathered_mut(modal);
            gathered -= faer::Scale(body.sign) * load;
            p.spread(modal, &mut work.step[start..start + body.len()]);
            start += body.len();
            modal_start += p.mode_count();
        }
        (turn, multipliers)
    }
}
