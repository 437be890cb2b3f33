//! Finite elements against patch tests, manufactured and closed-form solutions.

mod bending;
mod cg;
mod closed_form;
mod iterations;
mod loads;
mod manufactured;
mod patch;
mod solvers;
mod stress;
