//! `runs.csv` of imported runs.

use std::collections::BTreeSet;

use kufe_sled::{ICE_AT, INDEX_COLUMNS, MORE_INDEX_COLUMNS};

use crate::error::Error;
use crate::mapping::plan::PlannedRun;

/// The text of `runs.csv`: its usual columns, empty where a run does not state them, and of the others and of the ice's temperatures at places those that a run states.
///
/// # Errors
/// [`Error::File`] of the writer.
pub fn index_csv(runs: &[PlannedRun], ending: &str) -> Result<Vec<u8>, Error> {
    let stated = |name: &&str| runs.iter().any(|run| run.index.cell(name).is_some());
    let more = MORE_INDEX_COLUMNS.into_iter().filter(stated);
    let places: BTreeSet<&String> = runs
        .iter()
        .flat_map(|run| run.index.ice_c_at.keys())
        .collect();
    let sensors: Vec<String> = places
        .iter()
        .map(|place| format!("{ICE_AT}{place}"))
        .collect();
    let sensors = sensors.iter().map(String::as_str);
    let columns: Vec<&str> = INDEX_COLUMNS
        .into_iter()
        .chain(more)
        .chain(sensors)
        .collect();
    let mut table = csv::Writer::from_writer(Vec::new());
    let told = |error: csv::Error| Error::file("runs.csv", error);
    table.write_record(&columns).map_err(told)?;
    for run in runs {
        let mut cells = Vec::new();
        for name in &columns {
            cells.push(match *name {
                "run" => run.name.clone(),
                "file" => format!("{}.{ending}", run.name),
                name => run.index.cell(name).unwrap_or_default().trim().to_string(),
            });
        }
        table.write_record(&cells).map_err(told)?;
    }
    table
        .into_inner()
        .map_err(|error| Error::file("runs.csv", error.error()))
}
