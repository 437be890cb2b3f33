//! The verification suite.

mod contact;
mod fem;
mod house;
