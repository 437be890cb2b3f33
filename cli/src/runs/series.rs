//! Runs over time as variables of a MAT-file.

use std::io::BufWriter;

use kufe::jobs::{Failure, write_document_mat};
use kufe_lut::MatValue;
use kufe_sled::{LateralForce, Run, RunValidation};
use serde::Serialize;

use crate::output::folder::OutputDir;

/// Writes validation.mat: the document's keys, and the forces of every run.
///
/// # Errors
/// [`Failure::BadInput`] where it cannot be written.
pub fn write_forces(
    output: &OutputDir,
    document: &impl Serialize,
    runs: &[RunValidation],
) -> Result<(), Failure> {
    write(output, "validation.mat", document, forces(runs))
}

/// Writes simulation.mat: the document's keys, and the channels of every run.
///
/// # Errors
/// As [`write_forces`].
pub fn write_channels(
    output: &OutputDir,
    document: &impl Serialize,
    runs: &[Run],
) -> Result<(), Failure> {
    write(output, "simulation.mat", document, channels(runs))
}

fn write(
    output: &OutputDir,
    name: &str,
    document: &impl Serialize,
    series: (String, MatValue),
) -> Result<(), Failure> {
    output.write(name, |file| {
        write_document_mat(&mut BufWriter::new(file), document, vec![series])
    })
}

/// What a column holds of an instant.
type Column = fn(&LateralForce) -> f64;

/// `series`: a structure a run, its lateral force over time.
fn forces(runs: &[RunValidation]) -> (String, MatValue) {
    let columns: [(&str, Column); 5] = [
        ("t_s", |force| force.t_s),
        ("s_m", |force| force.s_m),
        ("measured_n", |force| force.measured_n),
        ("model_n", |force| force.model_n),
        ("braghin_n", |force| force.braghin_n),
    ];
    let row = |run: &RunValidation| {
        let column = |(_, of): &(&str, Column)| MatValue::row(run.series.iter().map(of).collect());
        let name = MatValue::Text(run.run.clone());
        std::iter::once(name)
            .chain(columns.iter().map(column))
            .collect()
    };
    let names = std::iter::once("run").chain(columns.iter().map(|c| c.0));
    let names = names.map(str::to_owned).collect();
    let rows = runs.iter().map(row).collect();
    ("series".to_owned(), MatValue::Structures(names, rows))
}

/// `series`: a structure a run, its channels over time.
fn channels(runs: &[Run]) -> (String, MatValue) {
    // All runs of one simulation have the same channels.
    let known: Vec<&String> = runs
        .first()
        .map_or(Vec::new(), |run| run.columns.keys().collect());
    let row = |run: &Run| {
        let time = (0..run.len())
            .map(|i| run.t0_s + i as f64 * run.dt_s)
            .collect();
        let first = [MatValue::Text(run.entry.run.clone()), MatValue::row(time)];
        let channels = known
            .iter()
            .map(|name| MatValue::row(run.columns[*name].clone()));
        first.into_iter().chain(channels).collect()
    };
    let names = ["run", "t_s"].map(str::to_owned).into_iter();
    let names = names
        .chain(known.iter().map(|name| name.to_string()))
        .collect();
    let rows = runs.iter().map(row).collect();
    ("series".to_owned(), MatValue::Structures(names, rows))
}
