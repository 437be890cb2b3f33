//! Rows of an `experiments.csv`.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};

use kufe_sled::Conditions;
use kufe_sled::effects::{Column, OperatingPoint};
use kufe_sled::friction::film::Patch;
use rayon::prelude::*;

use crate::error::Error;
use crate::input::table::Table;

#[derive(Clone, Debug)]
pub struct Row {
    pub name: String,
    /// Session; the row itself if there is no such column.
    pub session: String,
    /// Peak pressure [Pa].
    pub pressure: f64,
    /// Its standard deviation [Pa].
    pub pressure_sd: f64,
    /// Measured coefficient of friction.
    pub mu: f64,
    pub mu_sd: f64,
    /// Friction of the melt film on its contact; NaN for other base laws.
    pub film: f64,
    /// Conditions as the effects of the catalogue take them.
    pub conditions: OperatingPoint,
    /// All further numeric columns.
    pub columns: BTreeMap<String, f64>,
}

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

/// Reads the rows; `drag_area` [m2] is the model's.
///
/// # Errors
/// [`Error::MissingColumn`], [`Error::Cell`] with row and column; [`Error::Duplicate`] for a row
/// that repeats another one under another name.
pub fn read(table: &Table, drag_area: f64) -> Result<Vec<Row>, Error> {
    let names = table.texts("specimen")?;
    let pressure = table.numbers("p_max_pa", 0.0, 1e10)?;
    let pressure_sd = table.numbers("p_max_sd_pa", 0.0, 1e10)?;
    let mu = table.numbers("mu", 0.0, 1.0)?;
    let mu_sd = table.numbers("mu_sd", 1e-9, 1.0)?;
    let sessions = match table.place("session") {
        Some(_) => table.texts("session")?,
        None => names
            .iter()
            .enumerate()
            .map(|(i, name)| format!("{name} {i}"))
            .collect(),
    };
    let column = |name: &str, low: f64, high: f64| table.optional(name, low, high);
    let fz = column("fz_n", 1e-3, 1e6)?;
    let v = column("v_mps", 1e-3, 200.0)?;
    let ice = column("ice_c", -80.0, 5.0)?;
    let air = column("air_c", -80.0, 60.0)?;
    let humidity = column("humidity_pct", 0.0, 100.0)?;
    let air_pa = column("air_pa", 4e4, 1.2e5)?;
    let distance = column("distance_m", 0.0, 1e9)?;
    let length = column("contact_length_m", 1e-5, 10.0)?;
    let width = column("contact_width_m", 1e-7, 1.0)?;
    let roughness = column("roughness_m", 0.0, 1e-4)?;
    let (time, place) = (column("t_s", 0.0, 1e6)?, column("s_m", -1e6, 1e6)?);
    let mut further = Vec::new();
    for name in &table.header {
        if KNOWN.contains(&name.as_str()) {
            continue;
        }
        // Text columns are ignored; an invalid number in a numeric column is an error.
        let numbers = table.texts(name)?;
        if numbers.iter().any(|text| text.parse::<f64>().is_ok()) {
            further.push((name, table.numbers(name, f64::MIN, f64::MAX)?));
        }
    }
    let rows = (0..names.len())
        .map(|i| {
            let get = |x: &Option<Vec<f64>>, default: f64| x.as_ref().map_or(default, |x| x[i]);
            let (air_c, air_pa) = (get(&air, 0.0), get(&air_pa, 95_000.0));
            Row {
                name: names[i].clone(),
                session: sessions[i].clone(),
                pressure: pressure[i],
                pressure_sd: pressure_sd[i],
                mu: mu[i],
                mu_sd: mu_sd[i],
                film: f64::NAN,
                conditions: OperatingPoint {
                    t: get(&time, f64::NAN),
                    s: get(&place, f64::NAN),
                    v: get(&v, f64::NAN),
                    fz: get(&fz, f64::NAN),
                    conditions: Conditions {
                        ice_c: get(&ice, f64::NAN),
                        air_c,
                        air_pa,
                        humidity_pct: get(&humidity, f64::NAN),
                        distance_m: get(&distance, f64::NAN),
                        mass_kg: f64::NAN,
                    },
                    air_density: kufe_sled::aero::air_density(air_pa, air_c),
                    drag_area,
                    film: f64::NAN,
                    patch: Patch {
                        length: get(&length, f64::NAN),
                        width: get(&width, f64::NAN),
                        roughness: get(&roughness, f64::NAN),
                    },
                },
                columns: further
                    .iter()
                    .map(|(name, values)| ((*name).clone(), values[i]))
                    .chain([(ORDER.to_owned(), i as f64)])
                    .collect(),
            }
        })
        .collect();
    refuse_copies(table)?;
    Ok(rows)
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
pub fn set_films(rows: &mut [Row], table: &Table, boundary_shear: f64) -> Result<(), Error> {
    if let Some(column) = OF_FILM.iter().find(|c| table.place(c.name()).is_none()) {
        return Err(Error::MissingColumn {
            file: table.file.clone(),
            column: column.name().to_owned(),
            found: format!(
                "{} (friction.longitudinal.film = true needs it)",
                table.header.join(", ")
            ),
        });
    }
    rows.par_iter_mut().enumerate().try_for_each(|(i, row)| {
        let at = &row.conditions;
        let film = at
            .patch
            .friction(at.fz, at.v, at.conditions.ice_c, boundary_shear);
        row.film = film.map_err(|error| Error::File {
            file: table.file.clone(),
            reason: format!("row {}: the melt film: {error}", i + 2),
        })?;
        Ok(())
    })
}

fn refuse_copies(table: &Table) -> Result<(), Error> {
    let name = table.place("specimen");
    let mut known: HashMap<Vec<&str>, usize> = HashMap::new();
    for (i, row) in table.rows.iter().enumerate() {
        let measured = row.iter().enumerate().filter(|(k, _)| Some(*k) != name);
        let measured = measured.map(|(_, cell)| cell.as_str()).collect();
        match known.entry(measured) {
            Entry::Vacant(first) => first.insert(i),
            Entry::Occupied(first) => {
                return Err(Error::Duplicate {
                    file: table.file.clone(),
                    first: format!("row {}", first.get() + 2),
                    second: format!("row {}", i + 2),
                });
            }
        };
    }
    Ok(())
}
