//! Cells of each node, neighbouring nodes, and their nested dissection.

use kufe_mesh::HexMesh;
use rayon::prelude::*;

/// Cells and corners of every node, by rows, cells ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeCells {
    /// Start of each node's places; one entry more than there are nodes.
    pub start: Vec<usize>,
    /// Each node's places in cells, as 8 * cell + corner.
    pub places: Vec<u64>,
}

impl NodeCells {
    /// The cells of a mesh, which name existing nodes.
    pub fn new(mesh: &HexMesh) -> Self {
        let node_count = mesh.points.len();
        let mut start = vec![0usize; node_count + 1];
        for &node in mesh.cells.iter().flatten() {
            start[node + 1] += 1;
        }
        for i in 0..node_count {
            start[i + 1] += start[i];
        }
        let mut next = start.clone();
        let mut places = vec![0u64; 8 * mesh.cells.len()];
        for (cell, corners) in mesh.cells.iter().enumerate() {
            for (corner, &node) in corners.iter().enumerate() {
                places[next[node]] = (8 * cell + corner) as u64;
                next[node] += 1;
            }
        }
        Self { start, places }
    }

    /// The (cell, corner) pairs that contain a node, cells ascending.
    pub fn of(&self, node: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.places[self.start[node]..self.start[node + 1]]
            .iter()
            .map(|&place| ((place / 8) as usize, (place % 8) as usize))
    }
}

/// Neighbours and cells of every node, by rows, each row ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeGraph {
    /// Start of each node's neighbours; `node_count + 1` entries.
    pub row_start: Vec<usize>,
    /// Neighbouring nodes, the node itself included.
    pub neighbours: Vec<u32>,
    /// The cells of every node.
    pub cells: NodeCells,
}

impl NodeGraph {
    /// The graph of a mesh whose cells name existing nodes, fewer than 2^32.
    pub fn new(mesh: &HexMesh) -> Self {
        let node_count = mesh.points.len();
        let cells = NodeCells::new(mesh);
        // Boxed, without the capacity for the up to 64 corners from which a row is built.
        let rows: Vec<Box<[u32]>> = (0..node_count)
            .into_par_iter()
            .map(|node| {
                let around = cells.of(node).flat_map(|(cell, _)| &mesh.cells[cell]);
                let mut row: Vec<u32> = around.map(|&n| n as u32).collect();
                row.sort_unstable();
                row.dedup();
                row.into_boxed_slice()
            })
            .collect();
        let mut row_start = vec![0];
        for row in &rows {
            row_start.push(row_start[row_start.len() - 1] + row.len());
        }
        let neighbours = rows.concat();
        Self {
            row_start,
            neighbours,
            cells,
        }
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.row_start.len() - 1
    }

    /// Neighbours of a node, itself included, ascending.
    pub fn row(&self, node: usize) -> &[u32] {
        &self.neighbours[self.row_start[node]..self.row_start[node + 1]]
    }
}

/// Largest size of a set of nodes that is not divided further.
const LEAF: usize = 24;

/// An elimination order of nodes with little fill (nested dissection): first both halves, then the
/// separator between them, recursively.
///
/// Each set is divided at the median of one coordinate. The separator consists of the nodes of the
/// lower half with neighbours in the upper half. The coordinate with the smallest separator is
/// used, so that graded meshes are divided across the fewest cells, regardless of the cells'
/// lengths. On structured hexahedra the fill equals that of METIS.
///
/// `nodes` are the nodes to be ordered (ascending, without repetition); `points` [m] are the
/// positions of all nodes. Returns `nodes` in the order of elimination. Source: A. George, Nested
/// dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10 (1973), 345-363.
pub fn nested_dissection(graph: &NodeGraph, points: &[[f64; 3]], nodes: &[usize]) -> Vec<usize> {
    let mut order = nodes.to_vec();
    // Part of each node in the current cut: outside the set, below or above, or separator.
    let mut side = vec![OUTSIDE; graph.node_count()];
    dissect(graph, points, &mut order, &mut side);
    order
}

const OUTSIDE: u8 = 0;
const BELOW: u8 = 1;
const ABOVE: u8 = 2;
const SEPARATOR: u8 = 3;

