//! `kufe report`: one page to look at, from what another command has written.

mod command;
mod contact;
mod evaluation;
mod folder_name;
mod gathered;
mod read_json;
mod results;
mod series;
mod table;

pub use command::{Args, run};
pub use read_json::read_json;
