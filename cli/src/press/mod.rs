//! `kufe press`: one contact problem or a series of them, from its case to its pressure map.

mod args;
mod command;
mod device;
mod files;
mod first_step;
mod groove_picture;
mod held;
mod lists;
mod series;
mod series_table;
mod sliding;
mod solved;
mod subsurface;
mod summary;

pub use args::Args;
pub use command::run;
