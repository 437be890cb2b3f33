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
    let document = Datum::of(document).map_err(Failure::bad_input)?;
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
