//! Null distributions: randomisations, their largest statistics and the tail above them.

pub(crate) mod clusters;
pub(crate) mod gumbel;
pub(crate) mod permutations;
pub(crate) mod random;
pub(crate) mod score_bootstrap;
pub(crate) mod sign_flips;

pub use gumbel::gumbel_tail;
pub use permutations::by_session_permutation;
pub use sign_flips::MaxT;

/// Combined p-value of two independent ones: `p q (1 - ln(p q))`.
///
/// Source: R. A. Fisher, Statistical Methods for Research Workers, 4th ed. (1932), section 21.1.
pub(crate) fn combined_p_value(p: f64, q: f64) -> f64 {
    let product = (p * q).max(f64::MIN_POSITIVE);
    product * (1.0 - product.ln())
}
