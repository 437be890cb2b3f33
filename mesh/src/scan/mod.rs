//! Properties of a scanned hull: its unit and axes, its rotation, the spacing and the noise of its
//! vertices.

pub(crate) mod frame;
pub(crate) mod noise;
pub(crate) mod orientation;

pub use frame::{ScanFrame, unlike_runner};
pub use noise::{
    Noise, keel_spacing, noise_of_faces, noise_of_hull, strips_of_hull, strips_warning,
};
pub use orientation::{Estimate, Orientation};
