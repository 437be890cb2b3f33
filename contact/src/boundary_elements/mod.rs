//! The contact on its plane alone: boundary elements, a second method that shares the problem's gap with the first, how rims are read, and nothing else.

mod active_set;
mod check;
mod layers;
mod operator;
mod plane;
mod radial;
mod rectangle;
mod surface;
mod window;

pub use check::{
    BoundaryElements, boundary_elements, boundary_elements_to, boundary_elements_to_compare,
};
pub use surface::NotChecked;
