//! The eight-node hexahedron with incompatible modes, which bends without locking.
//!
//! Each element gets three inner modes 1 - xi^2, 1 - eta^2, 1 - zeta^2 in each displacement
//! component. Their gradients are taken with the Jacobian J_0 of the centre and scaled by det J_0 /
//! det J, so that their integral over the element vanishes: with this condition distorted elements
//! pass the patch test. The nine amplitudes are eliminated by static condensation.
//!
//! Source: R. L. Taylor, P. J. Beresford and E. L. Wilson, A non-conforming element for stress
//! analysis, Int. J. Numer. Meth. Engng 10 (1976), 1211-1219.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

use crate::body::Material;
use crate::element::hex8::{Corners, ElementMatrix, Jacobian, add_block, gauss_points, gradients};

/// Gradients [1/m] of the three modes at natural coordinates `xi` where the determinant is
/// `determinant`.
pub fn mode_gradients(centre: &Jacobian, xi: [f64; 3], determinant: f64) -> [[f64; 3]; 3] {
    let scale = centre.determinant / determinant;
    std::array::from_fn(|m| centre.inverse[m].map(|g| -2.0 * xi[m] * scale * g))
}

/// Cholesky factor of the stiffness of the inner amplitudes.
pub type InnerFactor = Cholesky<f64, Const<9>>;

/// The element before its inner amplitudes are condensed out.
pub struct Uncondensed {
    /// Stiffness of the corner displacements (24 x 24) [N/m].
    pub corners: ElementMatrix,
    /// Coupling of inner amplitudes (rows) to corner displacements (columns) [N/m].
    pub coupling: SMatrix<f64, 9, 24>,
    /// Factor of the stiffness of the inner amplitudes.
    pub inner_factor: InnerFactor,
}

impl Uncondensed {
    /// Integrates the element with 2 x 2 x 2 Gauss points. Every Jacobian determinant must be
    /// positive.
    pub fn new(corners: &Corners, material: Material) -> Self {
        let (lambda, mu) = (material.lame_lambda(), material.shear_modulus());
        let centre = Jacobian::at(corners, [0.0; 3]);
        let mut blocks = [[[[0.0; 3]; 3]; 11]; 11];
        for xi in gauss_points() {
            let (g, determinant) = gradients(corners, xi);
            let modes = mode_gradients(&centre, xi, determinant);
            let all: [[f64; 3]; 11] =
                std::array::from_fn(|a| if a < 8 { g[a] } else { modes[a - 8] });
            for a in 0..11 {
                for b in a..11 {
                    let moduli = [lambda * determinant, mu * determinant];
                    add_block(&mut blocks[a][b], [all[a], all[b]], moduli);
                }
            }
        }
        let entry = |row: usize, column: usize| {
            let (a, i, b, j) = (row / 3, row % 3, column / 3, column % 3);
            if row <= column {
                blocks[a][b][i][j]
            } else {
                blocks[b][a][j][i]
            }
        };
        Self {
            corners: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
            coupling: SMatrix::from_fn(|i, j| entry(24 + i, j)),
            inner_factor: factor_of(|i, j| entry(24 + i, 24 + j)),
        }
    }

    /// The inner amplitudes [m] that minimise the energy for corner displacements `u` [m].
    pub fn amplitudes(&self, u: &[f64; 24]) -> [f64; 9] {
        let force = -(self.coupling * SVector::from(*u));
        self.inner_factor.solve(&force).into()
    }
}

/// The factor of the stiffness with these entries; not finite if it is not positive definite, as in
/// a cell that is inside out.
fn factor_of(entry: impl Fn(usize, usize) -> f64) -> InnerFactor {
    Cholesky::new_unchecked(SMatrix::from_fn(entry))
}

/// [`Uncondensed::inner_factor`] alone.
pub(crate) fn inner_factor(corners: &Corners, material: Material) -> InnerFactor {
    let (lambda, mu) = (material.lame_lambda(), material.shear_modulus());
    let centre = Jacobian::at(corners, [0.0; 3]);
    let mut blocks = [[[[0.0; 3]; 3]; 3]; 3];
    for xi in gauss_points() {
        let determinant = Jacobian::at(corners, xi).determinant;
        let modes = mode_gradients(&centre, xi, determinant);
        for a in 0..3 {
            for b in 0..=a {
                let moduli = [lambda * determinant, mu * determinant];
                add_block(&mut blocks[a][b], [modes[a], modes[b]], moduli);
            }
        }
    }
    factor_of(|i, j| blocks[i / 3][j / 3][i % 3][j % 3])
}

