//! What can go wrong.

/// Errors of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Young's modulus is not a positive finite number.
    #[error("Young's modulus is {found} Pa; expected a positive finite number")]
    YoungsModulus {
        /// The value found [Pa].
        found: f64,
    },
    /// Poisson's ratio is outside the range of a stable, compressible solid.
    #[error("Poisson's ratio is {found}; expected -1 < nu < 0.5")]
    PoissonsRatio {
        /// The value found.
        found: f64,
    },
}
