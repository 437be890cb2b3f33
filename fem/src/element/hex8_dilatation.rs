//! The eight-node hexahedron with the mean dilatation of the cell (B-bar).
//!
//! A plain trilinear cell of a nearly incompressible material must conserve its volume at each of
//! its Gauss points, so that it can hardly deform: it locks. Here the dilatation is replaced by its
//! mean over the cell, weighted by det J,
//!
//! ```text
//! strain = e - tr(e) / 3 I + mean / 3 I,   mean = integral of tr(e) / volume,
//! ```
//!
//! in the strain and in the virtual strain. The deviator is that of the plain element, so that only
//! rigid motions have no energy. The strain of linear displacements is exact for any shape of cell.
//! On boxes the stiffness is a sum of Kronecker products
//! ([`crate::TensorOperator::with_mean_dilatation`]). Source: T. J. R. Hughes, Generalization of
//! selective integration procedures to anisotropic and nonlinear media, Int. J. Numer. Meth. Engng
//! 15 (1980), 1413-1418.

use crate::body::Material;
use crate::element::hex8::{self, Corners, ElementMatrix, gauss_points};

/// Poisson's ratio from which a block has this element.
///
/// Hertz's paraboloid (rocker 30 m, section 5 mm, 1 kN, 18,192 unknowns): error of the mesh's peak
/// relative to the closed form, and the estimated error, in per cent.
///
/// | ratio | plain | estimated | this | estimated |
/// |---|---|---|---|---|
/// | 0.33 | 0.49 | 0.48 | 0.27 | 0.62 |
/// | 0.40 | 0.69 | 0.59 | 0.26 | 0.79 |
/// | 0.42 | 0.81 | 0.64 | 0.25 | 0.85 |
/// | 0.44 | 1.03 | 0.96 | 0.24 | 0.91 |
/// | 0.45 | 1.21 | 1.44 | 0.22 | 0.94 |
///
/// From 0.44 on the plain element's estimated error, by which meshes are refined, is the larger
/// one. With a limit of half this lambda / mu (0.41) products would cost twice as much without a
/// gain; with twice (0.474) meshes would be refined unnecessarily.
pub const NEARLY_INCOMPRESSIBLE: f64 = 0.45;

/// Stiffness (24 x 24), symmetric [N/m].
///
/// Every Jacobian determinant must be positive ([`hex8::smallest_determinant`]); [`crate::Body`]
/// checks it.
pub fn stiffness(corners: &Corners, material: Material) -> ElementMatrix {
    let mean = mean_divergence(corners);
    let mut k = [[0.0; 24]; 24];
    for xi in gauss_points() {
        let mut b = hex8::strain_displacement(corners, xi);
        let determinant = hex8::Jacobian::at(corners, xi).determinant;
        for j in 0..24 {
            let third = (mean[j] - b[0][j] - b[1][j] - b[2][j]) / 3.0;
            (0..3).for_each(|row| b[row][j] += third);
        }
        hex8::add_density(&mut k, &b, determinant, material);
    }
    hex8::mirrored(k)
}

/// Strain (xx, yy, zz, yz, zx, xy) at natural coordinates `xi` for corner displacements `u` [m].
pub(crate) fn strain(corners: &Corners, u: &[f64; 24], xi: [f64; 3]) -> [f64; 6] {
    let times = |row: [f64; 24]| row.iter().zip(u).map(|(b, u)| b * u).sum::<f64>();
    let mut strain = hex8::strain_displacement(corners, xi).map(times);
    let mean = times(mean_divergence(corners));
    let third = (mean - strain[0] - strain[1] - strain[2]) / 3.0;
    (0..3).for_each(|row| strain[row] += third);
    strain
}

/// Coefficients of a cell's mean dilatation by its corners' displacements [1/m].
fn mean_divergence(corners: &Corners) -> [f64; 24] {
    let (mut mean, mut volume) = ([0.0; 24], 0.0);
    for xi in gauss_points() {
        let (gradients, determinant) = hex8::gradients(corners, xi);
        volume += determinant;
        for (mean, g) in mean.iter_mut().zip(gradients.as_flattened()) {
            *mean += determinant * g;
        }
    }
    mean.map(|sum| sum / volume)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::hex8::tests::*;

    fn energy(k: &ElementMatrix, u: &[f64; 24]) -> f64 {
        let force = |i: usize| k[i].iter().zip(u).map(|(k, u)| k * u).sum::<f64>();
        (0..24).map(|i| 0.5 * u[i] * force(i)).sum()
    }

    /// Only the six rigid motions cost nothing, whatever the shape and however near 0.5 Poisson's
    /// ratio is.
    #[test]
    fn no_motion_but_a_rigid_one_is_free() {
        for (corners, ratio) in [
            (distorted([1.0, 0.3, 0.5]), 0.3),
            (distorted([1.0, 0.3, 0.5]), 0.4999),
            (hex8::CORNERS, 0.3),
            (hex8::CORNERS, 0.4999),
        ] {
            let material = Material::new(1.0, ratio).unwrap();
            let k = stiffness(&corners, material);
            let size = k.iter().flatten().fold(0.0f64, |s, v| s.max(v.abs()));
            for mode in rigid_motions(&corners) {
                assert!(energy(&k, &mode).abs() < 1e-13 * size);
            }
            let matrix = faer::Mat::from_fn(24, 24, |i, j| k[i][j]);
            let values = matrix.self_adjoint_eigenvalues(faer::Side::Lower).unwrap();
            // The softest shape is sheared, so that lambda has no part in it.
            let shear = material.shear_modulus() * hex8::volume(&corners).cbrt();
            assert!(
                values[5].abs() < 1e-13 * values[23] && values[6] > 1e-3 * shear,
                "{ratio}: {values:?}"
            );
        }
    }

    /// Motions that keep a box' volume on the whole cost shear alone: of the 18 that are not rigid
    /// only one feels lambda, where all but one of the plain element's do.
    #[test]
    fn only_the_mean_dilatation_of_a_box_feels_a_high_lambda() {
        let material = Material::new(3.0, 0.499_999).unwrap();
        let stiff = |k: ElementMatrix| {
            let matrix = faer::Mat::from_fn(24, 24, |i, j| k[i][j]);
            let values = matrix.self_adjoint_eigenvalues(faer::Side::Lower).unwrap();
            values.iter().filter(|&&v| v > 1e3).count()
        };
        assert_eq!(stiff(stiffness(&hex8::CORNERS, material)), 1);
        assert!(stiff(hex8::stiffness(&hex8::CORNERS, material)) > 6);
    }
}
