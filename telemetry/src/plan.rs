//! The runs of a mapping: their files, and their rows of `runs.csv`.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use kufe_files::{TABLE_TEXT, column_names, line_of_row, row_error};
use kufe_sled::{
    CONDITIONS, COVARIATE, Conditions, Entry, ICE_AT, INDEX_COLUMNS, IceAlong, MORE_INDEX_COLUMNS,
    file_stem, write_index,
};
use serde::Serialize;

use crate::error::Error;
use crate::mapping::{IndexValues, Mapping, PlannedRun, place_of, plain_name};

/// Largest size of an index table [bytes].
const MAX_TABLE_BYTES: u64 = 1 << 24;

/// A run that is not imported.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExcludedRun {
    /// Name of the run.
    pub run: String,
    /// Reason why it is not imported.
    pub reason: String,
}

/// The runs of a mapping.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Runs with a file of every logger, sorted by name.
    pub runs: Vec<PlannedRun>,
    /// Runs without a file of some logger.
    pub excluded: Vec<ExcludedRun>,
}

/// The runs of a mapping in `folder`, sorted by name.
///
/// The text that the `*` of a logger's pattern matches is the name of a run; tables `[[run]]` state
/// further runs.
///
/// # Errors
/// [`Error::Key`] for a pattern without matches, an invalid name of a run, or where no run has all
/// of its files; [`Error::File`] for an index table that cannot be read.
pub fn plan(mapping: &Mapping, folder: &Path, file: &str) -> Result<Plan, Error> {
    let wrong = |key: String, found: String, expected: String| Error::Key {
        file: file.to_string(),
        key,
        found,
        expected,
    };
    let files = files_by_run(mapping, folder, &wrong)?;
    let table = match &mapping.index.table {
        None => Vec::new(),
        Some(path) => {
            let path = folder.join(path);
            let file = path.display().to_string();
            let bytes = kufe_files::read_regular(&path, MAX_TABLE_BYTES);
            read_table(&bytes.map_err(|error| Error::file(&file, error))?, &file)?
        }
    };
    if files.is_empty() {
        let expected = "logger.NAME.files or a table [[run]]";
        return Err(wrong("run".into(), "no run".into(), expected.into()));
    }
    for (name, _) in &table {
        if !files.contains_key(name) {
            let known: Vec<&str> = files.keys().map(String::as_str).take(60).collect();
            let (found, known) = (format!("a row of run {name:?}"), known.join(", "));
            return Err(wrong(
                "index.table".into(),
                found,
                format!("one of: {known}"),
            ));
        }
    }
    let mut plan = Plan::default();
    let mut first = None;
    for (name, files) in files {
        let mut loggers = mapping.logger.keys();
        if let Some(logger) = loggers.find(|logger| !files.contains_key(*logger)) {
            let there = files.values().map(|path| path.display().to_string());
            let there = there.collect::<Vec<_>>().join(", ");
            let found = format!("no file of run {name}");
            let expected =
                format!("one in addition to {there}, or files.{logger} in a table [[run]]");
            let error = wrong(format!("logger.{logger}.files"), found, expected);
            plan.excluded.push(ExcludedRun {
                run: name,
                reason: error.to_string(),
            });
            first.get_or_insert(error);
            continue;
        }
        let own = mapping.run.iter().find(|run| run.name == name);
        let own = own.cloned().unwrap_or_default();
        let row = table.iter().find(|(run, _)| *run == name);
        let row = row.map_or(IndexValues::default(), |(_, values)| values.clone());
        plan.runs.push(PlannedRun {
            index: mapping.index.overridden_by(&row).overridden_by(&own.index),
            name,
            files,
            ..own
        });
    }
    match first {
        Some(error) if plan.runs.is_empty() => Err(error),
        _ => Ok(plan),
    }
}

/// The error of a key with the value that was found and what was expected.
type KeyError<'a> = dyn Fn(String, String, String) -> Error + 'a;

/// The file of each logger, by run and logger: those that match patterns, and those of `[[run]]`.
fn files_by_run(
    mapping: &Mapping,
    folder: &Path,
    wrong: &KeyError,
) -> Result<BTreeMap<String, BTreeMap<String, PathBuf>>, Error> {
    let mut files: BTreeMap<String, BTreeMap<String, PathBuf>> = BTreeMap::new();
    for (name, logger) in &mapping.logger {
        let Some(pattern) = &logger.files else {
            continue;
        };
        let key = format!("logger.{name}.files");
        let found = matching(folder, pattern)
            .map_err(|expected| wrong(key.clone(), pattern.clone(), expected))?;
        for (run, path) in found {
            if plain_name(&run).is_none() {
                let expected =
                    "a file whose name can name a run: letters, digits, '-', '_' and '.'";
                return Err(wrong(key, path.display().to_string(), expected.to_string()));
            }
            files.entry(run).or_default().insert(name.clone(), path);
        }
    }
    for run in &mapping.run {
        let own = run.files.iter();
        let own = own.map(|(logger, path)| (logger.clone(), folder.join(path)));
        files.entry(run.name.clone()).or_default().extend(own);
    }
    Ok(files)
}

