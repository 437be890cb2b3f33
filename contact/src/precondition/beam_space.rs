//! The motions of a beam in a body's preconditioner, where they meet the contact plane and the mount.

use faer::Mat;
use kufe_fem::{BeamModes, to_components, to_nodes};
use rayon::prelude::*;

/// Entries (motion, value) of a row of Z.
type Row = Vec<(usize, f64)>;

/// Z and C = Z^T K Z of a slender body on a tensor grid.
pub(crate) struct BeamSpace {
    modes: BeamModes,
    /// C^-1, dense.
    inverse: Mat<f64>,
    /// Nodes along x and y.
    shape: [usize; 2],
    /// Rows of the vertical displacements of the contact plane.
    contact: Vec<Row>,
    /// Length of a displacement vector.
    vector_len: usize,
}

impl BeamSpace {
    /// For a body of `shape` whose contact plane is the lowest.
    pub fn new(modes: BeamModes, shape: [usize; 3]) -> Self {
        let n = modes.len();
        let [nx, ny, nz] = shape;
        let columns: Vec<Vec<f64>> = (0..n)
            .into_par_iter()
            .map(|j| {
                let mut c = vec![0.0; n];
                c[j] = 1.0;
                modes.solve(&mut c);
                c
            })
            .collect();
        let contact = (0..nx * ny).map(|node| modes.row(node, 2)).collect();
        BeamSpace {
            inverse: Mat::from_fn(n, n, |i, j| 0.5 * (columns[j][i] + columns[i][j])),
            modes,
            shape: [nx, ny],
            contact,
            vector_len: 3 * nx * ny * nz,
        }
    }

    /// Number of motions.
    pub fn len(&self) -> usize {
        self.modes.len()
    }

    /// Length of a displacement vector.
    pub fn vector_len(&self) -> usize {
        self.vector_len
    }

    /// c = Z^T r for r by components, through a vector node by node and the sums of tasks.
    pub fn project(&self, r: &[f64], c: &mut [f64], by_node: &mut [f64], sums: &mut Vec<f64>) {
        to_nodes(r, by_node);
        self.modes.project_with(by_node, c, sums);
    }

    /// C^-1 c.
    pub fn answer(&self, c: &[f64]) -> Vec<f64> {
        let mut out = c.to_vec();
        self.modes.solve(&mut out);
        out
    }

    /// `u` += Z c for u by components, through a vector node by node.
    pub fn add_motion(&self, c: &[f64], u: &mut [f64], by_node: &mut [f64]) {
        to_nodes(u, by_node);
        self.modes.add_motion(c, by_node);
        to_components(by_node, u);
    }

    /// Z's row of a component of the node in column (i, j) on plane `plane`.
    pub fn row(&self, [i, j]: [usize; 2], plane: usize, component: usize) -> Row {
        let [nx, ny] = self.shape;
        self.modes.row((plane * ny + j) * nx + i, component)
    }

    /// Vertical displacement of a node of the contact plane.
    pub fn on_contact(&self, [i, j]: [usize; 2], c: &[f64]) -> f64 {
        self.contact[j * self.shape[0] + i]
            .iter()
            .map(|&(k, v)| v * c[k])
            .sum()
    }

    /// `c` -= Z^T of a vertical force on the contact plane.
    pub fn subtract_contact(&self, [i, j]: [usize; 2], force: f64, c: &mut [f64]) {
        for &(k, v) in &self.contact[j * self.shape[0] + i] {
            c[k] -= force * v;
        }
    }

    /// Z C^-1 Z^T between vertical displacements of the contact plane.
    pub fn contact_green(&self, nodes: &[[usize; 2]]) -> Mat<f64> {
        let rows = self.contact_rows(nodes);
        self.green(&rows, &rows)
    }

    /// Z's rows of nodes of the contact plane.
    pub fn contact_rows(&self, nodes: &[[usize; 2]]) -> Vec<&Row> {
        nodes
            .iter()
            .map(|[i, j]| &self.contact[j * self.shape[0] + i])
            .collect()
    }

    /// R C^-1 S^T for rows R and S of Z.
    pub fn green(&self, left: &[&Row], right: &[&Row]) -> Mat<f64> {
        let columns: Vec<Vec<f64>> = right
            .par_iter()
            .map(|row| {
                let mut answer = vec![0.0; self.len()];
                for &(k, value) in *row {
                    for (a, c) in answer.iter_mut().zip(self.inverse.col(k).iter()) {
                        *a += value * c;
                    }
                }
                left.iter()
                    .map(|row| row.iter().map(|&(k, v)| v * answer[k]).sum())
                    .collect()
            })
            .collect();
        Mat::from_fn(left.len(), right.len(), |i, j| columns[j][i])
    }
}
