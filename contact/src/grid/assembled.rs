//! The stiffness of a mesh's bodies, assembled.

use std::sync::Arc;

use kufe_fem::{Body, ElementKind, SparseStiffness};

use crate::Error;
use crate::bodies::hexahedra::hexahedra;
use crate::grid::contact_mesh::ContactMesh;
use crate::grid::discretise::Discretisation;
use crate::result::solution::AssembledBody;

/// Assembles the stiffness of every body of a mesh, to be multiplied with from now on.
///
/// `element` is that of a runner whose hexahedra are none of tensor shape.
///
/// # Errors
/// [`Error::StiffnessTooLarge`] where the bodies together would need more than `limit` bytes, [`Error::RunnerMesh`].
pub(crate) fn assemble(
    mesh: &mut Discretisation,
    element: Option<ElementKind>,
    limit: u64,
) -> Result<(), Error> {
    let mut left = limit;
    let mut of = |body: &Body| {
        let made = SparseStiffness::assemble(body, left).map_err(named)?;
        left = left.saturating_sub(made.bytes() as u64);
        Ok::<_, Error>(Some(Arc::new(made)))
    };
    for body in &mut mesh.contact.bodies {
        let solid = match &mesh.runner_mesh {
            Some(runner) if body.is_mapped() => {
                let kind = element.unwrap_or_default();
                Body::uniform(runner.clone(), body.material, kind)
            }
            _ => hexahedra(&body.operator, body.material),
        };
        body.assembled = of(&solid.map_err(named)?)?;
    }
    if let Some(solid) = &mut mesh.contact.solid {
        solid.assembled = of(solid.body())?;
    }
    Ok(())
}

fn named(error: kufe_fem::Error) -> Error {
    match error {
        kufe_fem::Error::MatrixTooLarge {
            dofs,
            needed,
            limit,
        } => Error::StiffnessTooLarge {
            dofs,
            needed,
            limit,
        },
        error => Error::RunnerMesh {
            reason: error.to_string(),
        },
    }
}

/// The assembled bodies with what is held of them; none where nothing was assembled.
pub(crate) fn assembled_bodies(contact: &ContactMesh) -> Vec<AssembledBody> {
    let of = |name, stiffness: &Option<Arc<SparseStiffness>>, free: Vec<bool>| {
        let held = (0..free.len()).filter(|&entry| !free[entry]);
        Some(AssembledBody {
            name,
            stiffness: stiffness.clone()?,
            held: held.collect(),
        })
    };
    let names = ["ice", "runner"].into_iter();
    let bodies = names.zip(&contact.bodies);
    let bodies = bodies.filter_map(|(name, body)| of(name, &body.assembled, body.free()));
    let solid = contact.solid.iter();
    let solid = solid.filter_map(|solid| of("runner", &solid.assembled, solid.free()));
    bodies.chain(solid).collect()
}
