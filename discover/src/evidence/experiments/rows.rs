//! Rows of an `experiments.csv`.

use std::collections::{BTreeMap, HashMap};

use kufe_sled::Conditions;
use kufe_sled::effects::{Column, OperatingPoint};
use kufe_sled::friction::film::Patch;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::input::table::Table;

/// A row of friction experiments.
#[derive(Clone, Debug)]
pub struct Row {
    /// Specimen.
    pub name: String,
    /// Session; the row itself if there is no such column.
    pub session: String,
    /// Peak pressure [Pa].
    pub pressure: f64,
    /// Standard deviation of the peak pressure [Pa].
    pub pressure_sd: f64,
    /// Measured coefficient of friction.
    pub mu: f64,
    pub mu_sd: f64,
    /// Coefficient of friction of the melt film on the row's contact; NaN for other base laws.
    pub film: f64,
    /// Conditions at which effects are evaluated.
    pub conditions: OperatingPoint,
    /// All further numeric columns.
    pub columns: BTreeMap<String, f64>,
}

/// Names of effects and laws that cannot be tested, with the reason.
pub type Untestable = Vec<(String, String)>;

/// Columns of numbers, by name.
type NumericColumns = Vec<(String, Vec<f64>)>;

/// Name of the column of row numbers, which represents drift.
pub const ORDER: &str = "row";

/// Columns that are not candidates.
const KNOWN: [&str; 6] = [
    "specimen",
    "session",
    "p_max_pa",
    "p_max_sd_pa",
    "mu",
    "mu_sd",
];

/// Reads the rows, and the laws of columns that are not all numbers with the reason; `drag_area`
/// [m2] is the model's.
///
/// # Errors
/// [`Error::MissingColumn`], [`Error::Cell`] with row and column; [`Error::Duplicate`] for a row
/// that repeats another one under another name.
pub fn read(table: &Table, drag_area: f64) -> Result<(Vec<Row>, Untestable)> {
    let names = table.texts("specimen")?;
    let pressure = table.numbers("p_max_pa", 1e4, 1e11)?;
    let pressure_sd = table.numbers("p_max_sd_pa", 0.0, 1e10)?;
    let mu = table.numbers("mu", 0.0, 1.0)?;
    let mu_sd = table.numbers("mu_sd", 1e-9, 1.0)?;
    let sessions = match table.place("session") {
        Some(_) => table.texts("session")?,
        None => (0..names.len())
            .map(|i| format!("{} {i}", names[i]))
            .collect(),
    };
    let column = |name: &str, low: f64, high: f64| table.numbers_or(name, low, high, f64::NAN);
    let fz = column("fz_n", 1e-3, 1e6)?;
    let v = column("v_mps", 1e-3, 200.0)?;
    let ice = column("ice_c", -80.0, 5.0)?;
    let air = table.numbers_or("air_c", -80.0, 60.0, 0.0)?;
    let humidity = column("humidity_pct", 0.0, 100.0)?;
    let air_pa = table.numbers_or("air_pa", 4e4, 1.2e5, 95_000.0)?;
    let distance = column("distance_m", 0.0, 1e9)?;
    let length = column("contact_length_m", 1e-5, 10.0)?;
    let width = column("contact_width_m", 1e-7, 1.0)?;
    let roughness = column("roughness_m", 0.0, 1e-4)?;
    let (time, place) = (column("t_s", 0.0, 1e6)?, column("s_m", -1e6, 1e6)?);
    let (mut further, unreadable) = numeric_columns(table)?;
    further.push((
        ORDER.to_owned(),
        (0..names.len()).map(|i| i as f64).collect(),
    ));
    refuse_copies(table)?;
    let row = |i: usize| Row {
        name: names[i].clone(),
        session: sessions[i].clone(),
        pressure: pressure[i],
        pressure_sd: pressure_sd[i],
        mu: mu[i],
        mu_sd: mu_sd[i],
        film: f64::NAN,
        conditions: OperatingPoint {
            t: time[i],
            s: place[i],
            v: v[i],
            fz: fz[i],
            conditions: Conditions {
                ice_c: ice[i],
                air_c: air[i],
                air_pa: air_pa[i],
                humidity_pct: humidity[i],
                distance_m: distance[i],
                mass_kg: f64::NAN,
            },
            air_density: kufe_sled::aero::air_density(air_pa[i], air[i]),
            drag_area,
            film: f64::NAN,
            patch: Patch {
                length: length[i],
                width: width[i],
                roughness: roughness[i],
            },
        },
        columns: (further.iter())
            .map(|(name, values)| (name.clone(), values[i]))
            .collect(),
    };
    Ok(((0..names.len()).map(row).collect(), unreadable))
}

