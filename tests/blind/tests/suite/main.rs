//! The generator and the scorer, without the finder.

mod command;
mod film;
mod generator;
mod judge;
mod open_worlds;
mod shares;
