//! Friction experiments: one row a specimen or condition.

use std::collections::BTreeMap;
use std::io::{Read, Write};

use crate::friction::error::Error;

/// A measured coefficient of friction at a computed or measured peak pressure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Name of the specimen or condition.
    pub specimen: String,
    /// Peak pressure [Pa].
    pub p_max_pa: f64,
    /// Standard deviation of the peak pressure [Pa].
    pub p_max_sd_pa: f64,
    /// Coefficient of friction.
    pub mu: f64,
    /// Standard deviation of the coefficient of friction.
    pub mu_sd: f64,
    /// Session of the measurement.
    pub session: Option<String>,
    /// Normal force [N].
    pub fz_n: Option<f64>,
    /// Speed [m/s].
    pub v_mps: Option<f64>,
    /// Ice temperature [degrees Celsius].
    pub ice_c: Option<f64>,
    /// Air temperature [degrees Celsius].
    pub air_c: Option<f64>,
    /// Relative humidity [%].
    pub humidity_pct: Option<f64>,
    /// Air pressure [Pa].
    pub air_pa: Option<f64>,
    /// Distance glided before [m].
    pub distance_m: Option<f64>,
    /// Rocker radius [m].
    pub rocker_radius_m: Option<f64>,
    /// Further columns as they stand, ignored by the fits.
    pub extra: BTreeMap<String, String>,
}

const COLUMNS: Columns = Columns {
    required: &["specimen", "p_max_pa", "p_max_sd_pa", "mu", "mu_sd"],
    optional: &[
        "session",
        "fz_n",
        "v_mps",
        "ice_c",
        "air_c",
        "humidity_pct",
        "air_pa",
        "distance_m",
        "rocker_radius_m",
    ],
    extra: Extra::Kept,
};

/// Reads `experiments.csv`; `file` is the name that errors carry.
///
/// # Errors
/// [`Error::MissingColumn`], and [`Error::BadValue`] with the row for cells that are empty, not finite or outside
/// what the unit allows (a pressure in MPa, a coefficient in thousandths).
pub fn read_experiments(file: &str, reader: impl Read) -> Result<Vec<Experiment>, Error> {
    let table = Table::read(file, reader, &COLUMNS)?;
    let positive = |v: f64| v > 0.0;
    (0..table.rows())
        .map(|row| {
            let pressure = |v: f64| (1e4..1e11).contains(&v);
            let known =
                |name: &str| COLUMNS.required.contains(&name) || COLUMNS.optional.contains(&name);
            Ok(Experiment {
                specimen: table.name(row, "specimen")?,
                p_max_pa: table.number(row, "p_max_pa", pressure, "a pressure in Pa (7.7e6)")?,
                p_max_sd_pa: table.number(
                    row,
                    "p_max_sd_pa",
                    |v| v >= 0.0,
                    "a standard deviation in Pa, 0 or more",
                )?,
                mu: table.number(
                    row,
                    "mu",
                    |v| (-1.0..=1.0).contains(&v),
                    "a coefficient of friction (0.004)",
                )?,
                mu_sd: table.number(
                    row,
                    "mu_sd",
                    |v| (0.0..=1.0).contains(&v),
                    "a standard deviation (0.0004), 0 to 1",
                )?,
                session: table
                    .text(row, "session")
                    .filter(|text| !text.is_empty())
                    .map(str::to_string),
                fz_n: table.optional(row, "fz_n", positive, "a force in N, positive")?,
                v_mps: table.optional(row, "v_mps", |v| v >= 0.0, "a speed in m/s, 0 or more")?,
                ice_c: table.optional(row, "ice_c", celsius, CELSIUS)?,
                air_c: table.optional(row, "air_c", celsius, CELSIUS)?,
                humidity_pct: table.optional(
                    row,
                    "humidity_pct",
                    |v| (0.0..=100.0).contains(&v),
                    "a relative humidity in %, 0 to 100",
                )?,
                air_pa: table.optional(row, "air_pa", air_pressure, AIR_PRESSURE)?,
                distance_m: table.optional(
                    row,
                    "distance_m",
                    |v| v >= 0.0,
                    "a distance in m, 0 or more",
                )?,
                rocker_radius_m: table.optional(
                    row,
                    "rocker_radius_m",
                    positive,
                    "a radius in m, positive",
                )?,
                extra: table
                    .header()
                    .iter()
                    .filter(|name| !known(name))
                    .map(|name| {
                        let text = table.text(row, name).unwrap_or("");
                        (name.clone(), text.to_string())
                    })
                    .collect(),
            })
        })
        .collect()
}

