//! Checks and quality of hexahedral meshes.

use nalgebra::Vector3;

use crate::error::MeshError;
use crate::hexahedra::hex_mesh::HexMesh;
use crate::parameter::range;

/// The three neighbours of each corner, in an order that makes a right-handed frame.
const NEIGHBOURS: [[usize; 3]; 8] = [
    [1, 3, 4],
    [2, 0, 5],
    [3, 1, 6],
    [0, 2, 7],
    [7, 5, 0],
    [4, 6, 1],
    [5, 7, 2],
    [6, 4, 3],
];

/// The corners of each face, counter-clockwise seen from outside.
const FACES: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

/// Quality of the shapes of a mesh's cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Number of cells.
    pub cells: usize,
    /// Cells with a corner whose Jacobian is not positive.
    pub inverted: usize,
    /// Smallest scaled Jacobian: ratio of a corner's Jacobian to the product of the lengths of its
    /// edges; 1 for a brick.
    pub min_scaled_jacobian: f64,
    /// Mean over the cells of each cell's smallest scaled Jacobian.
    pub mean_scaled_jacobian: f64,
    /// Largest ratio of a cell's longest to its shortest edge.
    pub max_aspect: f64,
    /// Smallest cell volume [m^3].
    pub min_volume: f64,
    /// Sum of the cells' volumes [m^3].
    pub volume: f64,
}

impl HexMesh {
    /// Jacobian [m^3] and scaled Jacobian at each corner of a cell.
    pub fn corner_jacobians(&self, cell: &[usize; 8]) -> [[f64; 2]; 8] {
        std::array::from_fn(|corner| {
            let origin = self.point(cell[corner]);
            let [a, b, c] = NEIGHBOURS[corner].map(|n| self.point(cell[n]) - origin);
            let jacobian = a.dot(&b.cross(&c));
            let lengths = a.norm() * b.norm() * c.norm();
            let scaled = if lengths > 0.0 {
                jacobian / lengths
            } else {
                0.0
            };
            [jacobian, scaled]
        })
    }

    fn point(&self, node: usize) -> Vector3<f64> {
        self.points[node].into()
    }

    /// Volume of a cell [m^3], exact for trilinear hexahedra.
    pub fn cell_volume(&self, cell: &[usize; 8]) -> f64 {
        let p = cell.map(|n| self.point(n) - self.point(cell[0]));
        let tetrahedron = |a: usize, b: usize, c: usize| p[a].dot(&p[b].cross(&p[c])) / 6.0;
        let split = |f: [usize; 4]| tetrahedron(f[0], f[1], f[2]) + tetrahedron(f[0], f[2], f[3]);
        // Each bilinear face is integrated as the mean of its two splits into triangles.
        let face = |&[a, b, c, d]: &[usize; 4]| 0.5 * (split([a, b, c, d]) + split([b, c, d, a]));
        FACES.iter().map(face).sum()
    }

    /// Shape of all cells.
    pub fn quality(&self) -> Quality {
        let mut quality = Quality {
            cells: self.cells.len(),
            inverted: 0,
            min_scaled_jacobian: f64::INFINITY,
            mean_scaled_jacobian: 0.0,
            max_aspect: 0.0,
            min_volume: f64::INFINITY,
            volume: 0.0,
        };
        for cell in &self.cells {
            let [smallest, _] = range(self.corner_jacobians(cell).map(|[_, scaled]| scaled));
            let edges = (0..8).flat_map(|a| NEIGHBOURS[a].map(|b| [a, b]));
            let edges = edges.map(|[a, b]| (self.point(cell[a]) - self.point(cell[b])).norm());
            let [short, long] = range(edges);
            let volume = self.cell_volume(cell);
            quality.inverted += usize::from(smallest.is_nan() || smallest <= 0.0);
            quality.min_scaled_jacobian = quality.min_scaled_jacobian.min(smallest);
            quality.mean_scaled_jacobian += smallest / self.cells.len() as f64;
            quality.max_aspect = quality.max_aspect.max(long / short);
            quality.min_volume = quality.min_volume.min(volume);
            quality.volume += volume;
        }
        quality
    }
}

