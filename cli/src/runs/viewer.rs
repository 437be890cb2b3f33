//! The viewer of runs in the folder of another command.

use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::view_runs::{ViewOptions, ViewedRuns, view_runs};
use kufe::report::{Kind, RunsPage, VIEWER, page};

use crate::output::OutputDir;
use crate::terminal::{Global, warn};

/// All runs of an index without a model, in a page of the usual size.
pub fn all_runs(runs: PathBuf) -> ViewOptions {
    ViewOptions {
        runs,
        model: None,
        track: None,
        only: Vec::new(),
        most_values: RunsPage::MOST_VALUES,
    }
}

/// The page; runs that it does not show are warned of.
pub fn viewer_page(viewed: ViewedRuns) -> String {
    for [run, reason] in &viewed.left_out {
        warn(&format!("run {run} is not shown: {reason}"));
    }
    let title = format!("Runs of {}", viewed.index);
    page(Kind::Runs, &title, &RunsPage::new(viewed))
}

/// Writes the page into the folder of another command, whose page links to it; its address from
/// there. A failure is a warning: the results of the command are more than the view of its runs.
///
/// # Errors
/// [`Failure::BadInput`] where the file cannot be written.
pub fn write_view(
    output: &OutputDir,
    options: &ViewOptions,
    global: &Global,
) -> Result<Option<&'static str>, Failure> {
    match global.watched(|watch| view_runs(options, watch)) {
        Ok(viewed) => {
            output.text(VIEWER, &viewer_page(viewed))?;
            Ok(Some(VIEWER))
        }
        Err(failure) => {
            warn(&format!("{VIEWER} is not written: {failure}"));
            Ok(None)
        }
    }
}
