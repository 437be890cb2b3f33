//! Conjugate gradients on one contact set, in the subspace where its nodes stay closed.

use faer::Mat;

use crate::active_set::contact_set::{Control, Progress};
use crate::bodies::elastic_body::BodyWork;
use crate::green::closed_set::{ClosedSet, MAX_ITERATIONS};
use crate::green::matrix::Green;
use crate::mesh::contact_mesh::{ContactMesh, Sets, State};
use crate::motion::{dot, forces_and_motion};
use crate::precondition::dense::DenseCholesky;
use crate::vector;

/// The constraint of one contact set: its nodes are closed and the load is balanced.
pub(crate) struct Constraint<'a> {
    /// ConstraintSolver nodes, as numbers of plane nodes.
    pub inside: Vec<usize>,
    rows: Vec<[f64; 3]>,
    solver: ConstraintSolver<'a>,
}

/// Solver for the forces that keep a set closed.
enum ConstraintSolver<'a> {
    /// The factor of G on the set, with G^-1 N.
    Factored {
        factor: DenseCholesky,
        motion_columns: Mat<f64>,
    },
    /// Inner conjugate gradients.
    Iterated(ClosedSet<'a>),
}

/// A contact set to iterate on.
pub(crate) struct SetProblem<'a> {
    pub sets: &'a Sets,
    pub constraint: &'a Constraint<'a>,
    pub control: &'a Control<'a>,
    /// Residual at which the signs are checked first. It is smaller once sets have changed often,
    /// since forces that are accurate to a hundredth can make sets cycle.
    pub first_check: f64,
    /// Relative magnitude of wrong signs that a converged set may have.
    pub slack: f64,
}

/// Vectors that the iteration reuses.
pub(crate) struct Workspace {
    pub residual: Vec<f64>,
    step: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    bodies: Vec<BodyWork>,
}

impl ContactMesh {
    /// The constraint of a contact set; `None` if its block of G cannot be factored.
    pub fn constrain<'a>(&self, sets: &Sets, green: &'a Green<'_>) -> Option<Constraint<'a>> {
        let inside = &sets.inside;
        let nodes: Vec<usize> = inside.iter().map(|&i| self.candidates[i]).collect();
        let rows: Vec<[f64; 3]> = nodes.iter().map(|&node| self.rows[node]).collect();
        let solver = match green {
            Green::Dense(green) => {
                let n = inside.len();
                let matrix = Mat::from_fn(n, n, |i, j| green[(inside[i], inside[j])]);
                let factor = DenseCholesky::new(&matrix)?;
                let columns = Mat::from_fn(n, 3, |i, j| rows[i][j]);
                let motion_columns = factor.solve(&columns);
                ConstraintSolver::Factored {
                    factor,
                    motion_columns,
                }
            }
            Green::Modal(green) => {
                ConstraintSolver::Iterated(ClosedSet::new(green, inside, &rows, self.motion.free))
            }
        };
        Some(Constraint {
            inside: nodes,
            rows,
            solver,
        })
    }

    pub fn workspace(&self) -> Workspace {
        let n = self.len();
        Workspace {
            residual: vec![0.0; n],
            step: vec![0.0; n],
            direction: vec![0.0; n],
            image: vec![0.0; n],
            bodies: self.work(),
        }
    }

    /// Conjugate gradients in the subspace where the set's nodes stay closed.
    ///
    /// Returns whether the tolerance was reached and the signs confirm the set.
    pub fn iterate(
        &self,
        set: &SetProblem,
        state: &mut State,
        work: &mut Workspace,
        progress: &mut Progress,
    ) -> bool {
        let SetProblem {
            sets,
            constraint,
            control,
            ..
        } = *set;
        self.project_forces(sets, state);
        self.enter_subspace(constraint, state, work);
        progress.iterations += 1;
        // From here on the step's defect and imbalance are 0.
        let mut before = 0.0;
        let mut motion_direction = [0.0; 3];
        let mut next_check = set.first_check;
        loop {
            let (motion_step, rho) = self.equilibrate(constraint, state, work, progress);
            if let Some(confirmed) = self.check_set(set, state, progress.residual, &mut next_check)
            {
                return confirmed;
            }
            if control.reached(progress.iterations) {
                return false;
            }
            let beta = if before > 0.0 { rho / before } else { 0.0 };
            before = rho;
            motion_direction = [0, 1, 2].map(|a| motion_step[a] + beta * motion_direction[a]);
            let Some(alpha) = self.cg_step(beta, rho, state, work) else {
                return false;
            };
            state.motion = [0, 1, 2].map(|a| state.motion[a] + alpha * motion_direction[a]);
            progress.iterations += 1;
        }
    }

