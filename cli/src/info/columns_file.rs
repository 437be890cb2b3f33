//! What a table of columns holds: an index, a run, a track, figures.

use std::collections::BTreeSet;
use std::path::Path;

use kufe::jobs::{Failure, runs::failure};
use kufe_sled::{Columns, Entry, read_columns, read_index};
use serde_json::{Map, Value, json};

/// What columns tell of a file: those that it must have, what it is then, and the command that writes it, where one does.
const KINDS: [(&[&str], &str, &str); 14] = [
    (
        &["t_s", "v_mps", "yaw_rate_radps"],
        "a run",
        "kufe runs import, kufe simulate",
    ),
    (&["t_s", "v_mps"], "a run, or a glide", ""),
    (
        &["s_m", "slope_rad", "curvature_1pm"],
        "a track",
        "kufe runs align, kufe simulate",
    ),
    (
        &["step", "folder", "p_max_pa"],
        "a series of contacts",
        "kufe press",
    ),
    (
        &["case", "ice_c", "v_mps", "mu"],
        "friction over speed and temperature",
        "kufe friction",
    ),
    (
        &["mu", "mu_error", "mu_ploughing"],
        "friction of varied runners",
        "kufe friction --optimise",
    ),
    (
        &["x_m", "width_m", "pressure_pa", "film_m"],
        "a melt film from the front",
        "kufe press",
    ),
    (
        &["depth_m", "sigma_zz_pa", "max_shear_pa"],
        "stress under the peak",
        "kufe press --subsurface",
    ),
    (
        &["fz_n", "curvature_1pm", "p_max_pa"],
        "a lookup table",
        "kufe lut --csv",
    ),
    (
        &["run", "driver", "increase_total"],
        "an evaluation of drivers",
        "kufe evaluate",
    ),
    (&["specimen", "mu"], "friction experiments", "kufe icehouse"),
    (&["case", "fz_n", "p_max_pa"], "pressure measurements", ""),
    (&["x_m", "y_m", "z_m"], "a measured surface of ice", ""),
    (&["y_m", "z_m"], "a measured section", ""),
];

/// Columns that tell glides from runs in an index of them.
const OF_GLIDES: [&str; 2] = ["direction", "specimen"];

/// What it is, and from where to where each column goes; of an index its runs.
pub fn describe(path: &Path) -> Result<Value, Failure> {
    let header = header(path)?;
    let has = |name: &&str| header.iter().any(|column| column == name);
    if ["run", "file"].iter().all(has) && !OF_GLIDES.iter().all(has) {
        let entries = read_index(path).map_err(|error| failure(&error))?;
        return Ok(index(&entries));
    }
    let columns = read_columns(path, &[]).map_err(|error| failure(&error))?;
    let has =
        |name: &&str| header.iter().any(|column| column == name) || columns.contains_key(*name);
    let glides = ["run", "file"].iter().chain(&OF_GLIDES).all(has);
    let kind = KINDS.iter().find(|(needed, ..)| needed.iter().all(has));
    let (kind, command) = match kind {
        _ if glides => ("an index of glides", ""),
        Some((_, kind, command)) => (*kind, *command),
        None => {
            return Err(Failure::BadInput(format!(
                "{}: a table that is not known, its columns {}: expected a run (t_s, v_mps, ...), an index (run, file, ...), a track \
                 (s_m, slope_rad, ...), or a table that a command writes",
                path.display(),
                shortened(&header)
            )));
        }
    };
    let mut facts = Map::new();
    facts.insert("kind".into(), json!(kind));
    if !command.is_empty() {
        facts.insert("written_by".into(), json!(command));
    }
    facts.insert(
        "rows".into(),
        json!(columns.values().next().map_or(0, Vec::len)),
    );
    if let Some(times) = columns.get("t_s").filter(|times| times.len() > 1) {
        let (first, last) = (times[0], times[times.len() - 1]);
        facts.insert("duration_s".into(), json!(last - first));
        facts.insert(
            "rate_hz".into(),
            json!((times.len() - 1) as f64 / (last - first)),
        );
    }
    facts.insert("columns".into(), Value::Object(ranges(&columns)));
    Ok(Value::Object(facts))
}

/// The names of the columns of a text; none of another format, whose reader tells them.
fn header(path: &Path) -> Result<Vec<String>, Failure> {
    if path.extension().is_some_and(|ending| ending != "csv") {
        return Ok(Vec::new());
    }
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let file = kufe_files::open_regular(path).map_err(|error| told(error.to_string()))?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(std::io::Read::take(file, 1 << 16));
    let header = reader.headers().map_err(|error| told(error.to_string()))?;
    Ok(header.iter().map(str::to_owned).collect())
}

fn shortened(header: &[String]) -> String {
    const MOST: usize = 8;
    let shown = header
        .iter()
        .take(MOST)
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    match header.len() {
        0 => "none".into(),
        1..=MOST => shown,
        more => format!("{shown} and {} more", more - MOST),
    }
}

fn ranges(columns: &Columns) -> Map<String, Value> {
    let range = |(name, values): (&String, &Vec<f64>)| {
        let there = || values.iter().copied().filter(|value| value.is_finite());
        let missing = values.len() - there().count();
        let mut range = Map::new();
        if missing < values.len() {
            range.insert("from".into(), json!(there().fold(f64::INFINITY, f64::min)));
            range.insert(
                "to".into(),
                json!(there().fold(f64::NEG_INFINITY, f64::max)),
            );
        }
        if missing > 0 {
            range.insert("missing".into(), json!(missing));
        }
        (name.clone(), Value::Object(range))
    };
    columns.iter().map(range).collect()
}

fn index(entries: &[Entry]) -> Value {
    let names = |of: fn(&Entry) -> &str| {
        let each: BTreeSet<&str> = entries.iter().map(of).collect();
        each.into_iter().collect::<Vec<_>>().join(", ")
    };
    let absent: Vec<&str> = entries
        .iter()
        .filter(|entry| !entry.file.is_file())
        .map(|entry| entry.run.as_str())
        .collect();
    json!({
        "kind": "an index of runs",
        "written_by": "kufe runs import, kufe runs gather, kufe simulate",
        "runs": entries.len(),
        "tracks": names(|entry| &entry.track),
        "sessions": names(|entry| &entry.session),
        "drivers": names(|entry| &entry.driver),
        "files_missing": absent,
    })
}
