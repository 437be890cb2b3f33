//! Finding the patch before anything is solved in the volume.

use kufe_fem::Material;

use crate::accuracy::mesh_solve::Forces;
use crate::active_set::plane_problem::PlaneState;
use crate::green::matrix::StorageLimit;
use crate::grid::first_guess::first_guess;
use crate::grid::grading::Resolution;
use crate::grid::patch::Patch;
use crate::mesh::discretise::{MeshPlan, Reach};
use crate::problem::gap::Gap;
use crate::result::pressure::Field;
use crate::{Error, Options, Problem};

/// Cells over half the patch while it is being found.
const COARSE_MESH: Resolution = Resolution {
    cells: 7.0,
    growth: 0.7,
};

/// Most times that the plane is solved.
const ROUNDS: usize = 30;

/// Finds the patch with contact problems on the plane alone, regrading until the grid fits what it
/// finds.
pub(crate) fn find_patch(
    problem: &Problem,
    gap: &Gap,
    material: Material,
    options: &Options,
) -> Result<(Patch, Forces), Error> {
    let mut patch = first_guess(problem, gap);
    for _ in 0..ROUNDS {
        if options.stopped() {
            return Err(Error::Stopped);
        }
        let mesh = MeshPlan {
            problem,
            gap,
            material,
            patch: &patch,
            resolution: COARSE_MESH,
            reach: Reach::WholeHull,
        }
        .mesh()?;
        let contact = &mesh.contact;
        let [_, scaled] = contact.greens(StorageLimit::USUAL);
        let none = vec![0.0; contact.candidates.len()];
        let start = PlaneState::new(none, [patch.motion, 0.0, 0.0]);
        let found = contact.plane_contact(&scaled, &contact.unpressed_gap(), start);
        let state = contact.state_of(&found.force, found.motion);
        let next = Field::new(&mesh, problem, &patch).of(&state).patch;
        let settled = similar(&patch, &next);
        patch = next;
        if settled {
            return Ok((patch, Forces::of(&mesh, &state)));
        }
    }
    Err(Error::no_patch(ROUNDS))
}

/// Whether a grid made for one patch resolves the other.
fn similar(a: &Patch, b: &Patch) -> bool {
    a.all_stretches(b, |a, b| {
        a.ends_near(b, 0.3) && b.half() > 0.75 * a.half() && b.finest() > 0.85 * a.finest()
    })
}
