//! The sled and its friction: `model.toml`, and the same made ready to compute with.

pub(crate) mod model_toml;
pub(crate) mod vehicle;
