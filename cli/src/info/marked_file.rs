//! Text that a command wrote for other programs: its first lines say which version did.

use std::path::Path;

use kufe::jobs::Failure;
use serde_json::{Value, json};

use crate::output::marks::version_of;

/// What it is by its ending, and the version in its mark, `kufe 1.2.3`.
pub fn describe(path: &Path, kind: &str, command: &str) -> Result<Value, Failure> {
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    match version_of(path).map_err(|error| told(format!("cannot be read: {error}")))? {
        Some(version) => Ok(json!({ "kind": kind, "written_by": command, "version": version })),
        None => Err(told(format!(
            "not of kufe: expected {kind} by {command}, with its version in the first lines"
        ))),
    }
}
