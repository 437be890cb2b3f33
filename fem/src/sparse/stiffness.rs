//! The assembled stiffness in component order, for products and files.

use rayon::prelude::*;

use crate::body::Body;
use crate::error::Error;
use crate::sparse::assembly::{BlockMatrix, assemble_on};
use crate::sparse::graph::NodeGraph;

/// The stiffness of all displacements of a body [N/m], fixed ones included.
///
/// Vectors hold component after component, as those of [`crate::TensorOperator`]: component `c` of
/// node `n` has the index `c * node_count + n`. Rows are stored in blocks of 3 x 3; a product has
/// the same bits for any number of threads.
#[derive(Clone, Debug)]
pub struct SparseStiffness {
    matrix: BlockMatrix,
}

/// Nodes whose rows are applied by one task.
const NODES_PER_TASK: usize = 256;

/// Memory of a block of 3 x 3 with its node [bytes].
const BYTES_PER_BLOCK: u64 = 9 * 8 + 4;

/// Memory of a node in addition to its blocks [bytes]: its cells and the starts of rows.
const BYTES_PER_NODE: u64 = 8 * 8 + 2 * 8;

/// Memory of the matrix on this graph [bytes].
fn bytes(graph: &NodeGraph) -> u64 {
    BYTES_PER_BLOCK * graph.neighbours.len() as u64 + BYTES_PER_NODE * graph.node_count() as u64
}

impl SparseStiffness {
    /// Assembles the stiffness of a body, in parallel.
    ///
    /// Needs 80 bytes per node and 76 for each of its about 27 neighbours; this memory is computed
    /// first.
    ///
    /// # Errors
    /// [`Error::MatrixTooLarge`] if it would need more than `limit` bytes; nothing is then
    /// assembled.
    ///
    /// ```
    /// use kufe_fem::{Body, ElementKind, Material, SparseStiffness};
    /// use kufe_mesh::TensorGrid;
    /// let axis = vec![0.0, 1.0, 2.0];
    /// let grid = TensorGrid { x: axis.clone(), y: axis.clone(), z: axis };
    /// let body = Body::uniform(grid.hex_mesh(), Material::new(1.0, 0.3)?, ElementKind::Hex8)?;
    /// let stiffness = SparseStiffness::assemble(&body, 1 << 20)?;
    /// let mut force = vec![1.0; body.dofs()];
    /// stiffness.apply(&vec![1.0; body.dofs()], &mut force);
    /// assert!(force.iter().all(|f| f.abs() < 1e-14)); // a translation costs nothing
    /// # Ok::<(), kufe_fem::Error>(())
    /// ```
    pub fn assemble(body: &Body, limit: u64) -> Result<Self, Error> {
        // The graph alone takes a tenth of what the matrix does.
        let graph = NodeGraph::new(body.mesh());
        let needed = bytes(&graph);
        if needed > limit {
            return Err(Error::MatrixTooLarge {
                dofs: body.dofs(),
                needed,
                limit,
            });
        }
        let matrix = assemble_on(body, graph.into());
        Ok(Self { matrix })
    }

    /// Number of displacements.
    pub fn dofs(&self) -> usize {
        self.matrix.dofs()
    }

    /// Number of entries stored, both triangles.
    pub fn entries(&self) -> usize {
        9 * self.matrix.blocks.len()
    }

    /// Memory that the matrix holds [bytes].
    pub fn bytes(&self) -> u64 {
        bytes(&self.matrix.graph)
    }

