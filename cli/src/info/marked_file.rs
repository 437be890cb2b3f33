//! Text that a command wrote for other programs: its first lines say which version did.

use std::io::Read;
use std::path::Path;

use kufe_files::open_regular;
use kufe_jobs::Failure;
use serde_json::{Value, json};

/// The mark stands in here [bytes].
const HEAD: u64 = 1 << 13;

/// What it is by its ending, and the version in its mark, `kufe 1.2.3`.
pub fn describe(path: &Path, kind: &str, command: &str) -> Result<Value, Failure> {
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let unreadable = |error: std::io::Error| told(format!("cannot be read: {error}"));
    let mut head = Vec::new();
    let file = open_regular(path).map_err(unreadable)?;
    file.take(HEAD).read_to_end(&mut head).map_err(unreadable)?;
    let head = String::from_utf8_lossy(&head);
    let version = head.match_indices("kufe ").find_map(|(at, mark)| {
        let rest = &head[at + mark.len()..];
        let end = rest
            .find(|c: char| !c.is_ascii_digit() && c != '.')
            .unwrap_or(rest.len());
        let version = rest[..end].trim_end_matches('.');
        (version.split('.').count() == 3).then_some(version)
    });
    match version {
        Some(version) => Ok(json!({ "kind": kind, "written_by": command, "version": version })),
        None => Err(told(format!(
            "not of kufe: expected {kind} by {command}, with its version in the first lines"
        ))),
    }
}
