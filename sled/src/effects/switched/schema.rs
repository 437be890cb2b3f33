//! The `[effects]` of a model as a JSON schema.

use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use crate::effects::catalogue::CATALOGUE;
use crate::effects::motion::Sensor;
use crate::effects::switched::channel::Channel;

/// A table for each effect of the catalogue, once or by place (`NAME@PLACE`), and tables with an expression.
pub fn schema(_: &mut SchemaGenerator) -> Schema {
    let known: Map<String, Value> = CATALOGUE
        .iter()
        .map(|effect| {
            let info = &effect.info;
            let mut keys: Map<String, Value> = info
                .parameters
                .iter()
                .map(|parameter| {
                    let key = json!({
                        "description": format!("[{}]", parameter.unit),
                        "type": "number",
                        "minimum": parameter.low,
                        "maximum": parameter.high,
                    });
                    (parameter.name.to_owned(), key)
                })
                .collect();
            keys.insert("track".to_owned(), track());
            let table = json!({
                "description": info.summary,
                "type": "object",
                "properties": keys,
                "additionalProperties": false,
            });
            // A table with an expression is one's own effect, whatever its name.
            let either = json!({ "anyOf": [table, own()] });
            (format!("^{}(@.*)?$", info.name), either)
        })
        .collect();
    json_schema!({
        "description": "Effects beyond the base model, by name; an absent one is off.",
        "type": "object",
        "patternProperties": known,
        "additionalProperties": own(),
    })
}

fn track() -> Value {
    json!({ "description": "Acts on this track only.", "type": "string" })
}

fn own() -> Value {
    let sensors = Sensor::ALL.into_iter().map(Channel::Sensor);
    let channels = Channel::NAMED
        .iter()
        .map(|(_, channel)| *channel)
        .chain(sensors);
    let channels: Vec<_> = channels.map(Channel::name).collect();
    json!({
        "description": "An effect of one's own: value times expression.",
        "type": "object",
        "properties": {
            "expression": { "description": "Formula of columns.", "type": "string" },
            "channel": { "enum": channels },
            "unit": { "type": "string" },
            "value": { "type": "number" },
            "low": { "type": "number" },
            "high": { "type": "number" },
            "track": track(),
        },
        "required": ["expression", "channel"],
        "additionalProperties": false,
    })
}
