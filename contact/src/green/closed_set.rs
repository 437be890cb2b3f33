//! Forces that keep a set of nodes closed, by conjugate gradients with a Green's matrix that is
//! applied but not stored.

use nalgebra::{Matrix3, Vector3};

use crate::green::modal::ModalGreen;
use crate::motion::{dot, solve_semidefinite};

/// Tolerance on the forces' error in the energy norm, relative to the energy norm of the forces.
const TOLERANCE: f64 = 1e-11;

/// Largest number of iterations; a few dozen are usual on any set.
pub(crate) const MAX_ITERATIONS: usize = 300;

/// The system G f = N q - g on a set A of candidates, with N^T f = balance for the free motions.
///
/// It is solved by conjugate gradients in the subspace of balanced forces; before each step the
/// part N q is removed from the residual (N. I. M. Gould, M. E. Hribar and J. Nocedal, SIAM J. Sci.
/// Comput. 23 (2001), 1376-1395). The preconditioner W is the block of A in the plane's G^-1: an
/// operator of the opposite order on the same nodes, so that the number of iterations hardly grows
/// with the mesh.
pub(crate) struct ClosedSet<'a> {
    green: &'a ModalGreen<'a>,
    /// The set, as numbers of candidates.
    inside: Vec<usize>,
    rows: Vec<[f64; 3]>,
    free: [bool; 3],
    /// W N.
    columns: [Vec<f64>; 3],
    /// N^T W N over the free motions.
    gram: Matrix3<f64>,
}

impl<'a> ClosedSet<'a> {
    /// The system on the candidates `inside`, with their rows of N.
    pub fn new(
        green: &'a ModalGreen<'a>,
        inside: &[usize],
        rows: &[[f64; 3]],
        free: [bool; 3],
    ) -> Self {
        let mut set = ClosedSet {
            green,
            inside: inside.to_vec(),
            rows: rows.to_vec(),
            free,
            columns: Default::default(),
            gram: Matrix3::zeros(),
        };
        set.columns = [0, 1, 2].map(|a| {
            let column: Vec<f64> = rows.iter().map(|row| row[a]).collect();
            set.precondition(&column)
        });
        set.gram = Matrix3::from_fn(|a, b| {
            if free[a] && free[b] {
                set.resultant(&set.columns[b], a)
            } else {
                0.0
            }
        });
        set
    }

    /// Forces f and motion q for gaps g, from the forces `initial`.
    ///
    /// Fixed motions, and motions that do not change the gaps of the set, stay as in `current`.
    /// `None` if `max_iterations` are not enough.
    pub fn solve(
        &self,
        max_iterations: usize,
        gap: &[f64],
        [balance, current]: [[f64; 3]; 2],
        initial: &[f64],
    ) -> Option<(Vec<f64>, [f64; 3])> {
        let mut force = initial.to_vec();
        let imbalance = self.on_free(|a| balance[a] - self.resultant(&force, a));
        self.add_columns(solve_semidefinite(self.gram, imbalance), &mut force);
        let mut image = self.times(&force);
        let mut motion = current;
        let mut residual: Vec<f64> = (0..force.len())
            .map(|i| gap[i] - dot(self.rows[i], motion) + image[i])
            .collect();
        let mut direction = vec![0.0; force.len()];
        let mut previous_rho = 0.0;
        for _ in 0..max_iterations {
            let mut step = self.precondition(&residual);
            let imbalance = self.on_free(|a| self.resultant(&step, a));
            let motion_step = solve_semidefinite(self.gram, imbalance);
            self.add_columns(-motion_step, &mut step);
            for (r, row) in residual.iter_mut().zip(&self.rows) {
                *r -= dot(*row, motion_step.into());
            }
            motion = [0, 1, 2].map(|a| motion[a] + motion_step[a]);
            let rho = product(&residual, &step);
            if !rho.is_finite() {
                return None;
            }
            if rho <= TOLERANCE.powi(2) * product(&force, &image) {
                return Some((force, motion));
            }
            let beta = if previous_rho > 0.0 {
                rho / previous_rho
            } else {
                0.0
            };
            previous_rho = rho;
            for (d, z) in direction.iter_mut().zip(&step) {
                *d = -z + beta * *d;
            }
            let g_direction = self.times(&direction);
            let alpha = rho / product(&direction, &g_direction);
            for i in 0..force.len() {
                force[i] += alpha * direction[i];
                image[i] += alpha * g_direction[i];
                residual[i] += alpha * g_direction[i];
            }
        }
        None
    }

