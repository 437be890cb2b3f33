//! What an EXR file says of itself, from its header alone.

use std::io::BufReader;
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use kufe_files::open_regular;
use kufe_jobs::{Failure, json_number};
use serde_json::{Map, Value, json};

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
            (
                channel.name.to_string(),
                json!(format!("{:?}", channel.sample_type)),
            )
        })
        .collect();
    let mut attributes: Vec<(String, Value)> = header
        .own_attributes
        .other
        .iter()
        .chain(&header.shared_attributes.other)
        .map(|(name, value)| (name.to_string(), attribute(value)))
        .collect();
    attributes.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(json!({
        "kind": "EXR",
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
