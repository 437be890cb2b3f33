//! What an EXR file says of itself, from its header alone.

use std::io::BufReader;
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use kufe::jobs::{Failure, json_number};
use kufe_files::open_regular;
use serde_json::{Map, Value, json};

/// Channels of kufe's maps, what they hold, and what a file is that has one; the first of them tells.
const CHANNELS: [(&str, &str, &str); 4] = [
    (
        "p",
        "contact pressure [Pa]",
        "a map of pressure, gap and displacement",
    ),
    ("gap", "distance of the surfaces [m]", "a map of gaps"),
    (
        "uz",
        "displacement of the ice upwards [m]",
        "a map of displacements",
    ),
    ("depth", "depth of the groove [m]", "a map of a groove"),
];

/// Size, channels and own attributes of an EXR file; pixels are not read.
pub fn describe(path: &Path) -> Result<Value, Failure> {
    let told = |error: exr::error::Error| Failure::BadInput(format!("{}: {error}", path.display()));
    let file = open_regular(path).map_err(|error| told(error.into()))?;
    let meta = MetaData::read_from_buffered(BufReader::new(file), false).map_err(told)?;
    let Some(header) = meta.headers.first() else {
        return Err(Failure::BadInput(format!(
            "{}: an EXR without layers",
            path.display()
        )));
    };
    let channels: Map<String, Value> = header
        .channels
        .list
        .iter()
        .map(|channel| {
            let name = channel.name.to_string();
            let known = CHANNELS.iter().find(|(known, ..)| *known == name);
            let holds = known.map_or(String::new(), |(_, holds, _)| format!(", {holds}"));
            (name, json!(format!("{:?}{holds}", channel.sample_type)))
        })
        .collect();
    let kind = CHANNELS
        .iter()
        .find(|(name, ..)| channels.contains_key(*name));
    let mut attributes: Vec<(String, Value)> = header
        .own_attributes
        .other
        .iter()
        .chain(&header.shared_attributes.other)
        .map(|(name, value)| (name.to_string(), attribute(value)))
        .collect();
    attributes.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(json!({
        "kind": kind.map_or("an EXR picture", |(.., kind)| kind),
        "width": header.layer_size.width(),
        "height": header.layer_size.height(),
        "channels": channels,
        "attributes": Map::from_iter(attributes),
    }))
}

fn attribute(value: &AttributeValue) -> Value {
    match value {
        AttributeValue::Text(text) => json!(text.to_string()),
        AttributeValue::F64(value) => json_number(*value),
        AttributeValue::F32(value) => json_number(f64::from(*value)),
        AttributeValue::I32(number) => json!(number),
        AttributeValue::FloatVec2(pair) => json!([pair.0, pair.1]),
        other => json!(format!("{other:?}")),
    }
}
