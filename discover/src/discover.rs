//! From a data file to a report, by what the file holds.

use std::path::Path;

use crate::evidence::{experiments, maps, runs};

use crate::error::Error;
use crate::input::table::Table;
use crate::options::Options;
use crate::procedure::search::Found;

/// What the three kinds of data are usually called.
const FILES: [&str; 3] = ["runs.csv", "experiments.csv", "pressures.csv"];

/// Reads data and model, searches, and returns the report and the next model's text.
///
/// The kind of data is told by its columns: `run` (runs), `mu` (friction experiments), `case` (pressure measurements).
///
/// # Errors
/// Those of the readers, [`Error::File`] for a folder and for a table of none of the three kinds, and of the search.
pub fn discover(
    data: &Path,
    model: &Path,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Found, Error> {
    if data.is_dir() {
        let held = FILES.iter().filter(|name| data.join(name).is_file());
        let held: Vec<String> = held
            .map(|name| data.join(name).display().to_string())
            .collect();
        return Err(Error::File {
            file: data.display().to_string(),
            reason: match held.is_empty() {
                true => format!("a folder; expected a file like {}", FILES.join(", ")),
                false => format!("a folder; expected a file, such as {}", held.join(" or ")),
            },
        });
    }
    let table = Table::read(data)?;
    let has = |name: &str| table.place(name).is_some();
    if has("run") && has("file") {
        let model = kufe_sled::Model::load(model)?;
        progress("reading runs");
        let data = runs::read(data, &model, options)?;
        return runs::search(&data, &model, options, progress);
    }
    if has("mu") {
        let model = kufe_sled::Model::load(model)?;
        return experiments::search(data, &model, options, progress);
    }
    if has("case") {
        return maps::search(data, model, options, progress);
    }
    Err(Error::File {
        file: data.display().to_string(),
        reason: format!(
            "columns {}; expected those of runs.csv (run, file, ...), experiments.csv (specimen, p_max_pa, mu, ...) or pressures.csv (case, fz_n, ...)",
            table.header.join(", ")
        ),
    })
}
