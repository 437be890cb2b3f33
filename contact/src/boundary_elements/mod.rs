//! The contact on its plane alone: boundary elements, a second method. With finite elements it only
//! shares the gap of the problem and the estimation of rims. Contacts of many asperities are solved
//! by boundary elements alone.

pub(crate) mod active_set;
pub(crate) mod asperities;
pub(crate) mod check;
pub(crate) mod operator;
pub(crate) mod window;
pub(crate) mod window_contact;
