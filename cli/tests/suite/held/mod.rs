//! What must be true for every command: inputs are unchanged, outputs are of one run, answers carry their load, and every command ends.

mod asked;
mod endings;
mod import;
mod inputs;
mod outputs;
mod stale;