/// Files that match a pattern, with the text that its `*` matches, sorted. For a pattern without
/// `*` the text is the stem of the file name.
///
/// # Errors
/// The expected pattern or files.
fn matching(folder: &Path, pattern: &str) -> Result<Vec<(String, PathBuf)>, String> {
    let whole = folder.join(pattern);
    let text = |part: Option<&OsStr>| part.unwrap_or_default().to_string_lossy().to_string();
    let last = text(whole.file_name());
    let parent = whole.parent().unwrap_or(Path::new("")).to_path_buf();
    let Some((before, after)) = last.split_once('*') else {
        return Ok(vec![(text(whole.file_stem()), whole)]);
    };
    if after.contains('*') || parent.to_string_lossy().contains('*') {
        return Err("one '*', in the last part of the path".to_string());
    }
    let here = parent.as_os_str().is_empty();
    let shown = if here { Path::new(".") } else { &parent };
    let entries = std::fs::read_dir(shown)
        .map_err(|error| format!("a folder {}: {error}", shown.display()))?;
    let mut found = Vec::new();
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().to_string();
        let rest = name.strip_prefix(before);
        let run = rest.and_then(|rest| rest.strip_suffix(after));
        if let Some(run) = run.filter(|run| !run.is_empty() && !name.starts_with('.')) {
            found.push((run.to_string(), parent.join(&name)));
        }
    }
    found.sort();
    if found.is_empty() {
        return Err(format!("files of that pattern in {}", shown.display()));
    }
    Ok(found)
}

impl IndexValues {
    /// Numeric values in the order of [`CONDITIONS`].
    pub(crate) fn numbers(&mut self) -> [&mut Option<f64>; 6] {
        [
            &mut self.ice_c,
            &mut self.air_c,
            &mut self.air_pa,
            &mut self.humidity_pct,
            &mut self.distance_m,
            &mut self.mass_kg,
        ]
    }