    /// Values of the free motions, 0 of the others.
    fn on_free(&self, value: impl Fn(usize) -> f64) -> Vector3<f64> {
        Vector3::from_fn(|a, _| if self.free[a] { value(a) } else { 0.0 })
    }

    /// N^T f for a motion.
    fn resultant(&self, force: &[f64], motion: usize) -> f64 {
        let terms = self.rows.iter().zip(force);
        terms.map(|(row, f)| row[motion] * f).sum()
    }

    fn add_columns(&self, factors: Vector3<f64>, out: &mut [f64]) {
        for (factor, column) in factors.iter().zip(&self.columns) {
            if *factor != 0.0 {
                let pairs = out.iter_mut().zip(column);
                pairs.for_each(|(o, c)| *o += factor * c);
            }
        }
    }

    /// G f on the set.
    fn times(&self, force: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.green.diagonal.len()];
        for (&number, &f) in self.inside.iter().zip(force) {
            all[number] = f;
        }
        let deflection = self.green.times(&all);
        let inside = self.inside.iter();
        inside.map(|&number| deflection[number]).collect()
    }

    /// W r, the set's block of the plane's G^-1.
    fn precondition(&self, residual: &[f64]) -> Vec<f64> {
        let window = &self.green.window;
        let values = self.inside.iter().copied().zip(residual.iter().copied());
        let field = self.green.stiffness.times(&window.scatter(values));
        let at = |&number: &usize| window.at(&field, number);
        self.inside.iter().map(at).collect()
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    //! Claims on the equations of a closed set: they are met, in iterations that hardly grow with
    //! the mesh.

    use std::sync::Arc;

    use super::*;
    use kufe_mesh::Paraboloid;

    use crate::accuracy::mesh_solve::tests::MeshProblem;
    use crate::green::matrix::{Green, StorageLimit};
    use crate::{Ice, Load, Problem, Runner, Tilt};

    /// Four times the nodes and four times again: the same few dozen iterations are enough.
    #[test]
    fn sets_are_closed_in_iterations_that_hardly_grow_with_the_mesh()
    -> Result<(), Box<dyn std::error::Error>> {
        let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?));
        let load = Load::central(1000.0, Tilt::Free);
        let problem = Problem::new(runner, Ice::half_space(9e9, 0.33), load);
        for cells in [5.0, 10.0, 20.0] {
            let MeshProblem { mesh, patch, .. } = MeshProblem::new(problem.clone(), cells)?;
            let contact = &mesh.contact;
            let [Green::Modal(green), _] = contact.greens(StorageLimit {
                faces: 0,
                mounted: 0,
            }) else {
                return Err("a stored matrix above the limit".into());
            };
            let near = |&i: &usize| contact.gap[contact.candidates[i]] < patch.motion;
            let inside: Vec<usize> = (0..contact.candidates.len()).filter(near).collect();
            let nodes = || inside.iter().map(|&i| contact.candidates[i]);
            let rows: Vec<[f64; 3]> = nodes().map(|node| contact.rows[node]).collect();
            let gap: Vec<f64> = nodes().map(|node| contact.gap[node]).collect();
            let set = ClosedSet::new(&green, &inside, &rows, contact.motion.free);
            let balance = contact.motion.balance;
            let none = vec![0.0; inside.len()];
            let count = (1..MAX_ITERATIONS)
                .find(|&most| set.solve(most, &gap, [balance, [0.0; 3]], &none).is_some());
            println!("{} nodes: {count:?} iterations", inside.len());
            let (force, motion) = set
                .solve(40, &gap, [balance, [0.0; 3]], &none)
                .ok_or("more than 40 iterations")?;
            let moved = set.times(&force);
            for k in 0..inside.len() {
                let open = gap[k] + moved[k] - dot(rows[k], motion);
                assert!(open.abs() < 1e-9 * motion[0].abs(), "{cells}: {open:e}");
            }
            let carried: f64 = force.iter().sum();
            assert!((carried / balance[0] - 1.0).abs() < 1e-12, "{carried}");
        }
        Ok(())
    }
}
