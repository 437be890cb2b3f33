//! The variables of a MAT-file, from their heads.

use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use kufe::jobs::Failure;
use kufe_files::open_regular;
use serde_json::{Map, Value, json};

/// More variables than a file of figures has.
const MOST: usize = 10_000;
/// The head of a variable: flags, shape and name are in here [bytes].
const HEAD: u64 = 512;

/// The file's own words on its origin, and the shape of each variable.
///
/// MathWorks, "MAT-File Format" (version 5): 128 bytes of head, then elements of type and length; a variable (type 14) begins with its flags, its
/// shape and its name.
pub fn describe(path: &Path) -> Result<Value, Failure> {
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let unreadable = |error: std::io::Error| told(format!("cannot be read: {error}"));
    let mut file = BufReader::new(open_regular(path).map_err(unreadable)?);
    let mut head = [0; 128];
    file.read_exact(&mut head).map_err(unreadable)?;
    let origin = String::from_utf8_lossy(&head[..116])
        .trim_end_matches([' ', '\0'])
        .to_owned();
    if !origin.starts_with("MATLAB 5.0") || &head[126..] != b"IM" {
        return Err(told(format!(
            "begins with {:?}: expected a MAT-file of version 5, little-endian",
            origin.chars().take(20).collect::<String>()
        )));
    }
    let (mut variables, mut packed) = (Map::new(), 0);
    let mut tag = [0; 8];
    while variables.len() + packed < MOST && read_whole(&mut file, &mut tag).map_err(unreadable)? {
        let [kind, length] = [0, 4].map(|at| word(&tag, at).unwrap_or(0));
        let next = file.stream_position().map_err(unreadable)? + u64::from(length);
        match kind {
            14 => {
                let mut head = Vec::new();
                let most = HEAD.min(u64::from(length));
                file.by_ref()
                    .take(most)
                    .read_to_end(&mut head)
                    .map_err(unreadable)?;
                let (name, shape) = variable(&head).ok_or_else(|| {
                    told(format!(
                        "variable {}: expected flags, shape and name",
                        variables.len() + 1
                    ))
                })?;
                variables.insert(name, json!(shape));
            }
            15 => packed += 1,
            other => {
                return Err(told(format!(
                    "an element of type {other}: expected a variable (14 or 15)"
                )));
            }
        }
        file.seek(SeekFrom::Start(next)).map_err(unreadable)?;
    }
    let mut facts = Map::new();
    facts.insert("kind".into(), json!("variables for MATLAB"));
    facts.insert("origin".into(), json!(origin));
    if packed > 0 {
        facts.insert("compressed_variables".into(), json!(packed));
    }
    facts.insert("variables".into(), Value::Object(variables));
    Ok(Value::Object(facts))
}

/// Whether there was more.
fn read_whole(file: &mut impl Read, tag: &mut [u8; 8]) -> std::io::Result<bool> {
    match file.read_exact(tag) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at + 4)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

/// Name and shape ("3 x 1") of a variable.
fn variable(head: &[u8]) -> Option<(String, String)> {
    // Flags: a tag and eight bytes. Shape: a tag and four bytes a dimension, padded to eight.
    let length = word(head, 20)? as usize;
    let shape: Option<Vec<String>> = (0..length / 4)
        .map(|k| Some(word(head, 24 + 4 * k)?.to_string()))
        .collect();
    let at = 24 + length.next_multiple_of(8);
    // A short name stands in its tag: its length in the upper half of the first word.
    let first = word(head, at)?;
    let name = match first >> 16 {
        0 => head.get(at + 8..at + 8 + word(head, at + 4)? as usize)?,
        short => head.get(at + 4..at + 4 + short as usize)?,
    };
    Some((
        String::from_utf8_lossy(name).into_owned(),
        shape?.join(" x "),
    ))
}
