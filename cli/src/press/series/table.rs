//! One table of a series' results.

use std::path::Path;

use kufe::jobs::{Failure, write_whole};
use serde_json::{Map, Value, json};

/// One step of a series: what was varied and what came out.
pub struct Row {
    /// Its number, from 1.
    pub step: usize,
    /// Its folder in the output folder.
    pub folder: String,
    /// The varied keys and their values.
    pub values: Vec<(&'static str, f64)>,
    /// Its result.json.
    pub result: Option<Value>,
    /// Why there is none.
    pub error: Option<String>,
}

/// The figures of result.json that a table has as columns; `fz_n` is the step's own where it varies.
pub const FIGURES: [&str; 16] = [
    "p_max_pa",
    "p_max_error_pa",
    "p_mean_pa",
    "p_mean_error_pa",
    "area_m2",
    "area_error_m2",
    "length_m",
    "length_error_m",
    "width_m",
    "width_error_m",
    "approach_m",
    "approach_error_m",
    "kkt_residual",
    "dofs",
    "iterations",
    "seconds",
];

/// What some results have besides: what a hull's vertices leave, what an elastic runner bears, a second method's answer, and what a runner that slides has.
const FURTHER: [&str; 17] = [
    "p_max_hull_pa",
    "p_max_noise_pa",
    "approach_hull_m",
    "approach_noise_m",
    "runner_von_mises_max_pa",
    "check_p_max_pa",
    "check_p_max_error_pa",
    "mu",
    "mu_error",
    "mu_ploughing",
    "mu_ploughing_error",
    "mu_viscous",
    "mu_viscous_error",
    "groove_depth_m",
    "groove_depth_error_m",
    "film_mean_m",
    "film_mean_error_m",
];

impl Row {
    /// The row as an object: step, folder, what was varied, figures, error.
    fn document(&self) -> Value {
        let mut row = Map::new();
        row.insert("step".into(), json!(self.step));
        row.insert("folder".into(), json!(self.folder));
        for (key, value) in &self.values {
            // JSON has no infinity.
            let value = if value.is_finite() {
                json!(value)
            } else {
                json!(value.to_string())
            };
            row.insert((*key).into(), value);
        }
        for key in FIGURES {
            let figure = self.result.as_ref().map_or(Value::Null, |r| r[key].clone());
            row.insert(key.into(), figure);
        }
        if let Some(shear) = self.result.as_ref().and_then(|r| r.get("subsurface")) {
            for key in [
                "max_shear_pa",
                "max_shear_error_pa",
                "max_shear_depth_m",
                "max_shear_depth_error_m",
            ] {
                row.insert(key.into(), shear[key].clone());
            }
        }
        for key in FURTHER {
            let figure = self.result.as_ref().and_then(|r| r.get(key));
            row.extend(figure.map(|figure| (key.into(), figure.clone())));
        }
        row.insert("error".into(), json!(self.error));
        Value::Object(row)
    }
}

/// All rows, as table.json and `--json` have them.
pub fn document(rows: &[Row]) -> Value {
    rows.iter().map(Row::document).collect()
}

/// Writes table.json and table.csv.
///
/// # Errors
/// [`Failure::BadInput`] with the file that cannot be written.
pub fn write_table(out: &Path, rows: &[Row]) -> Result<(), Failure> {
    let table = document(rows);
    write_whole(&out.join("table.json"), |writer| {
        writeln!(writer, "{table:#}")
    })?;
    write_whole(&out.join("table.csv"), |writer| {
        let rows: Vec<&Map<String, Value>> = table
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(Value::as_object)
            .collect();
        // Rows without a result lack columns that others have: the longest names them all.
        let Some(longest) = rows.iter().max_by_key(|row| row.len()) else {
            return Ok(());
        };
        let mut csv = csv::Writer::from_writer(writer);
        csv.write_record(longest.keys())?;
        for row in &rows {
            csv.write_record(longest.keys().map(|key| match row.get(key) {
                Some(Value::String(text)) => text.clone(),
                None | Some(Value::Null) => String::new(),
                Some(value) => value.to_string(),
            }))?;
        }
        csv.flush()
    })
}