impl HexMesh {
    /// Checks indices and positions of a mesh from another program, removes unused points, and
    /// reorders the corners of cells that are inside out (upper and lower face exchanged).
    ///
    /// # Errors
    /// [`MeshError::Invalid`] if there is no cell, a corner has no point, or a point that a cell
    /// uses is not finite.
    pub fn checked(points: &[[f64; 3]], cells: &[[usize; 8]]) -> Result<Self, MeshError> {
        if cells.is_empty() {
            return Err(MeshError::Invalid("the mesh has no hexahedra".into()));
        }
        let mut number = vec![usize::MAX; points.len()];
        let mut mesh = Self {
            points: Vec::new(),
            cells: Vec::with_capacity(cells.len()),
        };
        for (index, cell) in cells.iter().enumerate() {
            let mut corners = [0; 8];
            for (corner, &node) in corners.iter_mut().zip(cell) {
                let place = number.get_mut(node).ok_or_else(|| {
                    MeshError::Invalid(format!(
                        "cell {} refers to node {node}, counted from 0; the mesh has {} nodes",
                        index + 1,
                        points.len()
                    ))
                })?;
                if *place == usize::MAX {
                    let position = points[node];
                    if position.iter().any(|v| !v.is_finite()) {
                        return Err(MeshError::not_finite(node + 1, position));
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
    use crate::hexahedra::hex_mesh::TensorGrid;

    fn bricks() -> HexMesh {
        TensorGrid {
            x: vec![0.0, 1.0, 3.0],
            y: vec![0.0, 1.0],
            z: vec![0.0, 0.5, 1.0],
        }
        .hex_mesh()
    }

    #[test]
    fn bricks_have_unit_scaled_jacobian_their_aspect_and_volume() {
        let quality = bricks().quality();
        assert_eq!((quality.cells, quality.inverted), (4, 0));
        assert!(
            (quality.min_scaled_jacobian - 1.0).abs() < 1e-15
                && (quality.mean_scaled_jacobian - 1.0).abs() < 1e-15
        );
        assert!((quality.max_aspect - 4.0).abs() < 1e-15 && (quality.volume - 3.0).abs() < 1e-14);
        assert!((quality.min_volume - 0.5).abs() < 1e-15);
    }

    #[test]
    fn volume_of_a_twisted_cell_equals_gauss_quadrature() {
        let mut mesh = TensorGrid {
            x: vec![0.0, 1.0],
            y: vec![0.0, 1.0],
            z: vec![0.0, 1.0],
        }
        .hex_mesh();
        for (i, p) in mesh.points.iter_mut().enumerate() {
            (0..3).for_each(|k| p[k] += 0.15 * ((7 * i + 3 * k) as f64).sin());
        }
        let cell = mesh.cells[0];
        let corner = |k: usize| {
            [
                [0, 0, 0],
                [1, 0, 0],
                [1, 1, 0],
                [0, 1, 0],
                [0, 0, 1],
                [1, 0, 1],
                [1, 1, 1],
                [0, 1, 1],
            ][k]
        };
        let mut volume = 0.0;
        let g = 0.6f64.sqrt();
        let rule = [(-g, 5.0 / 9.0), (0.0, 8.0 / 9.0), (g, 5.0 / 9.0)];
        for (r, wr) in rule {
            for (s, ws) in rule {
                for (t, wt) in rule {
                    let at = [r, s, t].map(|v| 0.5 * (1.0 + v));
                    let mut columns = [[0.0; 3]; 3];
                    for (k, node) in cell.iter().enumerate() {
                        let factor = |e: usize| {
                            if corner(k)[e] == 1 {
                                at[e]
                            } else {
                                1.0 - at[e]
                            }
                        };
                        let sign = |e: usize| if corner(k)[e] == 1 { 1.0 } else { -1.0 };
                        for (d, column) in columns.iter_mut().enumerate() {
                            let weight = sign(d) * factor((d + 1) % 3) * factor((d + 2) % 3);
                            (0..3).for_each(|c| column[c] += weight * mesh.points[*node][c]);
                        }
                    }
                    let [a, b, c] = columns.map(Vector3::from);
                    volume += wr * ws * wt / 8.0 * a.dot(&b.cross(&c));
                }
            }
        }
        assert!((mesh.cell_volume(&cell) - volume).abs() < 1e-14, "{volume}");
    }

    #[test]
    fn inverted_cells_are_counted_and_those_checked_turned() {
        let mut mesh = bricks();
        mesh.cells[1].rotate_left(4);
        let quality = mesh.quality();
        assert_eq!(quality.inverted, 1);
        assert!((quality.min_scaled_jacobian + 1.0).abs() < 1e-15);
        mesh.points.push([9.0; 3]);
        let turned = HexMesh::checked(&mesh.points, &mesh.cells).unwrap();
        assert_eq!((turned.quality().inverted, turned.points.len()), (0, 18));
    }

    #[test]
    fn cells_without_points_are_refused() {
        let refused = |points: &[[f64; 3]], cells: &[[usize; 8]]| {
            HexMesh::checked(points, cells).unwrap_err().to_string()
        };
        assert!(refused(&[[0.0; 3]], &[]).contains("no hexahedra"));
        assert!(refused(&[[0.0; 3]], &[[0, 0, 0, 0, 0, 0, 0, 7]]).contains("node 7"));
        assert!(refused(&[[f64::NAN; 3]], &[[0; 8]]).contains("NaN"));
    }
}
