//! Rows of pressure measurements: a contact problem, its peak and optionally its map; and what
//! these can identify.

use std::path::Path;

use kufe::case::Case;
use kufe::case::effects::{CATALOGUE, Map};
use kufe_contact::{Load, Problem};

use crate::error::{Error, Result};
use crate::evidence::maps::noise::{deviations, is_blank};
use crate::evidence::maps::registration::FilmTolerance;
use crate::evidence::maps::simulate::SizedEffects;
use crate::input::exr_map::read_map;
use crate::input::table::Table;
use crate::procedure::rules::MapRules;

/// Longest text of a case [bytes]: usual ones have some kilobytes.
const LONGEST_CASE: u64 = 1 << 24;

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

/// Columns of a table of pressure measurements.
const COLUMNS: [&str; 9] = [
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

/// Input of a search.
pub struct Measured {
    /// The case to improve, as text.
    pub text: String,
    pub rows: Vec<Row>,
    /// Remarks on the table.
    pub remarks: Vec<String>,
}

impl Measured {
    /// Reads a `pressures.csv` and the cases and maps that it names; `model` is the case file to
    /// improve.
    ///
    /// # Errors
    /// [`Error::Cell`], [`Error::MissingColumn`], [`Error::File`], those of the cases;
    /// [`Error::Duplicate`] if two rows have the same map or are copies.
    pub fn read(path: &Path, model: &Path, rules: &MapRules) -> Result<Self> {
        let (text, model_case) = read_case(model)?;
        let table = Table::read(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let cases = table.texts("case")?;
        let fz = table.numbers("fz_n", 1e-3, 1e6)?;
        let radius = table.numbers("radius_m", f64::NEG_INFINITY, f64::INFINITY)?;
        let p_max = table.numbers("p_max_pa", 0.0, 1e12)?;
        let p_max_sd = table.numbers("p_max_sd_pa", 1e-9, 1e12)?;
        let shift = table.numbers_or("map_shift_sd_m", 0.0, 1.0, rules.film_shift_m)?;
        let rotation =
            table.numbers_or("map_rotation_sd_rad", 0.0, 1.0, rules.film_rotation_rad)?;
        let maps = match table.place("map") {
            Some(_) => table.texts("map")?,
            None => vec![String::new(); cases.len()],
        };
        let same = |a: &Path| {
            let [a, b] = [a, model].map(|file| file.canonicalize().ok());
            a.is_some() && a == b
        };
        let mut rows: Vec<Row> = Vec::new();
        for i in 0..cases.len() {
            let wrong = |column: &str, found: &str, expected: &str| Error::Cell {
                file: table.file.clone(),
                row: table.lines[i],
                column: column.to_owned(),
                found: found.to_owned(),
                expected: expected.to_owned(),
            };
            let stated = folder.join(&cases[i]);
            let (file, case) = if same(&stated) {
                (model, model_case.clone())
            } else {
                (stated.as_path(), read_case(&stated)?.1)
            };
            let mut problem = at_rest(&case, &stated, file)?;
            if let Load::Force { fz: force, .. } = &mut problem.load {
                *force = fz[i];
            }
            if radius[i] == 0.0 {
                let expected = "a radius, or inf for a straight";
                return Err(wrong("radius_m", "0", expected));
            }
            problem.track_curvature = 1.0 / radius[i];
            let map = if maps[i].is_empty() {
                None
            } else {
                Some(read_map(&folder.join(&maps[i]))?)
            };
            if map.as_ref().is_some_and(is_blank) {
                let expected =
                    "a map with more pressure in the contact than at its outermost pixels";
                return Err(wrong("map", &maps[i], expected));
            }
            let is_copy = |k: &usize| {
                (map.is_some() && rows[*k].map == map) || table.rows[*k] == table.rows[i]
            };
            if let Some(copy) = (0..i).find(is_copy) {
                return Err(Error::Duplicate {
                    file: table.file.clone(),
                    first: format!("row {}", table.lines[copy]),
                    second: format!("row {}", table.lines[i]),
                });
            }
            let track = if radius[i].is_finite() {
                format!("radius {} m", radius[i])
            } else {
                "straight".to_owned()
            };
            let noise = map.as_ref().map(|map| deviations(map, p_max[i], rules));
            rows.push(Row {
                name: format!("row {} ({:.0} N, {track})", table.lines[i], fz[i]),
                problem,
                p_max: p_max[i],
                p_max_sd: p_max_sd[i].max(0.015 * p_max[i]),
                fz: fz[i],
                map,
                noise: noise.unwrap_or_default(),
                film: FilmTolerance {
                    shift: shift[i],
                    rotation: rotation[i],
                },
                sensor: sensor(&case),
            });
        }
        let unused = table.header.iter().map(String::as_str);
        let unused: Vec<&str> = unused.filter(|name| !COLUMNS.contains(name)).collect();
        let remark = format!("columns not used: {}", unused.join(", "));
        Ok(Self {
            text,
            rows,
            remarks: Vec::from_iter((!unused.is_empty()).then_some(remark)),
        })
    }
}

/// A case file, as text and read.
fn read_case(file: &Path) -> Result<(String, Case)> {
    let text = kufe_files::text_of_regular(file, LONGEST_CASE);
    let text = text.map_err(|error| Error::file(file, error))?;
    let case = Case::parse(&text).map_err(|error| Error::file(file, error))?;
    Ok((text, case))
}

/// The contact problem of a case that a table names as `stated`, read from `file`.
fn at_rest(case: &Case, stated: &Path, file: &Path) -> Result<Problem> {
    if case.sliding.is_some() {
        return Err(Error::file(stated, "[sliding]: expected a case at rest"));
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    let problem = case.problem(folder);
    problem.map_err(|error| Error::file(stated, error))
}

/// A number of a TOML file, whole or not.
pub fn number(value: &toml::Value) -> Option<f64> {
    let whole = value.as_integer().map(|whole| whole as f64);
    value.as_float().or(whole)
}

/// Sensor effects of a case, with their sizes.
fn sensor(case: &Case) -> SizedEffects {
    let effects = CATALOGUE.iter().filter(|effect| effect.is_of_the_sensor());
    effects
        .filter_map(|effect| {
            let table = case.effects.get(effect.info.name)?;
            Some((effect, number(table.get(effect.parameter().name)?)?))
        })
        .collect()
}

/// Effects that these rows can hardly identify, with the reason.
pub fn untestable(rows: &[Row]) -> Vec<(String, String)> {
    let mapped = rows.iter().any(|r| r.map.is_some());
    let reason = "needs the column map, which is absent or empty";
    CATALOGUE
        .iter()
        .filter(|e| e.search.needs_map && !mapped)
        .map(|e| (e.info().name.to_owned(), reason.to_owned()))
        .collect()
}

/// Remarks on the rows.
pub fn remarks_on(rows: &[Row]) -> Vec<String> {
    let mut remarks = vec![
        "errors of a pixel: the sensor's noise as the map itself shows it, a third of a pixel in its place, 0.3 % of the peak, and what a finer mesh changes; 16 neighbouring pixels count as one value; shift and rotation of each film are fitted within its tolerance".to_owned(),
    ];
    if rows.iter().any(|r| r.map.is_none()) {
        remarks.push("rows without a map contribute their peak pressure alone".to_owned());
    }
    if rows.len() < 3 {
        remarks.push(format!(
            "{} rows are too few to hold one out: the misfit is that of the training rows",
            rows.len()
        ));
    }
    let same = |value: &dyn Fn(&Row) -> f64| rows.iter().all(|r| value(r) == value(&rows[0]));
    if same(&|r| r.fz) && same(&|r| r.problem.track_curvature) {
        remarks.push(format!(
            "fz_n and radius_m are the same in all rows ({} N): effects that differ by load alone cannot be distinguished",
            rows[0].fz
        ));
    }
    remarks
}

/// Root mean square of the stated and estimated deviations \[Pa\].
pub fn typical_noise(rows: &[&Row]) -> f64 {
    let of_row = |row: &&Row| {
        if row.noise.is_empty() {
            vec![row.p_max_sd]
        } else {
            row.noise.clone()
        }
    };
    let deviations: Vec<f64> = rows.iter().flat_map(of_row).collect();
    let squares: f64 = deviations.iter().map(|sd| sd * sd).sum();
    f64::sqrt(squares / f64::max(deviations.len() as f64, 1.0))
}
