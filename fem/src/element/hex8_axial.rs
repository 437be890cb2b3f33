//! The eight-node hexahedron for beams along its first axis: shear strains averaged along it.
//!
//! In bending, a long thin trilinear cell has a parasitic shear strain that is linear along it.
//! Here, over the two Gauss points xi = -1/sqrt(3), 1/sqrt(3) of each line along the first natural
//! axis, means weighted by det J replace
//!
//! ```text
//! gamma_xy, gamma_zx,   and in  eps_xx = d u_x / d xi  d xi / d x + [d u_x / d eta  d eta / d x + d u_x / d zeta  d zeta / d x]
//! ```
//!
//! the bracket, which is not zero if the cell's sides are inclined along x. Everything else is as
//! in the plain element. Means weighted by det J preserve the forces of a constant stress (the
//! argument of B-bar: T. J. R. Hughes, Int. J. Numer. Meth. Engng 15 (1980), 1413-1418). The strain
//! of linear displacements is exact if the corners lie in planes across x, so that the patch test
//! is passed on columns of any height. Runners are meshed that way; for other meshes use
//! [`crate::element::hex8_incompatible`]. In planes across x the element is the plain one.
//!
//! On a tensor grid the blocks of the stiffness are still sums of Kronecker products, with the mass
//! matrix of x averaged in component x ([`crate::Axis::averaged`]), so that fast diagonalisation is
//! an effective preconditioner for any aspect ratio of the cells. Incompatible modes soften all
//! planes at once, which no such sum represents.

use crate::body::Material;
use crate::element::hex8::{self, Corners, ElementMatrix, GAUSS, gauss_points};

/// Rows of zx and xy in a strain.
const SHEARS: [usize; 2] = [4, 5];
/// Gauss points that share a line along the first natural axis.
pub(crate) const LINES: [[usize; 2]; 4] = [[0, 1], [3, 2], [4, 5], [7, 6]];

/// B (6 x 24) of the plain element, apart from the bracket of eps_xx, and that bracket by corner;
/// with det J.
type Split = ([[f64; 24]; 6], [f64; 8], f64);

fn split(corners: &Corners, xi: [f64; 3]) -> Split {
    let mut b = hex8::strain_displacement(corners, xi);
    let jacobian = hex8::Jacobian::at(corners, xi);
    let mut bracket = [0.0; 8];
    for (a, corner) in hex8::CORNERS.iter().enumerate() {
        // d N_a / d xi at xi, times d xi / d x.
        let along = corner[0] * (1.0 + corner[1] * xi[1]) * (1.0 + corner[2] * xi[2]) / 8.0
            * jacobian.inverse[0][0];
        bracket[a] = b[0][3 * a] - along;
        b[0][3 * a] = along;
    }
    (b, bracket, jacobian.determinant)
}

/// Averages B over two points of a line, in the form of [`split`].
fn averaged(ends: &mut [Split; 2]) {
    let weight = ends[0].2 / (ends[0].2 + ends[1].2);
    let mean = |p: f64, q: f64| weight * p + (1.0 - weight) * q;
    let [first, second] = ends;
    for row in SHEARS {
        for column in 0..24 {
            let value = mean(first.0[row][column], second.0[row][column]);
            first.0[row][column] = value;
            second.0[row][column] = value;
        }
    }
    for a in 0..8 {
        let value = mean(first.1[a], second.1[a]);
        first.0[0][3 * a] += value;
        second.0[0][3 * a] += value;
    }
}

/// Stiffness (24 x 24), symmetric [N/m].
///
/// Every Jacobian determinant must be positive ([`hex8::smallest_determinant`]); [`crate::Body`]
/// checks it.
pub fn stiffness(corners: &Corners, material: Material) -> ElementMatrix {
    let points = gauss_points();
    let mut k = [[0.0; 24]; 24];
    for line in LINES {
        let mut ends = line.map(|g| split(corners, points[g]));
        averaged(&mut ends);
        for (b, _, determinant) in &ends {
            hex8::add_density(&mut k, b, *determinant, material);
        }
    }
    hex8::mirrored(k)
}