fn dissect(graph: &NodeGraph, points: &[[f64; 3]], set: &mut [usize], side: &mut [u8]) {
    if set.len() <= LEAF {
        return;
    }
    let touches_above = |side: &[u8], node: usize| {
        let mut others = graph.row(node).iter();
        others.any(|&other| side[other as usize] == ABOVE)
    };
    let mut best: Option<(usize, f64, usize)> = None;
    for axis in 0..3 {
        let Some(cut) = median_cut(points, set, axis) else {
            continue;
        };
        mark(points, set, side, axis, cut);
        let cut_off = |&&n: &&usize| side[n] == BELOW && touches_above(side, n);
        let separator = set.iter().filter(cut_off).count();
        if best.is_none_or(|(_, _, smallest)| separator < smallest) {
            best = Some((axis, cut, separator));
        }
    }
    // All nodes of the set are at one point.
    let Some((axis, cut, _)) = best else {
        return;
    };
    mark(points, set, side, axis, cut);
    for &node in set.iter() {
        if side[node] == BELOW && touches_above(side, node) {
            side[node] = SEPARATOR;
        }
    }
    set.sort_by_key(|&node| side[node]);
    let below = set.partition_point(|&node| side[node] <= BELOW);
    let above = set.partition_point(|&node| side[node] <= ABOVE);
    for &node in set.iter() {
        side[node] = OUTSIDE;
    }
    dissect(graph, points, &mut set[..below], side);
    dissect(graph, points, &mut set[below..above], side);
}

/// The coordinate at or below which about half of the set lies; `None` if all coordinates are
/// equal.
fn median_cut(points: &[[f64; 3]], set: &[usize], axis: usize) -> Option<f64> {
    let mut values: Vec<f64> = set.iter().map(|&node| points[node][axis]).collect();
    let middle = (values.len() - 1) / 2;
    let (lower, &mut median, upper) = values.select_nth_unstable_by(middle, f64::total_cmp);
    if upper.iter().any(|&v| v > median) {
        return Some(median);
    }
    let below = lower.iter().copied().filter(|&v| v < median);
    below.max_by(f64::total_cmp)
}

fn mark(points: &[[f64; 3]], set: &[usize], side: &mut [u8], axis: usize, cut: f64) {
    for &node in set {
        let below = points[node][axis] <= cut;
        side[node] = if below { BELOW } else { ABOVE };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::tests::block;

    #[test]
    fn inner_nodes_of_a_block_have_27_neighbours_and_8_cells() {
        let graph = NodeGraph::new(&block([4, 3, 3], [1.0; 3], 0.0));
        let counts: Vec<usize> = (0..graph.node_count())
            .map(|n| graph.row(n).len())
            .collect();
        assert_eq!(counts.iter().filter(|&&c| c == 27).count(), 3 * 2 * 2);
        assert_eq!(counts.iter().filter(|&&c| c == 8).count(), 8);
        assert_eq!(
            counts.iter().sum::<usize>(),
            (3 * 5 - 2) * (3 * 4 - 2) * (3 * 4 - 2)
        );
        for node in 0..graph.node_count() {
            assert!(graph.row(node).windows(2).all(|w| w[0] < w[1]));
            for &other in graph.row(node) {
                assert!(graph.row(other as usize).contains(&(node as u32)));
            }
        }
    }

    #[test]
    fn order_is_a_permutation_whose_last_nodes_cut_the_mesh_in_two() {
        let mesh = block([12, 4, 4], [1.0, 5.0, 5.0], 0.0);
        let graph = NodeGraph::new(&mesh);
        let nodes: Vec<usize> = (0..mesh.points.len()).collect();
        let order = nested_dissection(&graph, &mesh.points, &nodes);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, nodes);
        // Longest in cells along x although shortest in metres: the separator is one plane of 25
        // nodes.
        let mut cut = vec![false; nodes.len()];
        for &node in &order[order.len() - 25..] {
            cut[node] = true;
        }
        let mut reached = vec![false; nodes.len()];
        let start = nodes.iter().copied().find(|&n| !cut[n]).unwrap();
        let mut stack = vec![start];
        reached[start] = true;
        while let Some(node) = stack.pop() {
            for &other in graph.row(node) {
                let other = other as usize;
                if !cut[other] && !reached[other] {
                    reached[other] = true;
                    stack.push(other);
                }
            }
        }
        let count = reached.iter().filter(|&&r| r).count();
        assert!(
            [150, 125, 175].contains(&count),
            "{count} of {}",
            nodes.len()
        );
    }

    #[test]
    fn coincident_points_end_the_recursion() {
        let mesh = block([3, 3, 3], [1.0; 3], 0.0);
        let graph = NodeGraph::new(&mesh);
        let nodes: Vec<usize> = (0..mesh.points.len()).collect();
        let order = nested_dissection(&graph, &vec![[0.0; 3]; nodes.len()], &nodes);
        assert_eq!(order, nodes);
    }
}
