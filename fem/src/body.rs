//! A meshed elastic body.

use kufe_mesh::HexMesh;
use rayon::prelude::*;

use crate::element::hex8::{self, Corners};
use crate::error::Error;
use crate::material::Material;
use crate::section::{ElementKind, Section};

/// A hexahedral mesh whose cells have materials and elements, checked once.
///
/// Displacements and forces of a body are `3 * node_count` numbers, node by node, (x, y, z) within a node.
///
/// ```
/// use kufe_fem::{Body, ElementKind, Material};
/// use kufe_mesh::TensorGrid;
/// let grid = TensorGrid { x: vec![0.0, 1.0], y: vec![0.0, 1.0], z: vec![0.0, 1.0] };
/// let steel = Material::new(210e9, 0.3)?;
/// let body = Body::uniform(grid.hex_mesh(), steel, ElementKind::Hex8Incompatible)?;
/// assert_eq!(body.dofs(), 24);
/// # Ok::<(), kufe_fem::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Body {
    mesh: HexMesh,
    sections: Vec<Section>,
}

impl Body {
    /// A body with one section a cell.
    ///
    /// Fails where there are no cells, a cell names a missing node, a Jacobian determinant at a Gauss point or at a
    /// cell's centre is not positive, the number of sections differs from that of cells, or the nodes exceed 32 bits.
    pub fn new(mesh: HexMesh, sections: Vec<Section>) -> Result<Self, Error> {
        let node_count = mesh.points.len();
        let limit = (u32::MAX / 3) as usize;
        if mesh.cells.is_empty() {
            return Err(Error::NoCells);
        }
        if node_count > limit {
            return Err(Error::TooManyNodes { node_count, limit });
        }
        if sections.len() != mesh.cells.len() {
            return Err(Error::Length {
                what: "sections of a body's cells",
                found: sections.len(),
                expected: mesh.cells.len(),
            });
        }
        for (cell, corners) in mesh.cells.iter().enumerate() {
            if let Some(&node) = corners.iter().find(|&&node| node >= node_count) {
                return Err(Error::NodeIndex {
                    cell,
                    node,
                    node_count,
                });
            }
        }
        let body = Self { mesh, sections };
        let inverted = (0..body.mesh.cells.len())
            .into_par_iter()
            .find_map_first(|cell| {
                let determinant = hex8::smallest_determinant(&body.corners(cell));
                let valid = determinant > 0.0 && determinant.is_finite();
                (!valid).then_some(Error::InvertedCell { cell, determinant })
            });
        match inverted {
            Some(error) => Err(error),
            None => Ok(body),
        }
    }

    /// A body of one material and one kind of element. Fails as [`Body::new`].
    pub fn uniform(mesh: HexMesh, material: Material, kind: ElementKind) -> Result<Self, Error> {
        let sections = vec![Section { material, kind }; mesh.cells.len()];
        Self::new(mesh, sections)
    }

    /// The mesh.
    pub fn mesh(&self) -> &HexMesh {
        &self.mesh
    }

    /// The sections, one a cell.
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.mesh.points.len()
    }

    /// Number of displacements, three a node.
    pub fn dofs(&self) -> usize {
        3 * self.mesh.points.len()
    }

    /// Positions of a cell's corners [m].
    pub fn corners(&self, cell: usize) -> Corners {
        self.mesh.cells[cell].map(|node| self.mesh.points[node])
    }

    /// The 24 values of `u` (`dofs` long) at a cell's corners.
    pub fn gather(&self, cell: usize, u: &[f64]) -> [f64; 24] {
        let nodes = &self.mesh.cells[cell];
        std::array::from_fn(|d| u[3 * nodes[d / 3] + d % 3])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_block::block;

    #[test]
    fn bad_meshes_are_refused_with_their_place() {
        let steel = Material::new(210e9, 0.3).unwrap();
        let good = block([2, 2, 2], [1.0; 3], 0.0);
        let refuse = |mesh: HexMesh| Body::uniform(mesh, steel, ElementKind::Hex8).unwrap_err();

        let mut mesh = good.clone();
        mesh.cells[3][5] = 99;
        assert_eq!(
            refuse(mesh),
            Error::NodeIndex {
                cell: 3,
                node: 99,
                node_count: 27
            }
        );
        let mut mesh = good.clone();
        mesh.cells[2].swap(0, 6);
        assert!(
            matches!(refuse(mesh), Error::InvertedCell { cell: 2, determinant } if determinant < 0.0)
        );
        let mut mesh = good.clone();
        mesh.points[13][1] = f64::NAN;
        assert!(matches!(refuse(mesh), Error::InvertedCell { cell: 0, .. }));
        let mut mesh = good;
        mesh.cells.clear();
        assert_eq!(refuse(mesh), Error::NoCells);
    }
}
