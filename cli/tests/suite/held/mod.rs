//! What must hold whatever is asked: inputs stay, outputs are of one run, answers carry their load, and every command ends.

mod asked;
mod endings;
mod import;
mod inputs;
mod leftovers;
mod outputs;
mod owned;
mod stale;
