//! What a mount holds of a meshed runner's top, and what loads it there.

use kufe_mesh::TensorGrid;

use crate::problem::mount::{LoadedPlace, spread_along};
use crate::{Load, Mount, Problem};

/// The nodes (i, j) of the top that the mount holds, by component; mirror planes hold theirs already.
///
/// A runner that nothing holds gets three points without reaction, which fix its six rigid motions.
pub(crate) fn held_nodes(
    mount: &Mount,
    grid: &TensorGrid,
    symmetry: [bool; 2],
) -> [Vec<[usize; 2]>; 3] {
    let [nx, ny, _] = grid.shape();
    let free = |c: usize, [i, j]: [usize; 2]| {
        !(c == 0 && symmetry[0] && i == 0 || c == 1 && symmetry[1] && j == 0)
    };
    let Mount::Loads(_) = mount else {
        let places: Vec<[usize; 2]> = (0..ny)
            .flat_map(|j| (0..nx).map(move |i| [i, j]))
            .filter(|&[i, _]| mount.over(grid.x[i]))
            .collect();
        return [0, 1, 2].map(|c| places.iter().copied().filter(|&n| free(c, n)).collect());
    };
    let centre = |n: usize, symmetric: bool| if symmetric { 0 } else { n / 2 };
    let (i, j) = (centre(nx, symmetry[0]), centre(ny, symmetry[1]));
    let mut held = [Vec::new(), Vec::new(), vec![[i, j]]];
    if !symmetry[0] {
        held[0].push([i, j]);
        held[2].push([nx - 1, j]);
    }
    if !symmetry[1] {
        held[1].push([i, j]);
        held[2].push([i, ny - 1]);
    }
    if !symmetry[0] && !symmetry[1] {
        held[1].push([nx - 1, j]);
    }
    held
}

/// The nodal forces of the loads on the top, by components [N].
pub(crate) fn load_of(
    problem: &Problem,
    loads: &[LoadedPlace],
    grid: &TensorGrid,
    symmetry: [bool; 2],
) -> Vec<f64> {
    let [nx, ny, nz] = grid.shape();
    let mut forces = vec![0.0; 3 * nx * ny * nz];
    let Load::Force { fz, offset_y, .. } = problem.load else {
        return forces;
    };
    // Between the two rows of nodes beside the line of action; half of it on a mirror plane.
    let row = grid.y.partition_point(|&y| y <= offset_y).clamp(1, ny - 1) - 1;
    let part = ((offset_y - grid.y[row]) / (grid.y[row + 1] - grid.y[row])).clamp(0.0, 1.0);
    let half = if symmetry[1] { 0.5 } else { 1.0 };
    let top = (2 * nz + nz - 1) * nx * ny;
    for load in loads {
        for (i, along) in spread_along(&grid.x, &load.place).iter().enumerate() {
            let force = -fz * load.share * along * half;
            forces[top + row * nx + i] += force * (1.0 - part);
            forces[top + (row + 1) * nx + i] += force * part;
        }
    }
    forces
}
