//! What must be true for every command: inputs are unchanged, outputs are of one run, contacts carry their load, and every command ends.

mod endings;
mod import;
mod inputs;
mod outputs;
mod settings;
mod stale;
