//! `kufe view`: the page of a contact with a form that solves again, served to this machine alone.

mod command;
mod form;
mod request;
mod server;
mod turn;

pub use command::{Args, run};
