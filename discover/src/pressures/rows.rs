//! Measurements of pressure as they are read: one contact problem a row, with its peak and, where there is one, its map.

use std::path::{Path, PathBuf};

use kufe_contact::case::{Case, CaseError};
use kufe_contact::effects::Map;
use kufe_contact::{Load, Problem};

use crate::Error;
use crate::exr_map::read_map;
use crate::table::Table;

/// One measurement.
pub struct Row {
    /// Name for reports.
    pub name: String,
    /// What is solved.
    pub problem: Problem,
    /// Largest pressure [Pa].
    pub p_max: f64,
    /// Its standard deviation [Pa].
    pub p_max_sd: f64,
    /// The measured map.
    pub map: Option<Map>,
    /// Standard deviation of a pixel [Pa].
    pub noise: f64,
}

/// Reads the table and the cases and maps that it names; rows with the case `model` take `model_case`.
///
/// # Errors
/// [`Error::Cell`], [`Error::MissingColumn`], [`Error::File`]; [`Error::Duplicate`] where two rows hold the same map.
pub fn read(path: &Path, model: &Path, model_case: &Case) -> Result<Vec<Row>, Error> {
    let table = Table::read(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let cases = table.texts("case")?;
    let fz = table.numbers("fz_n", 1e-3, 1e6)?;
    let radius = table.numbers("radius_m", f64::NEG_INFINITY, f64::INFINITY)?;
    let p_max = table.numbers("p_max_pa", 0.0, 1e12)?;
    let p_max_sd = table.numbers("p_max_sd_pa", 1e-9, 1e12)?;
    let maps = match table.place("map") {
        Some(_) => table.texts("map")?,
        None => vec![String::new(); cases.len()],
    };
    let same = |a: &PathBuf, b: &Path| {
        a.canonicalize()
            .ok()
            .is_some_and(|a| b.canonicalize().is_ok_and(|b| a == b))
    };
    let mut rows: Vec<Row> = Vec::new();
    for i in 0..cases.len() {
        let file = folder.join(&cases[i]);
        let told = |error: CaseError| Error::File {
            file: file.display().to_string(),
            reason: error.to_string(),
        };
        let (case, base) = if same(&file, model) {
            (model_case.clone(), model.parent().unwrap_or(Path::new("")))
        } else {
            let text = std::fs::read_to_string(&file).map_err(|error| Error::File {
                file: file.display().to_string(),
                reason: error.to_string(),
            })?;
            (
                Case::parse(&text).map_err(told)?,
                file.parent().unwrap_or(Path::new("")),
            )
        };
        let mut problem = case.problem(base).map_err(told)?;
        if let Load::Force { fz: force, .. } = &mut problem.load {
            *force = fz[i];
        }
        if radius[i] == 0.0 {
            return Err(Error::Cell {
                file: table.file.clone(),
                row: i as u64 + 2,
                column: "radius_m".to_owned(),
                found: "0".to_owned(),
                expected: "a radius, or inf for a straight".to_owned(),
            });
        }
        problem.track_curvature = 1.0 / radius[i];
        let map = match maps[i].is_empty() {
            true => None,
            false => Some(read_map(&folder.join(&maps[i]))?),
        };
        let noise = map.as_ref().map_or(0.0, far_noise).max(0.015 * p_max[i]);
        if let Some(copy) = rows.iter().position(|r| r.map.is_some() && r.map == map) {
            return Err(Error::Duplicate {
                file: table.file.clone(),
                first: format!("row {}", copy + 2),
                second: format!("row {}", i + 2),
            });
        }
        rows.push(Row {
            name: format!("row {} ({:.0} N, radius {} m)", i + 2, fz[i], radius[i]),
            problem,
            p_max: p_max[i],
            p_max_sd: p_max_sd[i].max(0.015 * p_max[i]),
            map,
            noise,
        });
    }
    Ok(rows)
}

/// Noise of the sensor from the rim of the map, where nothing presses.
fn far_noise(map: &Map) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for j in 0..map.ny {
        for i in 0..map.nx {
            if j == 0 || j + 1 == map.ny || i == 0 || i + 1 == map.nx {
                sum += map.pressure[j * map.nx + i].powi(2);
                count += 1.0;
            }
        }
    }
    (sum / f64::max(count, 1.0)).sqrt()
}
