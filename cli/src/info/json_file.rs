//! What a JSON document of a command holds.

use std::path::Path;

use kufe::jobs::Failure;
use kufe_files::text_of_regular;
use serde_json::{Map, Value, json};

use crate::output::documents::{DOCUMENTS, LONGEST, figures, known_as};

/// What it is, which command and version wrote it, and its figures.
pub fn describe(path: &Path) -> Result<Value, Failure> {
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let text =
        text_of_regular(path, LONGEST).map_err(|error| told(format!("cannot be read: {error}")))?;
    let document: Value = serde_json::from_str(&text).map_err(|error| told(error.to_string()))?;
    let Some(known) = known_as(&document) else {
        let mut kinds: Vec<&str> = DOCUMENTS.iter().map(|known| known.kind).collect();
        kinds.sort_unstable();
        return Err(told(format!(
            "a JSON document that is not known: expected {}",
            kinds.join(", ")
        )));
    };
    let mut facts = Map::new();
    facts.insert("kind".into(), json!(known.kind));
    facts.insert("written_by".into(), json!(known.command));
    if let Some(version) = document.get("version") {
        facts.insert("version".into(), version.clone());
    }
    facts.extend(figures(&document));
    Ok(Value::Object(facts))
}
