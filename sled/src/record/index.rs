//! The index `runs.csv`: one row a run.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::columns::table::{Table, TableColumns};
use crate::conditions::{CONDITIONS, Conditions};
use crate::error::Error;
use crate::record::file_names::track_file;
use crate::track::table::{IceAlong, Track};

/// Columns of the index. `run` and `file` are required; the others only for computations that need
/// them.
pub const INDEX_COLUMNS: [&str; 9] = [
    "run",
    "file",
    "track",
    "driver",
    "driver_class",
    "session",
    "ice_c",
    "air_c",
    "air_pa",
];

/// Further columns of the index: conditions that some effects need, and the mass of the run if it
/// differs from that of the model.
pub const MORE_INDEX_COLUMNS: [&str; 3] = ["humidity_pct", "distance_m", "mass_kg"];

/// Prefix of the columns of further covariates, numbers or words: `x_start_order`, `x_runners`. See
/// [`covariates`].
pub const COVARIATE: &str = "x_";

/// Most runs of an index: a campaign has hundreds.
const MAX_RUNS: usize = 20_000;

const COLUMNS: TableColumns = TableColumns {
    required: INDEX_COLUMNS.split_at(2).0,
    optional: INDEX_COLUMNS.split_at(2).1,
    further: |name| {
        MORE_INDEX_COLUMNS.contains(&name) || name.starts_with(ICE_AT) || is_covariate(name)
    },
    further_names: ", humidity_pct, distance_m, mass_kg, ice_c@350 (at 350 m), x_NAME (your own)",
};

/// Name of a track, driver, class or session that the index does not give.
const UNNAMED: &str = "unnamed";

/// Prefix of the columns of ice temperatures along the track: `ice_c@350` at 350 m.
pub const ICE_AT: &str = "ice_c@";

/// One row of the index.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Entry {
    /// Line of the run in the index; 0 for a run without an index.
    pub line: u64,
    /// Name of the run, unique in the index.
    pub run: String,
    /// The run's file, resolved against the folder of the index.
    pub file: PathBuf,
    /// Name of the track.
    pub track: String,
    /// Name of the driver.
    pub driver: String,
    /// Class of the driver.
    pub driver_class: String,
    /// Session: runs of one day with one set-up.
    pub session: String,
    /// Ice, air, runners and mass.
    pub conditions: Conditions,
    /// Ice temperatures along the track, measured for this run.
    pub ice_along: IceAlong,
    /// Ice temperatures of the track's table, common to all runs on it.
    pub ice_of_track: IceAlong,
    /// Cells of the columns `x_NAME` by column, without empty ones.
    pub covariates: BTreeMap<String, String>,
}

impl Entry {
    /// Ice temperature [degrees Celsius] at a distance [m], of the run, else of the track's table;
    /// `None` if neither has any.
    pub fn ice_at(&self, s_m: f64) -> Option<f64> {
        self.ice_along.at(s_m).or_else(|| self.ice_of_track.at(s_m))
    }
}

/// The columns `x_NAME` of an index as numbers: for each run the values by name, without those of
/// its empty cells.
///
/// A column in which every cell is a finite number has these values. A column with words is a
/// factor: each word of several runs, but not of all, becomes an indicator `x_NAME=WORD` of 1 or 0.
/// Of two words the first in the alphabet is the reference and has no indicator.
pub fn covariates(entries: &[&Entry]) -> Vec<BTreeMap<String, f64>> {
    let mut values = vec![BTreeMap::new(); entries.len()];
    let names: BTreeSet<&String> = entries.iter().flat_map(|e| e.covariates.keys()).collect();
    for name in names {
        let cells: Vec<(usize, &str)> = (entries.iter().enumerate())
            .filter_map(|(run, entry)| Some((run, entry.covariates.get(name)?.as_str())))
            .collect();
        let number = |cell: &str| cell.parse().ok().filter(|value: &f64| value.is_finite());
        let numbers: Option<Vec<f64>> = cells.iter().map(|(_, cell)| number(cell)).collect();
        if let Some(numbers) = numbers {
            for ((run, _), value) in cells.iter().zip(numbers) {
                values[*run].insert(name.clone(), value);
            }
            continue;
        }
        let words: BTreeSet<&str> = cells.iter().map(|(_, cell)| *cell).collect();
        for word in words.iter().skip(usize::from(words.len() == 2)) {
            let with = cells.iter().filter(|(_, cell)| cell == word).count();
            if with < 2 || with == cells.len() {
                continue;
            }
            for (run, cell) in &cells {
                values[*run].insert(format!("{name}={word}"), f64::from(cell == word));
            }
        }
    }
    values
}

