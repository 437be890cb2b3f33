//! What `runs.csv` says of each run.

use kufe_sled::{ICE_AT, INDEX_COLUMNS, MORE_INDEX_COLUMNS};

use crate::error::Error;
use crate::mapping::check::{INDEX_RANGES, place_of};
use crate::mapping::file::IndexValues;

impl IndexValues {
    /// A number by its column's name.
    pub fn number(&self, name: &str) -> Option<f64> {
        match name {
            "ice_c" => self.ice_c,
            "air_c" => self.air_c,
            "air_pa" => self.air_pa,
            "humidity_pct" => self.humidity_pct,
            "distance_m" => self.distance_m,
            "mass_kg" => self.mass_kg,
            _ => None,
        }
    }

    /// A cell of `runs.csv`, where it is stated.
    pub fn cell(&self, name: &str) -> Option<String> {
        match name {
            "track" => self.track.clone(),
            "driver" => self.driver.clone(),
            "driver_class" => self.driver_class.clone(),
            "session" => self.session.clone(),
            _ => match name.strip_prefix(ICE_AT) {
                Some(place) => self.ice_c_at.get(place).copied(),
                None => self.number(name),
            }
            .map(|value| value.to_string()),
        }
    }

    /// Sets what a cell says.
    ///
    /// # Errors
    /// What is expected there.
    fn set(&mut self, name: &str, cell: &str) -> Result<(), String> {
        let text = || Some(cell.to_string());
        match name {
            "track" => self.track = text(),
            "driver" => self.driver = text(),
            "driver_class" => self.driver_class = text(),
            "session" => self.session = text(),
            _ => {
                let place = name.strip_prefix(ICE_AT);
                let range = place.map_or(name, |_| "ice_c");
                let Some((_, low, high)) = INDEX_RANGES.iter().find(|known| known.0 == range)
                else {
                    return Err("no cell".to_string());
                };
                let value: Option<f64> = cell.replace(',', ".").parse().ok();
                let value = value.filter(|value| (*low..=*high).contains(value));
                let value = value.ok_or_else(|| format!("a number from {low} to {high}"))?;
                if let Some(place) = place {
                    self.ice_c_at.insert(place.to_string(), value);
                    return Ok(());
                }
                let slot = match name {
                    "ice_c" => &mut self.ice_c,
                    "air_c" => &mut self.air_c,
                    "air_pa" => &mut self.air_pa,
                    "humidity_pct" => &mut self.humidity_pct,
                    "distance_m" => &mut self.distance_m,
                    _ => &mut self.mass_kg,
                };
                *slot = Some(value);
            }
        }
        Ok(())
    }

    /// What `before` says, and what is said here where it says nothing.
    pub(crate) fn below(&self, before: &IndexValues) -> IndexValues {
        IndexValues {
            table: None,
            track: before.track.clone().or_else(|| self.track.clone()),
            driver: before.driver.clone().or_else(|| self.driver.clone()),
            driver_class: before
                .driver_class
                .clone()
                .or_else(|| self.driver_class.clone()),
            session: before.session.clone().or_else(|| self.session.clone()),
            ice_c: before.ice_c.or(self.ice_c),
            ice_c_at: match before.ice_c_at.is_empty() {
                true => self.ice_c_at.clone(),
                false => before.ice_c_at.clone(),
            },
            air_c: before.air_c.or(self.air_c),
            air_pa: before.air_pa.or(self.air_pa),
            humidity_pct: before.humidity_pct.or(self.humidity_pct),
            distance_m: before.distance_m.or(self.distance_m),
            mass_kg: before.mass_kg.or(self.mass_kg),
        }
    }
}

/// Rows of an index table by their run, each with the line it stands in.
///
/// # Errors
/// [`Error::Cell`] and [`Error::File`] with row and column.
pub(crate) fn read_table(bytes: &[u8], file: &str) -> Result<Vec<(String, IndexValues)>, Error> {
    let told = |error: csv::Error| Error::file(file, error);
    let head = bytes
        .split(|byte| *byte == b'\n')
        .next()
        .unwrap_or_default();
    let delimiter = if head.contains(&b';') { b';' } else { b',' };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .from_reader(bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes));
    let header = reader.headers().map_err(told)?.clone();
    let known = || INDEX_COLUMNS.iter().chain(&MORE_INDEX_COLUMNS);
    for name in &header {
        let place = name.strip_prefix(ICE_AT);
        if place.is_some_and(|place| place_of(place).is_some()) {
            continue;
        }
        if name == "file" || !known().any(|known| *known == name) {
            let names: Vec<&str> = known().copied().filter(|name| *name != "file").collect();
            return Err(Error::file(
                file,
                format!(
                    "column {name:?} is unknown, expected some of: {}, {ICE_AT}350 (at 350 m)",
                    names.join(", ")
                ),
            ));
        }
    }
    let Some(run) = header.iter().position(|name| name == "run") else {
        return Err(Error::file(file, "there is no column \"run\""));
    };
    let mut rows: Vec<(String, IndexValues)> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(told)?;
        let row = record.position().map_or(0, csv::Position::line);
        let name = record.get(run).unwrap_or("").to_string();
        if rows.iter().any(|(known, _)| *known == name) {
            return Err(Error::file(
                file,
                format!("row {row}: run {name:?} stands there twice, expected once"),
            ));
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

/// Questions about the lines of `runs.csv`, for a mapping that is guessed.
pub(crate) fn index_help() -> String {
    let mut text = String::from(
        "\n[index]\n# What runs.csv says of the runs; a CSV with a column run may say it run by run.\n# table = \"index.csv\"\n",
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
    text + "# humidity_pct, distance_m, mass_kg and ice_c_at = { 350 = -8.2 } may stand here too\n"
}
