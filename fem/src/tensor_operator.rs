//! The stiffness of trilinear hexahedra on a tensor grid, applied without being stored.

use kufe_mesh::TensorGrid;
use rayon::prelude::*;

use crate::tensor_axis::Axis;
use crate::tensor_kernel::{Factors, Plane, Scratch};

/// Which components are held on which faces: `held[c][axis]` is (low face, high face).
pub type HeldFaces = [[[bool; 2]; 3]; 3];

/// Isotropic elasticity on a tensor grid of trilinear hexahedra.
///
/// With the 1-D matrices K, M, D of each axis ([`Axis`]) the block of test component c and trial
/// component d is a sum of Kronecker products:
///
/// * c = d: (lambda + 2 mu) K on axis c, M on the others, plus mu K on each other axis in turn;
/// * c != d: lambda D_c D_d^T + mu D_c^T D_d, M on the third axis.
///
/// Vectors hold component after component, each in [`TensorGrid::node`] order: `3 * node_count`
/// numbers. The integration is exact. Cost: about 90 multiplications and
/// additions a node.
#[derive(Clone, Debug)]
pub struct TensorOperator {
    /// x, y and z.
    pub axes: [Axis; 3],
    /// First Lame constant [Pa].
    pub lambda: f64,
    /// Shear modulus [Pa].
    pub mu: f64,
    /// Held faces; results are 0 there.
    pub held: HeldFaces,
    factors: Factors,
}

impl TensorOperator {
    /// The operator of a grid; `lambda` and `mu` are the Lame constants [Pa].
    pub fn new(grid: &TensorGrid, lambda: f64, mu: f64, held: HeldFaces) -> Self {
        let axes = [Axis::new(&grid.x), Axis::new(&grid.y), Axis::new(&grid.z)];
        let factors = Factors::new(&axes, lambda, mu);
        TensorOperator {
            axes,
            lambda,
            mu,
            held,
            factors,
        }
    }

    /// Nodes along each axis.
    pub fn shape(&self) -> [usize; 3] {
        [self.axes[0].len(), self.axes[1].len(), self.axes[2].len()]
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.shape().iter().product()
    }

    /// Number of unknowns that no held face takes away.
    pub fn free_dofs(&self) -> usize {
        let free = |c: usize, axis: usize| {
            let held = self.held[c][axis];
            self.axes[axis].len() - usize::from(held[0]) - usize::from(held[1])
        };
        (0..3).map(|c| free(c, 0) * free(c, 1) * free(c, 2)).sum()
    }

    /// Sets the held entries of a vector to 0.
    pub fn mask(&self, u: &mut [f64]) {
        let [nx, ny, nz] = self.shape();
        let nodes = nx * ny * nz;
        for (c, component) in u.chunks_exact_mut(nodes).enumerate() {
            component
                .par_chunks_mut(nx * ny)
                .enumerate()
                .for_each(|(k, plane)| {
                    mask_plane(plane, self.held[c], [nx, ny, nz], k);
                });
        }
    }

    /// `out` = K `u`, with 0 on held entries; the held entries of `u` count as prescribed values.
    ///
    /// # Panics
    /// Where a vector does not have `3 * node_count` numbers.
    pub fn apply(&self, u: &[f64], out: &mut [f64]) {
        let [nx, ny, nz] = self.shape();
        let plane = nx * ny;
        let nodes = plane * nz;
        assert_eq!(
            (u.len(), out.len()),
            (3 * nodes, 3 * nodes),
            "vectors of {nodes} nodes"
        );
        let (out_x, rest) = out.split_at_mut(nodes);
        let (out_y, out_z) = rest.split_at_mut(nodes);
        out_x
            .par_chunks_mut(plane)
            .zip(out_y.par_chunks_mut(plane))
            .zip(out_z.par_chunks_mut(plane))
            .enumerate()
            .for_each_init(
                || Scratch::new(nx),
                |scratch, (k, ((x, y), z))| {
                    pulp::Arch::new().dispatch(Plane {
                        factors: &self.factors,
                        u,
                        k,
                        scratch,
                        out: [&mut *x, &mut *y, &mut *z],
                    });
                    for (c, plane) in [x, y, z].into_iter().enumerate() {
                        mask_plane(plane, self.held[c], [nx, ny, nz], k);
                    }
                },
            );
    }
}

fn mask_plane(plane: &mut [f64], held: [[bool; 2]; 3], shape: [usize; 3], k: usize) {
    let [nx, ny, nz] = shape;
    if (held[2][0] && k == 0) || (held[2][1] && k == nz - 1) {
        plane.fill(0.0);
        return;
    }
    if held[1][0] {
        plane[..nx].fill(0.0);
    }
    if held[1][1] {
        plane[(ny - 1) * nx..].fill(0.0);
    }
    for row in plane.chunks_exact_mut(nx) {
        if held[0][0] {
            row[0] = 0.0;
        }
        if held[0][1] {
            row[nx - 1] = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, ElementKind, Material, assemble};

    /// The assembled stiffness of the same hexahedra, on graded grids whose rows are shorter and longer than a register.
    #[test]
    fn operator_is_the_assembled_stiffness() {
        for shape in [[2, 2, 2], [3, 5, 4], [9, 2, 3], [12, 6, 5], [19, 4, 3]] {
            let axis = |n: usize, growth: f64| -> Vec<f64> {
                (0..n).map(|i| 1e-2 * growth.powi(i as i32)).collect()
            };
            let grid = TensorGrid {
                x: axis(shape[0], 1.4),
                y: axis(shape[1], 1.3),
                z: axis(shape[2], 1.7),
            };
            let nodes = grid.node_count();
            let ice = Material::new(9e9, 0.33).unwrap();
            let body = Body::uniform(grid.hex_mesh(), ice, ElementKind::Hex8).unwrap();
            let free = [[[false; 2]; 3]; 3];
            let operator = TensorOperator::new(&grid, ice.lame_lambda(), ice.shear_modulus(), free);
            let u: Vec<f64> = (0..3 * nodes).map(|i| (1.3 * i as f64).sin()).collect();
            let (mut expected, mut found) = (vec![0.0; 3 * nodes], vec![f64::NAN; 3 * nodes]);
            assemble(&body).apply(&u, &mut expected);
            let by_component: Vec<f64> = (0..3 * nodes)
                .map(|i| u[3 * (i % nodes) + i / nodes])
                .collect();
            operator.apply(&by_component, &mut found);
            let size = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for (i, found) in found.iter().enumerate() {
                let expected = expected[3 * (i % nodes) + i / nodes];
                assert!(
                    (found - expected).abs() < 1e-13 * size,
                    "{shape:?}, {i}: {found} instead of {expected}"
                );
            }
        }
    }
}
