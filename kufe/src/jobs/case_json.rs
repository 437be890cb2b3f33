//! A case as results and tables keep it.

use crate::case::Case;
use serde_json::{Value, json};

/// The case key by key; JSON has no infinity, so `inf` becomes the word "inf".
pub fn case_json(case: &Case) -> Value {
    toml::Value::try_from(case).map_or(Value::Null, |value| toml_json(&value))
}

/// A number, or `"inf"`, `"-inf"`, `"nan"` as files of keys spell them.
pub fn json_number(value: f64) -> Value {
    match value {
        finite if finite.is_finite() => json!(finite),
        nan if nan.is_nan() => json!("nan"),
        infinite => json!(infinite.to_string()),
    }
}

/// What a file of keys states, its numbers as [`json_number`] has them.
pub fn toml_json(value: &toml::Value) -> Value {
    match value {
        toml::Value::Table(table) => table
            .iter()
            .map(|(key, value)| (key.clone(), toml_json(value)))
            .collect(),
        toml::Value::Array(values) => values.iter().map(toml_json).collect(),
        toml::Value::Float(number) => json_number(*number),
        toml::Value::Integer(number) => json!(number),
        toml::Value::Boolean(flag) => json!(flag),
        other => json!(other.as_str().map_or(other.to_string(), str::to_string)),
    }
}
