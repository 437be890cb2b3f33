//! `kufe lut TABLE.toml`: the whole table in one process.

use std::path::PathBuf;
use std::time::Instant;

use kufe::jobs::{
    Failure,
    table::{Solver, TableSpec},
};
use kufe_files::resolved;

use crate::cli::misspelt;
use crate::lut::SUBCOMMANDS;
use crate::lut::export::Forms;
use crate::lut::finish::finish;
use crate::output::OutputFiles;
use crate::terminal::Global;

/// Arguments of `kufe lut` without a subcommand.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table file (docs/tables.md)
    #[arg(required = true)]
    table: Option<PathBuf>,
    /// Where the table goes [default: the table file's name with .lut]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    forms: Forms,
}

/// Solves every point that is not on disk yet and writes the table.
///
/// # Errors
/// As [`crate::lut::run`].
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let Some(path) = &args.table else {
        return Err(Failure::Usage("kufe lut: which table file?".into()));
    };
    if let Some(text) = misspelt(&path.to_string_lossy(), &SUBCOMMANDS) {
        return Err(Failure::Usage(text));
    }
    let spec = TableSpec::read(path)?;
    let out = args.out.clone();
    let out = out.unwrap_or_else(|| path.with_extension("lut"));
    let started = Instant::now();
    let (solver, filled, files) = global.watched(|watch| {
        let solver = Solver::new(&spec, watch)?;
        let mut outputs = args.forms.paths(&out);
        outputs.push(out.clone());
        let files = OutputFiles::begin("lut", &solver.inputs(&spec)?, &outputs, global.force)?;
        let filled = kufe::jobs::table::fill(&spec, &solver, &resolved(&out), watch)?;
        Ok::<_, Failure>((solver, filled, files))
    })?;
    let written = args.forms.commit(&filled.swept.table, &out, files)?;
    filled.clear()?;
    let spent = (filled.solves, started.elapsed());
    finish(&filled.swept, &solver, &out, &written, spent, global)
}
