//! Search for the patch on the contact plane, before the volume is solved.

use crate::Error;
use crate::accuracy::mesh_solve::Forces;
use crate::green::matrix::StorageLimit;
use crate::grid::first_guess::first_guess;
use crate::grid::grading::Resolution;
use crate::grid::patch::Patch;
use crate::mesh::discretise::Reach;
use crate::problem::check::CheckedProblem;
use crate::result::pressure::Field;

/// Resolution of the search.
const COARSE_MESH: Resolution = Resolution {
    cells: 7.0,
    growth: 0.7,
};

/// Largest number of solutions of the plane.
const MAX_ROUNDS: usize = 30;

/// Finds the patch with contact problems on the plane alone, which are repeated on a grid for the
/// last patch until it is similar to the next one.
pub(crate) fn find_patch(checked: &CheckedProblem) -> Result<(Patch, Forces), Error> {
    let mut patch = first_guess(checked);
    for _ in 0..MAX_ROUNDS {
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
    Err(Error::no_patch(MAX_ROUNDS))
}

/// Whether a grid made for one patch resolves the other.
fn similar(a: &Patch, b: &Patch) -> bool {
    a.all_stretches(b, |a, b| {
        a.ends_near(b, 0.3) && b.half() > 0.75 * a.half() && b.finest() > 0.85 * a.finest()
    })
}
