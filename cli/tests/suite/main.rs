//! The command as a user runs it, one program: each test runs `kufe` in a folder of its own.

mod about;
mod guarantees;
mod input;
mod kufe;
mod lut;
mod pages;
mod press;
mod runs;
mod search;
