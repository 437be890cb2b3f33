//! What an output folder holds from earlier runs, and what of it goes: only files that `kufe` wrote.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use serde::Deserialize;

use crate::output::held::Held;
use crate::report::read_json;

/// Most bytes of a series' table.json.
const LONGEST_TABLE: u64 = 1 << 28;

/// The files in `folder` that an earlier `kufe press` wrote there and that are as it wrote them.
fn contact_files(folder: &Path) -> Vec<PathBuf> {
    Held::of(folder).written_with("result.json")
}

/// The folders of the steps of the series in `folder`; `None` where it holds none.
pub fn series_steps(folder: &Path) -> Option<Vec<String>> {
    #[derive(Deserialize)]
    struct Row {
        #[serde(rename = "step")]
        _step: u64,
        folder: String,
    }
    let table: Vec<Row> = read_json(&folder.join("table.json"), LONGEST_TABLE).ok()?;
    let step = |row: Row| {
        let digits = row.folder.strip_prefix("step-")?;
        let plain = digits.bytes().all(|byte| byte.is_ascii_digit());
        plain.then_some(row.folder)
    };
    table.into_iter().map(step).collect()
}

/// Refuses a folder that holds a series for a single contact: its steps would stand beside another result.
///
/// # Errors
/// [`Failure::BadInput`] with the folder.
pub fn no_series(folder: &Path) -> Result<(), Failure> {
    match series_steps(folder) {
        None => Ok(()),
        Some(steps) => Err(Failure::BadInput(format!(
            "{}: holds a series of {} steps (table.json): expected another folder for a single contact",
            folder.display(),
            steps.len()
        ))),
    }
}

/// Refuses a folder for a series where results of another command stand, or files of a series' names that kufe did not write.
///
/// # Errors
/// As [`Held::check`].
pub fn no_others(folder: &Path, inputs: &[PathBuf], overview: &[&str]) -> Result<(), Failure> {
    // A single contact's files go.
    let names = [overview, &["result.json"]].concat();
    Held::of(folder).check(inputs, &names)
}

/// Removes what an earlier series left in `folder`: steps that are not among `steps`, and a single contact's files.
///
/// # Errors
/// [`Failure::BadInput`] with the file that cannot be removed.
pub fn clear_before_series(folder: &Path, steps: &[&str]) -> Result<(), Failure> {
    let mut gone = contact_files(folder);
    let before = series_steps(folder).unwrap_or_default();
    let left: Vec<PathBuf> = before
        .iter()
        .filter(|name| !steps.contains(&name.as_str()))
        .map(|name| folder.join(name))
        .collect();
    gone.extend(left.iter().flat_map(|step| contact_files(step)));
    if !before.is_empty() {
        let lists = ["series.pvd", "runner.pvd"].map(|name| folder.join(name));
        gone.extend(lists.into_iter().filter(|path| path.is_file()));
    }
    for file in &gone {
        std::fs::remove_file(file).map_err(|error| {
            Failure::BadInput(format!("{}: cannot be removed: {error}", file.display()))
        })?;
    }
    for step in &left {
        // Where something else stands in it, it stays.
        let _ = std::fs::remove_dir(step);
    }
    Ok(())
}
