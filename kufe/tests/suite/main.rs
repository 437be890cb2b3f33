//! case.toml, the effects that it switches on, and pictures.

mod case_page;
mod effects;
mod optimum;
mod page;
mod picture;
