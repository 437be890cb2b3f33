//! The mark of a file that kufe wrote: its name and version near the beginning.

use std::io::{Read, Result};
use std::path::Path;

use kufe_files::open_regular;

/// The mark stands in here [bytes].
const HEAD: u64 = 1 << 13;

/// What plans and tables are marked with beside a version.
const FORMATS: [&str; 2] = ["\"kufe-lut", "--job-name=kufe-lut"];

/// The version in a file's mark, `kufe 1.2.3`; `None` where it has no mark.
///
/// # Errors
/// The system's where it cannot be read.
pub fn version_of(path: &Path) -> Result<Option<String>> {
    Ok(version_in(&head(path)?))
}

fn version_in(head: &str) -> Option<String> {
    head.match_indices("kufe ").find_map(|(at, mark)| {
        let rest = &head[at + mark.len()..];
        let end = rest
            .find(|c: char| !c.is_ascii_digit() && c != '.')
            .unwrap_or(rest.len());
        let version = rest[..end].trim_end_matches('.');
        (version.split('.').count() == 3).then(|| version.to_owned())
    })
}

/// Whether a file says of itself that kufe wrote it.
pub fn is_marked(path: &Path) -> bool {
    head(path).is_ok_and(|head| {
        version_in(&head).is_some() || FORMATS.iter().any(|mark| head.contains(mark))
    })
}

fn head(path: &Path) -> Result<String> {
    let mut head = Vec::new();
    open_regular(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(String::from_utf8_lossy(&head).into_owned())
}
