//! Reading, checking and writing of the files of runs.

use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::io::{BufWriter, Write};
use std::path::Path;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::column::COLUMNS;
use crate::columns::parquet::write_parquet;
use crate::columns::{is_cut_short, read_columns, write_csv};
use crate::error::Error;
use crate::record::check::columns::check_columns;
use crate::record::check::faults::{add_remarks, find_faults};
use crate::record::gaps::OnGaps;
use crate::record::index::{Entry, read_index};
use crate::record::needs::Needs;
use crate::record::run::Run;

/// Reads the index and all of its runs, in the order of the index; a run must have the columns that
/// the computation `needs`.
///
/// Files are CSV, Parquet (`.parquet`) or MATLAB v5 (`.mat`). Every run is checked by
/// [`check_columns`], and its channels against one another by [`find_faults`]; suspected faults become
/// a remark. If the index has no `distance_m`, it is the sum of the earlier runs of the session.
///
/// # Errors
/// The error of the first bad run in the order of the index; [`Error::DuplicateContent`] for two
/// equal runs; [`Error::Wrong`] for a proved fault.
pub fn read_runs(index: &Path, needs: &Needs, on_gaps: OnGaps) -> Result<Vec<Run>, Error> {
    let (runs, bad) = read_good_runs(index, needs, on_gaps)?;
    let more = bad.len().saturating_sub(1);
    match bad.into_iter().next() {
        None => Ok(runs),
        Some(Error::Wrong { fault, .. }) => Err(Error::Wrong { fault, more }),
        Some(error) => Err(error),
    }
}

/// Like [`read_runs`], but excludes bad runs and returns their errors with the good ones.
///
/// # Errors
/// Those of the index itself.
pub fn read_good_runs(
    index: &Path,
    needs: &Needs,
    on_gaps: OnGaps,
) -> Result<(Vec<Run>, Vec<Error>), Error> {
    let read = |entry: Entry| {
        let (line, file) = (entry.line, entry.file.clone());
        let run = read_run(entry, needs.columns, on_gaps);
        run.map_err(|error| {
            if file.exists() {
                needs.explain(error)
            } else {
                let index = index.display().to_string();
                Error::row(&index, line, error.to_string())
            }
        })
    };
    let entries = read_index(index)?.into_par_iter();
    let read: Vec<Result<Run, Error>> = entries.map(read).collect();
    let (good, bad): (Vec<_>, Vec<_>) = read.into_iter().partition(Result::is_ok);
    let mut good: Vec<Run> = good.into_iter().flatten().collect();
    let mut bad: Vec<Error> = bad.into_iter().filter_map(Result::err).collect();
    let copies = copies(&good);
    let name = |run: usize| good[run].entry.run.clone();
    bad.extend(
        copies
            .iter()
            .map(|(first, second)| Error::DuplicateContent {
                first: name(*first),
                second: name(*second),
            }),
    );
    // The last first: the indices of the others remain valid.
    for (_, second) in copies.into_iter().rev() {
        good.remove(second);
    }
    let (proven, suspected): (Vec<_>, Vec<_>) = find_faults(&good)
        .into_iter()
        .partition(|fault| fault.proven);
    add_remarks(&mut good, &suspected);
    for fault in proven {
        good.retain(|run| run.entry.run != fault.run);
        bad.push(Error::Wrong {
            fault: Box::new(fault),
            more: 0,
        });
    }
    fill_in_distances(&mut good);
    Ok((good, bad))
}

/// Reads and checks the file of one run; `required` are the columns it must have besides `t_s`.
///
/// A sample is used if all recorded columns of [`COLUMNS`] and `s_m` have a value. A column that is
/// not required and has no value at all counts as not recorded.
///
/// # Errors
/// Those of the format's reader and of [`check_columns`].
pub fn read_run(entry: Entry, required: &[&str], on_gaps: OnGaps) -> Result<Run, Error> {
    let known: Vec<&str> = COLUMNS.into_iter().chain(["s_m"]).collect();
    read_run_of(entry, required, &known, on_gaps)
}

/// As [`read_run`], for a computation that uses only the `required` columns and the recorded ones of
/// `known`: gaps of other columns do not matter.
///
/// # Errors
/// As [`read_run`].
pub fn read_run_of(
    entry: Entry,
    required: &[&str],
    known: &[&str],
    on_gaps: OnGaps,
) -> Result<Run, Error> {
    let file = entry.file.display().to_string();
    let more = required.iter().filter(|name| !known.contains(name));
    let known: Vec<&str> = known.iter().chain(more).copied().collect();
    let mut found = read_columns(&entry.file, &known)?;
    let columns = &mut found.columns;
    let mut remarks = Vec::new();
    if is_cut_short(&entry.file) {
        remarks.push(format!(
            "{file}: the last line has no end and is not read: it may be cut short"
        ));
    }
    for name in known.iter().filter(|name| !required.contains(*name)) {
        let empty = |column: &Vec<f64>| column.iter().all(|x| !x.is_finite());
        if columns.get(*name).is_some_and(empty) {
            columns.remove(*name);
            remarks.push(format!(
                "{file}: column {name} holds no number: taken as not recorded"
            ));
        }
    }
    let is_recorded = |name: &&str| found.columns.contains_key(*name);
    let used: Vec<&str> = known.into_iter().filter(is_recorded).collect();
    let (clock, gaps, saturated) = check_columns(&mut found, required, &used, on_gaps, &file)?;
    Ok(Run {
        entry,
        t0_s: clock.t0_s,
        dt_s: clock.dt_s,
        columns: found.columns,
        gaps,
        saturated,
        remarks,
    })
}

