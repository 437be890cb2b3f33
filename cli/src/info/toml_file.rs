//! What a file of keys states: a case, a table, a model, a mapping, a campaign.

use std::path::Path;

use kufe::jobs::{Failure, case_file::LoadedCase, case_json, toml_json};
use kufe_files::text_of_regular;
use serde_json::{Map, Value, json};

/// What is longer is no file that someone wrote [bytes].
const LONGEST: u64 = 1 << 24;

/// Kinds by the tables that they have, and the command that reads them.
const KINDS: [(&[&str], &str, &str); 6] = [
    (&["runner", "ice", "load"], "a case", "kufe press"),
    (
        &["case", "axes"],
        "what a lookup table is asked for",
        "kufe lut",
    ),
    (&["channels"], "a mapping of recordings", "kufe runs import"),
    (
        &["sled", "friction"],
        "a model of the sled",
        "kufe simulate, evaluate, validate, fit, discover",
    ),
    (&["model"], "a campaign", "kufe discover"),
    (
        &["friction"],
        "a law of friction for a model",
        "kufe simulate, with [sled] beside it",
    ),
];

/// What it is, which command reads it, and what it states; a case is checked.
pub fn describe(path: &Path) -> Result<Value, Failure> {
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let text =
        text_of_regular(path, LONGEST).map_err(|error| told(format!("cannot be read: {error}")))?;
    let stated: toml::Table = toml::from_str(&text).map_err(|error| told(error.to_string()))?;
    let kind = KINDS
        .iter()
        .find(|(tables, ..)| tables.iter().all(|table| stated.contains_key(*table)));
    let Some((_, kind, command)) = kind else {
        let expected: Vec<String> = KINDS
            .iter()
            .map(|(tables, kind, _)| format!("{kind} ({})", tables.join(", ")))
            .collect();
        return Err(told(format!(
            "keys that are not known: expected {}",
            expected.join(", ")
        )));
    };
    let mut facts = Map::new();
    facts.insert("kind".into(), json!(kind));
    facts.insert("read_by".into(), json!(command));
    let states = match *kind {
        "a case" => case_json(&LoadedCase::read(path)?.case),
        _ => toml_json(&toml::Value::Table(stated)),
    };
    facts.insert("states".into(), states);
    Ok(Value::Object(facts))
}
