//! Meshes for the verification of the finite elements.

use kufe_mesh::{HexMesh, TensorGrid};

/// A block of equal cells from the origin to `size` [m].
pub fn block(cells: [usize; 3], size: [f64; 3]) -> HexMesh {
    let axis = |a: usize| {
        (0..=cells[a])
            .map(|i| size[a] * i as f64 / cells[a] as f64)
            .collect()
    };
    let grid = TensorGrid {
        x: axis(0),
        y: axis(1),
        z: axis(2),
    };
    grid.hex_mesh()
}

/// Moves the nodes inside a block at random by up to `share` of a cell along x, y and z. Nodes on a
/// face stay in its plane.
pub fn shake(mesh: &mut HexMesh, cells: [usize; 3], size: [f64; 3], share: [f64; 3]) {
    let mut seed = 20_261_121u64;
    for point in &mut mesh.points {
        let at = *point;
        for a in 0..3 {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            let random = 2.0 * ((seed >> 33) as f64 / (1u64 << 31) as f64) - 1.0;
            if at[a] > 0.0 && at[a] < size[a] {
                point[a] += share[a] * random * size[a] / cells[a] as f64;
            }
        }
    }
}

/// Nodes of a mesh whose position satisfies a condition, ascending.
pub fn nodes_where(mesh: &HexMesh, condition: impl Fn([f64; 3]) -> bool) -> Vec<usize> {
    (0..mesh.points.len())
        .filter(|&node| condition(mesh.points[node]))
        .collect()
}

/// Boundary faces whose four nodes satisfy a condition, counter-clockwise seen from outside.
pub fn faces_where(mesh: &HexMesh, condition: impl Fn([f64; 3]) -> bool) -> Vec<[usize; 4]> {
    let mut faces = kufe_fem::boundary_faces(mesh);
    faces.retain(|face| face.iter().all(|&node| condition(mesh.points[node])));
    faces
}

/// Slope of log(error) over log(h) by least squares.
pub fn fitted_slope(h: &[f64], error: &[f64]) -> f64 {
    let n = h.len() as f64;
    let x: Vec<f64> = h.iter().map(|h| h.ln()).collect();
    let y: Vec<f64> = error.iter().map(|e| e.ln()).collect();
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let covariance: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let variance: f64 = x.iter().map(|x| (x - mx) * (x - mx)).sum();
    covariance / variance
}
