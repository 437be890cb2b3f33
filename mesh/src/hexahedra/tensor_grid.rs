//! Graded tensor grids.

use crate::hexahedra::hex_mesh::HexMesh;

/// Graded coordinates along the three axes, each strictly increasing [m].
#[derive(Clone, Debug, PartialEq)]
pub struct TensorGrid {
    /// Coordinates along x [m].
    pub x: Vec<f64>,
    /// Coordinates across, y [m].
    pub y: Vec<f64>,
    /// Coordinates upwards, z [m].
    pub z: Vec<f64>,
}

impl TensorGrid {
    /// Number of nodes along each axis.
    pub fn shape(&self) -> [usize; 3] {
        [self.x.len(), self.y.len(), self.z.len()]
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.x.len() * self.y.len() * self.z.len()
    }

    /// Index of node (`i`, `j`, `k`): x runs fastest, then y, then z.
    pub fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (k * self.y.len() + j) * self.x.len() + i
    }

    /// The grid as a mesh, nodes and cells with x fastest, cells in VTK's corner order.
    pub fn hex_mesh(&self) -> HexMesh {
        let [nx, ny, nz] = self.shape();
        let mut points = Vec::with_capacity(self.node_count());
        for &z in &self.z {
            for &y in &self.y {
                points.extend(self.x.iter().map(|&x| [x, y, z]));
            }
        }
        let mut cells = Vec::with_capacity((nx - 1) * (ny - 1) * (nz - 1));
        for k in 0..nz - 1 {
            for j in 0..ny - 1 {
                for i in 0..nx - 1 {
                    let low = |di, dj| self.node(i + di, j + dj, k);
                    let high = |di, dj| self.node(i + di, j + dj, k + 1);
                    cells.push([
                        low(0, 0),
                        low(1, 0),
                        low(1, 1),
                        low(0, 1),
                        high(0, 0),
                        high(1, 0),
                        high(1, 1),
                        high(0, 1),
                    ]);
                }
            }
        }
        HexMesh { points, cells }
    }
}
