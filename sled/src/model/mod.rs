//! The sled and its friction: `model.toml`, and the model with its tables opened.

pub(crate) mod model_toml;
pub(crate) mod vehicle;
