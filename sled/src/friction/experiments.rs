//! Friction experiments: one row per specimen or condition.

use std::io::{Read, Write};

use crate::columns::table::{Table, TableColumns};
use crate::conditions::Conditions;
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

const COLUMNS: TableColumns = TableColumns {
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
    further: |_| true,
    further_names: "",
};

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
            session: table.nonempty_text(row, "session"),
            conditions: table.conditions(row)?,
            fz_n: table.optional(row, "fz_n")?,
            v_mps: table.optional(row, "v_mps")?,
            rocker_radius_m: table.optional(row, "rocker_radius_m")?,
        })
    };
    (0..table.rows()).map(experiment).collect()
}

/// Writes `experiments.csv` with the required columns and those that at least one row states.
///
/// A pressure that is NaN (not known yet) gives an empty cell, which a reader reports.
///
/// # Errors
/// Errors of the writer.
pub fn write_experiments(experiments: &[Experiment], writer: impl Write) -> std::io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    let cells = |e: &Experiment| {
        let c = &e.conditions;
        let known = |value: &f64| value.is_finite();
        let number = |value: Option<f64>| value.filter(known).map(|value| value.to_string());
        let numbers = [e.p_max_pa, e.p_max_sd_pa, e.mu, e.mu_sd].map(|value| number(Some(value)));
        let weather = [c.ice_c, c.air_c, c.humidity_pct, c.air_pa, c.distance_m];
        let mut cells = vec![Some(e.specimen.clone())];
        cells.extend(numbers);
        cells.extend([e.session.clone(), number(e.fz_n), number(e.v_mps)]);
        cells.extend(weather.map(|value| number(Some(value))));
        cells.push(number(e.rocker_radius_m));
        cells
    };
    let rows: Vec<Vec<Option<String>>> = experiments.iter().map(cells).collect();
    let names = COLUMNS.required.iter().chain(COLUMNS.optional).enumerate();
    let is_written = |place: usize| {
        place < COLUMNS.required.len() || rows.iter().any(|row| row[place].is_some())
    };
    let written = names.filter(|(place, _)| is_written(*place));
    let (written, header): (Vec<usize>, Vec<&str>) = written.unzip();
    csv.write_record(header)?;
    for row in &rows {
        let cells = written.iter().map(|place| row[*place].as_deref());
        csv.write_record(cells.map(Option::unwrap_or_default))?;
    }
    csv.flush()
}