    /// Equilibrium residual of a state, in the energy norm of the preconditioner and relative to
    /// the state's energy norm. It is computed from the operator, not updated by an iteration.
    pub fn out_of_equilibrium(&self, state: &State) -> f64 {
        let mut work = self.workspace();
        self.residual(state, &mut work.residual, &mut work.bodies);
        self.precondition_bodies(&mut work);
        let energy = self.energy(state).max(f64::MIN_POSITIVE);
        (vector::dot(&work.residual, &work.step).abs() / energy).sqrt()
    }

    /// The step z = M^-1 r of the bodies alone.
    fn precondition_bodies(&self, work: &mut Workspace) {
        let mut closing = vec![0.0; self.gap.len()];
        for ((body, part), body_work) in self.parts().zip(&mut work.bodies) {
            body.begin(&work.residual[part.clone()], &mut closing, body_work);
            body.finish(&[], &mut work.step[part], body_work);
        }
    }

    /// Solves K u = load - B^T f for the displacements of a state by preconditioned conjugate
    /// gradients, from its present displacements; returns the number of iterations, `None` if
    /// `max_iterations` are not enough.
    ///
    /// It ends when the residual is below `tolerance` times the energy norm of the state.
    pub fn solve_displacement(
        &self,
        state: &mut State,
        tolerance: f64,
        max_iterations: usize,
    ) -> Option<usize> {
        let mut work = self.workspace();
        self.residual(state, &mut work.residual, &mut work.bodies);
        let mut before = 0.0;
        for iteration in 0..max_iterations {
            self.precondition_bodies(&mut work);
            let rho = vector::dot(&work.residual, &work.step).max(0.0);
            let energy = self.energy(state).max(f64::MIN_POSITIVE);
            if rho <= tolerance * tolerance * energy {
                return Some(iteration);
            }
            let beta = if before > 0.0 { rho / before } else { 0.0 };
            before = rho;
            self.cg_step(beta, rho, state, &mut work)?;
        }
        None
    }

    /// One step of conjugate gradients along z + `beta` times the previous direction; returns the
    /// step length, `None` if the curvature is not positive.
    fn cg_step(&self, beta: f64, rho: f64, state: &mut State, work: &mut Workspace) -> Option<f64> {
        vector::scale_add(&mut work.direction, beta, &work.step);
        self.apply(&work.direction, &mut work.image, &mut work.bodies);
        let curvature = vector::dot(&work.direction, &work.image);
        if curvature <= 0.0 {
            return None;
        }
        let alpha = rho / curvature;
        vector::add_two(
            alpha,
            [&mut state.displacement, &mut work.residual],
            [&work.direction, &work.image],
        );
        Some(alpha)
    }

    /// Enters the subspace: closes the set's nodes and balances the load. `work.residual` is then
    /// that of the new state.
    fn enter_subspace(&self, constraint: &Constraint, state: &mut State, work: &mut Workspace) {
        self.residual(state, &mut work.residual, &mut work.bodies);
        let closing = self.closing(&state.displacement);
        let defect: Vec<f64> = constraint
            .inside
            .iter()
            .map(|&i| self.gap[i] - dot(self.rows[i], state.motion) - closing[i])
            .collect();
        let mut balance = self.motion.balance;
        let loaded = self.rows.iter().zip(&state.force);
        for (row, force) in loaded.filter(|(_, f)| **f != 0.0) {
            for (b, r) in balance.iter_mut().zip(row) {
                *b -= r * force;
            }
        }
        let (force, motion_step) = self.precondition(constraint, &defect, balance, work);
        state.motion = [0, 1, 2].map(|a| state.motion[a] + motion_step[a]);
        vector::add(&mut state.displacement, &work.step);
        add_to(constraint, &force, state);
        self.residual(state, &mut work.residual, &mut work.bodies);
    }