/// The columns of numbers, with their values, and the laws of columns of which some cells alone are
/// numbers.
fn numeric_columns(table: &Table) -> Result<(NumericColumns, Untestable)> {
    let (mut numeric, mut unreadable) = (Vec::new(), Vec::new());
    let further = table.header.iter();
    for name in further.filter(|name| !KNOWN.contains(&name.as_str())) {
        let texts = table.texts(name)?;
        let number = |text: &String| text.parse::<f64>().ok().filter(|x| x.is_finite());
        let numbers: Vec<Option<f64>> = texts.iter().map(number).collect();
        match numbers.iter().position(Option::is_none) {
            None => numeric.push((name.clone(), numbers.into_iter().flatten().collect())),
            // A column without any number is a text.
            Some(row) if numbers.iter().any(Option::is_some) => unreadable.push((
                format!("unknown:{name}"),
                format!(
                    "needs a number in every row; row {} has {:?}",
                    table.lines[row], texts[row]
                ),
            )),
            Some(_) => {}
        }
    }
    Ok((numeric, unreadable))
}

/// All further numeric columns, by name.
pub fn further_columns(rows: &[Row]) -> Vec<(&str, Vec<f64>)> {
    let names = rows.first().map(|first| first.columns.keys());
    let values = |name: &str| rows.iter().map(|row| row.columns[name]).collect();
    let names = names.into_iter().flatten();
    names.map(|name| (name.as_str(), values(name))).collect()
}

/// Columns that the melt film is computed from.
const OF_FILM: [Column; 5] = [
    Column::ContactLength,
    Column::ContactWidth,
    Column::Load,
    Column::Speed,
    Column::IceTemperature,
];

/// Computes the friction of the film of every row with the model's boundary shear stress [Pa].
///
/// # Errors
/// [`Error::MissingColumn`]; [`Error::File`] with the row if the film cannot be computed.
pub fn set_films(rows: &mut [Row], table: &Table, boundary_shear: f64) -> Result<()> {
    if let Some(column) = OF_FILM.iter().find(|c| table.place(c.name()).is_none()) {
        let reason = " (friction.longitudinal.film = true needs it)";
        return Err(table.missing(column.name(), reason));
    }
    rows.par_iter_mut().enumerate().try_for_each(|(i, row)| {
        let at = &row.conditions;
        let film = at
            .patch
            .friction(at.fz, at.v, at.conditions.ice_c, boundary_shear);
        let reason = |error| format!("row {}: the melt film: {error}", table.lines[i]);
        row.film = film.map_err(|error| Error::file(table.file.as_ref(), reason(error)))?;
        Ok(())
    })
}

fn refuse_copies(table: &Table) -> Result<()> {
    let name = table.place("specimen");
    let mut known: HashMap<Vec<&str>, usize> = HashMap::new();
    for (i, row) in table.rows.iter().enumerate() {
        let measured = row.iter().enumerate().filter(|(k, _)| Some(*k) != name);
        let measured = measured.map(|(_, cell)| cell.as_str()).collect();
        if let Some(first) = known.insert(measured, i) {
            return Err(Error::Duplicate {
                file: table.file.clone(),
                first: format!("row {}", table.lines[first]),
                second: format!("row {}", table.lines[i]),
            });
        }
    }
    Ok(())
}
