//! A case as results and tables keep it.

use kufe_case::Case;
use serde_json::{Value, json};

/// The case key by key; JSON has no infinity, so `inf` becomes the word "inf".
pub fn case_json(case: &Case) -> Value {
    toml::Value::try_from(case).map_or(Value::Null, |value| as_json(&value))
}

fn as_json(value: &toml::Value) -> Value {
    match value {
        toml::Value::Table(table) => table
            .iter()
            .map(|(key, value)| (key.clone(), as_json(value)))
            .collect(),
        toml::Value::Array(values) => values.iter().map(as_json).collect(),
        toml::Value::Float(number) if !number.is_finite() => json!(number.to_string()),
        toml::Value::Float(number) => json!(number),
        toml::Value::Integer(number) => json!(number),
        toml::Value::Boolean(flag) => json!(flag),
        other => json!(other.as_str().map_or(other.to_string(), str::to_string)),
    }
}
