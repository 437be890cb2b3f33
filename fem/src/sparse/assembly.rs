//! The stiffness matrix of a body.

use std::sync::Arc;

use rayon::prelude::*;

use crate::body::Body;
use crate::element::hex8::ElementMatrix;
use crate::sparse::block_matrix::BlockMatrix;
use crate::sparse::node_graph::NodeGraph;

/// Cells whose matrices are held at once: 4.6 kB each. A constant, so that sums never depend on the thread count.
const CELLS_A_CHUNK: usize = 2048;

/// Assembles the stiffness matrix of a body.
///
/// K = sum over cells of A_e^T K_e A_e. Element matrices are made in parallel, then added row by row in the order of
/// the cells, in parallel over rows: the same bits for any number of threads.
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

/// Assembles the stiffness matrix on a graph made before with [`NodeGraph::new`] from a mesh with the same cells.
///
/// For bodies that keep their cells while nodes move or materials change.
pub fn assemble_on(body: &Body, graph: Arc<NodeGraph>) -> BlockMatrix {
    let cells = &body.mesh().cells;
    assert_eq!(graph.node_count(), body.node_count());
    assert_eq!(graph.cells.places.len(), 8 * cells.len());
    let mut blocks = vec![[[0.0; 3]; 3]; graph.neighbours.len()];
    let mut matrices: Vec<ElementMatrix> = Vec::with_capacity(CELLS_A_CHUNK.min(cells.len()));
    let mut touched: Vec<usize> = Vec::new();
    for first in (0..cells.len()).step_by(CELLS_A_CHUNK) {
        let chunk = first..(first + CELLS_A_CHUNK).min(cells.len());
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
            for (cell, corner) in graph
                .cells
                .of(node)
                .filter(|(cell, _)| chunk.contains(cell))
            {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::Constraints;
    use crate::material::Material;
    use crate::section::{ElementKind, Section};
    use crate::test_block::block;

    fn mixed(n: usize) -> Body {
        let mesh = block([n, n + 1, n + 2], [1.0, 2.0, 0.5], 0.2);
        let sections = (0..mesh.cells.len())
            .map(|cell| Section {
                material: Material::new(1.0 + (cell % 5) as f64, 0.3).unwrap(),
                kind: [ElementKind::Hex8, ElementKind::Hex8Incompatible][cell % 2],
            })
            .collect();
        Body::new(mesh, sections).unwrap()
    }

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
        let mut held = Constraints::new(body.node_count());
        held.clamp([3, 7, 8]).unwrap();
        let map = held.dof_map();
        let whole = k.to_faer(&map).to_dense();
        let lower = k.lower_free(&map).to_dense();
        let diagonal = k.diagonal();
        for j in 0..map.free_count() {
            let mut e = vec![0.0; body.dofs()];
            e[map.free()[j] as usize] = 1.0;
            let mut y = vec![0.0; body.dofs()];
            k.apply(&e, &mut y);
            assert_eq!(whole[(j, j)], diagonal[map.free()[j] as usize]);
            for i in 0..map.free_count() {
                let expected = y[map.free()[i] as usize];
                // Both triangles are summed in the same order, so symmetry is exact up to the products' rounding.
                assert!((whole[(i, j)] - expected).abs() < 1e-15);
                assert_eq!(lower[(i, j)], if i >= j { whole[(i, j)] } else { 0.0 });
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
        assert!(body.mesh().cells.len() > CELLS_A_CHUNK);
        assert!(with(1) == with(3));
    }
}
