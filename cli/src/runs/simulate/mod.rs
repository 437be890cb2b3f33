//! `kufe simulate`: what it is asked for, runs driven, a measured run driven again, the sample data.

mod args;
mod command;
mod drive;
mod replay;
mod sample;
mod written;

pub use args::Args;
pub use command::run;
