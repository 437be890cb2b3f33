//! The assembled stiffness in blocks of three by three.

use std::io::{self, Write};
use std::sync::Arc;

use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use rayon::prelude::*;

use crate::body::Body;
use crate::constraints::DofMap;
use crate::element::hex8::ElementMatrix;
use crate::sparse::graph::NodeGraph;
use crate::sparse::stiffness::SparseStiffness;

/// A symmetric sparse matrix of 3 x 3 blocks over the nodes of a mesh.
///
/// Takes two kilobytes per node of a hexahedral mesh. Both triangles are stored, so that rows can
/// be applied in parallel with the same bits for any number of threads.
#[derive(Clone, Debug)]
pub struct BlockMatrix {
    /// The sparsity pattern of the blocks.
    pub graph: Arc<NodeGraph>,
    /// The blocks by rows, as `graph.neighbours`; each 3 x 3 by rows.
    pub blocks: Vec<[[f64; 3]; 3]>,
}

/// Nodes whose rows are applied by one task.
const ROWS_PER_TASK: usize = 256;

impl BlockMatrix {
    /// Number of rows, three per node.
    pub fn dofs(&self) -> usize {
        3 * self.graph.node_count()
    }

    /// The blocks of a node's row with their nodes, ascending.
    pub(crate) fn row(&self, node: usize) -> impl Iterator<Item = (&[[f64; 3]; 3], usize)> + Clone {
        let range = self.graph.row_start[node]..self.graph.row_start[node + 1];
        let neighbours = self.graph.neighbours[range.clone()].iter();
        let blocks = self.blocks[range].iter();
        blocks.zip(neighbours.map(|&other| other as usize))
    }

    /// `y` = K `u`; both hold [`BlockMatrix::dofs`] numbers.
    ///
    /// # Panics
    /// If a vector has another length.
    pub fn apply(&self, u: &[f64], y: &mut [f64]) {
        assert_eq!((u.len(), y.len()), (self.dofs(), self.dofs()));
        y.par_chunks_mut(3 * ROWS_PER_TASK)
            .enumerate()
            .for_each(|(task, y)| {
                for (local, y) in y.chunks_exact_mut(3).enumerate() {
                    let mut sum = [0.0; 3];
                    for (block, other) in self.row(task * ROWS_PER_TASK + local) {
                        let v = &u[3 * other..3 * other + 3];
                        for i in 0..3 {
                            sum[i] += block[i][0] * v[0] + block[i][1] * v[1] + block[i][2] * v[2];
                        }
                    }
                    y.copy_from_slice(&sum);
                }
            });
    }

    /// The diagonal, [`BlockMatrix::dofs`] numbers.
    pub fn diagonal(&self) -> Vec<f64> {
        let own = |node: usize| {
            let mut own = self.row(node).filter(move |(_, other)| *other == node);
            let (block, _) = own.next().expect("a node is its own neighbour");
            [0, 1, 2].map(|i| block[i][i])
        };
        (0..self.graph.node_count()).flat_map(own).collect()
    }

    /// The lower triangle over the free displacements of `map` as a faer matrix, diagonal included.
    ///
    /// Square, [`DofMap::free_count`] rows, columns and rows ascending: the input of a Cholesky
    /// factorisation.
    pub fn lower_free(&self, map: &DofMap) -> SparseColMat<u32, f64> {
        let n = map.free_count();
        // The matrix is symmetric, so a column's rows are read from the block row of its node.
        let entries = |column: usize| {
            let dof = map.free()[column] as usize;
            let (node, c) = (dof / 3, dof % 3);
            self.row(node).flat_map(move |(block, other)| {
                (0..3).filter_map(move |i| {
                    let row = map.index(3 * other + i)?;
                    (row >= column).then_some((row as u32, block[c][i]))
                })
            })
        };
        let counts: Vec<u32> = (0..n)
            .into_par_iter()
            .map(|j| entries(j).count() as u32)
            .collect();
        let mut column_start = vec![0u32; n + 1];
        for j in 0..n {
            let end = column_start[j].checked_add(counts[j]);
            column_start[j + 1] = end.expect("fewer than 2^32 entries");
        }
        let (rows, values) = (0..n).flat_map(entries).unzip();
        SparseColMat::new(
            SymbolicSparseColMat::new_checked(n, n, column_start, None, rows),
            values,
        )
    }
}

