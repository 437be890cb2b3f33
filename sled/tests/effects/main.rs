//! The catalogue held to what its files say, and effects of one's own.

mod acting;
mod catalogue;
mod own;
mod page;
mod sensors;
mod state;
mod tables;
mod written;
