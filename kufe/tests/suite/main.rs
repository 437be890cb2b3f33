//! case.toml, the effects that it switches on, and pictures.

mod case_page;
mod effects;
mod page;
mod picture;
