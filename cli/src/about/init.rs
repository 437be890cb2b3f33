//! `kufe init`: a commented file to start from, and the schema by which editors complete it.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, TABLE_EXAMPLE, case_file::EXAMPLE};
use kufe_sled::MODEL_EXAMPLE;
use kufe_telemetry::MAPPING_EXAMPLE;
use serde::Serialize;

use crate::about::schema::{Kind, write_with_schema};
use crate::terminal::Global;

/// Arguments of `kufe init`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The file to write [default: case.toml, table.toml, model.toml or mapping.toml]
    pub file: Option<PathBuf>,
    /// What to start
    #[arg(long, value_enum, default_value_t = Kind::Case)]
    pub kind: Kind,
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
/// [`Failure::BadInput`] where the file exists or cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let kind = args.kind.name();
    let file = match &args.file {
        Some(file) => file.clone(),
        None => PathBuf::from(format!("{kind}.toml")),
    };
    let path = file.display();
    let (example, next) = match args.kind {
        Kind::Case => (EXAMPLE, format!("solve it with: kufe press {path} -o out/")),
        Kind::Table => (TABLE_EXAMPLE, format!("fill it with: kufe lut {path}")),
        Kind::Model => (
            MODEL_EXAMPLE,
            format!("use it with: kufe evaluate runs.csv --model {path} -o evaluation/"),
        ),
        Kind::Mapping => (
            MAPPING_EXAMPLE,
            format!("import with it: kufe runs import {path} -o runs/"),
        ),
    };
    let schema = write_with_schema("init", args.kind, &[], &file, example, global.force)?;
    let written = WrittenFiles {
        file: &file,
        schema,
    };
    global.print(&written, || format!("{path} written; {next}\n"))
}
