//! Finding the patch before anything is solved in the volume.

use crate::Error;
use crate::accuracy::mesh_solve::Forces;
use crate::green::matrix::StorageLimit;
use crate::grid::first_guess::first_guess;
use crate::grid::grading::Resolution;
use crate::grid::patch::Patch;
use crate::mesh::discretise::Reach;
use crate::problem::check::CheckedProblem;
use crate::result::pressure::Field;

/// Cells over half the patch while it is being found.
const COARSE_MESH: Resolution = Resolution {
    cells: 7.0,
    growth: 0.7,
};

/// Most times that the plane is solved.
const ROUNDS: usize = 30;

/// Finds the patch with contact problems on the plane alone, regrading until the grid fits what it
/// finds.
pub(crate) fn find_patch(checked: &CheckedProblem) -> Result<(Patch, Forces), Error> {
    let mut patch = first_guess(checked);
    for _ in 0..ROUNDS {
        checked.options.check_stop()?;
        let mesh = checked.mesh(&patch, COARSE_MESH, Reach::WholeHull)?;
        let contact = &mesh.contact;
        let [_, scaled] = contact.greens(StorageLimit::USUAL);
        let found = contact.plane_contact_from_rest(&scaled, patch.motion);
        let state = contact.state_of(&found.force, found.motion);
        let next = Field::new(&mesh, checked.problem, &patch).of(&state).patch;
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
