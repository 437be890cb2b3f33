//! A command's document and its series as a MAT-file.

use std::io::Write;

use kufe_lut::{MatValue, write_mat_file};
use kufe_sled::{LateralForce, Run, RunValidation};
use serde::Serialize;

use crate::jobs::failure::Failure;

/// Writes every key of `document` and `more` as variables.
///
/// # Errors
/// Those of the writer.
pub fn write_document_mat(
    writer: &mut dyn Write,
    document: &impl Serialize,
    more: Vec<(String, MatValue)>,
) -> Result<(), Failure> {
    let document = serde_json::to_value(document).map_err(Failure::bad_input)?;
    let keys = document.as_object().into_iter().flatten();
    let mut variables: Vec<(String, MatValue)> = keys
        .map(|(key, value)| (key.clone(), MatValue::of_json(value)))
        .collect();
    variables.extend(more);
    write_mat_file(writer, env!("CARGO_PKG_VERSION"), variables).map_err(Failure::bad_input)
}

/// The value of a column at an instant.
type Column = fn(&LateralForce) -> f64;

/// `series`: a structure a run, its lateral force over time.
pub fn force_series(runs: &[RunValidation]) -> (String, MatValue) {
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
pub fn channel_series(runs: &[Run]) -> (String, MatValue) {
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
