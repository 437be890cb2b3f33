//! A contact problem for another solver: a deck of CalculiX, or the assembled stiffness.

mod calculix;
mod stiffness;

pub use calculix::{CalculixDeck, DeckResult};
pub use stiffness::{AssembledStiffness, StiffnessResult};
