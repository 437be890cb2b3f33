//! The index `runs.csv`: one row a run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::model::conditions::Conditions;
use crate::record::file_names::track_file;
use crate::track::table::{ICE_C, IceAlong, Track};

/// Columns of the index; only `run` and `file` must be there, the others where something asks for them.
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

/// Columns that the index may have besides: for effects that ask for them, and the mass where it is not the model's.
pub const MORE_INDEX_COLUMNS: [&str; 3] = ["humidity_pct", "distance_m", "mass_kg"];

/// Most runs of an index: a campaign has hundreds.
const MOST_RUNS: usize = 20_000;

/// The indispensable ones among [`INDEX_COLUMNS`]; the others may be absent, and their cells empty.
const ALWAYS: [&str; 2] = ["run", "file"];

/// What names say that are not stated.
const UNNAMED: &str = "unnamed";

/// How columns begin that hold the ice's temperature at a place, `ice_c@350` at 350 m.
pub const ICE_AT: &str = "ice_c@";

/// One row of the index.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name of the run, unique in the index.
    pub run: String,
    /// The run's file, resolved against the folder of the index.
    pub file: PathBuf,
    /// Name of the track.
    pub track: String,
    /// Driver.
    pub driver: String,
    /// Driver's class.
    pub driver_class: String,
    /// Session (a day, a set-up).
    pub session: String,
    /// Ice and air.
    pub conditions: Conditions,
    /// Temperatures of the ice at places along the track, measured for this run alone.
    pub ice_along: IceAlong,
    /// The same of the track's own table, for every run on it.
    pub ice_of_track: IceAlong,
}

impl Entry {
    /// The temperature of the ice at a place [m]: the run's own, else the track's; none where neither states it.
    pub fn ice_at(&self, s_m: f64) -> Option<f64> {
        self.ice_along.at(s_m).or_else(|| self.ice_of_track.at(s_m))
    }
}

/// Reads the index `runs.csv`; paths in it are relative to its folder, and so is `track_NAME.csv`, whose `ice_c` counts.
///
/// # Errors
/// [`Error::Column`], [`Error::MissingColumn`], [`Error::Cell`], [`Error::DuplicateRun`], [`Error::DuplicateContent`] for a
/// file that two runs have, [`Error::File`] for too many runs, those of [`Track::load`].
pub fn read_index(index: &Path) -> Result<Vec<Entry>, Error> {
    let file = index.display().to_string();
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(kufe_files::open_regular(index).map_err(|error| Error::file(&file, error))?);
    let header = reader
        .headers()
        .map_err(|error| Error::file(&file, error))?
        .clone();
    let (at, sensors) = place_columns(&header, &file)?;
    let folder = index.parent().unwrap_or(Path::new(""));
    let mut entries: Vec<Entry> = Vec::new();
    let mut files: BTreeMap<PathBuf, String> = BTreeMap::new();
    let mut rows: BTreeMap<String, u64> = BTreeMap::new();
    let mut tracks: BTreeMap<String, IceAlong> = BTreeMap::new();
    for record in reader.records() {
        let record = record.map_err(|error| Error::file(&file, error))?;
        let row = record.position().map_or(0, |position| position.line());
        let cell = |name: &str| {
            let cell = at.get(name).and_then(|place| record.get(*place));
            cell.unwrap_or("")
        };
        let text = |name: &str| match cell(name) {
            "" if ALWAYS.contains(&name) => Err(bad_cell(&file, row, name, "", "a name")),
            "" => Ok(UNNAMED.to_string()),
            cell => Ok(cell.to_string()),
        };
        let number = |name: &str, cell: &str, (low, high): (f64, f64)| {
            if cell.is_empty() {
                return Ok(None);
            }
            let value: Option<f64> = cell.parse().ok();
            let value = value.filter(|value| (low..=high).contains(value));
            let expected = || format!("a number from {low} to {high}");
            let value = value.ok_or_else(|| bad_cell(&file, row, name, cell, &expected()))?;
            Ok::<_, Error>(Some(value))
        };
        let stated = |name, low, high| number(name, cell(name), (low, high));
        let run = text("run")?;
        if let Some(first) = rows.insert(run.clone(), row) {
            return Err(Error::DuplicateRun {
                file,
                row,
                run,
                first,
            });
        }
        if entries.len() == MOST_RUNS {
            let reason = format!("row {row}: expected at most {MOST_RUNS} runs");
            return Err(Error::file(&file, reason));
        }
        let path = folder.join(text("file")?);
        if let Some(first) = files.insert(path.clone(), run.clone()) {
            let same = Error::DuplicateContent { first, second: run };
            let reason = format!("row {row}: {same}");
            return Err(Error::file(&file, reason));
        }
        let mut own = Vec::new();
        for (s_m, place) in &sensors {
            let name = format!("{ICE_AT}{s_m}");
            let value = number(&name, record.get(*place).unwrap_or(""), ICE_C)?;
            own.extend(value.map(|value| [*s_m, value]));
        }
        let track = text("track")?;
        if !tracks.contains_key(&track) {
            let table = folder.join(track_file(&track));
            tracks.insert(track.clone(), ice_of(&table)?);
        }
        entries.push(Entry {
            run,
            file: path,
            ice_along: IceAlong::new(own),
            ice_of_track: tracks[&track].clone(),
            track,
            driver: text("driver")?,
            driver_class: text("driver_class")?,
            session: text("session")?,
            conditions: Conditions {
                ice_c: stated("ice_c", ICE_C.0, ICE_C.1)?.unwrap_or(f64::NAN),
                air_c: stated("air_c", -60.0, 50.0)?.unwrap_or(f64::NAN),
                air_pa: stated("air_pa", 50e3, 110e3)?.unwrap_or(f64::NAN),
                humidity_pct: stated("humidity_pct", 0.0, 100.0)?,
                distance_m: stated("distance_m", 0.0, 1e8)?,
                mass_kg: stated("mass_kg", 1.0, 1e5)?,
            },
        });
    }
    if entries.is_empty() {
        return Err(Error::TooFew {
            what: format!("{file}: runs"),
            found: 0,
            needed: 1,
        });
    }
    Ok(entries)
}

