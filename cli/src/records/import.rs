//! `kufe runs import`: recordings of other programs brought into kufe's form.

use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::import::{ImportedRuns, RunImport};
use kufe::results::{ImportList, ImportedRun};
use kufe_telemetry::Note;

use crate::output::OutputDir;
use crate::terminal::{Global, note};

/// Arguments of `kufe runs import`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The mapping: the files of the runs, and the names of their channels
    pub mapping: PathBuf,
    /// Folder for runs.csv and one file a run
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
    let imported = global.watched(|watch| import.write(output.files(), watch))?;
    output.commit()?;
    report(args, global, &imported)?;
    imported.shortfall().map_or(Ok(()), Err)
}

/// Most notes and clocks that are listed; the files of the runs have them all.
const LISTED: usize = 12;

fn report(args: &Args, global: &Global, imported: &ImportedRuns) -> Result<(), Failure> {
    let ImportedRuns { list, notes } = imported;
    let mut remarks: Vec<(&str, usize)> = Vec::new();
    for remark in notes.iter().flat_map(|note| &note.remarks) {
        match remarks.iter_mut().find(|(text, _)| text == remark) {
            Some((_, count)) => *count += 1,
            None => remarks.push((remark, 1)),
        }
    }
    for (remark, count) in remarks.iter().take(LISTED).filter(|_| !global.quiet) {
        let runs = if *count > 1 {
            format!(" (in {count} runs)")
        } else {
            String::new()
        };
        note(&format!("note: {remark}{runs}"));
    }
    if remarks.len() > LISTED && !global.quiet {
        let more = remarks.len() - LISTED;
        note(&format!("note: {more} more notes are in RUN.import.json"));
    }
    for run in &list.excluded {
        note(&format!("run {} is not imported: {}", run.run, run.reason));
    }
    global.print(list, || {
        let (out, files) = (args.out.display(), list.files.len() - 1);
        text(list, notes) + &format!("{out}: runs.csv and {files} more files\n")
    })
}

fn text(list: &ImportList, notes: &[Note]) -> String {
    let seconds: f64 = list.runs.iter().map(|run| run.seconds).sum();
    let first = notes.first();
    let (columns, rate) = first.map_or((0, 0.0), |note| (note.channels.len(), note.rate_hz));
    let runs = notes.len();
    let mut text = format!("{runs} runs, {seconds:.0} s at {rate} Hz, {columns} columns\n");
    let counts = || list.runs.iter().flat_map(|run| run.samples.values());
    let expected: usize = counts().map(|count| count.expected).sum();
    let read: usize = counts().map(|count| count.read).sum();
    if read < expected {
        text += &format!("{read} of {expected} samples have a value\n");
    }
    let missing = |run: &ImportedRun| run.missing_rows.values().sum::<usize>();
    let missing: Vec<usize> = list
        .runs
        .iter()
        .map(missing)
        .filter(|count| *count > 0)
        .collect();
    if !missing.is_empty() {
        let (values, runs) = (missing.iter().sum::<usize>(), missing.len());
        text += &format!(
            "{values} values are missing, in {runs} runs: their places are in RUN.import.json\n"
        );
    }
    let loggers = notes.iter().flat_map(|note| &note.loggers);
    let found: Vec<_> = loggers.filter(|(_, l)| l.clock.source == "found").collect();
    for (name, logger) in found.iter().take(LISTED) {
        let (file, delay) = (&logger.file, logger.clock.delay_s);
        let sd = logger.clock.delay_sd_s.unwrap_or(0.0);
        text += &format!(
            "{file}: the clock of {name} is {delay:+.4} s late, within {sd:.4} s, the lag of its sensors included\n"
        );
    }
    if found.len() > LISTED {
        let more = found.len() - LISTED;
        text += &format!("{more} more clocks are in RUN.import.json\n");
    }
    text
}