/// Reads the index `runs.csv`, and the ice temperatures of the tables `track_NAME.csv` of its tracks.
/// Paths are relative to the folder of the index.
///
/// # Errors
/// [`Error::Column`], [`Error::MissingColumn`], [`Error::Cell`]; [`Error::Row`] for a run or a file
/// that is given twice and for too many runs; those of [`Track::load`].
pub fn read_index(index: &Path) -> Result<Vec<Entry>, Error> {
    let file = index.display().to_string();
    let reader = kufe_files::open_regular(index).map_err(|error| Error::file(&file, error))?;
    let table = Table::read(&file, reader, &COLUMNS)?;
    let sensors = temperature_places(&table.header, &file)?;
    let covariates = table.header.iter().filter(|name| is_covariate(name));
    let covariates: Vec<&String> = covariates.collect();
    let folder = index.parent().unwrap_or(Path::new(""));
    let mut entries: Vec<Entry> = Vec::new();
    let mut files: BTreeMap<PathBuf, String> = BTreeMap::new();
    let mut rows: BTreeMap<String, u64> = BTreeMap::new();
    let mut tracks: BTreeMap<String, IceAlong> = BTreeMap::new();
    for row in 0..table.rows() {
        let line = table.line(row);
        let text = |name: &str| {
            let cell = table.nonempty_text(row, name);
            cell.unwrap_or_else(|| UNNAMED.to_string())
        };
        let number = |name: &str, low: f64, high: f64| {
            let expected = format!("a number from {low} to {high}");
            let cell = table.nonempty_text(row, name);
            let value = cell.map(|_| table.number_within(row, name, (low, high), &expected));
            value.unwrap_or(Ok(f64::NAN))
        };
        let run = table.name(row, "run")?;
        if let Some(first) = rows.insert(run.clone(), line) {
            let reason =
                format!("run {run:?} is already named in row {first}, expected each run once");
            return Err(Error::row(&file, line, reason));
        }
        if entries.len() == MAX_RUNS {
            let reason = format!("expected at most {MAX_RUNS} runs");
            return Err(Error::row(&file, line, reason));
        }
        let path = folder.join(table.name(row, "file")?);
        if let Some(first) = files.insert(path.clone(), run.clone()) {
            let same = Error::DuplicateContent { first, second: run };
            return Err(Error::row(&file, line, same.to_string()));
        }
        let (_, low, high) = CONDITIONS[0];
        let mut points = Vec::new();
        for (s_m, name) in &sensors {
            points.push([*s_m, number(name, low, high)?]);
        }
        let track = text("track");
        if !tracks.contains_key(&track) {
            let table = folder.join(track_file(&track));
            tracks.insert(track.clone(), ice_of(&table)?);
        }
        let mut conditions = Conditions::UNSTATED.values();
        for (value, (name, low, high)) in conditions.iter_mut().zip(CONDITIONS) {
            *value = number(name, low, high)?;
        }
        let covariates = covariates.iter().copied();
        entries.push(Entry {
            line,
            run,
            file: path,
            ice_along: IceAlong::new(points),
            ice_of_track: tracks[&track].clone(),
            track,
            driver: text("driver"),
            driver_class: text("driver_class"),
            session: text("session"),
            conditions: Conditions::from_values(conditions),
            covariates: covariates
                .filter_map(|name| Some((name.clone(), table.nonempty_text(row, name)?)))
                .collect(),
        });
    }
    if entries.is_empty() {
        return Err(Error::too_few(format!("{file}: runs"), 0, 1));
    }
    Ok(entries)
}

