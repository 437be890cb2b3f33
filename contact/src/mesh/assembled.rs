//! The stiffness of a mesh's bodies, assembled.

use std::sync::Arc;

use kufe_fem::{Body, ElementKind, SparseStiffness};

use crate::Error;
use crate::bodies::elastic_body::{Stiffness, hexahedra};
use crate::mesh::contact_mesh::ContactMesh;
use crate::mesh::discretise::Discretisation;

/// The assembled stiffness of one body.
#[derive(Clone, Debug, PartialEq)]
pub struct AssembledBody {
    /// `"ice"` or `"runner"`.
    pub name: &'static str,
    /// K of all displacements of the body, component after component, nodes as in
    /// [`VolumeField`](crate::VolumeField) or [`RunnerField`](crate::RunnerField) [N/m].
    pub stiffness: Arc<SparseStiffness>,
    /// Displacements that mirror planes, outer faces or a mount fix, ascending.
    pub fixed: Vec<usize>,
}

/// Assembles the stiffness of every body of a mesh, which its products then use.
///
/// `element` is that of a runner on mapped hexahedra.
///
/// # Errors
/// [`Error::StiffnessTooLarge`] if the bodies together need more than `limit` bytes,
/// [`Error::Unsuitable`].
pub(crate) fn assemble(
    mesh: &mut Discretisation,
    element: Option<ElementKind>,
    limit: u64,
) -> Result<(), Error> {
    let mut remaining = limit;
    let mut of = |body: &Body| {
        let made = SparseStiffness::assemble(body, remaining).map_err(named)?;
        remaining = remaining.saturating_sub(made.bytes());
        Ok::<_, Error>(Some(Arc::new(made)))
    };
    for body in &mut mesh.contact.bodies {
        body.assembled = match (&body.stiffness, &mesh.runner_mesh) {
            (Stiffness::Solid(solid), _) => of(&solid.body)?,
            (Stiffness::Mapped { .. }, Some(runner)) => {
                let kind = element.unwrap_or_default();
                let solid = Body::uniform(runner.clone(), body.material(), kind);
                of(&solid.map_err(named)?)?
            }
            (Stiffness::Tensor(grid) | Stiffness::Mapped { grid, .. }, _) => {
                of(&hexahedra(grid).map_err(named)?)?
            }
        };
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
        error => Error::runner_mesh(error),
    }
}

/// The assembled bodies with their fixed displacements; empty if not assembled.
pub(crate) fn assembled_bodies(contact: &ContactMesh) -> Vec<AssembledBody> {
    let bodies = ["ice", "runner"].into_iter().zip(&contact.bodies);
    let assembled = bodies.filter_map(|(name, body)| {
        Some(AssembledBody {
            name,
            stiffness: body.assembled.clone()?,
            fixed: body.fixed_dofs(),
        })
    });
    assembled.collect()
}
