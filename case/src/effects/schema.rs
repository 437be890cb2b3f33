//! The `[effects]` of a case as a JSON schema.

use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use super::CATALOGUE;

/// One table an effect with its one key and the key's bounds.
pub(crate) fn schema(_: &mut SchemaGenerator) -> Schema {
    let effects: Map<String, Value> = CATALOGUE
        .iter()
        .map(|effect| {
            let info = effect.info();
            let table = json!({
                "type": "object",
                "properties": { info.key: {
                    "description": format!("[{}]", info.unit),
                    "type": "number",
                    "minimum": info.low,
                    "maximum": info.high,
                } },
                "additionalProperties": false,
            });
            (info.name.to_owned(), table)
        })
        .collect();
    json_schema!({
        "description": "Effects that are switched on, by name; an absent one is off.",
        "type": "object",
        "properties": effects,
        "additionalProperties": false,
    })
}