/// Writes `experiments.csv` with the columns that any row fills.
///
/// A pressure that is NaN (not known yet) leaves its cells empty, so that reading the file back names the gap.
///
/// # Errors
/// The writer's.
pub fn write_experiments(experiments: &[Experiment], writer: impl Write) -> std::io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    type Cell = fn(&Experiment) -> Option<String>;
    fn number(value: f64) -> Option<String> {
        value.is_finite().then(|| value.to_string())
    }
    let columns: [(&str, bool, Cell); 14] = [
        ("specimen", true, |e| Some(e.specimen.clone())),
        ("p_max_pa", true, |e| number(e.p_max_pa)),
        ("p_max_sd_pa", true, |e| number(e.p_max_sd_pa)),
        ("mu", true, |e| number(e.mu)),
        ("mu_sd", true, |e| number(e.mu_sd)),
        ("session", false, |e| e.session.clone()),
        ("fz_n", false, |e| e.fz_n.and_then(number)),
        ("v_mps", false, |e| e.v_mps.and_then(number)),
        ("ice_c", false, |e| e.ice_c.and_then(number)),
        ("air_c", false, |e| e.air_c.and_then(number)),
        ("humidity_pct", false, |e| e.humidity_pct.and_then(number)),
        ("air_pa", false, |e| e.air_pa.and_then(number)),
        ("distance_m", false, |e| e.distance_m.and_then(number)),
        ("rocker_radius_m", false, |e| {
            e.rocker_radius_m.and_then(number)
        }),
    ];
    let retained: Vec<_> = columns
        .iter()
        .filter(|(_, always, cell)| *always || experiments.iter().any(|e| cell(e).is_some()))
        .collect();
    csv.write_record(retained.iter().map(|(name, ..)| name))?;
    for experiment in experiments {
        csv.write_record(
            retained
                .iter()
                .map(|(_, _, cell)| cell(experiment).unwrap_or_default()),
        )?;
    }
    csv.flush()
}

pub(crate) const CELSIUS: &str = "a temperature in degrees Celsius, -60 to 60";
pub(crate) const AIR_PRESSURE: &str = "an air pressure in Pa (94700), 30000 to 120000";

pub(crate) fn celsius(value: f64) -> bool {
    (-60.0..=60.0).contains(&value)
}

pub(crate) fn air_pressure(value: f64) -> bool {
    (30e3..=120e3).contains(&value)
}

/// What is done with columns that nobody asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extra {
    /// They are an error: the table is made for this program.
    Refused,
    /// They are kept: the table is a measurement.
    Kept,
}

/// The columns a table must and may have.
pub(crate) struct Columns {
    pub required: &'static [&'static str],
    pub optional: &'static [&'static str],
    pub extra: Extra,
}

/// A table held as text.
pub(crate) struct Table {
    file: String,
    header: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

impl Table {
    pub(crate) fn read(file: &str, reader: impl Read, columns: &Columns) -> Result<Self, Error> {
        let unreadable = |error: csv::Error| Error::Unreadable {
            file: file.to_string(),
            reason: error.to_string(),
        };
        let mut csv = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(reader);
        let header: Vec<String> = csv
            .headers()
            .map_err(unreadable)?
            .iter()
            .map(|name| name.trim_start_matches('\u{feff}').to_string())
            .collect();
        for (i, name) in header.iter().enumerate() {
            if header[..i].contains(name) {
                return Err(Error::UnknownColumn {
                    file: file.into(),
                    column: format!("{name} (a second time)"),
                    expected: "each column once".into(),
                });
            }
            let known = columns.required.contains(&name.as_str())
                || columns.optional.contains(&name.as_str());
            if !known && columns.extra == Extra::Refused {
                return Err(Error::UnknownColumn {
                    file: file.into(),
                    column: name.clone(),
                    expected: [columns.required, columns.optional].concat().join(", "),
                });
            }
        }
        for name in columns.required {
            if !header.iter().any(|there| there == name) {
                return Err(Error::MissingColumn {
                    file: file.into(),
                    column: (*name).into(),
                    found: match header.join(", ") {
                        empty if empty.is_empty() => "nothing".into(),
                        names => names,
                    },
                    expected: columns.required.join(", "),
                });
            }
        }
        let rows = csv
            .into_records()
            .collect::<Result<Vec<_>, _>>()
            .map_err(unreadable)?;
        Ok(Table {
            file: file.into(),
            header,
            rows,
        })
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
    }

    pub(crate) fn header(&self) -> &[String] {
        &self.header
    }

    /// The cell's text; `None` where there is no such column.
    pub(crate) fn text(&self, row: usize, column: &str) -> Option<&str> {
        let place = self.header.iter().position(|name| name == column)?;
        self.rows[row].get(place)
    }

    /// The cell's text, which may not be empty.
    pub(crate) fn name(&self, row: usize, column: &str) -> Result<String, Error> {
        match self.text(row, column) {
            Some(text) if !text.is_empty() => Ok(text.to_string()),
            found => Err(self.bad(row, column, found.unwrap_or("nothing"), "a name")),
        }
    }

    /// The cell as a finite number that `fits`.
    pub(crate) fn number(
        &self,
        row: usize,
        column: &str,
        fits: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<f64, Error> {
        let text = self.text(row, column).unwrap_or("");
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() && fits(value) => Ok(value),
            _ => Err(self.bad(row, column, text, expected)),
        }
    }

    /// As [`Table::number`]; `None` where the column is absent or the cell empty.
    pub(crate) fn optional(
        &self,
        row: usize,
        column: &str,
        fits: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<Option<f64>, Error> {
        match self.text(row, column) {
            None | Some("") => Ok(None),
            Some(_) => self.number(row, column, fits, expected).map(Some),
        }
    }

    /// The complaint about a cell.
    pub(crate) fn bad(&self, row: usize, column: &str, found: &str, expected: &str) -> Error {
        let line = self.rows[row]
            .position()
            .map_or(row as u64 + 2, |p| p.line());
        Error::BadValue {
            file: self.file.clone(),
            row: line,
            column: column.into(),
            found: if found.is_empty() {
                "nothing".into()
            } else {
                found.into()
            },
            expected: expected.into(),
        }
    }
}
