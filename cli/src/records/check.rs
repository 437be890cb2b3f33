//! `kufe runs check`: what is provably wrong in recorded runs, what is odd, and what to do about
//! it.

use std::path::PathBuf;

use kufe::charts::odd_curves;
use kufe::jobs::Failure;
use kufe::jobs::runs::run_inputs;
use kufe::report::record_page;
use kufe::results::RunCheck;
use kufe_sled::{Error, Examination, Run, examine};
use rayon::prelude::*;

use crate::output::OutputDir;
use crate::runs::{all_runs, write_view};
use crate::terminal::Global;

/// Arguments of `kufe runs check`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Index of the runs
    pub runs: PathBuf,
    /// Folder for check.json and check.html
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Write view.html too, the page of kufe runs view with these runs: check.html links into it
    #[arg(long)]
    pub view: bool,
}

/// Examines and writes.
///
/// # Errors
/// [`Failure::BadInput`] for the index, and, once the report is written, where something is
/// provably wrong.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let inputs = run_inputs(&args.runs);
    let output = OutputDir::begin("runs check", &inputs, &args.out, global.force)?;
    let examined = global.during("examining the runs", || {
        let curves = |(one, run): (Examination, Option<Run>)| {
            let curves = run.map_or_else(Vec::new, |run| odd_curves(&one, &run));
            (one, curves)
        };
        Ok::<_, Error>(examine(&args.runs)?.into_par_iter().map(curves).unzip())
    });
    let (runs, curves): (Vec<_>, Vec<_>) = examined?;
    let check = RunCheck::new(args.runs.display().to_string(), runs);
    let viewed = args.view.then(|| all_runs(args.runs.clone()));
    let viewer = write_view(&output, viewed, global)?;
    let page = record_page(&check, &curves, viewer);
    output.text("check.html", &page)?;
    output.finish("check.json", &check, global, || summary(&check.runs))?;
    if check.wrong == 0 {
        return Ok(());
    }
    let (wrong, count, page) = (check.wrong, check.runs.len(), args.out.join("check.html"));
    let page = page.display();
    let reason = format!("{wrong} of {count} runs are provably wrong: see {page}");
    Err(Failure::in_file(&args.runs, reason))
}

/// What is wrong, each kind once with its runs, and the worst of what is odd.
fn summary(runs: &[Examination]) -> String {
    const MOST_NAMES: usize = 6;
    let mut lines: Vec<(String, Vec<&str>)> = Vec::new();
    for run in runs {
        let refused = run.refused.iter().map(|reason| format!("wrong  {reason}"));
        let faults = run.faults.iter().map(|fault| {
            let certain = if fault.proven { "wrong" } else { "doubt" };
            let (columns, like, mend) = (fault.columns.join(", "), &fault.looks_like, &fault.mend);
            format!("{certain}  {columns}: {like}; in a mapping: {mend}")
        });
        let notes = run.notes.iter().filter(|note| note.weight >= 0.05);
        let notes = notes.map(|note| match &*note.column {
            "" => format!("odd    rows: {}", note.what),
            column => format!("odd    {column}: {}", note.what),
        });
        for line in refused.chain(faults).chain(notes) {
            match lines.iter_mut().find(|(known, _)| *known == line) {
                Some((_, names)) if names.last() == Some(&run.run.as_str()) => {}
                Some((_, names)) => names.push(&run.run),
                None => lines.push((line, vec![&run.run])),
            }
        }
    }
    let mut text = String::new();
    for (line, names) in lines {
        let shown = names[..names.len().min(MOST_NAMES)].join(", ");
        let more = match names.len().saturating_sub(MOST_NAMES) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        text += &format!("{line}  ({shown}{more})\n");
    }
    let (good, count) = (
        runs.iter().filter(|run| !run.is_wrong()).count(),
        runs.len(),
    );
    text + &format!("{good} of {count} runs show nothing that is provably wrong\n")
}

#[cfg(test)]
mod tests {
    use kufe_sled::{Fault, FaultKind};

    use super::*;

    #[test]
    fn a_run_with_two_doubts_of_one_kind_is_named_once() {
        let doubt = |evidence: &str| Fault {
            run: "a".into(),
            file: "a.csv".into(),
            columns: vec!["ax_mps2".into()],
            kind: FaultKind::Sign,
            proven: false,
            looks_like: "the other sign".into(),
            evidence: evidence.into(),
            mend: "sign = -1 for ax_mps2".into(),
        };
        let run = Examination {
            run: "a".into(),
            faults: vec![doubt("rigid body"), doubt("air")],
            ..Examination::default()
        };
        let text = summary(&[run]);
        assert!(text.contains("  (a)\n"), "{text}");
    }
}
