//! A runner on its own hexahedra as a body of the contact problem.

use std::sync::Arc;

use kufe_mesh::TensorGrid;

use crate::RunnerSolid;
use crate::bodies::elastic_body::ElasticBody;
use crate::bodies::mortar::{Mortar, mortar_rows};
use crate::bodies::stiffness::Stiffness;
use crate::bodies::trace::Trace;
use crate::precondition::factored::FactoredInverse;
use crate::precondition::inverse::Inverse;

/// A solid with its factor as preconditioner, exact, over the plane of the ice's `grid` by a mortar.
pub(crate) fn solid_body(solid: &Arc<RunnerSolid>, grid: &TensorGrid) -> ElasticBody {
    let place = |node: usize| solid.surface.partition_point(|&s| s < node);
    let faces: Vec<_> = solid
        .faces
        .iter()
        .map(|face| {
            let corners = face.map(|node| solid.mesh().points[node]);
            (face.map(place), corners.map(|p| [p[0], p[1]]))
        })
        .collect();
    let vertical = 2 * solid.mesh().points.len();
    let mortar = Arc::new(Mortar {
        rows: mortar_rows(grid, &faces),
        entries: solid.surface.iter().map(|node| vertical + node).collect(),
    });
    ElasticBody {
        stiffness: Stiffness::Solid(solid.clone()),
        assembled: None,
        inverse: Inverse::Factored(FactoredInverse::new(solid.clone(), mortar.clone())),
        trace: Trace::Means(mortar),
        material: solid.material(),
        held: Vec::new(),
        load: Vec::new(),
    }
}
