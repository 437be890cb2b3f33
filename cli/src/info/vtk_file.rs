//! What a VTK file of bodies or surfaces holds, from its tags alone.

use std::io::{BufRead, BufReader};
use std::path::Path;

use kufe::jobs::Failure;
use kufe_files::open_regular;
use serde_json::{Map, Value, json};

/// A tag longer than this is none [bytes].
const LONGEST_TAG: usize = 1 << 12;
/// More tags than fields and steps have.
const MOST_TAGS: usize = 1 << 14;

/// Nodes, cells and the names of fields; of a series (`.pvd`) its steps.
pub fn describe(path: &Path) -> Result<Value, Failure> {
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let file = open_regular(path).map_err(|error| told(format!("cannot be read: {error}")))?;
    let tags = tags(BufReader::new(file)).map_err(|error| told(error.to_string()))?;
    let kind = match tags
        .iter()
        .find_map(|tag| attribute(tag, "VTKFile", "type"))
    {
        Some("UnstructuredGrid") => "hexahedra with fields",
        Some("PolyData") => "a surface with fields",
        Some("Collection") => "a series of bodies, for ParaView",
        _ => {
            return Err(told(
                "no VTK file: expected <VTKFile type=\"UnstructuredGrid\", \"PolyData\" or \"Collection\">".into(),
            ));
        }
    };
    let mut facts = Map::new();
    facts.insert("kind".into(), json!(kind));
    for (name, key) in [
        ("NumberOfPoints", "points"),
        ("NumberOfCells", "cells"),
        ("NumberOfPolys", "faces"),
    ] {
        let count = tags
            .iter()
            .find_map(|tag| attribute(tag, "Piece", name)?.parse::<u64>().ok());
        facts.extend(count.map(|count| (key.to_owned(), json!(count))));
    }
    // What stands between one tag and its end.
    let within = |name: &str| -> Vec<&str> {
        let (open, close) = (format!("<{name}"), format!("</{name}"));
        let inside = tags.iter().skip_while(|tag| !tag.starts_with(&open));
        let inside = inside.take_while(|tag| !tag.starts_with(&close));
        inside
            .filter_map(|tag| attribute(tag, "DataArray", "Name"))
            .collect()
    };
    for (name, key) in [
        ("PointData", "fields"),
        ("CellData", "cell_fields"),
        ("FieldData", "field_data"),
    ] {
        let names = within(name);
        if !names.is_empty() {
            facts.insert(key.into(), json!(names.join(", ")));
        }
    }
    let steps = tags
        .iter()
        .filter(|tag| attribute(tag, "DataSet", "file").is_some())
        .count();
    if steps > 0 {
        facts.insert("steps".into(), json!(steps));
    }
    Ok(Value::Object(facts))
}

/// Everything between `<` and `>`; what lies between tags is passed over.
fn tags(mut reader: impl BufRead) -> std::io::Result<Vec<String>> {
    let mut tags = Vec::new();
    let mut open: Option<Vec<u8>> = None;
    loop {
        let read = reader.fill_buf()?;
        if read.is_empty() || tags.len() >= MOST_TAGS {
            return Ok(tags);
        }
        for &byte in read {
            match (&mut open, byte) {
                (_, b'<') => open = Some(vec![byte]),
                (Some(tag), b'>') => {
                    tags.push(String::from_utf8_lossy(tag).into_owned());
                    open = None;
                }
                (Some(tag), _) if tag.len() < LONGEST_TAG => tag.push(byte),
                (Some(_), _) => open = None,
                (None, _) => {}
            }
        }
        let length = read.len();
        reader.consume(length);
    }
}

/// An attribute of a tag of this name.
fn attribute<'a>(tag: &'a str, name: &str, attribute: &str) -> Option<&'a str> {
    let rest = tag.strip_prefix('<')?.strip_prefix(name)?;
    let (_, value) = rest.split_once(&format!(" {attribute}=\""))?;
    value.split_once('"').map(|(value, _)| value)
}
