//! What a picture says of itself, from its first blocks.

use std::io::Read;
use std::path::Path;

use kufe::jobs::Failure;
use kufe_files::open_regular;
use serde_json::{Map, Value, json};

/// What a picture begins with is in here [bytes].
const HEAD: u64 = 1 << 12;

/// Size in pixels, and the program that drew it.
///
/// PNG (ISO/IEC 15948): eight bytes of signature, then blocks of length, name, data and checksum.
pub fn describe(path: &Path) -> Result<Value, Failure> {
    let told = |reason: &str| Failure::BadInput(format!("{}: {reason}", path.display()));
    let file = open_regular(path).map_err(|error| told(&format!("cannot be read: {error}")))?;
    let mut head = Vec::new();
    file.take(HEAD)
        .read_to_end(&mut head)
        .map_err(|error| told(&format!("cannot be read: {error}")))?;
    let mut facts = Map::from_iter([("kind".to_owned(), json!("a picture"))]);
    let mut rest = head
        .strip_prefix(b"\x89PNG\r\n\x1a\n")
        .ok_or_else(|| told("no PNG: expected its signature"))?;
    let number = |bytes: &[u8]| {
        bytes
            .iter()
            .fold(0u64, |sum, &byte| (sum << 8) | u64::from(byte))
    };
    while let Some((length, after)) = rest.split_at_checked(4) {
        let Some((name, after)) = after.split_at_checked(4) else {
            break;
        };
        let length = number(length) as usize;
        let Some((data, after)) = after.split_at_checked(length) else {
            break;
        };
        match name {
            b"IHDR" if length >= 8 => {
                facts.insert("width".into(), json!(number(&data[..4])));
                facts.insert("height".into(), json!(number(&data[4..8])));
            }
            b"tEXt" => {
                let text = String::from_utf8_lossy(data);
                if let Some(("Software", program)) = text.split_once('\0') {
                    facts.insert("drawn_by".into(), json!(program));
                }
            }
            _ => {}
        }
        rest = after.get(4..).unwrap_or_default();
    }
    match facts.contains_key("width") {
        true => Ok(Value::Object(facts)),
        false => Err(told("a PNG that breaks off before its size")),
    }
}
