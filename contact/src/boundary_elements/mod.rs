//! The contact on its plane alone: boundary elements, a second method that shares the problem's gap
//! with the first, how rims are read, and nothing else. Contacts of many asperities are solved by
//! it alone.

pub(crate) mod active_set;
pub(crate) mod asperities;
pub(crate) mod check;
pub(crate) mod operator;
pub(crate) mod window;
pub(crate) mod window_contact;