/// Number of cells whose matrices are in memory at once: 4.6 kB each. A constant, so that sums do
/// not depend on the number of threads.
const CELLS_PER_CHUNK: usize = 2048;

/// Assembles the stiffness matrix of a body.
///
/// K = sum over cells of A_e^T K_e A_e. Element matrices are computed in parallel, then added row
/// by row in the order of the cells, in parallel over rows: the same bits for any number of
/// threads.
///
/// ```
/// use kufe_fem::{Body, ElementKind, Material, assemble};
/// use kufe_mesh::TensorGrid;
/// let grid = TensorGrid { x: vec![0.0, 1.0, 2.0], y: vec![0.0, 1.0], z: vec![0.0, 1.0] };
/// let body = Body::uniform(grid.hex_mesh(), Material::new(1.0, 0.3)?, ElementKind::Hex8)?;
/// let stiffness = assemble(&body);
/// let mut force = vec![1.0; body.dofs()];
/// stiffness.apply(&vec![1.0; body.dofs()], &mut force);
/// assert!(force.iter().all(|f| f.abs() < 1e-15)); // a translation costs nothing
/// # Ok::<(), kufe_fem::Error>(())
/// ```
pub fn assemble(body: &Body) -> BlockMatrix {
    assemble_on(body, Arc::new(NodeGraph::new(body.mesh())))
}

/// Assembles the stiffness matrix on an existing graph from [`NodeGraph::new`] for a mesh with the
/// same cells.
///
/// For bodies whose nodes move or materials change while the cells stay the same.
pub fn assemble_on(body: &Body, graph: Arc<NodeGraph>) -> BlockMatrix {
    let cells = &body.mesh().cells;
    assert_eq!(graph.node_count(), body.node_count());
    assert_eq!(graph.cells.places.len(), 8 * cells.len());
    let mut blocks = vec![[[0.0; 3]; 3]; graph.neighbours.len()];
    let mut matrices: Vec<ElementMatrix> = Vec::with_capacity(CELLS_PER_CHUNK.min(cells.len()));
    let mut touched: Vec<usize> = Vec::new();
    for first in (0..cells.len()).step_by(CELLS_PER_CHUNK) {
        let chunk = first..(first + CELLS_PER_CHUNK).min(cells.len());
        chunk
            .clone()
            .into_par_iter()
            .map(|cell| body.sections()[cell].stiffness(&body.corners(cell)))
            .collect_into_vec(&mut matrices);

        touched.clear();
        touched.extend(cells[chunk.clone()].iter().flatten());
        touched.sort_unstable();
        touched.dedup();
        let mut rows = Vec::with_capacity(touched.len());
        let (mut rest, mut passed) = (&mut blocks[..], 0);
        for &node in &touched {
            let (start, end) = (graph.row_start[node], graph.row_start[node + 1]);
            let (row, after) = rest[start - passed..].split_at_mut(end - start);
            rows.push((node, row));
            (rest, passed) = (after, end);
        }
        rows.into_par_iter().for_each(|(node, row)| {
            let neighbours = graph.row(node);
            let places = graph.cells.of(node);
            for (cell, corner) in places.filter(|(cell, _)| chunk.contains(cell)) {
                let matrix = &matrices[cell - chunk.start];
                for (b, &other) in cells[cell].iter().enumerate() {
                    let place = neighbours.binary_search(&(other as u32));
                    let block = &mut row[place.expect("nodes of one cell are neighbours")];
                    for i in 0..3 {
                        for j in 0..3 {
                            block[i][j] += matrix[3 * corner + i][3 * b + j];
                        }
                    }
                }
            }
        });
    }
    BlockMatrix { graph, blocks }
}