/// Sets `distance_m`, the distance run on the same finish of the runners, if the index does not: to
/// the sum of the earlier runs in the session.
///
/// Runners are assumed to be finished between sessions and not within one; otherwise the index must
/// give `distance_m`.
fn fill_in_distances(runs: &mut [Run]) {
    let mut sums: BTreeMap<String, f64> = BTreeMap::new();
    for run in runs {
        let sum = sums.entry(run.entry.session.clone()).or_insert(0.0);
        let distance_m = &mut run.entry.conditions.distance_m;
        if distance_m.is_nan() {
            *distance_m = *sum;
        }
        *sum += match run.columns.get("s_m").map(Vec::as_slice) {
            Some([first, .., last]) if (last - first).is_finite() => last - first,
            _ => run.travelled_m(run.len()).unwrap_or(0.0),
        };
    }
}

/// Pairs of runs with the same samples, the first of them and a later one: a copied file would
/// count double.
pub(crate) fn copies<R: Borrow<Run>>(runs: &[R]) -> Vec<(usize, usize)> {
    let mut seen: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
    let copied = runs
        .iter()
        .map(R::borrow)
        .enumerate()
        .filter_map(|(i, run)| {
            // Whole columns are compared only if a few samples are equal.
            let columns = COLUMNS.iter().filter_map(|name| run.columns.get(*name));
            let few = columns.flat_map(|values| {
                let middle = values[values.len() / 2];
                [values.len() as u64, values[0].to_bits(), middle.to_bits()]
            });
            let first = *seen.entry(few.collect()).or_insert(i);
            let bits = |run: &Run| -> Vec<u64> {
                let values = run.columns.values().flatten();
                values.map(|x| x.to_bits()).collect()
            };
            let other = runs[first].borrow();
            let is_same =
                || other.columns.keys().eq(run.columns.keys()) && bits(other) == bits(run);
            (first != i && is_same()).then_some((first, i))
        });
    copied.collect()
}

/// File formats of written runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RunFormat {
    /// CSV with nine decimals.
    #[default]
    Csv,
    /// Parquet, 64-bit, compressed with Zstandard.
    Parquet,
}

impl RunFormat {
    /// Extension of the file's name.
    pub fn extension(self) -> &'static str {
        match self {
            RunFormat::Csv => "csv",
            RunFormat::Parquet => "parquet",
        }
    }
}

/// Writes one run: time, the columns of [`COLUMNS`] in their order, then the others by name. The
/// writer need not be buffered.
///
/// # Errors
/// [`Error::File`] from the writer, and for an infinite value.
pub fn write_run(
    run: &Run,
    writer: &mut (dyn Write + Send),
    format: RunFormat,
) -> Result<(), Error> {
    let failure = |reason: &dyn Display| Error::file(run.entry.file.display(), reason);
    for (column, values) in &run.columns {
        if let Some(i) = values.iter().position(|value| value.is_infinite()) {
            let (name, value) = (&run.entry.run, values[i]);
            return Err(failure(&format!(
                "run {name}: {column} is {value} in sample {i}; expected a finite number"
            )));
        }
    }
    let writer = BufWriter::with_capacity(1 << 18, writer);
    // Nine decimals are a nanosecond and far below any sensor's step; they keep text files short.
    let nine_decimals = |value: f64| (value * 1e9).round() / 1e9;
    let decimals = |value: &f64| match format {
        RunFormat::Csv => nine_decimals(*value),
        RunFormat::Parquet => *value,
    };
    let times = (0..run.len()).map(|i| nine_decimals(run.t0_s + i as f64 * run.dt_s));
    let others = run.columns.keys().map(String::as_str);
    let others = others.filter(|name| !COLUMNS.contains(name));
    let mut columns: Vec<(&str, Vec<f64>)> = vec![("t_s", times.collect())];
    for name in COLUMNS.into_iter().chain(others) {
        if let Some(values) = run.columns.get(name) {
            columns.push((name, values.iter().map(decimals).collect()));
        }
    }
    let slices = columns.iter().map(|(name, values)| (*name, &values[..]));
    let table: Vec<(&str, &[f64])> = slices.collect();
    match format {
        RunFormat::Csv => write_csv(writer, &table).map_err(|error| failure(&error)),
        RunFormat::Parquet => write_parquet(writer, &table),
    }
}
