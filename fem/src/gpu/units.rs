//! Units in which single precision has room.

use crate::tensor::operator::TensorOperator;

/// Powers of two that lengths and moduli are counted in on the device.
///
/// K is linear in both: the device holds K / (modulus length), whose numbers do not depend on what the caller's units are.
/// The length is a power of four, so that eigenvectors, which go with one over its square root, are scaled exactly too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Units {
    pub length: f64,
    pub modulus: f64,
}

impl Units {
    /// A length between the smallest cell and the whole grid, and the shear modulus.
    pub fn of(operator: &TensorOperator) -> Self {
        let nodes = operator.axes.iter().map(|axis| &axis.nodes);
        let smallest = nodes
            .clone()
            .flat_map(|nodes| nodes.windows(2).map(|w| w[1] - w[0]))
            .fold(f64::INFINITY, f64::min);
        let largest = nodes
            .map(|nodes| nodes[nodes.len() - 1] - nodes[0])
            .fold(0.0, f64::max);
        let root = power_of_two(smallest.sqrt() * largest.sqrt()).sqrt();
        Units {
            length: power_of_two(root).powi(2),
            modulus: power_of_two(operator.mu),
        }
    }

    /// What the device's K is multiplied with to be the operator's.
    pub fn stiffness(&self) -> f64 {
        self.modulus * self.length
    }
}

/// The largest power of two that is not above `value`, a positive normal number.
fn power_of_two(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & f64::INFINITY.to_bits())
}
