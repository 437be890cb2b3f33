//! A command's document and its series as a MAT-file.

use std::io::Write;

use kufe_lut::{MatValue, write_mat_file};
use kufe_sled::{LateralForce, Run, RunValidation};
use serde::Serialize;

use crate::jobs::failure::Failure;
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
    let keys = document.group().into_iter().flat_map(Data::iter);
    let mut variables: Vec<(String, MatValue)> = keys
        .map(|(key, datum)| (key.to_owned(), mat_value(datum)))
        .collect();
    variables.extend(more);
    write_mat_file(writer, env!("CARGO_PKG_VERSION"), variables).map_err(Failure::bad_input)
}

/// A datum as a MATLAB value: numbers, true as 1, absent ones as NaN; lists of numbers as rows, of
/// groups as rows of structures with the fields of them all (an empty array where one has none),
/// other lists as cells; groups as structures.
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
    let mut names: Vec<String> = Vec::new();
    for (name, _) in groups().flat_map(Data::iter) {
        if !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    let empty = || MatValue::Numbers(vec![0, 0], Vec::new());
    let of = |group: &Data, name: &String| group.get(name).map_or_else(empty, mat_value);
    let rows = groups().map(|group| names.iter().map(|name| of(group, name)).collect());
    let rows = rows.collect();
    MatValue::Structures(names, rows)
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
    let series = runs.iter().map(|run| {
        let column =
            |(name, of): &(&str, Column)| (name.to_string(), run.series.iter().map(of).collect());
        (run.run.as_str(), columns.iter().map(column).collect())
    });
    series_of(series.collect())
}

/// `series`: a structure a run, its channels over time.
pub fn channel_series(runs: &[Run]) -> (String, MatValue) {
    let series = runs.iter().map(|run| {
        let time = (0..run.len()).map(|i| run.t0_s + i as f64 * run.dt_s);
        let channels = run
            .columns
            .iter()
            .map(|(name, values)| (name.clone(), values.clone()));
        let time = ("t_s".to_owned(), time.collect());
        (
            run.entry.run.as_str(),
            std::iter::once(time).chain(channels).collect(),
        )
    });
    series_of(series.collect())
}

/// Columns by name.
type Columns = Vec<(String, Vec<f64>)>;

/// The columns of runs that all have the same ones.
fn series_of(runs: Vec<(&str, Columns)>) -> (String, MatValue) {
    let mut names = vec!["run".to_owned()];
    names.extend(
        runs.iter()
            .take(1)
            .flat_map(|(_, columns)| columns)
            .map(|c| c.0.clone()),
    );
    let rows = runs.into_iter().map(|(run, columns)| {
        let columns = columns.into_iter().map(|(_, values)| MatValue::row(values));
        std::iter::once(MatValue::Text(run.to_owned()))
            .chain(columns)
            .collect()
    });
    let rows = rows.collect();
    ("series".to_owned(), MatValue::Structures(names, rows))
}