    /// Text values with the names of their columns.
    fn texts(&mut self) -> [(&'static str, &mut Option<String>); 4] {
        [
            ("track", &mut self.track),
            ("driver", &mut self.driver),
            ("driver_class", &mut self.driver_class),
            ("session", &mut self.session),
        ]
    }

    /// Sets the value of a cell.
    ///
    /// # Errors
    /// The expected value.
    fn set(&mut self, name: &str, cell: &str) -> Result<(), String> {
        let text = self.texts().iter().position(|(known, _)| *known == name);
        if let Some(at) = text {
            *self.texts()[at].1 = Some(cell.to_string());
            return Ok(());
        }
        if name.starts_with(COVARIATE) {
            self.covariates.insert(name.to_owned(), cell.to_owned());
            return Ok(());
        }
        let place = name.strip_prefix(ICE_AT);
        let column = place.map_or(name, |_| "ice_c");
        let known = CONDITIONS.iter().position(|known| known.0 == column);
        let at = known.ok_or("no cell")?;
        let (_, low, high) = CONDITIONS[at];
        let value: Option<f64> = cell.replace(',', ".").parse().ok();
        let value = value.filter(|value| (low..=high).contains(value));
        let value = value.ok_or_else(|| format!("a number from {low} to {high}"))?;
        match place {
            Some(place) => {
                self.ice_c_at.insert(place.to_string(), value);
            }
            None => *self.numbers()[at] = Some(value),
        }
        Ok(())
    }

    /// The values of `overriding`, with those of `self` as defaults.
    pub(crate) fn overridden_by(&self, overriding: &IndexValues) -> IndexValues {
        let (mut defaults, mut merged) = (self.clone(), overriding.clone());
        for (value, default) in merged.numbers().into_iter().zip(defaults.numbers()) {
            *value = value.or(*default);
        }
        for ((_, text), (_, default)) in merged.texts().into_iter().zip(defaults.texts()) {
            *text = text.take().or(default.take());
        }
        if merged.ice_c_at.is_empty() {
            merged.ice_c_at = defaults.ice_c_at;
        }
        defaults.covariates.append(&mut merged.covariates);
        merged.covariates = defaults.covariates;
        IndexValues {
            table: None,
            ..merged
        }
    }
}

impl PlannedRun {
    /// The run's row of `runs.csv`.
    pub(crate) fn entry(&self, file: PathBuf) -> Entry {
        let mut index = self.index.clone();
        let ice = index.ice_c_at.iter();
        let ice_along = ice.filter_map(|(place, value)| Some([place_of(place)?, *value]));
        let ice_along = IceAlong::new(ice_along);
        let stated = index.numbers().map(|value| value.unwrap_or(f64::NAN));
        let [track, driver, driver_class, session] = index
            .texts()
            .map(|(_, text)| text.as_deref().unwrap_or_default().trim().to_string());
        Entry {
            run: self.name.clone(),
            file,
            track,
            driver,
            driver_class,
            session,
            conditions: Conditions::from_values(stated),
            ice_along,
            covariates: index.covariates,
            ..Entry::default()
        }
    }
}

/// Rows of an index table: the name of each run with its values.
///
/// # Errors
/// [`Error::Cell`] and [`Error::File`] with row and column.
pub(crate) fn read_table(bytes: &[u8], file: &str) -> Result<Vec<(String, IndexValues)>, Error> {
    let failure = |error: csv::Error| Error::file(file, error);
    let bytes = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    let head = bytes.split(|byte| *byte == b'\n').next();
    let semicolons = head.is_some_and(|head| head.contains(&b';'));
    let delimiter = if semicolons { b';' } else { b',' };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .from_reader(bytes);
    let header = column_names(reader.byte_headers().map_err(failure)?.iter())
        .map_err(|what| Error::file(file, format!("{what}; expected {TABLE_TEXT}")))?;
    let known = || INDEX_COLUMNS.iter().chain(&MORE_INDEX_COLUMNS);
    for (i, name) in header.iter().enumerate() {
        if header[..i].contains(name) {
            let twice = format!("column {name:?} is given twice, expected once");
            return Err(Error::file(file, twice));
        }
        let place = name.strip_prefix(ICE_AT);
        let own = name.strip_prefix(COVARIATE);
        if place.is_some_and(|place| place_of(place).is_some())
            || own.is_some_and(|own| !own.is_empty())
        {
            continue;
        }
        if name == "file" || !known().any(|known| known == name) {
            let names: Vec<&str> = known().copied().filter(|name| *name != "file").collect();
            let names = names.join(", ");
            let unknown = format!(
                "column {name:?} is unknown, expected some of: {names}, {ICE_AT}350 (at 350 m), {COVARIATE}NAME (your own)"
            );
            return Err(Error::file(file, unknown));
        }
    }
    let Some(run) = header.iter().position(|name| name == "run") else {
        return Err(Error::file(file, "there is no column \"run\""));
    };
    let mut rows: Vec<(String, IndexValues)> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| Error::file(file, row_error(bytes, &error)))?;
        let row = line_of_row(bytes, &record);
        let name = record.get(run).unwrap_or("").to_string();
        if rows.iter().any(|(known, _)| *known == name) {
            let twice = format!("row {row}: run {name:?} is given twice, expected once");
            return Err(Error::file(file, twice));
        }
        let mut values = IndexValues::default();
        for (column, cell) in header.iter().zip(&record) {
            if column == "run" || cell.is_empty() {
                continue;
            }
            values.set(column, cell).map_err(|expected| {
                let found =
                    format!("row {row}, column {column}: found {cell:?}, expected {expected}");
                Error::file(file, found)
            })?;
        }
        rows.push((name, values));
    }
    Ok(rows)
}

/// Questions about the values of `runs.csv`, for a guessed mapping.
pub(crate) fn index_help() -> String {
    let mut text = String::from(
        "\n[index]\n# Values of runs.csv for all runs; a CSV with a column run may state them run by run.\n# table = \"index.csv\"\n",
    );
    for (name, what) in [
        ("track", "\"\""),
        ("driver", "\"\""),
        ("driver_class", "\"\""),
        ("session", "\"\""),
        ("ice_c", "-8.0"),
        ("air_c", "0.0"),
        ("air_pa", "95000.0"),
    ] {
        text += &format!("# ? {name} of the runs\n# {name} = {what}\n");
    }
    text + "# humidity_pct, distance_m, mass_kg and ice_c_at = { 350 = -8.2 } are possible here too\n"
}

/// The text of `runs.csv`: its usual columns, with empty cells for missing values, and further
/// columns that any run states.
///
/// # Errors
/// [`Error::File`] of the writer.
pub fn index_csv(runs: &[PlannedRun], ending: &str) -> Result<Vec<u8>, Error> {
    let file = |run: &PlannedRun| format!("{}.{ending}", file_stem(&run.name)).into();
    let entries: Vec<Entry> = runs.iter().map(|run| run.entry(file(run))).collect();
    let mut text = Vec::new();
    write_index(&mut text, &entries).map_err(|error| Error::file("runs.csv", error))?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_after_blank_lines_has_the_line_of_the_file() {
        for end in ["\n", "\r\n"] {
            let lines = ["\u{feff}run,ice_c", "", "a,-5", "", "b,warm", ""];
            let text = lines.join(end);
            let error = read_table(text.as_bytes(), "index.csv").unwrap_err();
            assert!(error.to_string().contains("row 5"), "{error}");
        }
    }
}
