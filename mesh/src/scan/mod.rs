//! Properties of a scanned hull: its unit and axes, the spacing and the noise of its vertices.

pub(crate) mod frame;
pub(crate) mod noise;

pub use frame::ScanFrame;
pub use noise::{Noise, Sampling, noise_of_faces, noise_of_hull};
