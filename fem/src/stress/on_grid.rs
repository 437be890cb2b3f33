//! Stresses at the nodes of a tensor grid, from differences along its axes.

use kufe_mesh::TensorGrid;
use rayon::prelude::*;

use crate::material::Material;

/// Stresses [Pa] at the nodes of a tensor grid of plain trilinear hexahedra, for displacements [m] in [`TensorGrid::node`] order.
///
/// What [`nodal_stresses`](crate::nodal_stresses) gives for [`ElementKind::Hex8`](crate::ElementKind::Hex8) on the grid's mesh: in a corner of such
/// a cell the derivative along an axis is what the two ends of the edge there differ by, over its length, so that the mean over a
/// node's cells is the mean of the edges on its two sides. `below` is another material, with the number of layers of cells from
/// below that it fills; where the two meet the stress is the mean of both sides.
///
/// # Panics
/// Where there is not one displacement a node.
pub fn grid_stresses(
    grid: &TensorGrid,
    material: Material,
    below: Option<(usize, Material)>,
    displacement: &[[f64; 3]],
) -> Vec<[f64; 6]> {
    assert_eq!(displacement.len(), grid.node_count());
    let [nx, ny, _] = grid.shape();
    let (x, y, z) = (slopes(&grid.x), slopes(&grid.y), slopes(&grid.z));
    let between = below.map_or(0, |(layers, _)| layers);
    let lower = below.map_or(material, |(_, lower)| lower);
    let along = |node: usize, stride: usize, [low, high]: [f64; 2]| -> [f64; 3] {
        let at = &displacement[node];
        let before = &displacement[node.saturating_sub(stride)];
        let after = displacement.get(node + stride).unwrap_or(at);
        std::array::from_fn(|c| low * (at[c] - before[c]) + high * (after[c] - at[c]))
    };
    let mut stresses = vec![[0.0; 6]; grid.node_count()];
    stresses
        .par_chunks_mut(nx)
        .enumerate()
        .for_each(|(row, stresses)| {
            let (j, k) = (row % ny, row / ny);
            let meet = below.is_some() && k == between;
            for (i, stress) in stresses.iter_mut().enumerate() {
                let node = row * nx + i;
                let (dx, dy) = (along(node, 1, x[i]), along(node, nx, y[j]));
                let of = |material: Material, sides: [f64; 2]| {
                    let dz = along(node, nx * ny, sides);
                    let [yz, zx, xy] = [dz[1] + dy[2], dz[0] + dx[2], dy[0] + dx[1]];
                    material.stress([dx[0], dy[1], dz[2], yz, zx, xy])
                };
                *stress = match meet {
                    false if k < between => of(lower, z[k]),
                    false => of(material, z[k]),
                    true => {
                        let [under, over] = z[k];
                        let under = of(lower, [2.0 * under, 0.0]);
                        let over = of(material, [0.0, 2.0 * over]);
                        std::array::from_fn(|c| 0.5 * (under[c] + over[c]))
                    }
                };
            }
        });
    stresses
}

/// At each node the weights of the differences to the node before and to the one after [1/m]: their mean, one alone at the ends.
fn slopes(nodes: &[f64]) -> Vec<[f64; 2]> {
    let last = nodes.len() - 1;
    (0..nodes.len())
        .map(|k| {
            let share = if k == 0 || k == last { 1.0 } else { 0.5 };
            let before = (k > 0).then(|| share / (nodes[k] - nodes[k - 1]));
            let after = (k < last).then(|| share / (nodes[k + 1] - nodes[k]));
            [before, after].map(|weight| weight.unwrap_or(0.0))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Body;
    use crate::section::{ElementKind, Section};
    use crate::stress::field::nodal_stresses;

    #[test]
    fn a_grid_has_the_stresses_of_its_mesh_in_one_material_and_in_two() {
        let grid = TensorGrid {
            x: vec![-0.3, -0.1, 0.0, 0.25],
            y: vec![0.0, 1e-3, 3e-3],
            z: vec![-0.05, -0.02, -0.01, -0.004, 0.0],
        };
        let [ice, bed] = [[9.0e9, 0.33], [3.0e10, 0.2]]
            .map(|[modulus, poisson]| Material::new(modulus, poisson).unwrap());
        let u: Vec<[f64; 3]> = (0..grid.node_count())
            .map(|k| [1.7, 2.3, 0.9].map(|w| 1e-6 * (w * k as f64 + (k * k) as f64).sin()))
            .collect();
        let flat: Vec<f64> = u.iter().flatten().copied().collect();
        for layers in [0, 1, 2] {
            let mesh = grid.hex_mesh();
            let sections = (0..mesh.cells.len())
                .map(|cell| Section {
                    material: if cell < layers * 6 { bed } else { ice },
                    kind: ElementKind::Hex8,
                })
                .collect();
            let expected = nodal_stresses(&Body::new(mesh, sections).unwrap(), &flat);
            let below = (layers > 0).then_some((layers, bed));
            let found = grid_stresses(&grid, ice, below, &u);
            let largest = expected
                .as_flattened()
                .iter()
                .fold(0.0f64, |m, s| m.max(s.abs()));
            for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((a - b).abs() < 1e-12 * largest, "{a} {b}");
            }
        }
    }
}
