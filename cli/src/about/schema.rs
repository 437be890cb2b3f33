//! `kufe schema`: the keys of files and results as JSON schemas, for editors and readers.

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, PossibleValuesParser};
use kufe::case::Case;
use kufe::jobs::{Failure, table};
use kufe::results::finding::Report;
use kufe::results::{
    Alignment, Comparison, ContactResult, Evaluation, FrictionOptimum, FrictionTable,
    IceHouseResult, LateralFitDocument, MeshQuality, PressureFit, ReplayResult, RunCheck,
    SampleTruth, SeriesRow, Simulation, Validation,
};
use kufe_sled::Model;
use kufe_telemetry::Mapping;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, SchemaGenerator};

use crate::output::{OutputFiles, write_file};
use crate::terminal::{Global, say};

/// Arguments of `kufe schema`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The file or result
    #[arg(value_parser = names(&DOCUMENTS))]
    pub document: String,
    /// Write it here instead of printing it
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// A file with a schema: its name on the command line, its description, and the schema.
type Document = (
    &'static str,
    &'static str,
    fn(&mut SchemaGenerator) -> Schema,
);

/// The files with a schema; those that users write come first.
#[rustfmt::skip]
const DOCUMENTS: [Document; 21] = [
    ("case", "case.toml: one contact problem", of::<Case>),
    ("table", "table.toml: one lookup table", table::schema),
    ("model", "model.toml: the sled and its friction", of::<Model>),
    ("mapping", "mapping.toml: where runs are recorded, and how", of::<Mapping>),
    ("result", "result.json: one solved contact", of::<ContactResult>),
    ("comparison", "comparison.json: two solved contacts", of::<Comparison>),
    ("series", "table.json: the contacts of a series", of::<Vec<SeriesRow>>),
    ("mesh", "quality.json: the quality of a mesh", of::<MeshQuality>),
    ("friction", "friction.json: friction over speed and temperature", of::<FrictionTable>),
    ("optimum", "friction.json of a search: the runner with the least friction", of::<FrictionOptimum>),
    ("pressure-fit", "fit.json of friction over pressure", of::<PressureFit>),
    ("icehouse", "icehouse.json: gliding runs in an ice house", of::<IceHouseResult>),
    ("lateral-fit", "fit.json of lateral friction", of::<LateralFitDocument>),
    ("validation", "validation.json: model and measurement compared", of::<Validation>),
    ("evaluation", "evaluation.json: losses of drivers", of::<Evaluation>),
    ("simulation", "simulation.json: simulated runs", of::<Simulation>),
    ("replay", "simulation.json of a replay", of::<ReplayResult>),
    ("check", "check.json: examined runs", of::<RunCheck>),
    ("alignment", "align.json: aligned runs", of::<Alignment>),
    ("truth", "truth.json: sample runs", of::<SampleTruth>),
    ("finding", "report.json: the effects found", of::<Report>),
];

fn of<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    generator.root_schema_for::<T>()
}

fn names(documents: &[Document]) -> PossibleValuesParser {
    let names = documents.iter().copied();
    PossibleValuesParser::new(names.map(|(name, what, _)| PossibleValue::new(name).help(what)))
}

/// The files that users write.
pub fn kinds() -> PossibleValuesParser {
    names(&DOCUMENTS[..4])
}

/// The schema of a document in JSON Schema draft 7, which editors for TOML read.
fn schema(document: &str) -> String {
    let mut known = DOCUMENTS.iter();
    let found = known.find(|(name, ..)| *name == document);
    let (.., schema) = found.expect("the parser admits known documents alone");
    let mut generator = SchemaSettings::draft07().into_generator();
    format!("{:#}\n", schema(&mut generator).to_value())
}

/// Writes a file of a kind and its schema, which the first line of the file names, into one folder.
/// Returns the path of the schema.
///
/// # Errors
/// [`Failure::BadInput`] if the file exists, or one of the two cannot be written.
pub fn write_with_schema(
    command: &'static str,
    kind: &str,
    inputs: &[PathBuf],
    file: &Path,
    text: &str,
    force: bool,
) -> Result<PathBuf, Failure> {
    let name = format!("{kind}.schema.json");
    let path = file.parent().unwrap_or(Path::new("")).join(&name);
    let content = schema(kind);
    let mut outputs = vec![file.to_path_buf()];
    // An unchanged schema of another command stays.
    let found = kufe_files::read_regular(&path, content.len() as u64);
    let is_missing = found.ok().as_deref() != Some(content.as_bytes());
    outputs.extend(is_missing.then(|| path.clone()));
    let files = OutputFiles::begin(command, inputs, &outputs, force)?;
    if is_missing {
        files.bytes(&path, content.as_bytes())?;
    }
    files.bytes(file, format!("#:schema ./{name}\n{text}").as_bytes())?;
    files.commit()?;
    Ok(path)
}

/// Prints or writes a schema.
///
/// # Errors
/// [`Failure::BadInput`] if the file cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let text = schema(&args.document);
    let Some(path) = &args.out else {
        say(&text);
        return Ok(());
    };
    write_file("schema", &[], path, text.as_bytes(), global)?;
    if !global.quiet {
        say(&format!("{} written\n", path.display()));
    }
    Ok(())
}