    /// `y` = K `u`, by component.
    ///
    /// # Panics
    /// If a vector has another length.
    pub fn apply(&self, u: &[f64], y: &mut [f64]) {
        assert_eq!((u.len(), y.len()), (self.dofs(), self.dofs()));
        let nodes = self.dofs() / 3;
        let (x, rest) = y.split_at_mut(nodes);
        let (y, z) = rest.split_at_mut(nodes);
        let [x, y, z] = [x, y, z].map(|part| part.par_chunks_mut(NODES_PER_TASK));
        x.zip(y).zip(z).enumerate().for_each(|(task, ((x, y), z))| {
            for local in 0..x.len() {
                let row = self.matrix.row(task * NODES_PER_TASK + local);
                let sum = |c: usize| {
                    let along =
                        |i: usize| row.clone().map(move |(k, n)| u[i * nodes + n] * k[c][i]);
                    (0..3).flat_map(along).sum::<f64>()
                };
                [x[local], y[local], z[local]] = [sum(0), sum(1), sum(2)];
            }
        });
    }

    /// The entries of the lower triangle as (row, column, value [N/m]), column by column, rows
    /// ascending.
    pub fn lower(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let nodes = self.dofs() / 3;
        (0..self.dofs()).flat_map(move |column| {
            let (c, node) = (column / nodes, column % nodes);
            // The matrix is symmetric, so a column's rows are read from the block row of its node.
            let along = move |i: usize| {
                self.matrix
                    .row(node)
                    .map(move |(k, n)| (i * nodes + n, k[c][i]))
            };
            let entries = (0..3).flat_map(along);
            entries
                .filter(move |(row, _)| *row >= column)
                .map(move |(row, value)| (row, column, value))
        })
    }
}

impl PartialEq for SparseStiffness {
    fn eq(&self, other: &Self) -> bool {
        self.dofs() == other.dofs() && self.lower().eq(other.lower())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::tests::mixed;
    use crate::constraints::{to_components, to_nodes};
    use crate::sparse::assembly::assemble;

    #[test]
    fn product_is_that_of_the_blocks_over_several_tasks_and_for_any_number_of_threads() {
        let body = mixed(14);
        let n = body.dofs();
        assert!(n > 6 * NODES_PER_TASK);
        let u: Vec<f64> = (0..n).map(|i| (0.37 * i as f64).sin()).collect();
        let (mut by_node, mut expected) = (vec![0.0; n], vec![0.0; n]);
        to_nodes(&u, &mut by_node);
        let mut image = vec![0.0; n];
        assemble(&body).apply(&by_node, &mut image);
        to_components(&image, &mut expected);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let mut found = vec![f64::NAN; n];
            pool.build().unwrap().install(|| {
                let stiffness = SparseStiffness::assemble(&body, u64::MAX).unwrap();
                stiffness.apply(&u, &mut found);
            });
            found
        };
        let found = with(1);
        let size = expected.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-13 * size);
        }
        assert_eq!(found, with(3));
    }

    #[test]
    fn lower_triangle_with_its_mirror_is_the_matrix() {
        let body = mixed(2);
        let stiffness = SparseStiffness::assemble(&body, u64::MAX).unwrap();
        let n = stiffness.dofs();
        let u: Vec<f64> = (0..n).map(|i| (0.7 * i as f64).cos()).collect();
        let (mut expected, mut found) = (vec![0.0; n], vec![0.0; n]);
        stiffness.apply(&u, &mut expected);
        let mut stored = 0;
        for (row, column, value) in stiffness.lower() {
            found[row] += value * u[column];
            if row > column {
                found[column] += value * u[row];
                stored += 1;
            }
            stored += 1;
        }
        assert_eq!(stored, stiffness.entries());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        }
    }

    #[test]
    fn a_matrix_beyond_the_limit_is_refused_with_its_bytes() {
        let body = mixed(3);
        let stiffness = SparseStiffness::assemble(&body, u64::MAX).unwrap();
        let all = stiffness.bytes();
        assert_eq!(SparseStiffness::assemble(&body, all), Ok(stiffness));
        let error = SparseStiffness::assemble(&body, all - 1).unwrap_err();
        assert!(
            matches!(error, Error::MatrixTooLarge { needed, .. } if needed == all),
            "{error}"
        );
    }
}
