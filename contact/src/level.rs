//! The contact problem on one mesh: conjugate gradients that keep the contact closed.

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, MatRef, Side};
use rayon::prelude::*;

use crate::body::Body;
use crate::motion::{Motion, dot_rows, solve_motion};
use crate::psor::{PlaneProblem, PlaneState, Sets, dot};
use crate::vector;

/// A mesh with everything the iteration needs; plane arrays have x fastest.
pub(crate) struct Level {
    /// Elastic bodies that share the columns of the contact plane.
    pub bodies: Vec<Body>,
    /// Nodes along x on the contact plane.
    pub nx: usize,
    /// Undeformed gap; infinite where there is no hull [m].
    pub gap: Vec<f64>,
    /// Rows N of the rigid motion.
    pub rows: Vec<[f64; 3]>,
    /// Largest contact force of each node [N].
    pub bound: Vec<f64>,
    /// Nodes that may touch (indices on the plane).
    pub candidates: Vec<usize>,
    /// The runner's motion and the balance of the modelled part.
    pub motion: Motion,
}

/// Displacements, contact forces and motion on one mesh.
#[derive(Clone, Debug)]
pub(crate) struct State {
    /// Displacements of the bodies one after another, held values included [m].
    pub displacement: Vec<f64>,
    /// Contact forces on the plane [N].
    pub force: Vec<f64>,
    /// Approach [m], pitch and roll [rad].
    pub motion: [f64; 3],
}

/// How an iteration went.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    /// Conjugate-gradient iterations in all.
    pub iterations: usize,
    /// For each contact set: nodes, iterations, residual, largest force.
    pub updates: Vec<SetUpdate>,
    /// Energy-norm residual over the energy of the solution.
    pub residual: f64,
    /// Whether tolerance and set were both reached.
    pub converged: bool,
}

impl Progress {
    /// A solve without iterations.
    pub fn direct(converged: bool) -> Self {
        Progress {
            iterations: 0,
            updates: Vec::new(),
            residual: 0.0,
            converged,
        }
    }
}

/// What happened with one contact set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SetUpdate {
    pub contact_nodes: usize,
    pub iterations: usize,
    pub residual: f64,
}

/// The factorised constraint of one contact set.
struct Constraint {
    inside: Vec<usize>,
    rows: Vec<[f64; 3]>,
    factor: Llt<f64>,
    motion_columns: Mat<f64>,
}

/// Vectors that the iteration reuses.
struct Workspace {
    residual: Vec<f64>,
    step: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    modal: Vec<f64>,
    scratch: Vec<f64>,
}

impl Level {
    /// Length of a displacement vector.
    pub fn len(&self) -> usize {
        self.bodies.iter().map(Body::len).sum()
    }

    /// The dense Green's matrix of the candidates: that of P, and that scaled to elasticity's.
    pub fn greens(&self) -> [Mat<f64>; 2] {
        let n = self.candidates.len();
        let mut plain = Mat::zeros(n, n);
        let mut scaled = Mat::zeros(n, n);
        for body in &self.bodies {
            let [first_x, first_y] = body.columns.first;
            let nodes: Vec<[usize; 2]> = self
                .candidates
                .iter()
                .map(|&n| [n % self.nx - first_x, n / self.nx - first_y])
                .collect();
            let mut green = Mat::zeros(n, n);
            body.modes.add_green(&nodes, 1.0, &mut green);
            plain += &green;
            scaled += faer::Scale(body.response) * &green;
        }
        [plain, scaled]
    }

    /// Place of a plane node in a body's vector.
    fn entry(&self, body: &Body, node: usize) -> Option<usize> {
        body.columns
            .local([node % self.nx, node / self.nx])
            .map(|local| body.plane_start() + local)
    }

    /// Vertical closing of the gap by the displacements: sum of sign times u_z on the plane.
    pub fn closing(&self, displacement: &[f64]) -> Vec<f64> {
        let mut closing = vec![0.0; self.gap.len()];
        let mut start = 0;
        for body in &self.bodies {
            for (node, c) in closing.iter_mut().enumerate() {
                if let Some(entry) = self.entry(body, node) {
                    *c += body.sign * displacement[start + entry];
                }
            }
            start += body.len();
        }
        closing
    }

    /// Vertical displacement of the lowest body's plane, the ice surface.
    pub fn ice_surface(&self, displacement: &[f64]) -> Vec<f64> {
        let ice = &self.bodies[0];
        (0..self.gap.len())
            .map(|node| {
                self.entry(ice, node)
                    .map_or(0.0, |entry| displacement[entry])
            })
            .collect()
    }

