//! `kufe runs align`: alignment of runs to a common distance along their track.

use std::io::BufWriter;
use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::align::AlignOptions;
use kufe::jobs::runs::{run_format, write_runs};
use kufe_sled::{gaps_line, track_file};

use crate::output::OutputDir;
use crate::terminal::{Global, warn};
use crate::text::document_text;

/// Arguments of `kufe runs align`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Index of the runs
    pub runs: PathBuf,
    /// Model of the sled and its friction, with positions of its sensors and tolerances
    #[arg(long, short, value_name = "MODEL.toml")]
    pub model: PathBuf,
    /// Folder for the runs
    #[arg(long, short, value_name = "FOLDER")]
    pub out: PathBuf,
    /// Estimate every track from its runs, even if a survey exists
    #[arg(long)]
    pub estimate: bool,
    /// Refuse runs with missing files, values or rows, uneven times or standstill, instead of
    /// excluding them
    #[arg(long)]
    pub strict: bool,
    /// Write Parquet instead of CSV
    #[arg(long)]
    pub parquet: bool,
}

/// Aligns and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let options = AlignOptions {
        runs: args.runs.clone(),
        model: args.model.clone(),
        estimate: args.estimate,
        strict: args.strict,
    };
    let output = OutputDir::begin("runs align", &options.inputs(), &args.out, global.force)?;
    let mut aligned = global.watched(|watch| options.align(watch))?;
    for (name, table) in &aligned.tracks {
        if let Some(table) = table {
            output.write(&track_file(name), |file| {
                table.write_csv(BufWriter::new(file))
            })?;
        }
    }
    let format = run_format(args.parquet);
    write_runs(&output, &mut aligned.runs, format)?;
    let document = &aligned.document;
    for remark in aligned.runs.iter().flat_map(|run| &run.remarks) {
        warn(remark);
    }
    if !document.gaps.is_empty() {
        warn(&gaps_line(&document.gaps));
    }
    let mut text = String::new();
    for track in &document.tracks {
        let with = if track.surveyed {
            "the survey"
        } else {
            "one another"
        };
        text += &format!("{} along {with}\n", track.track);
        text += &document_text(&track.runs)?;
    }
    output.finish("align.json", document, global, || text)
}
