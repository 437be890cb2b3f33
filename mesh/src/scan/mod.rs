//! What a scanned hull is like: how it stands in its file, and how dense and noisy it is where it touches the ice; how noisy a mesh is.

pub(crate) mod nodes;
pub(crate) mod polynomial;
pub(crate) mod sampling;
pub(crate) mod standing;

pub use nodes::noise_of_faces;
pub use sampling::Sampling;
pub use standing::Standing;