/// Writes the block-diagonal stiffness of several bodies in Matrix Market format.
///
/// `coordinate real symmetric`: the lower triangle, one-based (row, column, value [N/m]), column by
/// column; values have as many digits as are needed to read the same number. `comments` come first,
/// one per line. Source: R. F. Boisvert, R. Pozo and K. A. Remington, The Matrix Market exchange
/// formats, NISTIR 5935 (1996).
///
/// # Errors
/// Those of `out`.
///
/// ```
/// use kufe_fem::{Body, ElementKind, Material, SparseStiffness, write_matrix_market};
/// use kufe_mesh::TensorGrid;
/// let grid = TensorGrid { x: vec![0.0, 1.0], y: vec![0.0, 1.0], z: vec![0.0, 1.0] };
/// let body = Body::uniform(grid.hex_mesh(), Material::new(1.0, 0.3)?, ElementKind::Hex8)?;
/// let stiffness = SparseStiffness::assemble(&body, 1 << 20)?;
/// let mut text = Vec::new();
/// write_matrix_market(&[&stiffness], &["one cell".into()], &mut text)?;
/// let text = String::from_utf8(text)?;
/// assert!(text.starts_with("%%MatrixMarket matrix coordinate real symmetric\n% one cell\n24 24 300\n1 1 "));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_matrix_market(
    bodies: &[&SparseStiffness],
    comments: &[String],
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "%%MatrixMarket matrix coordinate real symmetric")?;
    for comment in comments {
        writeln!(out, "% {}", comment.replace(char::is_control, " "))?;
    }
    let dofs: usize = bodies.iter().map(|body| body.dofs()).sum();
    // Every row has a diagonal entry, and every other entry occurs twice.
    let entries: usize = bodies.iter().map(|body| body.entries()).sum();
    writeln!(out, "{dofs} {dofs} {}", (entries + dofs) / 2)?;
    let mut first = 1;
    for body in bodies {
        for (row, column, value) in body.lower() {
            writeln!(out, "{} {} {value:e}", first + row, first + column)?;
        }
        first += body.dofs();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::tests::mixed;
    use crate::constraints::Constraints;

    #[test]
    fn assembled_product_is_the_sum_over_elements() {
        let body = mixed(3);
        let u: Vec<f64> = (0..body.dofs()).map(|i| (i as f64 * 0.37).sin()).collect();
        let mut sum = vec![0.0; body.dofs()];
        for (cell, nodes) in body.mesh().cells.iter().enumerate() {
            let k = body.sections()[cell].stiffness(&body.corners(cell));
            let local = body.gather(cell, &u);
            for i in 0..24 {
                sum[3 * nodes[i / 3] + i % 3] += (0..24).map(|j| k[i][j] * local[j]).sum::<f64>();
            }
        }
        let mut y = vec![0.0; body.dofs()];
        assemble(&body).apply(&u, &mut y);
        let size = sum.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        for (a, b) in y.iter().zip(&sum) {
            assert!((a - b).abs() < 1e-13 * size);
        }
    }

    #[test]
    fn faer_form_agrees_with_the_blocks() {
        let body = mixed(2);
        let k = assemble(&body);
        let mut fixed = Constraints::new(body.node_count());
        fixed.clamp([3, 7, 8]).unwrap();
        let map = fixed.dof_map();
        let lower = k.lower_free(&map).to_dense();
        let diagonal = k.diagonal();
        for j in 0..map.free_count() {
            let mut e = vec![0.0; body.dofs()];
            e[map.free()[j] as usize] = 1.0;
            let mut y = vec![0.0; body.dofs()];
            k.apply(&e, &mut y);
            assert_eq!(lower[(j, j)], diagonal[map.free()[j] as usize]);
            for i in 0..map.free_count() {
                let expected = if i >= j {
                    y[map.free()[i] as usize]
                } else {
                    0.0
                };
                // Both triangles are summed in the same order, so symmetry is exact up to the
                // products' rounding.
                assert!((lower[(i, j)] - expected).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn assembly_gives_the_same_bits_for_one_and_three_threads() {
        let body = mixed(14);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                let k = assemble(&body);
                let u: Vec<f64> = (0..body.dofs()).map(|i| (i as f64 * 0.37).sin()).collect();
                let mut y = vec![0.0; body.dofs()];
                k.apply(&u, &mut y);
                (k.blocks, y)
            })
        };
        assert!(body.mesh().cells.len() > CELLS_PER_CHUNK);
        assert!(with(1) == with(3));
    }
}
