//! Displacements of the mesh's outer faces, from the half-space outside.

use kufe_fem::{Material, boussinesq};
use kufe_mesh::TensorGrid;
use rayon::prelude::*;

use crate::precondition::planewise::Side;
use crate::symmetry::images;

/// A vertical force on the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointForce {
    /// Point of action (x, y) [m].
    pub at: [f64; 2],
    /// Force, downwards positive [N].
    pub force: f64,
}

/// Lumps along the longer side of the contact, or of the quarter or half of it that is solved for.
const LUMPS: f64 = 8.0;

/// Gathers nodal forces into lumps at their centres of force, mirrored where symmetry was used: 8
/// along the longer side, fewer along the shorter in proportion. The error of a lump is
/// proportional to the square of the ratio of its size to the distance.
pub(crate) fn lumps(x: &[f64], y: &[f64], force: &[f64], symmetry: [bool; 2]) -> Vec<PointForce> {
    let touched = |i: usize, j: usize| force[j * x.len() + i] > 0.0;
    let columns = (0..x.len()).filter(|&i| (0..y.len()).any(|j| touched(i, j)));
    let rows = (0..y.len()).filter(|&j| (0..x.len()).any(|i| touched(i, j)));
    let (columns, rows): (Vec<usize>, Vec<usize>) = (columns.collect(), rows.collect());
    let extent = |nodes: &[f64], touched: &[usize]| match touched {
        [first, .., last] => nodes[*last] - nodes[*first],
        _ => 0.0,
    };
    let extents = [extent(x, &columns), extent(y, &rows)];
    let chunk = |axis: usize, count: usize| {
        let share = extents[axis] / extents[0].max(extents[1]).max(f64::MIN_POSITIVE);
        count
            .div_ceil((LUMPS * share).ceil().max(1.0) as usize)
            .max(1)
    };
    let mut lumps = Vec::new();
    for is in columns.chunks(chunk(0, columns.len())) {
        for js in rows.chunks(chunk(1, rows.len())) {
            let mut sums = [0.0; 3];
            for &j in js {
                for &i in is {
                    let f = force[j * x.len() + i];
                    sums = [sums[0] + f, sums[1] + f * x[i], sums[2] + f * y[j]];
                }
            }
            if sums[0] == 0.0 {
                continue;
            }
            let (cx, cy) = (sums[1] / sums[0], sums[2] / sums[0]);
            lumps.extend(images(symmetry).map(|[sx, sy]| PointForce {
                at: [sx * cx, sy * cy],
                force: sums[0],
            }));
        }
    }
    lumps
}

/// Writes the half-space's displacements under `lumps` onto the outer faces of the grid.
///
/// Outer faces are the end of z away from the contact, and the ends of x and y that are not mirror
/// planes. `displacement` holds component after component. A half-space above the plane is the
/// mirror image of one below.
pub(crate) fn prescribe(
    grid: &TensorGrid,
    symmetry: [bool; 2],
    material: Material,
    lumps: &[PointForce],
    side: Side,
    displacement: &mut [f64],
) {
    let [nx, ny, nz] = grid.shape();
    let nodes = grid.node_count();
    let (far, mirror) = match side {
        Side::Below => (0, 1.0),
        Side::Above => (nz - 1, -1.0),
    };
    let outer = |i: usize, j: usize, k: usize| {
        k == far
            || i == nx - 1
            || j == ny - 1
            || (i == 0 && !symmetry[0])
            || (j == 0 && !symmetry[1])
    };
    let all = (0..nodes).map(|n| [n % nx, n / nx % ny, n / nx / ny]);
    let faces: Vec<[usize; 3]> = all.filter(|&[i, j, k]| outer(i, j, k)).collect();
    let values: Vec<[f64; 3]> = faces
        .par_iter()
        .map(|&[i, j, k]| {
            let mut sum = [0.0; 3];
            for lump in lumps {
                let point = [
                    grid.x[i] - lump.at[0],
                    grid.y[j] - lump.at[1],
                    mirror * grid.z[k],
                ];
                let u = boussinesq(point, lump.force, material);
                sum = [sum[0] + u[0], sum[1] + u[1], sum[2] + u[2]];
            }
            [sum[0], sum[1], mirror * sum[2]]
        })
        .collect();
    for (&[i, j, k], value) in faces.iter().zip(&values) {
        let node = grid.node(i, j, k);
        for c in 0..3 {
            // On a mirror plane the normal displacement stays 0.
            let mirrored = c < 2 && symmetry[c] && [i, j][c] == 0;
            displacement[c * nodes + node] = if mirrored { 0.0 } else { value[c] };
        }
    }
}
