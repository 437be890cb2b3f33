//! How much softer a surface is than its preconditioner takes it for.

use kufe_fem::{Material, TensorOperator};

/// Factor by which the true surface response exceeds that of P on a half-space.
///
/// Both are 1 / |k| in the wave number: (1 - nu) / mu for elasticity, 1 / sqrt(mu (lambda + 2 mu)) for P.
pub(crate) fn surface_response(operator: &TensorOperator, material: Material) -> f64 {
    let stiffness_ratio = (operator.lambda + 2.0 * operator.mu) / operator.mu;
    (1.0 - material.poissons_ratio()) * stiffness_ratio.sqrt()
}
