//! One mesh of a problem, for tests.

use crate::accuracy::find_patch::find_patch;
use crate::accuracy::mesh_solve::{Forces, MeshSolve};
use crate::active_set::contact_set::Progress;
use crate::green::matrix::StorageLimit;
use crate::grid::grading::Resolution;
use crate::grid::patch::Patch;
use crate::mesh::contact_mesh::State;
use crate::mesh::discretise::{Discretisation, Reach};
use crate::problem::check::CheckedProblem;
use crate::{Error, Options, Problem};

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
