//! What a scanned hull is like: how it stands in its file, and how dense and noisy it is where it touches the ice.

pub(crate) mod nodes;
pub(crate) mod polynomial;
pub(crate) mod sampling;
pub(crate) mod standing;

pub use nodes::{Noise, noise_of_faces, noise_of_hull};
pub use sampling::Sampling;
pub use standing::Standing;
