//! `kufe runs import`: recordings of other programs brought into kufe's form.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_sled::{RunFormat, file_stem, run_file, write_run};
use kufe_telemetry::{
    ExcludedRun, Importer, Note, Plan, PlannedRun, RunFormatWord, index_csv, model_fragment, plan,
};
use rayon::prelude::*;
use serde::Serialize;

use crate::output::OutputDir;
use crate::terminal::{Global, note};

const EXAMPLES: &str = "\
Examples:
  kufe runs init raw/monday_01.csv -o mapping.toml     guess a mapping; answer its questions
  kufe runs import mapping.toml -o runs/               runs.csv and one file a run

A mapping names the files of each logger and what each column is made of:
  rate_hz = 100
  [logger.box]
  files = \"raw/*.csv\"                # the * is the run's name
  time = \"Time\"
  [channels]
  v_mps = { from = \"GPS Speed\", unit = \"km/h\" }
  ay_mps2 = { from = \"Lateral Acc\", unit = \"g\", sign = -1 }
  [index]
  track = \"igls\"                     # and driver, driver_class, session, ice_c, air_c, air_pa

Faster channels go through a low pass at 0.4 of the rate, slower ones are interpolated, gaps stay gaps. Several loggers are
brought to one clock by what their channels share. RUN.import.json describes how each run was made. A run that cannot be
imported is excluded with its reason, and the command ends with 5.";

/// The list of an import's runs and files.
const LIST: &str = "import.json";

/// Arguments of `kufe runs import`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
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

/// `import.json`: what was imported.
#[derive(Serialize)]
struct ImportList {
    mapping: String,
    version: &'static str,
    /// Files of the folder.
    files: Vec<String>,
    runs: Vec<RunSummary>,
    excluded: Vec<ExcludedRun>,
}

#[derive(Serialize)]
struct RunSummary {
    run: String,
    seconds: f64,
    /// Samples by channel.
    samples: BTreeMap<String, SampleCount>,
    /// Rows without a value by channel.
    missing_rows: BTreeMap<String, usize>,
    /// Delays that were found by logger.
    delays: BTreeMap<String, DelaySummary>,
    remarks: Vec<String>,
}

#[derive(Serialize)]
struct SampleCount {
    expected: usize,
    read: usize,
}

#[derive(Serialize)]
struct DelaySummary {
    delay_s: f64,
    delay_sd_s: Option<f64>,
    delay_includes: Option<&'static str>,
}

/// Reads, converts, resamples and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file, channel, row, value and what was expected; [`Failure::Partial`]
/// where some runs are excluded.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let file = args.mapping.display().to_string();
    let text = kufe_files::text_of_regular(&args.mapping, 1 << 24)
        .map_err(|error| Failure::BadInput(format!("{file}: {error}")))?;
    let importer = Importer::new(&text, &file).map_err(Failure::bad_input)?;
    let folder = args.mapping.parent().unwrap_or(Path::new(""));
    let Plan { runs, mut excluded } =
        plan(importer.mapping(), folder, &file).map_err(Failure::bad_input)?;
    if let Some(first) = excluded.first().filter(|_| args.strict) {
        return Err(Failure::BadInput(first.reason.clone()));
    }
    let count = runs.len() + excluded.len();
    let format = match importer.mapping().format {
        RunFormatWord::Csv => RunFormat::Csv,
        RunFormatWord::Parquet => RunFormat::Parquet,
    };
    let fragment = model_fragment(importer.mapping(), &file).map_err(Failure::bad_input)?;
    let table = importer.mapping().index.table.as_deref();
    let output = begin(args, table, folder, &runs, global)?;
    let written: Vec<_> = global.during("importing the runs", || {
        let written = runs.par_iter();
        let written = written.map(|run| write(&importer, run, format, &output));
        written.collect()
    });
    let (mut notes, mut imported) = (Vec::new(), Vec::new());
    for (run, written) in runs.into_iter().zip(written) {
        match written? {
            Ok(note) => {
                notes.push(note);
                imported.push(run);
            }
            Err(reason) if args.strict => return Err(Failure::BadInput(reason)),
            Err(reason) => excluded.push(ExcludedRun {
                run: run.name,
                reason,
            }),
        }
    }
    if imported.is_empty() {
        let first = excluded.into_iter().next().map(|run| run.reason);
        return Err(Failure::BadInput(first.unwrap_or_default()));
    }
    let index = index_csv(&imported, format.extension()).map_err(Failure::bad_input)?;
    output.write("runs.csv", |mut file| file.write_all(&index))?;
    if let Some(fragment) = &fragment {
        output.text("model.import.toml", fragment)?;
    }
    let list = ImportList {
        mapping: file,
        version: env!("CARGO_PKG_VERSION"),
        files: names_of(&imported, format, fragment.is_some()),
        runs: notes.iter().map(RunSummary::of).collect(),
        excluded,
    };
    output.json(LIST, &list)?;
    output.commit()?;
    report(args, global, &list, &notes)?;
    if list.excluded.is_empty() {
        return Ok(());
    }
    let names: Vec<&str> = list.excluded.iter().map(|run| run.run.as_str()).collect();
    Err(Failure::Partial(format!(
        "{} of {count} runs are not imported: {}",
        names.len(),
        names.join(", ")
    )))
}

/// The file that describes how a run was made.
fn note_file(run: &str) -> String {
    format!("{}.import.json", file_stem(run))
}

/// The files of an import.
fn names_of(runs: &[PlannedRun], format: RunFormat, fragment: bool) -> Vec<String> {
    let mut names = vec!["runs.csv".to_string(), LIST.to_string()];
    names.extend(fragment.then(|| "model.import.toml".to_string()));
    for run in runs {
        names.push(run_file(&run.name, format));
        names.push(note_file(&run.name));
    }
    names
}

/// The output folder.
fn begin(
    args: &Args,
    table: Option<&Path>,
    folder: &Path,
    runs: &[PlannedRun],
    global: &Global,
) -> Result<OutputDir, Failure> {
    let mut inputs = vec![args.mapping.clone()];
    inputs.extend(table.map(|table| folder.join(table)));
    inputs.extend(runs.iter().flat_map(|run| run.files.values().cloned()));
    OutputDir::begin("runs import", &inputs, &args.out, global.force)
}

/// Imports one run and writes its files; the reason where it cannot be imported.
///
/// # Errors
/// [`Failure::BadInput`] where a file cannot be written.
fn write(
    importer: &Importer,
    planned: &PlannedRun,
    format: RunFormat,
    output: &OutputDir,
) -> Result<Result<Note, String>, Failure> {
    let imported = match importer.run(planned) {
        Ok(imported) => imported,
        Err(error) => return Ok(Err(error.to_string())),
    };
    output.write(&run_file(&planned.name, format), |mut file| {
        write_run(&imported.run, &mut file, format)
    })?;
    output.json(&note_file(&planned.name), &imported.note)?;
    Ok(Ok(imported.note))
}

impl RunSummary {
    fn of(note: &Note) -> RunSummary {
        let channels = || note.channels.iter();
        let missing = channels().filter(|(_, channel)| channel.missing_rows > 0);
        let found = note
            .loggers
            .iter()
            .filter(|(_, l)| l.clock.source == "found");
        RunSummary {
            run: note.run.clone(),
            seconds: note.rows as f64 / note.rate_hz,
            samples: channels()
                .map(|(name, channel)| {
                    let count = SampleCount {
                        expected: channel.expected_samples,
                        read: channel.samples,
                    };
                    (name.clone(), count)
                })
                .collect(),
            missing_rows: missing
                .map(|(name, channel)| (name.clone(), channel.missing_rows))
                .collect(),
            delays: found
                .map(|(name, logger)| {
                    let summary = DelaySummary {
                        delay_s: logger.clock.delay_s,
                        delay_sd_s: logger.clock.delay_sd_s,
                        delay_includes: logger.clock.delay_includes,
                    };
                    (name.clone(), summary)
                })
                .collect(),
            remarks: note.remarks.clone(),
        }
    }
}

fn report(args: &Args, global: &Global, list: &ImportList, notes: &[Note]) -> Result<(), Failure> {
    for remark in notes
        .iter()
        .flat_map(|note| &note.remarks)
        .filter(|_| !global.quiet)
    {
        note(&format!("note: {remark}"));
    }
    for run in &list.excluded {
        note(&format!("run {} is not imported: {}", run.run, run.reason));
    }
    global.print(list, || {
        let files = list.files.len() - 1;
        text(list, notes) + &format!("{}: runs.csv and {files} more files\n", args.out.display())
    })
}

fn text(list: &ImportList, notes: &[Note]) -> String {
    let seconds: f64 = list.runs.iter().map(|run| run.seconds).sum();
    let columns = notes.first().map_or(0, |note| note.channels.len());
    let rate = notes.first().map_or(0.0, |note| note.rate_hz);
    let mut text = format!(
        "{} runs, {seconds:.0} s at {rate} Hz, {columns} columns\n",
        notes.len()
    );
    let counts = || list.runs.iter().flat_map(|run| run.samples.values());
    let (expected, read) = counts().fold((0, 0), |(expected, read), count| {
        (expected + count.expected, read + count.read)
    });
    if read < expected {
        text += &format!("{read} of {expected} samples have a value\n");
    }
    let missing = |run: &RunSummary| run.missing_rows.values().sum::<usize>();
    let runs = list.runs.iter().filter(|run| missing(run) > 0).count();
    if runs > 0 {
        let values: usize = list.runs.iter().map(missing).sum();
        text += &format!(
            "{values} values are missing, in {runs} runs: their places are in RUN.import.json\n"
        );
    }
    let loggers = notes.iter().flat_map(|note| &note.loggers);
    for (name, logger) in loggers.filter(|(_, l)| l.clock.source == "found").take(12) {
        text += &format!(
            "{}: the clock of {name} is {:+.4} s late, within {:.4} s, the lag of its sensors included\n",
            logger.file,
            logger.clock.delay_s,
            logger.clock.delay_sd_s.unwrap_or(0.0)
        );
    }
    text
}
