//! `kufe init`: a commented file to start from, and the schema by which editors complete it.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, MODEL_EXAMPLE, TABLE_EXAMPLE, case_file::EXAMPLE, write_whole};
use kufe_telemetry::MAPPING_EXAMPLE;
use serde::Deserialize;

use crate::about::schema::Kind;
use crate::output::apart::apart;
use crate::output::global::Global;
use crate::output::say::say;
use crate::report::read_json;

const EXAMPLES: &str = "\
Examples:
  kufe init                       case.toml: one contact problem
  kufe init --kind table          table.toml: a lookup table of case.toml
  kufe init bob.toml --kind model  a sled and its friction

Beside the file stands its schema, case.schema.json, which the file's first line names: editors that read such schemas
complete the keys and show what they mean.";

/// Arguments of `kufe init`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The file to write [default: case.toml, table.toml, model.toml or mapping.toml]
    pub file: Option<PathBuf>,
    /// What to start
    #[arg(long, value_enum, default_value_t = Kind::Case)]
    pub kind: Kind,
    /// Replace a file that exists
    #[arg(long)]
    pub force: bool,
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
    if file.exists() && !args.force {
        return Err(Failure::BadInput(format!(
            "{path}: exists already; --force replaces it"
        )));
    }
    let name = format!("{kind}.schema.json");
    let schema = file.parent().unwrap_or(Path::new("")).join(&name);
    apart(&[], &[file.clone(), schema.clone()])?;
    if schema.exists() && !args.force && !is_schema(&schema, args.kind) {
        return Err(Failure::BadInput(format!(
            "{}: exists already and is no schema of kufe's; --force replaces it",
            schema.display()
        )));
    }
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
    write_whole(&schema, |writer| {
        writer.write_all(args.kind.schema().as_bytes())
    })?;
    write_whole(&file, |writer| {
        write!(writer, "#:schema ./{name}\n{example}")
    })?;
    if global.json {
        let written = serde_json::json!({ "file": file, "schema": schema });
        say(&format!("{written}\n"));
    } else if !global.quiet {
        say(&format!("{path} written; {next}\n"));
    }
    Ok(())
}

/// A schema is a page or two [bytes].
const LONGEST: u64 = 1 << 22;

/// Whether a file is a schema of this kind, of this version of the command or another.
fn is_schema(path: &Path, kind: Kind) -> bool {
    #[derive(Deserialize)]
    struct Titled {
        title: String,
    }
    let title = format!("{}.toml", kind.name());
    read_json(path, LONGEST).is_ok_and(|found: Titled| found.title == title)
}