/// Condensed stiffness K_uu - K_ua K_aa^-1 K_au (24 x 24), symmetric [N/m].
///
/// Every Jacobian determinant must be positive ([`crate::element::hex8::smallest_determinant`]);
/// [`crate::Body`] checks it.
pub fn stiffness(corners: &Corners, material: Material) -> ElementMatrix {
    let element = Uncondensed::new(corners, material);
    // W = L^-1 K_au, so that K_ua K_aa^-1 K_au = W^T W: symmetric to the last bit.
    let mut w = element.coupling;
    let lower = element.inner_factor.l_dirty();
    lower.solve_lower_triangular_unchecked_mut(&mut w);
    let mut k = element.corners;
    for row in w.row_iter() {
        for i in 0..24 {
            for j in 0..24 {
                k[i][j] -= row[i] * row[j];
            }
        }
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::hex8::{self, tests::*};

    #[test]
    fn condensed_stiffness_is_symmetric_and_leaves_rigid_motions_free() {
        let corners = distorted([1.0, 0.1, 3.0]);
        let k = stiffness(&corners, Material::new(1.0, 0.3).unwrap());
        let size = k.iter().flatten().fold(0.0f64, |s, v| s.max(v.abs()));
        for mode in rigid_motions(&corners) {
            for row in &k {
                let f: f64 = row.iter().zip(&mode).map(|(a, b)| a * b).sum();
                assert!(f.abs() < 1e-13 * size, "{f}");
            }
        }
        for (i, row) in k.iter().enumerate() {
            for (j, v) in row.iter().enumerate() {
                assert_eq!(*v, k[j][i]);
            }
        }
    }

    #[test]
    fn linear_displacements_need_no_inner_modes() {
        let corners = distorted([1.0, 0.5, 2.0]);
        let element = Uncondensed::new(&corners, Material::new(1.0, 0.3).unwrap());
        let u: [f64; 24] = std::array::from_fn(|d| {
            let p = corners[d / 3];
            [0.3 * p[0] - p[1], 0.2 * p[2] + p[0], p[1] - 0.7 * p[2]][d % 3]
        });
        for a in element.amplitudes(&u) {
            assert!(a.abs() < 1e-14, "{a}");
        }
    }

    /// Bending u_x = x y, u_y = -x^2/2, of a plate in plane stress with nu = 0, has the energy E
    /// b^2 V / (2 * 3).
    #[test]
    fn pure_bending_has_the_energy_of_beam_theory() {
        let (a, b, c) = (4.0, 0.25, 0.5);
        let corners = hex8::CORNERS.map(|p| [a * p[0], b * p[1], c * p[2]]);
        let material = Material::new(7.0, 0.0).unwrap();
        let u: [f64; 24] = std::array::from_fn(|d| {
            let [x, y, _] = corners[d / 3];
            [x * y, -x * x / 2.0, 0.0][d % 3]
        });
        let energy = |k: ElementMatrix| {
            0.5 * (0..24)
                .map(|i| u[i] * (0..24).map(|j| k[i][j] * u[j]).sum::<f64>())
                .sum::<f64>()
        };
        let beam = 0.5 * 7.0 * b * b / 3.0 * 8.0 * a * b * c;
        let incompatible = energy(stiffness(&corners, material));
        let plain = energy(hex8::stiffness(&corners, material));
        // Corner forces some 1e5 times their sum cancel here.
        assert!(
            (incompatible / beam - 1.0).abs() < 1e-10,
            "{incompatible} {beam}"
        );
        // Plain hex8 stores the parasitic shear as well: 1 + (a/b)^2 / 2 at nu = 0.
        assert!((plain / beam - (1.0 + (a / b).powi(2) / 2.0)).abs() < 1e-9);
    }
}
