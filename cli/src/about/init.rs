//! `kufe init`: a commented file to start from, and its schema for editors.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, TABLE_EXAMPLE, case_file::EXAMPLE};
use kufe_sled::MODEL_EXAMPLE;
use kufe_telemetry::MAPPING_EXAMPLE;
use serde::Serialize;

use crate::about::schema::{kinds, write_with_schema};
use crate::terminal::Global;

/// Arguments of `kufe init`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The file to write [default: case.toml, table.toml, model.toml or mapping.toml]
    pub file: Option<PathBuf>,
    /// Kind of the file
    #[arg(long, value_parser = kinds(), default_value = "case")]
    pub kind: String,
}

/// The files that were written.
#[derive(Serialize)]
struct WrittenFiles<'a> {
    file: &'a Path,
    schema: PathBuf,
}

/// Writes the example with its comments, and its schema.
///
/// # Errors
/// [`Failure::BadInput`] if the file exists or cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let kind = &*args.kind;
    let file = args.file.clone();
    let file = file.unwrap_or_else(|| format!("{kind}.toml").into());
    let path = file.display();
    let (example, next) = match kind {
        "table" => (TABLE_EXAMPLE, format!("fill it with: kufe lut {path}")),
        "model" => (
            MODEL_EXAMPLE,
            format!("use it with: kufe evaluate runs.csv --model {path} -o evaluation/"),
        ),
        "mapping" => (
            MAPPING_EXAMPLE,
            format!("import with it: kufe runs import {path} -o runs/"),
        ),
        _ => (EXAMPLE, format!("solve it with: kufe press {path} -o out/")),
    };
    let schema = write_with_schema("init", kind, &[], &file, example, global.force)?;
    let written = WrittenFiles {
        file: &file,
        schema,
    };
    global.print(&written, || format!("{path} written; {next}\n"))
}
