//! `kufe runs`: recordings of other programs brought into kufe's form.

mod align;
mod check;
mod command;
mod gather;
mod gathered;
mod import;
mod init;

pub use command::{Args, run};
pub use gathered::UNNAMED;
