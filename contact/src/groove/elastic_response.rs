//! What the bodies answer to forces on the contact plane.

use crate::active_set::vector;
use crate::grid::contact_mesh::{ContactMesh, State};

/// Solves K u = load - B^T f for the displacements of a state, from those it has, by preconditioned conjugate gradients; returns
/// the iterations, `None` where `most` do not do.
///
/// It ends where the residual in the energy norm is below `tolerance` of the forces' own energy.
pub(crate) fn respond(
    contact: &ContactMesh,
    state: &mut State,
    tolerance: f64,
    most: usize,
) -> Option<usize> {
    let n = contact.len();
    let (mut residual, mut step, mut direction, mut image) =
        (vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut work = contact.work();
    let mut closing = vec![0.0; contact.gap.len()];
    contact.residual(state, &mut residual, &mut work);
    let mut before = 0.0;
    for iteration in 0..most {
        for ((body, part), kept) in contact.parts().zip(&mut work) {
            body.begin(&residual[part.clone()], &mut closing, kept);
            body.finish(&[], &mut step[part], kept);
        }
        let rho = vector::dot(&residual, &step).max(0.0);
        let energy = contact.energy(state).max(f64::MIN_POSITIVE);
        if rho <= tolerance * tolerance * energy {
            return Some(iteration);
        }
        let beta = if before > 0.0 { rho / before } else { 0.0 };
        before = rho;
        vector::scale_add(&mut direction, beta, &step);
        contact.apply(&direction, &mut image, &mut work);
        let curvature = vector::dot(&direction, &image);
        if curvature <= 0.0 {
            return None;
        }
        vector::add_two(
            rho / curvature,
            [&mut state.displacement, &mut residual],
            [&direction, &image],
        );
    }
    None
}
