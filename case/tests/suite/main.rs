//! case.toml, and the effects that it switches on.

mod case_page;
mod effects;
mod page;
