//! The JSON documents that commands leave in their folders, and how one is told from another.

use serde_json::{Map, Value, json};

/// A kind of document.
#[derive(Debug, PartialEq)]
pub struct Known {
    /// Its file, as the command calls it; empty where it tells nothing of a folder.
    pub name: &'static str,
    /// What it holds.
    pub kind: &'static str,
    /// The command that writes it.
    pub command: &'static str,
    /// The keys that it has and no other kind has all of; of a list, its first row.
    keys: &'static [&'static str],
}

const fn known(
    name: &'static str,
    kind: &'static str,
    command: &'static str,
    keys: &'static [&'static str],
) -> Known {
    Known {
        name,
        kind,
        command,
        keys,
    }
}

/// All kinds; a folder is what the first of them in it says.
const DOCUMENTS: [Known; 20] = [
    known(
        "result.json",
        "a solved contact",
        "kufe press",
        &["p_max_pa", "kkt_residual", "history"],
    ),
    known(
        "table.json",
        "a series of contacts",
        "kufe press",
        &["step", "folder"],
    ),
    known(
        "evaluation.json",
        "an evaluation of drivers",
        "kufe evaluate",
        &["runs", "groups", "interval"],
    ),
    known(
        "report.json",
        "a finding",
        "kufe discover",
        &["verdict", "steps", "held_out"],
    ),
    known(
        "friction.json",
        "the runner with the least friction",
        "kufe friction --optimise",
        &["parameters", "response_scatter"],
    ),
    known(
        "friction.json",
        "friction over speed and temperature",
        "kufe friction",
        &["points", "cases"],
    ),
    known(
        "fit.json",
        "a fit of lateral friction",
        "kufe fit lateral",
        &["front", "rear", "excluded_contacts"],
    ),
    known(
        "fit.json",
        "a fit of mu over pressure",
        "kufe friction fit",
        &["parameters", "covariance_bcd"],
    ),
    known(
        "validation.json",
        "a comparison of model and runs",
        "kufe validate",
        &["runs", "left_out_as_fitted"],
    ),
    known(
        "simulation.json",
        "simulated runs",
        "kufe simulate",
        &["runs", "times_real_time"],
    ),
    known(
        "simulation.json",
        "a replay of a measured run",
        "kufe simulate --replay",
        &["replay", "measured"],
    ),
    known(
        "icehouse.json",
        "gliding runs in an ice house",
        "kufe icehouse",
        &["specimens", "uphill"],
    ),
    known(
        "check.json",
        "an examination of runs",
        "kufe runs check",
        &["index", "wrong", "runs"],
    ),
    known(
        "align.json",
        "runs on one distance along their track",
        "kufe runs align",
        &["index", "tracks"],
    ),
    known(
        "import.json",
        "imported runs",
        "kufe runs import",
        &["mapping", "files", "runs"],
    ),
    known(
        "truth.json",
        "sample runs, and what is hidden in them",
        "kufe simulate --sample-data",
        &["seed", "drivers", "runs"],
    ),
    known(
        "quality.json",
        "what a mesh is like",
        "kufe mesh",
        &["ice", "version"],
    ),
    known(
        "plan.json",
        "the plan of a table",
        "kufe lut plan",
        &["shards", "points", "origin"],
    ),
    known(
        "import.json",
        "what was done to an imported run",
        "kufe runs import",
        &["mapping_sha256", "channels"],
    ),
    known(
        "",
        "a schema by which editors check a file of keys",
        "kufe init, kufe schema",
        &["type", "properties"],
    ),
];

/// Which kind a document is.
pub fn known_as(document: &Value) -> Option<&'static Known> {
    let keys = match document {
        Value::Array(rows) => rows.first()?,
        other => other,
    };
    let keys = keys.as_object()?;
    let fits = |known: &&Known| known.keys.iter().all(|key| keys.contains_key(*key));
    DOCUMENTS.iter().find(fits)
}

/// Leaves out the steel's constants of runners that are rigid, wherever a case stands in it: nothing comes of them.
pub fn without_idle_steel(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            if fields.get("elastic") == Some(&json!(false)) {
                fields.shift_remove("youngs_modulus_pa");
                fields.shift_remove("poissons_ratio");
            }
            fields.values_mut().for_each(without_idle_steel);
        }
        Value::Array(values) => values.iter_mut().for_each(without_idle_steel),
        _ => {}
    }
}

/// Its figures: numbers, words and flags as they are, of a list how long it is, of what is nested what it holds and values with
/// their intervals; the case as it stands.
pub fn figures(document: &Value) -> Map<String, Value> {
    if let Value::Array(rows) = document {
        return Map::from_iter([("rows".to_owned(), json!(rows.len()))]);
    }
    let figure = |(key, value): (&String, &Value)| {
        let shown = match value {
            Value::Array(list) if list.len() <= 3 && list.iter().all(is_single) => value.clone(),
            Value::Array(list) if key == "warnings" || key == "remarks" => json!(list),
            Value::Array(list) => json!(entries(list.len())),
            Value::Object(inner) if key != "case" => {
                let told = |value: &Value| is_single(value) || value.get("value").is_some();
                let told = inner.iter().filter(|(_, value)| told(value));
                let told: Map<String, Value> = told
                    .map(|(key, value)| (key.clone(), value.clone()))
                    .collect();
                match told.is_empty() {
                    true => json!(entries(inner.len())),
                    false => told.into(),
                }
            }
            other => other.clone(),
        };
        (key.clone(), shown)
    };
    let entries = document.as_object().into_iter().flatten();
    entries
        .map(figure)
        .filter(|(key, _)| !["version", "content_sha256", "files"].contains(&&**key))
        .collect()
}

fn entries(count: usize) -> String {
    match count {
        1 => "1 entry".to_owned(),
        count => format!("{count} entries"),
    }
}

fn is_single(value: &Value) -> bool {
    !value.is_array() && !value.is_object()
}
