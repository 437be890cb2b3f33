//! Friction experiments: one row a specimen or condition.

use std::fmt::Display;
use std::io::{Read, Write};

use crate::conditions::{CONDITIONS, Conditions};
use crate::error::Error;

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
    /// Ice, air and distance glided before.
    pub conditions: Conditions,
    /// Normal force [N].
    pub fz_n: Option<f64>,
    /// Speed [m/s].
    pub v_mps: Option<f64>,
    /// Rocker radius [m].
    pub rocker_radius_m: Option<f64>,
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
    extra: Extra::Ignored,
};

/// Numbers of measured tables: name, smallest and largest value, and what is expected.
const NUMBERS: [(&str, f64, f64, &str); 14] = [
    ("p_max_pa", 1e4, 1e11, "a pressure in Pa (7.7e6)"),
    (
        "p_max_sd_pa",
        0.0,
        1e11,
        "a standard deviation in Pa, 0 to 1e11",
    ),
    ("mu", -1.0, 1.0, "a coefficient of friction (0.004)"),
    ("mu_sd", 0.0, 1.0, "a standard deviation (0.0004), 0 to 1"),
    ("fz_n", LEAST, f64::MAX, "a force in N, positive"),
    ("v_mps", 0.0, f64::MAX, "a speed in m/s, 0 or more"),
    ("ice_c", -60.0, 60.0, CELSIUS),
    ("air_c", -60.0, 60.0, CELSIUS),
    (
        "humidity_pct",
        0.0,
        100.0,
        "a relative humidity in %, 0 to 100",
    ),
    (
        "air_pa",
        30e3,
        120e3,
        "an air pressure in Pa (94700), 30000 to 120000",
    ),
    ("distance_m", 0.0, f64::MAX, "a distance in m, 0 or more"),
    (
        "rocker_radius_m",
        LEAST,
        f64::MAX,
        "a radius in m, positive",
    ),
    ("mass_kg", 1.0, 2000.0, "a mass in kg, 1 to 2000"),
    ("cda_m2", 0.0, 5.0, "a drag area in m2, 0 to 5"),
];

const CELSIUS: &str = "a temperature in degrees Celsius, -60 to 60";

/// Most bytes of a table: empty cells and short rows take up to twenty times as many in memory.
const MOST_BYTES: u64 = 1 << 25;

/// The least positive number.
const LEAST: f64 = f64::MIN_POSITIVE;

/// Reads `experiments.csv`; errors name `file`.
///
/// # Errors
/// [`Error::MissingColumn`], and [`Error::Cell`] with the row for cells that are empty, not
/// finite or outside the range of the unit (a pressure in MPa, a coefficient in thousandths).
pub fn read_experiments(file: &str, reader: impl Read) -> Result<Vec<Experiment>, Error> {
    let table = Table::read(file, reader, &COLUMNS)?;
    let experiment = |row: usize| {
        Ok(Experiment {
            specimen: table.name(row, "specimen")?,
            p_max_pa: table.number(row, "p_max_pa")?,
            p_max_sd_pa: table.number(row, "p_max_sd_pa")?,
            mu: table.number(row, "mu")?,
            mu_sd: table.number(row, "mu_sd")?,
            session: table.stated_text(row, "session"),
            conditions: table.conditions(row)?,
            fz_n: table.optional(row, "fz_n")?,
            v_mps: table.optional(row, "v_mps")?,
            rocker_radius_m: table.optional(row, "rocker_radius_m")?,
        })
    };
    (0..table.rows()).map(experiment).collect()
}

/// Writes `experiments.csv` with the columns that any row fills.
///
/// A pressure that is NaN (not known yet) leaves its cells empty, so that a reader reports the gap.
///
/// # Errors
/// The writer's.
pub fn write_experiments(experiments: &[Experiment], writer: impl Write) -> std::io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    let number = |value: Option<f64>| {
        let finite = value.filter(|value| value.is_finite());
        finite.map(|value| value.to_string())
    };
    let cells = |e: &Experiment| {
        let numbers = [
            Some(e.p_max_pa),
            Some(e.p_max_sd_pa),
            Some(e.mu),
            Some(e.mu_sd),
        ];
        let optional = [
            e.fz_n,
            e.v_mps,
            Some(e.conditions.ice_c),
            Some(e.conditions.air_c),
            Some(e.conditions.humidity_pct),
            Some(e.conditions.air_pa),
            Some(e.conditions.distance_m),
            e.rocker_radius_m,
        ];
        let mut cells = vec![Some(e.specimen.clone())];
        cells.extend(numbers.map(number));
        cells.push(e.session.clone());
        cells.extend(optional.map(number));
        cells
    };
    let rows: Vec<Vec<Option<String>>> = experiments.iter().map(cells).collect();
    let names = COLUMNS.required.iter().chain(COLUMNS.optional);
    let is_written = |place: &usize| {
        *place < COLUMNS.required.len() || rows.iter().any(|row| row[*place].is_some())
    };
    let (written, header): (Vec<usize>, Vec<&str>) = names
        .enumerate()
        .map(|(place, name)| (place, *name))
        .filter(|(place, _)| is_written(place))
        .unzip();
    csv.write_record(header)?;
    for row in &rows {
        csv.write_record(
            written
                .iter()
                .map(|place| row[*place].as_deref().unwrap_or("")),
        )?;
    }
    csv.flush()
}