/// Strain (xx, yy, zz, yz, zx, xy) at natural coordinates `xi` for corner displacements `u` [m].
pub(crate) fn strain(corners: &Corners, u: &[f64; 24], xi: [f64; 3]) -> [f64; 6] {
    let of = |b: &[[f64; 24]; 6]| -> [f64; 6] {
        b.map(|row| row.iter().zip(u).map(|(b, u)| b * u).sum())
    };
    let mut ends = [-GAUSS, GAUSS].map(|s| split(corners, [s, xi[1], xi[2]]));
    let brackets = ends.map(|e| (0..8).map(|a| e.1[a] * u[3 * a]).sum::<f64>());
    let weight = ends[0].2 / (ends[0].2 + ends[1].2);
    let (here, _, _) = split(corners, xi);
    averaged(&mut ends);
    let mut strain = of(&here);
    strain[0] += weight * brackets[0] + (1.0 - weight) * brackets[1];
    let mean = of(&ends[0].0);
    for row in SHEARS {
        strain[row] = mean[row];
    }
    strain
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::hex8::tests::*;

    fn force(k: &ElementMatrix, u: &[f64; 24]) -> [f64; 24] {
        std::array::from_fn(|i| k[i].iter().zip(u).map(|(k, u)| k * u).sum())
    }

    /// Corners in planes across x, otherwise anywhere.
    fn in_planes(size: [f64; 3]) -> Corners {
        let mut corners = distorted(size);
        for (corner, p) in hex8::CORNERS.iter().zip(&mut corners) {
            p[0] = size[0] * corner[0];
        }
        corners
    }

    #[test]
    fn rigid_motions_are_free_and_linear_displacements_have_the_plain_elements_forces() {
        let corners = in_planes([1.0, 0.1, 3.0]);
        let material = Material::new(1.0, 0.3).unwrap();
        let k = stiffness(&corners, material);
        let size = k.iter().flatten().fold(0.0f64, |s, v| s.max(v.abs()));
        for mode in rigid_motions(&corners) {
            assert!(force(&k, &mode).iter().all(|f| f.abs() < 1e-13 * size));
        }
        let u: [f64; 24] = std::array::from_fn(|d| {
            let p = corners[d / 3];
            [0.3 * p[0] - p[1], 0.2 * p[2] + p[0], p[1] - 0.7 * p[2]][d % 3]
        });
        let plain = force(&hex8::stiffness(&corners, material), &u);
        for (a, b) in force(&k, &u).iter().zip(plain) {
            assert!((a - b).abs() < 1e-12 * size, "{a} {b}");
        }
    }

    /// Bending u_x = x z, u_z = -x^2/2 at nu = 0 has the energy E c^2 V / (2 * 3), however long the
    /// cell; and about z too.
    #[test]
    fn bending_along_the_first_axis_has_the_energy_of_beam_theory() {
        let material = Material::new(7.0, 0.0).unwrap();
        for a in [0.5, 4.0, 40.0] {
            let (b, c) = (0.25, 0.5);
            let corners = hex8::CORNERS.map(|p| [a * p[0], b * p[1], c * p[2]]);
            let k = stiffness(&corners, material);
            for (across, half) in [(1, b), (2, c)] {
                let u: [f64; 24] = std::array::from_fn(|d| {
                    let p = corners[d / 3];
                    let mut v = [p[0] * p[across], 0.0, 0.0];
                    v[across] = -p[0] * p[0] / 2.0;
                    v[d % 3]
                });
                let f = force(&k, &u);
                let energy = 0.5 * u.iter().zip(&f).map(|(u, f)| u * f).sum::<f64>();
                let beam = 0.5 * 7.0 * half * half / 3.0 * 8.0 * a * b * c;
                assert!((energy / beam - 1.0).abs() < 1e-6, "{a} {energy} {beam}");
            }
        }
    }

    /// Only the six rigid motions cost nothing.
    #[test]
    fn no_motion_but_a_rigid_one_is_free() {
        let corners = in_planes([1.0, 0.3, 0.5]);
        let k = stiffness(&corners, Material::new(1.0, 0.3).unwrap());
        let matrix = faer::Mat::from_fn(24, 24, |i, j| k[i][j]);
        let values = matrix.self_adjoint_eigenvalues(faer::Side::Lower).unwrap();
        let largest = values[23];
        assert!(
            values[5].abs() < 1e-12 * largest && values[6] > 1e-4 * largest,
            "{values:?}"
        );
    }
}