/// Writes the index; files are named relative to its folder, and [`MORE_INDEX_COLUMNS`] stand there where a run states them.
///
/// # Errors
/// [`Error::File`].
pub fn write_index(writer: impl std::io::Write, entries: &[Entry]) -> Result<(), Error> {
    let told = |error: csv::Error| Error::file("runs.csv", error);
    let mut table = csv::Writer::from_writer(writer);
    let more: [fn(&Conditions) -> Option<f64>; 3] =
        [|c| c.humidity_pct, |c| c.distance_m, |c| c.mass_kg];
    let stated = more.map(|of| entries.iter().any(|entry| of(&entry.conditions).is_some()));
    let names = MORE_INDEX_COLUMNS.iter().zip(stated);
    let names = names.filter_map(|(name, stated)| stated.then_some((*name).to_string()));
    let sensors = entries.iter().flat_map(|entry| entry.ice_along.points());
    let mut places: Vec<f64> = sensors.map(|point| point[0]).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let names = INDEX_COLUMNS.into_iter().map(str::to_string).chain(names);
    let sensors = places.iter().map(|s_m| format!("{ICE_AT}{s_m}"));
    table.write_record(names.chain(sensors)).map_err(told)?;
    for entry in entries {
        let c = &entry.conditions;
        let finite = |value: f64| match value.is_finite() {
            true => value.to_string(),
            false => String::new(),
        };
        let mut row = vec![
            entry.run.clone(),
            entry.file.display().to_string(),
            entry.track.clone(),
            entry.driver.clone(),
            entry.driver_class.clone(),
            entry.session.clone(),
            finite(c.ice_c),
            finite(c.air_c),
            finite(c.air_pa),
        ];
        for (of, _) in more.iter().zip(stated).filter(|(_, stated)| *stated) {
            row.push(of(c).map_or_else(String::new, |value| value.to_string()));
        }
        for s_m in &places {
            let point = entry.ice_along.points().iter().find(|p| p[0] == *s_m);
            row.push(point.map_or_else(String::new, |point| point[1].to_string()));
        }
        table.write_record(&row).map_err(told)?;
    }
    table
        .flush()
        .map_err(|error| Error::file("runs.csv", error))
}

/// What the table of a track says of its ice; nothing where there is no such table, or no `ice_c` in it.
fn ice_of(path: &Path) -> Result<IceAlong, Error> {
    let mut head = String::new();
    if let Ok(file) = kufe_files::open_regular(path) {
        let limit = std::io::Read::take(file, 1 << 16);
        // Who reads the rest of the table tells what is wrong with it.
        let _ = std::io::BufRead::read_line(&mut std::io::BufReader::new(limit), &mut head);
    }
    match head.split(',').any(|name| name.trim() == "ice_c") {
        true => Ok(Track::load(path)?.ice),
        false => Ok(IceAlong::default()),
    }
}

/// Where the columns stand, and those of temperatures at places [m].
type Places = (BTreeMap<&'static str, usize>, Vec<(f64, usize)>);

fn place_columns(header: &csv::StringRecord, file: &str) -> Result<Places, Error> {
    let mut at = BTreeMap::new();
    let mut sensors: Vec<(f64, usize)> = Vec::new();
    for (place, name) in header.iter().enumerate() {
        let odd = |what| Error::Column {
            file: file.to_string(),
            column: name.to_string(),
            what,
            expected: format!(
                "some of {}, {}, {ICE_AT}350 (at 350 m)",
                INDEX_COLUMNS.join(", "),
                MORE_INDEX_COLUMNS.join(", ")
            ),
        };
        if let Some(s_m) = name.strip_prefix(ICE_AT) {
            let s_m: Option<f64> = s_m.parse().ok().filter(|s: &f64| s.abs() < 1e6);
            let s_m = s_m.ok_or_else(|| odd("at no distance"))?;
            if sensors.iter().any(|(known, _)| *known == s_m) {
                return Err(odd("given twice"));
            }
            sensors.push((s_m, place));
            continue;
        }
        let known = INDEX_COLUMNS
            .iter()
            .chain(&MORE_INDEX_COLUMNS)
            .find(|known| **known == name)
            .ok_or_else(|| odd("unknown"))?;
        if at.insert(*known, place).is_some() {
            return Err(odd("given twice"));
        }
    }
    match ALWAYS.iter().find(|name| !at.contains_key(*name)) {
        None => Ok((at, sensors)),
        Some(missing) => Err(Error::MissingColumn {
            file: file.to_string(),
            column: missing.to_string(),
            found: header.iter().collect::<Vec<_>>().join(", "),
            needed_by: None,
        }),
    }
}

fn bad_cell(file: &str, row: u64, column: &str, found: &str, expected: &str) -> Error {
    Error::Cell {
        file: file.to_string(),
        row,
        column: column.to_string(),
        found: found.to_string(),
        expected: expected.to_string(),
    }
}
