//! Finite elements against patch tests, manufactured and closed-form solutions.

mod bending;
mod iterations;
mod manufactured;
mod patch;
mod solvers;
mod stress;
