//! The command as a user meets it, one program: each test runs `kufe` in a folder of its own.

mod about;
mod held;
mod input;
mod kufe;
mod lut;
mod pages;
mod press;
mod runs;
mod search;