    /// Gap of every plane node in a state.
    pub fn gaps(&self, state: &State) -> Vec<f64> {
        let closing = self.closing(&state.displacement);
        (0..self.gap.len())
            .map(|i| self.gap[i] - dot(self.rows[i], state.motion) - closing[i])
            .collect()
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

    /// Iterates from `state` until the energy-norm residual is below `tolerance` and the contact set stays.
    pub fn solve(
        &self,
        state: &mut State,
        greens: &[Mat<f64>; 2],
        tolerance: f64,
        limit: usize,
    ) -> Progress {
        let mut work = self.workspace();
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
            let Some(constraint) = self.constrain(&sets, &greens[0]) else {
                break;
            };
            let before = progress.iterations;
            let confirmed = self.iterate(
                &sets,
                &constraint,
                state,
                &mut work,
                tolerance,
                limit,
                &mut progress,
            );
            progress.updates.push(SetUpdate {
                contact_nodes: sets.inside.len() + sets.full.len(),
                iterations: progress.iterations - before,
                residual: progress.residual,
            });
            if confirmed || progress.iterations >= limit {
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
        progress
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
    fn signs(&self, state: &State, sets: &Sets, slack: f64) -> Option<Sets> {
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

    /// Deepest interpenetration of the undeformed shapes [m].
    pub fn depth(&self, state: &State) -> f64 {
        (0..self.gap.len())
            .map(|i| dot(self.rows[i], state.motion) - self.gap[i])
            .fold(f64::MIN_POSITIVE, f64::max)
    }

    fn constrain(&self, sets: &Sets, green: &Mat<f64>) -> Option<Constraint> {
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

    fn workspace(&self) -> Workspace {
        let n = self.len();
        let modal = self
            .bodies
            .iter()
            .map(|b| b.preconditioner.mode_count())
            .sum();
        let scratch = self
            .bodies
            .iter()
            .map(|b| b.preconditioner.scratch_len())
            .max()
            .unwrap_or(0);
        Workspace {
            residual: vec![0.0; n],
            step: vec![0.0; n],
            direction: vec![0.0; n],
            image: vec![0.0; n],
            modal: vec![0.0; modal],
            scratch: vec![0.0; scratch],
        }
    }

    /// Conjugate gradients in the subspace where the nodes inside stay closed.
    ///
    /// Returns whether the tolerance was reached and the signs confirm the set.
    #[allow(clippy::too_many_arguments)]
    fn iterate(
        &self,
        sets: &Sets,
        constraint: &Constraint,
        state: &mut State,
        work: &mut Workspace,
        tolerance: f64,
        limit: usize,
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
            if progress.iterations >= limit {
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
            vector::add(&mut state.displacement, alpha, &work.direction);
            vector::add(&mut work.residual, -alpha, &work.image);
            progress.iterations += 1;
        }
    }

    /// Twice the energy stored by the contact forces: sum of force times closing.
    fn energy(&self, state: &State) -> f64 {
        let closing = self.closing(&state.displacement);
        state
            .force
            .iter()
            .zip(&closing)
            .map(|(f, c)| f * c)
            .sum::<f64>()
            .abs()
    }

    /// Forces 0 outside the set and at their bound where full.
    fn project_forces(&self, sets: &Sets, state: &mut State) {
        let mut kept = vec![0.0; state.force.len()];
        for &i in &sets.inside {
            let node = self.candidates[i];
            kept[node] = state.force[node].clamp(0.0, self.bound[node]);
        }
        for &i in &sets.full {
            kept[self.candidates[i]] = self.bound[self.candidates[i]];
        }
        state.force = kept;
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

    /// `out` = K u, body by body.
    fn apply(&self, u: &[f64], out: &mut [f64]) {
        let mut start = 0;
        for body in &self.bodies {
            let range = start..start + body.len();
            body.apply(&u[range.clone()], &mut out[range]);
            start += body.len();
        }
    }

    /// `out` = - K u - B^T f.
    fn residual(&self, state: &State, out: &mut [f64]) {
        self.apply(&state.displacement, out);
        let mut start = 0;
        for body in &self.bodies {
            for (node, f) in state.force.iter().enumerate().filter(|(_, f)| **f != 0.0) {
                if let Some(entry) = self.entry(body, node) {
                    out[start + entry] += body.sign * f;
                }
            }
            start += body.len();
        }
        out.par_chunks_mut(vector::CHUNK)
            .for_each(|chunk| chunk.iter_mut().for_each(|r| *r = -*r));
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
            p.to_modes(
                &work.residual[start..start + body.len()],
                modal,
                &mut work.scratch,
            );
            p.divide(modal);
            let trace = body.modes.to_nodes(body.trace_modes(modal).as_ref());
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
            subtract_plane_load(body, body.modes.to_modes(plane.as_ref()).as_ref(), modal);
            p.from_modes(
                modal,
                &mut work.step[start..start + body.len()],
                &mut work.scratch,
            );
            start += body.len();
            modal_start += p.mode_count();
        }
        (turn, multipliers)
    }

    /// Sum of the contact forces' rows: normal force and moments of the modelled part.
    pub fn resultant(&self, state: &State) -> [f64; 3] {
        let force = Mat::from_fn(state.force.len(), 1, |i, _| state.force[i]);
        [0, 1, 2].map(|a| dot_rows(&self.rows, a, &force, 0))
    }
}

/// Subtracts what P^-1 answers to vertical forces on the contact plane, given by their modes.
fn subtract_plane_load(body: &Body, load: MatRef<'_, f64>, modal: &mut [f64]) {
    let range = body.preconditioner.component_range(2);
    let inverse = body.preconditioner.inverse(2);
    let (mx, my) = (load.nrows(), load.ncols());
    let flat: Vec<f64> = (0..mx * my).map(|i| load[(i % mx, i / mx)]).collect();
    modal[range]
        .par_chunks_mut(mx * my)
        .zip(inverse.par_chunks(mx * my))
        .zip(&body.modes.z)
        .for_each(|((layer, inverse), value)| {
            let factor = body.sign * value;
            for ((m, i), l) in layer.iter_mut().zip(inverse).zip(&flat) {
                *m -= factor * i * l;
            }
        });
}
