//! `kufe view`: the page of a contact with a form that solves again, served to this machine alone.

mod command;
mod form;
mod guard;
mod http;
mod server;
mod turn;
mod waiting;

pub use command::{Args, run};
