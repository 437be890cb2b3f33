//! Null distributions: randomisations, their largest statistics and the tail above them.

pub(crate) mod clusters;
pub(crate) mod gumbel;
pub(crate) mod permutations;
pub(crate) mod random;
pub(crate) mod sign_flips;

pub use gumbel::gumbel_tail;
pub use permutations::by_session_permutation;
pub use sign_flips::MaxT;
