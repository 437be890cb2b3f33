//! A result document with its time series as a MAT-file.

use std::io::Write;

use kufe_lut::{MatValue, write_mat_file};
use kufe_sled::{LateralForce, Run, RunValidation, distinct};
use serde::Serialize;

use crate::jobs::failure::{Failure, Located};
use crate::results::{Data, Datum};

/// Writes every key of `document` and `more` as variables.
///
/// # Errors
/// Those of the writer.
pub fn write_document_mat(
    writer: &mut dyn Write,
    document: &impl Serialize,
    more: Vec<(String, MatValue)>,
) -> Result<(), Failure> {
    let document = Datum::of(document)?;
    let keys = document.group().into_iter().flatten();
    let variables = keys.map(|(key, datum)| (key.clone(), mat_value(datum)));
    let variables = variables.chain(more).collect();
    write_mat_file(writer, env!("CARGO_PKG_VERSION"), variables).bad_input()
}

/// A datum as a MATLAB value.
///
/// - Numbers are numbers, flags 0 or 1, absent values NaN.
/// - Lists of numbers are rows, other lists are cells.
/// - Groups are structures. A list of groups is a row of structures with the fields of all groups;
///   a missing field is an empty array.
fn mat_value(datum: &Datum) -> MatValue {
    let number = |datum: &Datum| match datum {
        Datum::Absent(()) => Some(f64::NAN),
        Datum::Flag(flag) => Some(f64::from(u8::from(*flag))),
        other => other.number(),
    };
    match datum {
        Datum::Text(text) => MatValue::Text(text.clone()),
        Datum::Group(_) => structures(std::slice::from_ref(datum)),
        Datum::List(list) => {
            if let Some(numbers) = list.iter().map(number).collect() {
                MatValue::row(numbers)
            } else if list.iter().all(|datum| datum.group().is_some()) {
                structures(list)
            } else {
                MatValue::Cells(list.iter().map(mat_value).collect())
            }
        }
        other => MatValue::number(number(other).unwrap_or(f64::NAN)),
    }
}

fn structures(list: &[Datum]) -> MatValue {
    let groups = || list.iter().filter_map(Datum::group);
    let names = distinct(groups().flat_map(Data::keys));
    let empty = || MatValue::Numbers(vec![0, 0], Vec::new());
    let of = |group: &Data, name: &str| group.get(name).map_or_else(empty, mat_value);
    let rows = groups().map(|group| names.iter().map(|name| of(group, name)).collect());
    MatValue::Structures(
        names.iter().map(|name| name.to_string()).collect(),
        rows.collect(),
    )
}

/// The value of a column at an instant.
type Column = fn(&LateralForce) -> f64;

/// Columns of a table, with their names.
pub type Columns<'a> = Vec<(&'a str, Vec<f64>)>;

/// A run's lateral force over time.
pub fn force_columns(run: &RunValidation) -> Columns<'_> {
    let columns: [(&str, Column); 5] = [
        ("t_s", |force| force.t_s),
        ("s_m", |force| force.s_m),
        ("measured_n", |force| force.measured_n),
        ("model_n", |force| force.model_n),
        ("braghin_n", |force| force.braghin_n),
    ];
    let values = |of: Column| run.series.iter().map(of).collect();
    columns.map(|(name, of)| (name, values(of))).into()
}

/// A run's channels over time.
pub fn run_columns(run: &Run) -> Columns<'_> {
    let time = (0..run.len()).map(|i| run.t0_s + i as f64 * run.dt_s);
    let channels = run.columns.iter();
    let channels = channels.map(|(name, values)| (&**name, values.clone()));
    let time = std::iter::once(("t_s", time.collect()));
    time.chain(channels).collect()
}

/// Variable `series`: one structure per run with its lateral force over time.
pub fn force_series(runs: &[RunValidation]) -> (String, MatValue) {
    series_of(runs.iter().map(|run| (&*run.run, force_columns(run))))
}

/// Variable `series`: one structure per run with its channels over time.
pub fn channel_series(runs: &[Run]) -> (String, MatValue) {
    series_of(runs.iter().map(|run| (&*run.entry.run, run_columns(run))))
}

/// Structures of runs that all have the same columns; the fields are named after the columns.
fn series_of<'a>(runs: impl Iterator<Item = (&'a str, Columns<'a>)>) -> (String, MatValue) {
    let mut names = vec!["run".to_owned()];
    let rows = runs.map(|(run, columns)| {
        if names.len() == 1 {
            names.extend(columns.iter().map(|(name, _)| name.to_string()));
        }
        let columns = columns.into_iter();
        let columns = columns.map(|(_, values)| MatValue::row(values));
        let name = MatValue::Text(run.to_owned());
        std::iter::once(name).chain(columns).collect()
    });
    let rows = rows.collect();
    ("series".to_owned(), MatValue::Structures(names, rows))
}
