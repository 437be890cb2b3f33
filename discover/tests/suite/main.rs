//! What a search finds and what it does not.

mod hidden_effects;
mod real_data;
mod walls;
