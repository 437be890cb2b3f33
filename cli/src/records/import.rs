//! `kufe runs import`: import of recordings of other programs.

use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::import::{ImportedRuns, RunImport};

use crate::output::{OutputDir, listed};
use crate::terminal::{Global, note};

/// Arguments of `kufe runs import`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The mapping: the files of the runs, and the names of their channels
    pub mapping: PathBuf,
    /// Folder for runs.csv and one file per run
    #[arg(long, short, value_name = "FOLDER")]
    pub out: PathBuf,
    /// Refuse runs with missing files, values or rows, uneven times or standstill, instead of
    /// excluding them
    #[arg(long)]
    pub strict: bool,
}

/// Reads, converts, resamples and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file, channel, row, value and what was expected; [`Failure::Partial`]
/// where some runs are excluded.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let import = RunImport::read(&args.mapping, args.strict)?;
    let output = OutputDir::begin("runs import", &import.inputs(), &args.out, global.force)?;
    let imported = global.watched(|watch| import.write(&output, watch))?;
    let written = output.commit()?;
    for text in notices(&imported, global) {
        note(&text);
    }
    global.print(&imported.list, || {
        text(&imported) + &listed(&args.out, &written)
    })?;
    imported.shortfall().map_or(Ok(()), Err)
}

/// Largest number of notes and clocks that are printed; the files of the runs have all.
const MAX_LISTED: usize = 12;

/// Remarks on the runs, each once, unless the command is quiet, and the excluded runs.
fn notices(ImportedRuns { list, notes }: &ImportedRuns, global: &Global) -> Vec<String> {
    let mut remarks: Vec<(&str, usize)> = Vec::new();
    for remark in notes.iter().flat_map(|note| &note.remarks) {
        match remarks.iter_mut().find(|(text, _)| text == remark) {
            Some((_, count)) => *count += 1,
            None => remarks.push((remark, 1)),
        }
    }
    let mut notices: Vec<String> = Vec::new();
    if !global.quiet {
        let listed = remarks.iter().take(MAX_LISTED);
        notices.extend(listed.map(|(remark, count)| match count {
            1 => format!("note: {remark}"),
            count => format!("note: {remark} (in {count} runs)"),
        }));
        if let more @ 1.. = remarks.len().saturating_sub(MAX_LISTED) {
            notices.push(format!("note: {more} more notes are in RUN.import.json"));
        }
    }
    let excluded = list.excluded.iter();
    notices.extend(excluded.map(|run| format!("run {} is not imported: {}", run.run, run.reason)));
    notices
}

fn text(ImportedRuns { list, notes }: &ImportedRuns) -> String {
    let seconds: f64 = list.runs.iter().map(|run| run.seconds).sum();
    let first = notes.first();
    let (columns, rate) = first.map_or((0, 0.0), |note| (note.channels.len(), note.rate_hz));
    let runs = notes.len();
    let mut text = format!("{runs} runs, {seconds:.0} s at {rate} Hz, {columns} columns\n");
    let counts = || list.runs.iter().flat_map(|run| run.samples.values());
    let expected: usize = counts().map(|count| count.expected).sum();
    let read: usize = counts().map(|count| count.read).sum();
    if read < expected {
        text += &format!("{read} of {expected} samples of the recordings have a value\n");
    }
    let missing = list.runs.iter().map(|run| run.missing_rows.values().sum());
    let missing: Vec<usize> = missing.filter(|count| *count > 0).collect();
    if !missing.is_empty() {
        let (values, runs) = (missing.iter().sum::<usize>(), missing.len());
        text += &format!(
            "{values} values of {runs} runs are missing, next to such gaps included: their places are in RUN.import.json\n"
        );
    }
    let loggers = notes.iter().flat_map(|note| &note.loggers);
    let found: Vec<_> = loggers.filter(|(_, l)| l.clock.source == "found").collect();
    for (name, logger) in found.iter().take(MAX_LISTED) {
        let (file, delay) = (&logger.file, logger.clock.delay_s);
        let sd = logger.clock.delay_sd_s.unwrap_or(0.0);
        text += &format!(
            "{file}: the clock of {name} is {delay:+.4} s late, within {sd:.4} s, the lag of its sensors included\n"
        );
    }
    if found.len() > MAX_LISTED {
        let more = found.len() - MAX_LISTED;
        text += &format!("{more} more clocks are in RUN.import.json\n");
    }
    text
}
