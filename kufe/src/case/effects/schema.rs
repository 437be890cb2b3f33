//! The `[effects]` of a case as a JSON schema.

use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use crate::case::effects::catalogue::CATALOGUE;

/// One table an effect with its one key and the key's bounds.
pub(crate) fn schema(_: &mut SchemaGenerator) -> Schema {
    let effects: Map<String, Value> = CATALOGUE
        .iter()
        .map(|effect| {
            let p = effect.parameter();
            let table = json!({
                "description": effect.info.summary,
                "type": "object",
                "properties": { p.name: {
                    "description": format!("[{}]", p.unit),
                    "type": "number",
                    "minimum": p.low,
                    "maximum": p.high,
                } },
                "additionalProperties": false,
            });
            (effect.info.name.to_owned(), table)
        })
        .collect();
    json_schema!({
        "description": "Effects that are switched on, by name; an absent one is off.",
        "type": "object",
        "properties": effects,
        "additionalProperties": false,
    })
}
