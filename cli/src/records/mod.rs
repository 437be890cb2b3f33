//! `kufe runs`: recordings of other programs brought into kufe's form.

mod check;
mod command;
mod import;
mod init;

pub use command::{Args, run};
