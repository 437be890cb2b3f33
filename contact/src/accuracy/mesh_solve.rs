//! The solve on one mesh.

use kufe_fem::TensorOperator;
use kufe_mesh::TensorGrid;

use crate::active_set::contact_set::{Control, Counts, Progress, SetUpdate};
use crate::bodies::far_field::{lumps, prescribe};
use crate::green::matrix::{Green, StorageLimit};
use crate::mesh::contact_mesh::State;
use crate::mesh::discretise::Discretisation;
use crate::precondition::planewise::Side;
use crate::problem::check::CheckedProblem;
use crate::{Error, Foundation, Load};

/// The last contact forces, with the plane of their mesh.
pub(crate) struct Forces {
    x: Vec<f64>,
    y: Vec<f64>,
    force: Vec<f64>,
    symmetry: [bool; 2],
}

impl Forces {
    /// The forces of a state of `mesh`.
    pub fn of(mesh: &Discretisation, state: &State) -> Self {
        Forces {
            x: mesh.grid.x.clone(),
            y: mesh.grid.y.clone(),
            force: state.force.clone(),
            symmetry: mesh.symmetry,
        }
    }
}

/// The solve on one mesh of a problem, with its callback.
pub(crate) struct MeshSolve<'a> {
    pub checked: &'a CheckedProblem<'a>,
    pub mesh: &'a Discretisation,
    /// Largest number of candidates for which the Green's matrix is stored.
    pub stored: StorageLimit,
    /// Called at every update of the contact set, with the present state.
    pub report: &'a dyn Fn(&SetUpdate, &State),
}

/// Largest number of conjugate-gradient iterations on one mesh at a Poisson's ratio of 1/3.
const MAX_ITERATIONS: usize = 1000;
/// Largest number of far fields under a given approach.
const MAX_ROUNDS: usize = 20;
/// Tolerance of the relative change of the force between two far fields.
const FORCE_RTOL: f64 = 1e-6;

