//! Rows of pressure measurements: a contact problem, its peak and optionally its map.

use std::path::{Path, PathBuf};

use kufe::case::effects::{CATALOGUE, Map};
use kufe::case::{Case, CaseError};
use kufe_contact::{Load, Problem};

use crate::error::Error;
use crate::evidence::maps::measured::noise::deviations;
use crate::evidence::maps::registration::FilmTolerance;
use crate::evidence::maps::sized::SizedEffects;
use crate::input::exr_map::read_map;
use crate::input::table::Table;
use crate::procedure::rules::MapRules;

/// Longest text of a case [bytes]: usual ones have some kilobytes.
pub(super) const LONGEST_CASE: u64 = 1 << 24;

pub struct Row {
    pub name: String,
    pub problem: Problem,
    /// Measured peak pressure [Pa].
    pub p_max: f64,
    /// Its standard deviation [Pa].
    pub p_max_sd: f64,
    pub map: Option<Map>,
    /// Normal force [N].
    pub fz: f64,
    /// Standard deviation of each pixel [Pa]; empty without a map.
    pub noise: Vec<f64>,
    /// Tolerance of the film's position.
    pub film: FilmTolerance,
    /// Effects of the sensor that the case contains.
    pub sensor: SizedEffects,
}

/// Reads the table and the cases and maps that it names; rows with the case `model` take
/// `model_case`.
///
/// Returns the rows and remarks on unused columns.
///
/// # Errors
/// [`Error::Cell`], [`Error::MissingColumn`], [`Error::File`]; [`Error::Duplicate`] if two rows
/// have the same map or are copies.
pub fn read(
    path: &Path,
    (model, model_case): (&Path, &Case),
    rules: &MapRules,
) -> Result<(Vec<Row>, Vec<String>), Error> {
    let table = Table::read(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let cases = table.texts("case")?;
    let fz = table.numbers("fz_n", 1e-3, 1e6)?;
    let radius = table.numbers("radius_m", f64::NEG_INFINITY, f64::INFINITY)?;
    let p_max = table.numbers("p_max_pa", 0.0, 1e12)?;
    let p_max_sd = table.numbers("p_max_sd_pa", 1e-9, 1e12)?;
    let shift = table.optional("map_shift_sd_m", 0.0, 1.0)?;
    let rotation = table.optional("map_rotation_sd_rad", 0.0, 1.0)?;
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
        let file_error = |error: CaseError| Error::File {
            file: file.display().to_string(),
            reason: error.to_string(),
        };
        let (case, base) = if same(&file, model) {
            (model_case.clone(), model.parent().unwrap_or(Path::new("")))
        } else {
            let text =
                kufe_files::text_of_regular(&file, LONGEST_CASE).map_err(|error| Error::File {
                    file: file.display().to_string(),
                    reason: error.to_string(),
                })?;
            (
                Case::parse(&text).map_err(file_error)?,
                file.parent().unwrap_or(Path::new("")),
            )
        };
        if case.sliding.is_some() {
            return Err(Error::File {
                file: file.display().to_string(),
                reason: "[sliding]: expected a case at rest".to_owned(),
            });
        }
        let mut problem = case.problem(base).map_err(file_error)?;
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
        let noise = map
            .as_ref()
            .map_or(Vec::new(), |map| deviations(map, p_max[i], rules));
        let copied =
            |k: usize| (map.is_some() && rows[k].map == map) || table.rows[k] == table.rows[i];
        if let Some(copy) = (0..i).find(|k| copied(*k)) {
            return Err(Error::Duplicate {
                file: table.file.clone(),
                first: format!("row {}", copy + 2),
                second: format!("row {}", i + 2),
            });
        }
        rows.push(Row {
            name: match radius[i].is_finite() {
                true => format!("row {} ({:.0} N, radius {} m)", i + 2, fz[i], radius[i]),
                false => format!("row {} ({:.0} N, straight)", i + 2, fz[i]),
            },
            problem,
            p_max: p_max[i],
            p_max_sd: p_max_sd[i].max(0.015 * p_max[i]),
            fz: fz[i],
            map,
            noise,
            film: FilmTolerance {
                shift: shift.as_ref().map_or(rules.film_shift_m, |own| own[i]),
                rotation: rotation
                    .as_ref()
                    .map_or(rules.film_rotation_rad, |own| own[i]),
            },
            sensor: sensor(&case),
        });
    }
    let known = [
        "case",
        "fz_n",
        "radius_m",
        "p_max_pa",
        "p_max_sd_pa",
        "map",
        "map_shift_sd_m",
        "map_rotation_sd_rad",
        "ice_c",
    ];
    let unused: Vec<&str> = table
        .header
        .iter()
        .map(String::as_str)
        .filter(|name| !known.contains(name))
        .collect();
    let mut remarks = Vec::new();
    if !unused.is_empty() {
        remarks.push(format!("columns not used: {}", unused.join(", ")));
    }
    Ok((rows, remarks))
}

/// Sensor effects of a case, with their sizes.
fn sensor(case: &Case) -> SizedEffects {
    CATALOGUE
        .iter()
        .filter(|effect| effect.is_of_the_sensor())
        .filter_map(|effect| {
            let table = case.effects.get(effect.info.name)?;
            let value = table.get(effect.parameter().name)?;
            let size = value
                .as_float()
                .or(value.as_integer().map(|whole| whole as f64))?;
            Some((effect, size))
        })
        .collect()
}
