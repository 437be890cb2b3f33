//! `kufe runs check`: faults and anomalies of recorded runs, with remedies.

use std::path::PathBuf;

use kufe::charts::odd_curves;
use kufe::jobs::Failure;
use kufe::jobs::runs::run_inputs;
use kufe::report::{record_page, run_findings};
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
    output.bytes("check.html", &page)?;
    output.finish("check.json", &check, global, || summary(&check.runs))?;
    if check.wrong == 0 {
        return Ok(());
    }
    let (wrong, count, page) = (check.wrong, check.runs.len(), args.out.join("check.html"));
    let page = page.display();
    let reason = format!("{wrong} of {count} runs are provably wrong: see {page}");
    Err(Failure::in_file(&args.runs, reason))
}

/// Every finding once with its runs; findings of small weight are omitted.
fn summary(runs: &[Examination]) -> String {
    const MAX_NAMES: usize = 6;
    const MIN_WEIGHT: f64 = 0.05;
    let mut text = String::new();
    for finding in run_findings(runs) {
        if finding.weight < MIN_WEIGHT {
            continue;
        }
        let names = finding.runs.iter().map(|k| runs[*k].run.as_str());
        let shown = names.take(MAX_NAMES).collect::<Vec<_>>().join(", ");
        let more = match finding.runs.len().saturating_sub(MAX_NAMES) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let todo = match finding.mend {
            "" => String::new(),
            mend => format!("; to do: {mend}"),
        };
        let (class, head, what) = (finding.class, finding.head, finding.what);
        text += &format!("{class:5}  {head}: {what}{todo}  ({shown}{more})\n");
    }
    let good = runs.iter().filter(|run| !run.is_wrong()).count();
    let count = runs.len();
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
            faults: vec![doubt("-0.68 times"), doubt("-0.71 times")],
            ..Examination::default()
        };
        let text = summary(&[run]);
        assert_eq!(text.matches("  (a)\n").count(), 1, "{text}");
    }
}