    /// The next preconditioned step z in the subspace; returns its rigid motion and r . z.
    ///
    /// The increment of the multipliers is added to the forces, so that the residual is that of
    /// equilibrium with them.
    fn equilibrate(
        &self,
        constraint: &Constraint,
        state: &mut State,
        work: &mut Workspace,
        progress: &mut Progress,
    ) -> ([f64; 3], f64) {
        let none = vec![0.0; constraint.inside.len()];
        let (force, motion_step) = self.precondition(constraint, &none, [0.0; 3], work);
        let rho = vector::dot(&work.residual, &work.step).max(0.0);
        add_to(constraint, &force, state);
        let opposite = forces_on(constraint, &force, -1.0);
        self.add_forces(&opposite, &mut work.residual);
        let energy = self.energy(state).max(f64::MIN_POSITIVE);
        progress.residual = (rho / energy).sqrt();
        (motion_step, rho)
    }

    /// `Some(true)` if the tolerance is reached and the signs confirm the set, `Some(false)` if
    /// they contradict it, `None` to continue; signs are checked whenever the residual has fallen a
    /// hundredfold.
    fn check_set(
        &self,
        set: &SetProblem,
        state: &State,
        residual: f64,
        next_check: &mut f64,
    ) -> Option<bool> {
        let tolerance = set.control.options.residual;
        if residual.is_nan() || residual >= next_check.max(tolerance) {
            return None;
        }
        let reached = residual < tolerance;
        let slack = if reached { set.slack } else { residual };
        if self.contradicts(state, set.sets, slack) {
            return Some(false);
        }
        *next_check *= 1e-2;
        reached.then_some(true)
    }

    /// Solves P z + B^T m = r, N^T m = `balance`, B z + N q = `defect` for the step z (into
    /// `work.step`), the rigid motion q and the multipliers m of the closed nodes.
    fn precondition(
        &self,
        constraint: &Constraint,
        defect: &[f64],
        balance: [f64; 3],
        work: &mut Workspace,
    ) -> (Vec<f64>, [f64; 3]) {
        let mut closing = vec![0.0; self.gap.len()];
        for ((body, part), body_work) in self.parts().zip(&mut work.bodies) {
            body.begin(&work.residual[part], &mut closing, body_work);
        }
        let (multipliers, motion_step) = self.multipliers(constraint, &closing, defect, balance);
        let forces = forces_on(constraint, &multipliers, 1.0);
        for ((body, part), body_work) in self.parts().zip(&mut work.bodies) {
            body.finish(&forces, &mut work.step[part], body_work);
        }
        (multipliers, motion_step)
    }

    /// The multipliers and the rigid motion that close `defect` less `closing` = B P^-1 r; NaN if
    /// an inner iteration fails.
    fn multipliers(
        &self,
        constraint: &Constraint,
        closing: &[f64],
        defect: &[f64],
        balance: [f64; 3],
    ) -> (Vec<f64>, [f64; 3]) {
        let n = constraint.inside.len();
        let side = Mat::from_fn(n, 1, |i, _| defect[i] - closing[constraint.inside[i]]);
        let solved = match &constraint.solver {
            ConstraintSolver::Factored {
                factor,
                motion_columns,
            } => {
                let solved_side = factor.solve(&side);
                Mat::from_fn(n, 4, |i, j| match j {
                    0 => solved_side[(i, 0)],
                    _ => motion_columns[(i, j - 1)],
                })
            }
            ConstraintSolver::Iterated(set) => {
                let gap: Vec<f64> = side.col(0).iter().copied().collect();
                let found = set.solve(MAX_ITERATIONS, &gap, [balance, [0.0; 3]], &vec![0.0; n]);
                return found.unwrap_or((vec![f64::NAN; n], [f64::NAN; 3]));
            }
        };
        forces_and_motion(&self.motion, &constraint.rows, &solved, balance, [0.0; 3])
    }
}

/// Forces on the closed nodes times `factor`, as pairs of node and force.
fn forces_on(constraint: &Constraint, force: &[f64], factor: f64) -> Vec<(usize, f64)> {
    let nodes = constraint.inside.iter().copied();
    nodes.zip(force.iter().map(|f| factor * f)).collect()
}

/// Adds forces on the closed nodes to the state's.
fn add_to(constraint: &Constraint, force: &[f64], state: &mut State) {
    for (&node, f) in constraint.inside.iter().zip(force) {
        state.force[node] += f;
    }
}
