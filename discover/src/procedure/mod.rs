//! The one search: fit, screen, claim, add, refit; at the end, once, the locked-away data.

pub(crate) mod closed;
pub(crate) mod sentence;
