//! Effects on pressures: optional changes of a contact problem or of the sensor, with one parameter
//! each.

mod catalogue;
mod effect;

use std::collections::BTreeMap;

use kufe_contact::Problem;
use schemars::{Schema, SchemaGenerator, json_schema};

use crate::case::CaseError;

pub use catalogue::{CATALOGUE, find};
pub use effect::{Adds, Effect, Growth, Map, Search};
pub use kufe_sled::effects::{Form, Info, Parameter};

/// Changes a problem by the effects of a case's `[effects]` tables. Effects of the sensor do not
/// change it.
///
/// # Errors
/// [`CaseError::Effect`] with the effect, what was found and what was expected.
pub(crate) fn switch_on(
    tables: &BTreeMap<String, toml::Table>,
    problem: &mut Problem,
) -> Result<(), CaseError> {
    for (name, table) in tables {
        let refused = |found: String, expected: String| CaseError::Effect {
            name: name.clone(),
            found,
            expected,
        };
        let Some(effect) = find(name) else {
            let known: Vec<&str> = CATALOGUE.iter().map(|e| e.info.name).collect();
            return Err(refused("an unknown effect".to_owned(), known.join(", ")));
        };
        let p = effect.parameter();
        if let Some(key) = table.keys().find(|key| *key != p.name) {
            return Err(refused(format!("the key `{key}`"), format!("`{}`", p.name)));
        }
        let value = match table.get(p.name) {
            None => 0.0,
            Some(toml::Value::Float(value)) => *value,
            Some(toml::Value::Integer(value)) => *value as f64,
            Some(_) => f64::NAN,
        };
        if !(value >= p.low && value <= p.high) {
            let found = table.get(p.name).map_or(String::new(), ToString::to_string);
            return Err(refused(
                format!("`{}` = {found}", p.name),
                format!("a number from {} to {} {}", p.low, p.high, p.unit),
            ));
        }
        effect.alter(value, problem);
    }
    Ok(())
}

/// JSON schema of a case's `[effects]`: one table per effect with its key and the key's bounds.
pub(crate) fn schema(_: &mut SchemaGenerator) -> Schema {
    let effects: BTreeMap<&str, Schema> = CATALOGUE
        .iter()
        .map(|effect| {
            let table = json_schema!({
                "description": effect.info.summary,
                "type": "object",
                "properties": effect.info.parameter_schemas(),
                "additionalProperties": false,
            });
            (effect.info.name, table)
        })
        .collect();
    json_schema!({
        "description": "Effects that are switched on, by name; an absent one is off.",
        "type": "object",
        "properties": effects,
        "additionalProperties": false,
    })
}