/// Writes the index with files relative to its folder. [`MORE_INDEX_COLUMNS`], ice temperatures along
/// the track and columns `x_NAME` are written if a run has a value.
///
/// # Errors
/// [`Error::File`].
pub fn write_index(writer: impl std::io::Write, entries: &[Entry]) -> Result<(), Error> {
    let failure = |error: csv::Error| Error::file("runs.csv", error);
    let mut table = csv::Writer::from_writer(writer);
    let is_written = |place: &usize| {
        let mut values = entries.iter().map(|e| e.conditions.values()[*place]);
        *place < 3 || values.any(f64::is_finite)
    };
    let written: Vec<usize> = (0..CONDITIONS.len()).filter(is_written).collect();
    let sensors = entries.iter().flat_map(|entry| entry.ice_along.points());
    let mut places: Vec<f64> = sensors.map(|point| point[0]).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let names = INDEX_COLUMNS[..6].iter().copied().map(str::to_string);
    let conditions = written.iter().map(|place| CONDITIONS[*place].0.to_string());
    let sensors = places.iter().map(|s_m| format!("{ICE_AT}{s_m}"));
    let covariates: BTreeSet<&String> = entries.iter().flat_map(|e| e.covariates.keys()).collect();
    let further = covariates.iter().map(|name| (*name).clone());
    let header = names.chain(conditions).chain(sensors).chain(further);
    table.write_record(header).map_err(failure)?;
    let number = |value: f64| {
        let text = value.is_finite().then(|| value.to_string());
        text.unwrap_or_default()
    };
    for entry in entries {
        let mut row = vec![
            entry.run.clone(),
            entry.file.display().to_string(),
            entry.track.clone(),
            entry.driver.clone(),
            entry.driver_class.clone(),
            entry.session.clone(),
        ];
        let values = entry.conditions.values();
        row.extend(written.iter().map(|place| number(values[*place])));
        for s_m in &places {
            let point = entry.ice_along.points().iter().find(|p| p[0] == *s_m);
            row.push(number(point.map_or(f64::NAN, |point| point[1])));
        }
        let further = covariates.iter().map(|name| entry.covariates.get(*name));
        row.extend(further.map(|cell| cell.cloned().unwrap_or_default()));
        table.write_record(&row).map_err(failure)?;
    }
    table
        .flush()
        .map_err(|error| Error::file("runs.csv", error))
}

/// Ice temperatures of a track's table; empty without the table or without `ice_c` in it.
fn ice_of(path: &Path) -> Result<IceAlong, Error> {
    let mut head = String::new();
    if let Ok(file) = kufe_files::open_regular(path) {
        let limit = std::io::Read::take(file, 1 << 16);
        // An error appears again, and is reported, when the whole table is read.
        let _ = std::io::BufRead::read_line(&mut std::io::BufReader::new(limit), &mut head);
    }
    if head.split(',').any(|name| name.trim() == "ice_c") {
        Ok(Track::load(path)?.ice)
    } else {
        Ok(IceAlong::default())
    }
}

fn is_covariate(name: &str) -> bool {
    name.strip_prefix(COVARIATE)
        .is_some_and(|own| !own.is_empty())
}

/// Distances [m] and names of the columns of ice temperatures along the track.
fn temperature_places<'a>(header: &'a [String], file: &str) -> Result<Vec<(f64, &'a str)>, Error> {
    let mut places: Vec<(f64, &str)> = Vec::new();
    for name in header.iter().filter(|name| name.starts_with(ICE_AT)) {
        let error = |what| Error::column(file, name, what, "ice_c@350 for the ice at 350 m");
        let s_m: Option<f64> = name[ICE_AT.len()..].parse().ok();
        let s_m = s_m.filter(|s| s.abs() < 1e6);
        let s_m = s_m.ok_or_else(|| error("at no distance"))?;
        if places.iter().any(|(known, _)| *known == s_m) {
            return Err(error("given twice"));
        }
        places.push((s_m, name));
    }
    Ok(places)
}
