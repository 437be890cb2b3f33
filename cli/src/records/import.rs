//! `kufe runs import`: recordings of other programs brought into kufe's form.

use std::io::Write;
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_sled::{RunFormat, write_run};
use kufe_telemetry::{Importer, Note, PlannedRun, RunFormatWord, index_csv, model_fragment, plan};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::output::global::Global;
use crate::output::say::say;
use crate::output::staging::Staging;
use crate::report::read_json;

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
brought to one clock by what their channels share. RUN.import.json says what was done to each run.";

/// What marks a folder that an import wrote, and lists its files.
const LIST: &str = "import.json";

/// A list of some thousand files is short [bytes].
const LONGEST_LIST: u64 = 1 << 26;

/// Arguments of `kufe runs import`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Which files the runs are in, and what their channels are called
    pub mapping: PathBuf,
    /// Folder for runs.csv and one file a run
    #[arg(long, short, value_name = "FOLDER")]
    pub out: PathBuf,
}

/// Reads, converts, resamples and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file, channel, row, value and what was expected.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let file = args.mapping.display().to_string();
    let text = kufe_files::text_of_regular(&args.mapping, 1 << 24)
        .map_err(|error| Failure::BadInput(format!("{file}: {error}")))?;
    let importer = Importer::new(&text, &file).map_err(Failure::bad_input)?;
    let folder = args.mapping.parent().unwrap_or(Path::new(""));
    let runs = plan(importer.mapping(), folder, &file).map_err(Failure::bad_input)?;
    let format = match importer.mapping().format {
        RunFormatWord::Csv => RunFormat::Csv,
        RunFormatWord::Parquet => RunFormat::Parquet,
    };
    let index = index_csv(&runs, format.extension()).map_err(Failure::bad_input)?;
    let fragment = model_fragment(importer.mapping(), &file).map_err(Failure::bad_input)?;
    let mut names = vec!["runs.csv".to_string(), LIST.to_string()];
    names.extend(fragment.is_some().then(|| "model.import.toml".to_string()));
    for run in &runs {
        names.push(format!("{}.{}", run.name, format.extension()));
        names.push(format!("{}.import.json", run.name));
    }
    let staging = begin(
        args,
        importer.mapping().index.table.as_deref(),
        folder,
        &runs,
        &names,
    )?;
    let bar = global.progress();
    bar.set_message(format!("importing {} runs", runs.len()));
    let notes = runs
        .par_iter()
        .map(|run| write(&importer, run, format, &staging))
        .collect::<Vec<_>>()
        .into_iter()
        .collect::<Result<Vec<Note>, Failure>>()?;
    bar.finish_and_clear();
    staging.write("runs.csv", |mut file| file.write_all(&index))?;
    if let Some(fragment) = &fragment {
        staging.text("model.import.toml", fragment)?;
    }
    let document = json!({
        "mapping": file,
        "version": env!("CARGO_PKG_VERSION"),
        "files": names,
        "runs": notes.iter().map(summary).collect::<Vec<_>>(),
    });
    staging.text(LIST, &format!("{document:#}\n"))?;
    staging.commit()?;
    tell(args, global, &document, &notes, names.len());
    Ok(())
}

/// The output folder, where it is new, empty of runs, or written by an import.
fn begin(
    args: &Args,
    table: Option<&Path>,
    folder: &Path,
    runs: &[PlannedRun],
    names: &[String],
) -> Result<Staging, Failure> {
    let mut inputs = vec![args.mapping.clone()];
    inputs.extend(table.map(|table| folder.join(table)));
    inputs.extend(runs.iter().flat_map(|run| run.files.values().cloned()));
    let before: Option<Value> = read_json(&args.out.join(LIST), LONGEST_LIST).ok();
    let index = args.out.join("runs.csv");
    if index.exists() && before.is_none() {
        return Err(Failure::BadInput(format!(
            "{}: cannot be written: it stands there already and kufe runs import did not write it; expected another folder",
            index.display()
        )));
    }
    let staging = Staging::beside(&inputs, &args.out, names)?;
    staging.remove_on_interrupt();
    Ok(staging)
}

fn write(
    importer: &Importer,
    planned: &PlannedRun,
    format: RunFormat,
    staging: &Staging,
) -> Result<Note, Failure> {
    let imported = importer.run(planned).map_err(Failure::bad_input)?;
    let name = format!("{}.{}", planned.name, format.extension());
    let mut file = std::fs::File::create(staging.path(&name))
        .map_err(|error| staging.failure(&name, &error))?;
    write_run(&imported.run, &mut file, format).map_err(|error| staging.failure(&name, &error))?;
    file.sync_all()
        .map_err(|error| staging.failure(&name, &error))?;
    staging.text(
        &format!("{}.import.json", planned.name),
        &format!("{:#}\n", json!(imported.note)),
    )?;
    Ok(imported.note)
}

/// One run in the list.
fn summary(note: &Note) -> Value {
    let delays = note
        .loggers
        .iter()
        .filter(|(_, logger)| logger.clock == "found");
    let delays = delays.map(|(name, logger)| {
        (
            name.clone(),
            json!({
                "delay_s": logger.delay_s,
                "delay_sd_s": logger.delay_sd_s,
                "delay_includes": logger.delay_includes,
            }),
        )
    });
    json!({
        "run": note.run,
        "seconds": note.rows as f64 / note.rate_hz,
        "missing_rows": note.channels.iter().filter(|(_, c)| c.missing_rows > 0)
            .map(|(name, c)| (name.clone(), json!(c.missing_rows))).collect::<serde_json::Map<_, _>>(),
        "delays": delays.collect::<serde_json::Map<_, _>>(),
        "remarks": note.remarks,
    })
}

fn tell(args: &Args, global: &Global, document: &Value, notes: &[Note], files: usize) {
    if !global.quiet {
        for remark in notes.iter().flat_map(|note| &note.remarks) {
            eprintln!("kufe: note: {remark}");
        }
    }
    if global.json {
        say(&format!("{document:#}\n"));
        return;
    }
    if global.quiet {
        return;
    }
    let seconds: f64 = notes
        .iter()
        .map(|note| note.rows as f64 / note.rate_hz)
        .sum();
    let columns = notes.first().map_or(0, |note| note.channels.len());
    let mut text = format!(
        "{} runs, {seconds:.0} s at {} Hz, {columns} columns\n",
        notes.len(),
        notes[0].rate_hz
    );
    let missing: usize = notes
        .iter()
        .flat_map(|note| note.channels.values())
        .map(|c| c.missing_rows)
        .sum();
    let runs = notes
        .iter()
        .filter(|note| note.channels.values().any(|c| c.missing_rows > 0))
        .count();
    if missing > 0 {
        text += &format!(
            "{missing} values are missing, in {runs} runs: their places are in RUN.import.json\n"
        );
    }
    for (name, logger) in notes
        .iter()
        .flat_map(|note| &note.loggers)
        .filter(|(_, l)| l.clock == "found")
        .take(12)
    {
        text += &format!(
            "{}: the clock of {name} is {:+.4} s late, within {:.4} s, the lag of its sensors included\n",
            logger.file,
            logger.delay_s,
            logger.delay_sd_s.unwrap_or(0.0)
        );
    }
    say(&format!(
        "{text}{}: runs.csv and {} more files\n",
        args.out.display(),
        files - 1
    ));
}
