//! What no file can state, since its reader refuses it: a program that calls the library can.

mod parts;
mod problems;
