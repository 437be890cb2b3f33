//! Numbers that JSON has no word for.

use serde_json::{Value, json};

/// A number, or `"inf"`, `"-inf"`, `"nan"` as files of keys spell them.
pub fn number(value: f64) -> Value {
    match value {
        finite if finite.is_finite() => json!(finite),
        nan if nan.is_nan() => json!("nan"),
        other => json!(other.to_string()),
    }
}
