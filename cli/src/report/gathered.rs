//! The page of a folder that holds runs and nothing else: an index, as `kufe runs gather` writes it.

use std::path::Path;

use kufe::jobs::{Failure, runs::failure};
use kufe::report::results_page;
use kufe_sled::{Entry, read_index};
use serde_json::{Value, json};

use crate::records::UNNAMED;
use crate::report::folder_name::folder_name;

/// The file that lists runs.
pub const INDEX: &str = "runs.csv";

/// The page of the runs that the folder's index lists: of how many sessions, tracks and drivers, and each of them.
pub fn page(folder: &Path) -> Result<String, Failure> {
    let entries = read_index(&folder.join(INDEX)).map_err(|error| failure(&error))?;
    let row = |entry: &Entry| {
        let at = &entry.conditions;
        let file = entry.file.strip_prefix(folder).unwrap_or(&entry.file);
        json!({
            "run": entry.run,
            "track": stated(&entry.track),
            "driver": stated(&entry.driver),
            "driver_class": stated(&entry.driver_class),
            "session": stated(&entry.session),
            "ice_c": at.ice_c,
            "air_c": at.air_c,
            "air_pa": at.air_pa,
            "humidity_pct": at.humidity_pct,
            "mass_kg": at.mass_kg,
            "file": file.display().to_string(),
            "missing": (!entry.file.is_file()).then_some("there is no such file"),
        })
    };
    let count = entries.len();
    let plural = if count == 1 { "" } else { "s" };
    let title = format!("{}: {count} run{plural}", folder_name(folder));
    let documents = [
        (
            "sessions".to_owned(),
            counted(&entries, "session", |entry| &entry.session),
        ),
        (
            "tracks".to_owned(),
            counted(&entries, "track", |entry| &entry.track),
        ),
        (
            "drivers".to_owned(),
            counted(&entries, "driver", |entry| &entry.driver),
        ),
        ("every run".to_owned(), entries.iter().map(row).collect()),
    ];
    Ok(results_page(&title, &[], &documents))
}

/// What an index states; nothing where it says that it does not.
fn stated(name: &str) -> Option<&str> {
    (name != UNNAMED).then_some(name)
}

/// Names in the order in which they come, each with how many runs have it.
fn counted(entries: &[Entry], key: &str, of: fn(&Entry) -> &String) -> Value {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for entry in entries {
        let name = of(entry).as_str();
        match counts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count += 1,
            None => counts.push((name, 1)),
        }
    }
    let rows = counts
        .iter()
        .map(|(name, count)| json!({ key: name, "runs": count }));
    rows.collect()
}
