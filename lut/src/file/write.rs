//! Writing a `.lut` file (docs/lut-format.md).

use std::io::Write;

use serde_json::{Map, Value, json};

use crate::error::Error;
use crate::file::format::{FORMAT, FORMAT_VERSION, REDUCED_VERSION, figure};
use crate::table::axes::Axes;
use crate::table::flush::Flush;
use crate::table::mode::Mode;
use crate::table::nodes::{Check, Table};
use crate::table::quantity::Quantity;
use crate::table::solved::{Point, Solved};

impl Table {
    /// Writes the table as JSON; the same table gives the same bytes.
    ///
    /// # Errors
    /// [`Error::Write`] where the writer fails, [`Error::RockerOutside`] where a check lies off the
    /// rocker axis.
    pub fn write(&self, writer: &mut dyn Write) -> Result<(), Error> {
        let format_version = match self.axes().flush() {
            None => FORMAT_VERSION,
            Some(_) => REDUCED_VERSION,
        };
        let entries = [
            ("format", json!(FORMAT)),
            ("format_version", json!(format_version)),
            ("version", json!(self.version)),
            ("case_sha256", json!(self.case_sha256)),
            ("case", self.case.clone()),
            ("accuracy", self.accuracy()?),
        ];
        for (n, (key, value)) in entries.into_iter().enumerate() {
            let start = if n == 0 { "{" } else { "," };
            write!(writer, "{start}\n\"{key}\": {value}")?;
        }
        write_lines(writer, "axes", '[', ']', axis_lines(self.axes()))?;
        let quantities = Solved::KEYS.iter().enumerate().map(|(n, _)| {
            let (name, unit) = figure(n);
            let values: Vec<f64> = self.nodes().iter().map(|s| s.to_array()[n]).collect();
            format!(
                "\"{name}\": {}",
                json!({ "unit": unit, "values": nested(self.axes(), &values) })
            )
        });
        write_lines(writer, "quantities", '{', '}', quantities.collect())?;
        let checks = self.checks().iter().map(check_line).collect();
        write_lines(writer, "checks", '[', ']', checks)?;
        writeln!(writer, "\n}}")?;
        Ok(())
    }

    fn accuracy(&self) -> Result<Value, Error> {
        let mut modes = Map::new();
        for mode in Mode::ALL {
            let mut of_mode = Map::new();
            for quantity in Quantity::ALL {
                if let Some(measured) = self.interpolation_error(quantity, mode)? {
                    of_mode.insert(
                        quantity.name().into(),
                        json!({ "max": measured.max, "rms": measured.rms, "max_at": point(&measured.at) }),
                    );
                }
            }
            modes.insert(mode.name().into(), Value::Object(of_mode));
        }
        Ok(json!({
            "interpolation_asked": self.interpolation_asked,
            "solver_p_max": self.solver_error(),
            "checks": self.checks().len(),
            "interpolation": modes,
        }))
    }
}

fn write_lines(
    writer: &mut dyn Write,
    key: &str,
    open: char,
    close: char,
    lines: Vec<String>,
) -> Result<(), Error> {
    write!(writer, ",\n\"{key}\": {open}")?;
    for (n, line) in lines.iter().enumerate() {
        let end = if n == 0 { "" } else { "," };
        write!(writer, "{end}\n {line}")?;
    }
    write!(writer, "\n{close}")?;
    Ok(())
}

fn axis_lines(axes: &Axes) -> Vec<String> {
    let line = |name: &str, unit: &str, values: &[f64]| {
        json!({ "name": name, "unit": unit, "values": values }).to_string()
    };
    let curvature = match axes.flush() {
        None => line("curvature_1pm", "1/m", axes.curvature()),
        Some(flush) => reduced_line(axes, flush),
    };
    let mut lines = vec![line("fz_n", "N", axes.fz()), curvature];
    if let Some(radii) = axes.rocker_radius() {
        lines.push(line("rocker_radius_m", "m", radii));
    }
    lines
}

/// The reduced axis, with the curvature of every node for readers that only want that.
fn reduced_line(axes: &Axes, flush: &Flush) -> String {
    let [curvature, scale, from, to] = flush.numbers();
    let curvatures: Vec<f64> = axes.points().iter().map(|p| p.curvature).collect();
    json!({
        "name": "reduced_curvature",
        "unit": "1",
        "values": axes.curvature(),
        "flush": { "curvature_1pm": curvature, "scale_1pm_per_n": scale, "from_1pm": from, "to_1pm": to },
        "curvature_1pm": nested(axes, &curvatures),
    })
    .to_string()
}

/// Rows of columns (of rockers), as `numpy.array` takes them.
fn nested(axes: &Axes, values: &[f64]) -> Value {
    let columns = axes.curvature().len();
    let rockers = axes.rockers();
    let row = |row: &[f64]| match axes.rocker_radius() {
        None => json!(row),
        Some(_) => Value::Array(row.chunks_exact(rockers).map(|line| json!(line)).collect()),
    };
    Value::Array(values.chunks_exact(columns * rockers).map(row).collect())
}

fn point(point: &Point) -> Value {
    let mut map = Map::new();
    map.insert("fz_n".into(), json!(point.fz));
    map.insert("curvature_1pm".into(), json!(point.curvature));
    if let Some(radius) = point.rocker_radius {
        map.insert("rocker_radius_m".into(), json!(radius));
    }
    Value::Object(map)
}

fn check_line(check: &Check) -> String {
    let mut record = point(&check.point);
    if let Value::Object(map) = &mut record {
        for (key, value) in Solved::KEYS.into_iter().zip(check.solved.to_array()) {
            map.insert(key.into(), json!(value));
        }
    }
    record.to_string()
}
