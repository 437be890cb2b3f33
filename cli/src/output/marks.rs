//! The mark of a file that kufe wrote: its name and version near the beginning.

use std::io::{Read, Result};
use std::path::Path;

use kufe_files::open_regular;

/// Length of a file's beginning that contains the mark [bytes].
const HEAD: u64 = 1 << 13;

/// Marks of plans and tables, apart from `kufe 1.2.3`.
const FORMATS: [&str; 2] = ["\"kufe-lut", "--job-name=kufe-lut"];

/// Whether a file states within itself that kufe wrote it.
pub fn is_marked(path: &Path) -> bool {
    head(path)
        .is_ok_and(|head| has_version(&head) || FORMATS.iter().any(|mark| head.contains(mark)))
}

fn has_version(head: &str) -> bool {
    head.match_indices("kufe ").any(|(at, mark)| {
        let rest = &head[at + mark.len()..];
        let end = rest
            .find(|c: char| !c.is_ascii_digit() && c != '.')
            .unwrap_or(rest.len());
        rest[..end].trim_end_matches('.').split('.').count() == 3
    })
}

fn head(path: &Path) -> Result<String> {
    let mut head = Vec::new();
    open_regular(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(String::from_utf8_lossy(&head).into_owned())
}