/// Treatment of unknown columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extra {
    /// They are an error: the table is made for this program.
    Refused,
    /// They are ignored: the table is a measurement.
    Ignored,
}

/// The columns a table must and may have.
pub(crate) struct Columns {
    pub required: &'static [&'static str],
    pub optional: &'static [&'static str],
    pub extra: Extra,
}

/// A table as text.
pub(crate) struct Table {
    file: String,
    columns: &'static Columns,
    header: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

impl Table {
    pub(crate) fn read(
        file: &str,
        reader: impl Read,
        columns: &'static Columns,
    ) -> Result<Self, Error> {
        let unreadable =
            |reason: &dyn Display| Error::file(file, format!("cannot be read: {reason}"));
        let mut csv = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(reader.take(MOST_BYTES + 1));
        let header: Vec<String> = csv
            .headers()
            .map_err(|error| unreadable(&error))?
            .iter()
            .map(|name| name.trim_start_matches('\u{feff}').to_string())
            .collect();
        let all = [columns.required, columns.optional].concat();
        for (i, name) in header.iter().enumerate() {
            let twice = header[..i].contains(name);
            let known = columns.extra == Extra::Ignored || all.contains(&name.as_str());
            if twice || !known {
                return Err(Error::Column {
                    file: file.into(),
                    column: name.clone(),
                    what: if twice { "given twice" } else { "unknown" },
                    expected: all.join(", "),
                });
            }
        }
        for name in columns.required {
            if !header.iter().any(|there| there == name) {
                return Err(Error::MissingColumn {
                    file: file.into(),
                    column: (*name).into(),
                    found: header.join(", "),
                    needed_by: None,
                });
            }
        }
        let rows: Result<Vec<_>, _> = csv.records().collect();
        if csv.get_ref().limit() == 0 {
            return Err(unreadable(&format!(
                "it is longer than {MOST_BYTES} bytes: expected fewer rows"
            )));
        }
        let rows = rows.map_err(|error| unreadable(&error))?;
        Ok(Table {
            file: file.into(),
            columns,
            header,
            rows,
        })
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
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

    /// The cell's text, where there is any.
    pub(crate) fn stated_text(&self, row: usize, column: &str) -> Option<String> {
        let text = self.text(row, column).filter(|text| !text.is_empty());
        text.map(str::to_string)
    }

    /// The cell as a number within the range of its column.
    pub(crate) fn number(&self, row: usize, column: &str) -> Result<f64, Error> {
        let known = NUMBERS.iter().find(|known| known.0 == column);
        let (_, low, high, expected) = known.expect("a column of numbers");
        self.number_within(row, column, (*low, *high), expected)
    }

    /// The cell as a finite number within a range.
    pub(crate) fn number_within(
        &self,
        row: usize,
        column: &str,
        (low, high): (f64, f64),
        expected: &str,
    ) -> Result<f64, Error> {
        let text = self.text(row, column).unwrap_or("");
        let value = text.parse().ok();
        let value = value.filter(|value| (low..=high).contains(value));
        value.ok_or_else(|| self.bad(row, column, text, expected))
    }

    /// As [`Table::number`]; `None` where the column is absent or the cell empty.
    pub(crate) fn optional(&self, row: usize, column: &str) -> Result<Option<f64>, Error> {
        match self.text(row, column) {
            None | Some("") => Ok(None),
            Some(_) => self.number(row, column).map(Some),
        }
    }

    /// The conditions that the row states, of those that the table must or may have.
    pub(crate) fn conditions(&self, row: usize) -> Result<Conditions, Error> {
        let mut values = Conditions::UNSTATED.values();
        for (value, (name, ..)) in values.iter_mut().zip(CONDITIONS) {
            if self.columns.required.contains(&name) {
                *value = self.number(row, name)?;
            } else if self.columns.optional.contains(&name) {
                *value = self.optional(row, name)?.unwrap_or(f64::NAN);
            }
        }
        Ok(Conditions::from_values(values))
    }

    /// The error of a cell.
    pub(crate) fn bad(&self, row: usize, column: &str, found: &str, expected: &str) -> Error {
        let line = self.rows[row]
            .position()
            .map_or(row as u64 + 2, |p| p.line());
        Error::cell(&self.file, line, column, found, expected)
    }
}
