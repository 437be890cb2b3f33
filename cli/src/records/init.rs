//! `kufe runs init`: a commented mapping, guessed from samples.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, Located};
use kufe_sled::MOST_NUMBERS;
use kufe_telemetry::{TextOptions, guess_mapping, read_log};
use serde::Serialize;

use crate::about::schema::write_with_schema;
use crate::terminal::Global;

/// Arguments of `kufe runs init`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Files of one run, one per logger
    #[arg(required = true)]
    pub samples: Vec<PathBuf>,
    /// The mapping to write
    #[arg(long, short, value_name = "FILE", default_value = "mapping.toml")]
    pub out: PathBuf,
}

/// A mapping that was written.
#[derive(Serialize)]
struct WrittenMapping<'a> {
    file: &'a Path,
    schema: PathBuf,
    /// Lines to answer.
    questions: usize,
}

/// Guesses and writes.
///
/// # Errors
/// [`Failure::BadInput`] with the file.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let path = args.out.display();
    let mut logs = Vec::new();
    let max_numbers = MOST_NUMBERS / args.samples.len() as u64;
    for sample in &args.samples {
        let log = read_log(sample, TextOptions::default(), None, max_numbers);
        let log = log.bad_input()?;
        logs.push((from_mapping(sample, &args.out)?, log));
    }
    let text = guess_mapping(&logs);
    let (inputs, out) = (&args.samples, &args.out);
    let schema = write_with_schema("runs init", "mapping", inputs, out, &text, global.force)?;
    let written = WrittenMapping {
        file: &args.out,
        schema,
        questions: text.matches("\n# ? ").count(),
    };
    global.print(&written, || {
        format!(
            "{path} written with {} questions (lines that begin with \"# ?\"); answered: kufe runs import {path} -o runs/\n",
            written.questions
        )
    })
}

/// A sample's path in the mapping: relative if the sample is below the mapping's folder, else
/// absolute.
fn from_mapping(sample: &Path, mapping: &Path) -> Result<PathBuf, Failure> {
    let folder = mapping.parent().unwrap_or(Path::new(""));
    if folder.as_os_str().is_empty() || sample.is_absolute() {
        return Ok(sample.to_path_buf());
    }
    if let Ok(below) = sample.strip_prefix(folder) {
        return Ok(below.to_path_buf());
    }
    std::path::absolute(sample).in_file(sample)
}
