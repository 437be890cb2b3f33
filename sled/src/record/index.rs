//! The index `runs.csv`: one row a run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::model::sled::ModelConditions;
use crate::motion::aero;

/// Columns of the index.
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

/// Among [`INDEX_COLUMNS`] what only some laws of friction ask for: the column may be absent, and its cells empty.
const NOT_ALWAYS: &str = "ice_c";

/// Ice, air and crew of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Ice temperature [degrees Celsius]; NaN where nothing states it: only tables and effects over it ask for it.
    pub ice_c: f64,
    /// Air temperature [degrees Celsius].
    pub air_c: f64,
    /// Air pressure [Pa].
    pub air_pa: f64,
    /// Relative humidity [%], where it is stated; only effects ask for it.
    pub humidity_pct: Option<f64>,
    /// Distance run on this finish of the runners before the run [m], where it is stated; only effects ask for it.
    pub distance_m: Option<f64>,
    /// Mass of the sled with its crew [kg], where it is not the model's.
    pub mass_kg: Option<f64>,
}

impl Conditions {
    /// The same with what the model states where nothing is stated here.
    pub fn or(&self, model: &ModelConditions) -> Conditions {
        Conditions {
            humidity_pct: self.humidity_pct.or(model.humidity_pct),
            distance_m: self.distance_m.or(model.distance_m),
            ..*self
        }
    }

    /// What effects may ask for and is not stated.
    pub fn absent(&self) -> Vec<&'static str> {
        let ice = Some(self.ice_c).filter(|ice| ice.is_finite());
        let stated = [
            ("humidity_pct", self.humidity_pct),
            ("distance_m", self.distance_m),
            ("ice_c", ice),
        ];
        let absent = stated.into_iter().filter(|(_, value)| value.is_none());
        absent.map(|(name, _)| name).collect()
    }

    /// Density of the air [kg/m3] by [`aero::air_density`].
    pub fn air_density(&self) -> f64 {
        aero::air_density(self.air_pa, self.air_c)
    }
}

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
}

/// Reads the index `runs.csv`; paths in it are relative to its folder.
///
/// # Errors
/// [`Error::Column`], [`Error::MissingColumn`], [`Error::Cell`], [`Error::DuplicateRun`].
pub fn read_index(index: &Path) -> Result<Vec<Entry>, Error> {
    let file = index.display().to_string();
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_path(index)
        .map_err(|error| Error::file(&file, error))?;
    let header = reader
        .headers()
        .map_err(|error| Error::file(&file, error))?
        .clone();
    let at = place_columns(&header, &file)?;
    let folder = index.parent().unwrap_or(Path::new(""));
    let mut entries: Vec<Entry> = Vec::new();
    let mut rows: BTreeMap<String, u64> = BTreeMap::new();
    for record in reader.records() {
        let record = record.map_err(|error| Error::file(&file, error))?;
        let row = record.position().map_or(0, |position| position.line());
        let text = |name: &str| -> Result<String, Error> {
            let cell = record.get(at[name]).unwrap_or("");
            if cell.is_empty() {
                return Err(bad_cell(&file, row, name, cell, "a name"));
            }
            Ok(cell.to_string())
        };
        let number = |name: &str, low: f64, high: f64| -> Result<f64, Error> {
            let cell = record.get(at[name]).unwrap_or("");
            let expected = format!("a number from {low} to {high}");
            let value: f64 = cell
                .parse()
                .map_err(|_| bad_cell(&file, row, name, cell, &expected))?;
            if !(low..=high).contains(&value) {
                return Err(bad_cell(&file, row, name, cell, &expected));
            }
            Ok(value)
        };
        let stated = |name: &str, low: f64, high: f64| -> Result<Option<f64>, Error> {
            match at.get(name).and_then(|place| record.get(*place)) {
                None | Some("") => Ok(None),
                Some(_) => number(name, low, high).map(Some),
            }
        };
        let run = text("run")?;
        if let Some(first) = rows.insert(run.clone(), row) {
            return Err(Error::DuplicateRun {
                file,
                row,
                run,
                first,
            });
        }
        entries.push(Entry {
            run,
            file: folder.join(text("file")?),
            track: text("track")?,
            driver: text("driver")?,
            driver_class: text("driver_class")?,
            session: text("session")?,
            conditions: Conditions {
                ice_c: stated("ice_c", -60.0, 5.0)?.unwrap_or(f64::NAN),
                air_c: number("air_c", -60.0, 50.0)?,
                air_pa: number("air_pa", 50e3, 110e3)?,
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
    let names = names.filter_map(|(name, stated)| stated.then_some(*name));
    table
        .write_record(INDEX_COLUMNS.into_iter().chain(names))
        .map_err(told)?;
    for entry in entries {
        let c = &entry.conditions;
        let mut row = vec![
            entry.run.clone(),
            entry.file.display().to_string(),
            entry.track.clone(),
            entry.driver.clone(),
            entry.driver_class.clone(),
            entry.session.clone(),
            if c.ice_c.is_finite() {
                c.ice_c.to_string()
            } else {
                String::new()
            },
            c.air_c.to_string(),
            c.air_pa.to_string(),
        ];
        for (of, _) in more.iter().zip(stated).filter(|(_, stated)| *stated) {
            row.push(of(c).map_or_else(String::new, |value| value.to_string()));
        }
        table.write_record(&row).map_err(told)?;
    }
    table
        .flush()
        .map_err(|error| Error::file("runs.csv", error))
}

fn place_columns(
    header: &csv::StringRecord,
    file: &str,
) -> Result<BTreeMap<&'static str, usize>, Error> {
    let mut at = BTreeMap::new();
    for (place, name) in header.iter().enumerate() {
        let odd = |what| Error::Column {
            file: file.to_string(),
            column: name.to_string(),
            what,
            expected: format!(
                "{} and perhaps {}",
                INDEX_COLUMNS.join(", "),
                MORE_INDEX_COLUMNS.join(", ")
            ),
        };
        let known = INDEX_COLUMNS
            .iter()
            .chain(&MORE_INDEX_COLUMNS)
            .find(|known| **known == name)
            .ok_or_else(|| odd("unknown"))?;
        if at.insert(*known, place).is_some() {
            return Err(odd("given twice"));
        }
    }
    let needed = INDEX_COLUMNS.iter().filter(|name| **name != NOT_ALWAYS);
    match needed.clone().find(|name| !at.contains_key(*name)) {
        None => Ok(at),
        Some(missing) => Err(Error::MissingColumn {
            file: file.to_string(),
            column: missing.to_string(),
            found: header.iter().collect::<Vec<_>>().join(", "),
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
