//! `kufe schema`: the keys of files and results as JSON schemas, for editors and readers.

use std::path::{Path, PathBuf};

use kufe::case::Case;
use kufe::jobs::Failure;
use kufe::results::finding::Report;
use kufe::results::{
    Alignment, Comparison, ContactResult, Evaluation, FrictionOptimum, FrictionTable,
    IceHouseResult, LateralFitDocument, MeshQuality, PressureFit, ReplayResult, RunCheck,
    SampleTruth, SeriesRow, Simulation, Validation,
};
use kufe_sled::Model;
use kufe_telemetry::Mapping;
use schemars::generate::SchemaSettings;

use crate::output::OutputFiles;
use crate::terminal::{Global, say};

/// Arguments of `kufe schema`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Which file's
    pub document: Document,
    /// Write it here instead of printing it
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// The files that a user writes.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// case.toml: one contact problem
    Case,
    /// table.toml: one lookup table
    Table,
    /// model.toml: the sled and its friction
    Model,
    /// mapping.toml: where runs are recorded, and how
    Mapping,
}

/// The files that have a schema.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Document {
    /// case.toml: one contact problem
    Case,
    /// table.toml: one lookup table
    Table,
    /// model.toml: the sled and its friction
    Model,
    /// mapping.toml: where runs are recorded, and how
    Mapping,
    /// result.json: one solved contact
    Result,
    /// comparison.json: two solved contacts
    Comparison,
    /// table.json: the contacts of a series
    Series,
    /// quality.json: the quality of a mesh
    Mesh,
    /// friction.json: friction over speed and temperature
    Friction,
    /// friction.json of a search: the runner with the least friction
    Optimum,
    /// fit.json of friction over pressure
    PressureFit,
    /// icehouse.json: gliding runs in an ice house
    Icehouse,
    /// fit.json of lateral friction
    LateralFit,
    /// validation.json: model and measurement compared
    Validation,
    /// evaluation.json: losses of drivers
    Evaluation,
    /// simulation.json: simulated runs
    Simulation,
    /// simulation.json of a replay
    Replay,
    /// check.json: examined runs
    Check,
    /// align.json: aligned runs
    Alignment,
    /// truth.json: sample runs
    Truth,
    /// report.json: the effects found
    Finding,
}

impl From<Kind> for Document {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Case => Document::Case,
            Kind::Table => Document::Table,
            Kind::Model => Document::Model,
            Kind::Mapping => Document::Mapping,
        }
    }
}

impl Kind {
    /// The word on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Case => "case",
            Kind::Table => "table",
            Kind::Model => "model",
            Kind::Mapping => "mapping",
        }
    }
}

/// Writes a file of a kind with its schema, which its first line names, into one folder; returns
/// the schema's path.
///
/// # Errors
/// [`Failure::BadInput`] where one of them exists or cannot be written.
pub fn write_with_schema(
    command: &'static str,
    kind: Kind,
    inputs: &[PathBuf],
    file: &Path,
    text: &str,
    force: bool,
) -> Result<PathBuf, Failure> {
    let name = format!("{}.schema.json", kind.name());
    let schema = file.parent().unwrap_or(Path::new("")).join(&name);
    let content = Document::from(kind).schema();
    let mut outputs = vec![file.to_path_buf()];
    // Commands share it.
    let found = kufe_files::read_regular(&schema, content.len() as u64);
    if found.ok().as_deref() != Some(content.as_bytes()) {
        outputs.push(schema.clone());
    }
    let files = OutputFiles::begin(command, inputs, &outputs, force)?;
    if outputs.contains(&schema) {
        files.write(&schema, |writer| writer.write_all(content.as_bytes()))?;
    }
    files.write(file, |writer| write!(writer, "#:schema ./{name}\n{text}"))?;
    files.commit()?;
    Ok(schema)
}

impl Document {
    /// The schema, JSON Schema draft 7: what editors for TOML read.
    fn schema(self) -> String {
        let mut generator = SchemaSettings::draft07().into_generator();
        let schema = match self {
            Document::Case => generator.root_schema_for::<Case>(),
            Document::Table => kufe::jobs::table::schema(&mut generator),
            Document::Model => generator.root_schema_for::<Model>(),
            Document::Mapping => generator.root_schema_for::<Mapping>(),
            Document::Result => generator.root_schema_for::<ContactResult>(),
            Document::Comparison => generator.root_schema_for::<Comparison>(),
            Document::Series => generator.root_schema_for::<Vec<SeriesRow>>(),
            Document::Mesh => generator.root_schema_for::<MeshQuality>(),
            Document::Friction => generator.root_schema_for::<FrictionTable>(),
            Document::Optimum => generator.root_schema_for::<FrictionOptimum>(),
            Document::PressureFit => generator.root_schema_for::<PressureFit>(),
            Document::Icehouse => generator.root_schema_for::<IceHouseResult>(),
            Document::LateralFit => generator.root_schema_for::<LateralFitDocument>(),
            Document::Validation => generator.root_schema_for::<Validation>(),
            Document::Evaluation => generator.root_schema_for::<Evaluation>(),
            Document::Simulation => generator.root_schema_for::<Simulation>(),
            Document::Replay => generator.root_schema_for::<ReplayResult>(),
            Document::Check => generator.root_schema_for::<RunCheck>(),
            Document::Alignment => generator.root_schema_for::<Alignment>(),
            Document::Truth => generator.root_schema_for::<SampleTruth>(),
            Document::Finding => generator.root_schema_for::<Report>(),
        };
        format!("{:#}\n", schema.to_value())
    }
}

/// Prints or writes a schema.
///
/// # Errors
/// [`Failure::BadInput`] where the file cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let text = args.document.schema();
    let Some(path) = &args.out else {
        say(&text);
        return Ok(());
    };
    let outputs = std::slice::from_ref(path);
    let files = OutputFiles::begin("schema", &[], outputs, global.force)?;
    files.write(path, |writer| writer.write_all(text.as_bytes()))?;
    files.commit()?;
    if !global.quiet {
        say(&format!("{} written\n", path.display()));
    }
    Ok(())
}
