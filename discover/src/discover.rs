//! Searches a data file and returns a report; the kind of data follows from the file's columns.

use std::path::Path;

use crate::evidence::{experiments, maps, runs};

use crate::error::{Error, Result};
use crate::input::table::Table;
use crate::joint::search as joint;
use crate::options::Options;
use crate::procedure::search::Found;

/// Usual file names of the three kinds of data.
const FILES: [&str; 3] = ["runs.csv", "experiments.csv", "pressures.csv"];

/// Reads data and model, searches, and returns the report and the next model's text.
///
/// The kind of data is determined by its columns: `run` (runs), `mu` (friction experiments), `case`
/// (pressure measurements). A `campaign.toml` names several and their model; tables need one as
/// well.
///
/// # Errors
/// Errors of the readers and the search; [`Error::File`] for a folder, an unknown table or a
/// missing model.
pub fn discover(
    data: &Path,
    model: Option<&Path>,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Found> {
    let refused = |reason: String| Err(Error::file(data, reason));
    if data.is_dir() {
        let files = FILES.iter().map(|name| data.join(name));
        let present = files.filter(|file| file.is_file());
        let present: Vec<String> = present.map(|file| file.display().to_string()).collect();
        return refused(if present.is_empty() {
            format!("a folder; expected a file like {}", FILES.join(", "))
        } else {
            format!(
                "a folder; expected a file, such as {}",
                present.join(" or ")
            )
        });
    }
    if data.extension().is_some_and(|ending| ending == "toml") {
        return match model {
            None => joint::search(data, options, progress),
            Some(model) => refused(format!(
                "a campaign names its own model; {} is given as well",
                model.display()
            )),
        };
    }
    let Some(model) = model else {
        return refused(
            "a table without a model; expected a model as well, or a campaign.toml that names both"
                .to_owned(),
        );
    };
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
    refused(format!(
        "columns {}; expected those of runs.csv (run, file, ...), experiments.csv (specimen, p_max_pa, mu, ...) or pressures.csv (case, fz_n, ...)",
        table.header.join(", ")
    ))
}
