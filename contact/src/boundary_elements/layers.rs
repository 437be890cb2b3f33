//! How much the surface of bonded elastic layers over a rigid bed gives, wave by wave.

use nalgebra::{Matrix2, Matrix4};

/// A layer of one material.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Thickness [m].
    pub thickness: f64,
}

/// Largest wave number times thickness that one step in depth takes: its exponentials stay near 1.
const STEP: f64 = 2.0;
/// Thickness times k beyond which nothing of what lies below is felt: e^-80 of it.
const DEEP: f64 = 40.0;

impl Layer {
    /// k times the displacement of a half-space of this material under a pressure of amplitude 1 and any wave number k:
    /// 2 (1 - nu^2) / E [1/Pa].
    pub fn half_space(&self) -> f64 {
        2.0 * (1.0 - self.poissons_ratio.powi(2)) / self.youngs_modulus
    }

    /// Takes the compliance of the plane below this layer (displacements u_r, u_z under tractions tau, sigma of wave number `k`) to
    /// that of its upper plane.
    ///
    /// In depth d/dz (U, W, T, S) = A (U, W, T, S) for u_r = U J1(k r), u_z = W J0(k r). A has the eigenvalues k and -k twice each, so
    /// that N = A^2 - k^2 has N^2 = 0 and
    /// e^(A t) = cosh kt + A sinh(kt)/k + N t sinh(kt)/(2k) + A N (kt cosh kt - sinh kt)/(2 k^3).
    fn raise(&self, k: f64, below: Matrix2<f64>) -> Matrix2<f64> {
        let (e, nu) = (self.youngs_modulus, self.poissons_ratio);
        let (lambda, mu) = (
            e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            e / (2.0 * (1.0 + nu)),
        );
        let plane = lambda + 2.0 * mu;
        // Lengths in 1/k and stresses in mu make every entry of order 1.
        let a = Matrix4::new(
            0.0,
            1.0,
            1.0,
            0.0,
            -lambda / plane,
            0.0,
            0.0,
            mu / plane,
            (plane - lambda * lambda / plane) / mu,
            0.0,
            0.0,
            lambda / plane,
            0.0,
            0.0,
            -1.0,
            0.0,
        );
        let deep = (k * self.thickness).min(DEEP);
        let steps = (deep / STEP).ceil().max(1.0);
        let t = deep / steps;
        let n = a * a - Matrix4::identity();
        let through = Matrix4::identity() * t.cosh()
            + a * t.sinh()
            + n * (0.5 * t * t.sinh())
            + a * n * (0.5 * (t * t.cosh() - t.sinh()));
        let part = |row: usize, column: usize| -> Matrix2<f64> {
            through.fixed_view::<2, 2>(row, column).into_owned()
        };
        let mut c = below * (k * mu);
        for _ in 0..steps as usize {
            let (moved, loaded) = (part(0, 0) * c + part(0, 2), part(2, 0) * c + part(2, 2));
            // The traction of a finite layer's plane follows from any displacement: the matrix is regular.
            c = moved * loaded.try_inverse().unwrap_or_else(Matrix2::zeros);
        }
        c / (k * mu)
    }
}

/// Downward displacement of the surface of `layers` (from the top one down, the last bonded to a rigid bed) under a pressure of amplitude
/// 1 and wave number `k` [1/m], in m/Pa (I. N. Sneddon, Fourier Transforms, 1951, chapter 10).
pub(super) fn compliance(layers: &[Layer], k: f64) -> f64 {
    let bed = Matrix2::zeros();
    layers.iter().rev().fold(bed, |c, layer| layer.raise(k, c))[(1, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const ICE: Layer = Layer {
        youngs_modulus: 9e9,
        poissons_ratio: 0.33,
        thickness: 0.02,
    };

    #[test]
    fn a_layer_on_a_rigid_bed_gives_as_the_closed_form_says() {
        // K. L. Johnson, Contact Mechanics, 1985, section 5.8; in this form for axial symmetry as for a plane.
        for kh in [1e-3, 0.1, 1.0, 3.0, 9.0] {
            let nu = ICE.poissons_ratio;
            let (twice, kappa) = (2.0 * kh, 3.0 - 4.0 * nu);
            let above: f64 = kappa * f64::sinh(twice) - twice;
            let below = kappa * f64::cosh(twice) + 2.0 * kh * kh + 5.0 - 12.0 * nu + 8.0 * nu * nu;
            let closed = ICE.half_space() / (kh / ICE.thickness) * above / below;
            let found = compliance(&[ICE], kh / ICE.thickness);
            assert!(
                (found / closed - 1.0).abs() < 1e-6,
                "{kh}: {found} {closed}"
            );
        }
    }

    #[test]
    fn two_layers_of_one_material_are_one() {
        let half = Layer {
            thickness: 0.01,
            ..ICE
        };
        for k in [1.0, 100.0, 700.0] {
            let (one, two) = (compliance(&[ICE], k), compliance(&[half, half], k));
            assert!((one / two - 1.0).abs() < 1e-9, "{k}: {one} {two}");
        }
    }
}