impl MeshSolve<'_> {
    /// Solves, beginning with the contact on the plane alone at `motion`; the initial far field is
    /// that of `forces`.
    pub fn solve(&self, motion: f64, forces: &Forces) -> Result<(State, Progress), Error> {
        self.solve_within(MAX_ROUNDS, motion, forces)
    }

    /// [`MeshSolve::solve`] with a largest number of far fields.
    fn solve_within(
        &self,
        rounds: usize,
        motion: f64,
        forces: &Forces,
    ) -> Result<(State, Progress), Error> {
        let contact = &self.mesh.contact;
        let (problem, options) = (self.checked.problem, self.checked.options);
        let greens = contact.greens(self.stored);
        let on_plane = contact.plane_contact_from_rest(&greens[1], motion);
        let mut state = contact.state_of(&on_plane.force, on_plane.motion);
        state.displacement = vec![0.0; contact.len()];
        self.fix_outer_faces(forces, &mut state);
        let mut progress = self.with_fixed_faces(&greens, &mut state, on_plane.counts);
        if matches!(problem.load, Load::Approach { .. })
            && problem.ice.foundation == Foundation::HalfSpace
        {
            // The force, and with it the far field, follows from the solution.
            let mut change = f64::INFINITY;
            for _ in 0..rounds {
                let before = contact.resultant(&state)[0];
                self.fix_outer_faces(&Forces::of(self.mesh, &state), &mut state);
                options.check_stop()?;
                let again = self.with_fixed_faces(&greens, &mut state, Counts::default());
                progress.iterations += again.iterations;
                progress.converged &= again.converged;
                progress.residual = again.residual;
                change =
                    (contact.resultant(&state)[0] - before).abs() / before.max(f64::MIN_POSITIVE);
                if change <= FORCE_RTOL {
                    break;
                }
            }
            options.check_stop()?;
            if change.is_nan() || change > FORCE_RTOL {
                return Err(Error::FarField { rounds, change });
            }
        }
        options.check_stop()?;
        if !progress.converged {
            return Err(Error::NotConverged {
                iterations: progress.iterations,
                residual: progress.residual,
                tolerance: options.residual,
            });
        }
        // Where the ice yields on all nodes, the mesh may bear less than the load.
        let carried = contact.resultant(&state)[0];
        if matches!(problem.load, Load::Force { .. }) && carried <= 0.0 {
            return Err(Error::NoAnswer {
                name: "force carried [N]",
                value: carried,
                expected: "the requested normal force: a lower one, or harder ice",
            });
        }
        Ok((state, progress))
    }

    /// [`MAX_ITERATIONS`], more for nearly incompressible materials: the condition number of K with
    /// its preconditioner, which does not couple components, is about (lambda + 2 mu) / mu, 4 at
    /// 1/3, and iterations are proportional to its root.
    fn max_iterations(&self) -> usize {
        let materials = self.mesh.contact.bodies.iter().flat_map(|body| {
            let lower = body.stiffness.grid().and_then(TensorOperator::lower_layer);
            lower
                .map(|layer| layer.material)
                .into_iter()
                .chain([body.material()])
        });
        let conditions = materials.map(|m| m.uniaxial_strain_modulus() / m.shear_modulus());
        let condition = conditions.fold(4.0, f64::max);
        (MAX_ITERATIONS as f64 * (condition / 4.0).sqrt()) as usize
    }

    /// Prescribes the far field of the contact forces on the outer faces of a half-space.
    pub fn fix_outer_faces(&self, forces: &Forces, state: &mut State) {
        let lumps = lumps(&forces.x, &forces.y, &forces.force, forces.symmetry);
        let (grid, symmetry) = (&self.mesh.grid, self.mesh.symmetry);
        let (on_ice, on_runner) = state.displacement.split_at_mut(3 * grid.node_count());
        if self.checked.problem.ice.foundation == Foundation::HalfSpace {
            prescribe(
                grid,
                symmetry,
                self.checked.material,
                &lumps,
                Side::Below,
                on_ice,
            );
        }
        // An unbounded runner has all columns and is a half-space, too.
        if let [ice, body] = &self.mesh.contact.bodies[..]
            && body.columns() == ice.columns()
            && let Some(operator) = body.stiffness.grid()
        {
            let grid = TensorGrid {
                z: operator.axes[2].nodes.clone(),
                ..grid.clone()
            };
            let material = body.material();
            prescribe(&grid, symmetry, material, &lumps, Side::Above, on_runner);
        }
    }

    /// Solves the equations with prescribed displacements of the outer faces, from `state`; `begun`
    /// counts the sweeps and accelerations behind its forces.
    fn with_fixed_faces(&self, greens: &[Green; 2], state: &mut State, begun: Counts) -> Progress {
        let control = Control {
            iterations: self.max_iterations(),
            options: self.checked.options,
            report: self.report,
        };
        self.mesh.contact.solve(state, greens, begun, &control)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::sync::Arc;

    use kufe_mesh::Paraboloid;

    use super::*;
    use crate::accuracy::find_patch::find_patch;
    use crate::grid::grading::Resolution;
    use crate::grid::patch::Patch;
    use crate::mesh::discretise::Reach;
    use crate::{Ice, Options, Problem, Runner};

    /// A mesh of a problem's patch as found, and what it is solved from.
    pub(crate) struct MeshProblem {
        pub problem: Problem,
        pub patch: Patch,
        pub forces: Forces,
        pub mesh: Discretisation,
    }

    impl MeshProblem {
        /// With so many cells over half the patch.
        pub fn new(problem: Problem, cells: f64) -> Result<Self, Error> {
            let options = Options::default();
            let checked = CheckedProblem::bearable(&problem, &options)?;
            let (patch, forces) = find_patch(&checked)?;
            let mesh = checked.mesh(&patch, Resolution::of(cells), Reach::Patch)?;
            Ok(MeshProblem {
                problem,
                patch,
                forces,
                mesh,
            })
        }

        /// Solved with Green's matrices of so many nodes stored.
        pub fn solve(&self, stored: StorageLimit) -> Result<(State, Progress), Error> {
            MeshSolve {
                checked: &CheckedProblem::new(&self.problem, &Options::default())?,
                mesh: &self.mesh,
                stored,
                report: &|_, _| {},
            }
            .solve(self.patch.motion, &self.forces)
        }
    }

    #[test]
    fn a_far_field_that_does_not_settle_with_the_force_is_refused()
    -> Result<(), Box<dyn std::error::Error>> {
        let runner = Runner::rigid(Arc::new(Paraboloid::new(0.05, 0.05)?));
        let load = Load::Approach {
            approach: 1e-5,
            pitch: 0.0,
            roll: 0.0,
        };
        let problem = Problem::new(runner, Ice::half_space(9e9, 0.33), load);
        let one = MeshProblem::new(problem, 4.0)?;
        let options = Options::default();
        let solve = MeshSolve {
            checked: &CheckedProblem::new(&one.problem, &options)?,
            mesh: &one.mesh,
            stored: StorageLimit::USUAL,
            report: &|_, _| {},
        };
        let within = |rounds| solve.solve_within(rounds, one.patch.motion, &one.forces);
        let mut before = f64::INFINITY;
        for rounds in [1, 2] {
            let Err(Error::FarField {
                rounds: made,
                change,
            }) = within(rounds)
            else {
                return Err("a force that still changes was taken for an answer".into());
            };
            assert_eq!(made, rounds);
            assert!(FORCE_RTOL < change && change < 0.3 * before, "{change}");
            before = change;
        }
        let (state, _) = within(MAX_ROUNDS)?;
        assert!(one.mesh.contact.resultant(&state)[0] > 0.0);
        Ok(())
    }
}
