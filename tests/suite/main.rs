//! The verification suite, one program.

mod contact;
mod fem;
mod house;
