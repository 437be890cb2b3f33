//! The generator and the scorer, without the finder.

mod generator;
mod judge;
