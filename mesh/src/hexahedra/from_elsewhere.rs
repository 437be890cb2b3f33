//! Hexahedra from elsewhere, checked and turned right.

use crate::error::MeshError;
use crate::hexahedra::hex_mesh::HexMesh;

impl HexMesh {
    /// A mesh from elsewhere: indices and positions checked, unused points left out, cells that are
    /// inside out (upper and lower face exchanged) turned right.
    ///
    /// # Errors
    /// [`MeshError::NoCells`], [`MeshError::CellNode`] where a corner has no point,
    /// [`MeshError::NotFinite`] where a point that a cell uses is no number.
    pub fn from_elsewhere(points: &[[f64; 3]], cells: &[[usize; 8]]) -> Result<Self, MeshError> {
        if cells.is_empty() {
            return Err(MeshError::NoCells);
        }
        let mut number = vec![usize::MAX; points.len()];
        let mut mesh = Self {
            points: Vec::new(),
            cells: Vec::with_capacity(cells.len()),
        };
        for (index, cell) in cells.iter().enumerate() {
            let mut corners = [0; 8];
            for (corner, &node) in corners.iter_mut().zip(cell) {
                let unknown = MeshError::CellNode {
                    cell: index + 1,
                    node,
                    points: points.len(),
                };
                let place = number.get_mut(node).ok_or(unknown)?;
                if *place == usize::MAX {
                    let position = points[node];
                    if position.iter().any(|v| !v.is_finite()) {
                        return Err(MeshError::NotFinite {
                            vertex: node + 1,
                            position,
                        });
                    }
                    *place = mesh.points.len();
                    mesh.points.push(position);
                }
                *corner = *place;
            }
            let jacobians = mesh.corner_jacobians(&corners);
            if jacobians.iter().all(|[jacobian, _]| *jacobian < 0.0) {
                corners.rotate_left(4);
            }
            mesh.cells.push(corners);
        }
        Ok(mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hexahedra::tensor_grid::TensorGrid;

    fn bricks() -> HexMesh {
        TensorGrid {
            x: vec![0.0, 1.0, 3.0],
            y: vec![0.0, 1.0],
            z: vec![0.0, 0.5, 1.0],
        }
        .hex_mesh()
    }

    #[test]
    fn inverted_cells_are_counted_and_those_from_elsewhere_turned() {
        let mut mesh = bricks();
        mesh.cells[1].rotate_left(4);
        let quality = mesh.quality();
        assert_eq!(quality.inverted, 1);
        assert!((quality.min_scaled_jacobian + 1.0).abs() < 1e-15);
        mesh.points.push([9.0; 3]);
        let turned = HexMesh::from_elsewhere(&mesh.points, &mesh.cells).unwrap();
        assert_eq!((turned.quality().inverted, turned.points.len()), (0, 18));
    }

    #[test]
    fn cells_without_points_are_refused() {
        let refused = |points: &[[f64; 3]], cells: &[[usize; 8]]| {
            HexMesh::from_elsewhere(points, cells)
                .unwrap_err()
                .to_string()
        };
        assert!(refused(&[[0.0; 3]], &[]).contains("no hexahedra"));
        assert!(refused(&[[0.0; 3]], &[[0, 0, 0, 0, 0, 0, 0, 7]]).contains("node 7"));
        assert!(refused(&[[f64::NAN; 3]], &[[0; 8]]).contains("NaN"));
    }
}
