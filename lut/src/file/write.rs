//! Writing a `.lut` file (docs/tables.md).

use std::io::Write;

use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::error::Error;
use crate::file::format::{FORMAT, FORMAT_VERSION, REDUCED_VERSION, SLIDING_VERSION, figure};
use crate::file::json::point_json;
use crate::table::axes::Axes;
use crate::table::flush::Flush;
use crate::table::mode::Mode;
use crate::table::nodes::{Check, Table};
use crate::table::solved::Method;

impl Table {
    /// Writes the table as JSON; the same table gives the same bytes.
    ///
    /// # Errors
    /// [`Error::Write`] where the writer fails, [`Error::RockerOutside`] where a check lies off the
    /// rocker axis.
    pub fn write(&self, writer: &mut dyn Write) -> Result<(), Error> {
        let format_version = match self.axes().flush() {
            _ if self.is_sliding() => SLIDING_VERSION,
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
        let keys = self.keys().into_iter();
        let quantities = keys.enumerate().map(|(n, key)| {
            let (name, unit) = figure(key);
            let values: Vec<f64> = self.nodes().iter().map(|s| s.figures()[n]).collect();
            format!(
                "\"{name}\": {}",
                json!({ "unit": unit, "values": nested(self.axes(), &values) })
            )
        });
        write_lines(writer, "quantities", '{', '}', quantities.collect())?;
        let methods = self.nodes().iter().map(|s| s.method);
        if methods.clone().any(|method| method != Method::default()) {
            let names: Vec<&str> = methods.map(Method::name).collect();
            write!(writer, ",\n\"method\": {}", nested(self.axes(), &names))?;
        }
        let checks = self.checks().iter().map(check_line).collect();
        write_lines(writer, "checks", '[', ']', checks)?;
        writeln!(writer, "\n}}")?;
        Ok(())
    }

    fn accuracy(&self) -> Result<Value, Error> {
        let mut modes = Map::new();
        for mode in Mode::ALL {
            let mut of_mode = Map::new();
            for &quantity in self.quantities() {
                if let Some(measured) = self.interpolation_error(quantity, mode)? {
                    of_mode.insert(
                        quantity.name().into(),
                        json!({ "max": measured.max, "rms": measured.rms, "max_at": point_json(&measured.at) }),
                    );
                }
            }
            modes.insert(mode.name().into(), Value::Object(of_mode));
        }
        let solver = format!("solver_{}", self.judged().name());
        Ok(json!({
            "interpolation_asked": self.interpolation_asked,
            solver: self.solver_error(),
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
    let lines = axes
        .named()
        .into_iter()
        .map(|(name, unit, values)| match axes.flush() {
            Some(flush) if name == "reduced_curvature" => reduced_line(axes, flush),
            _ => json!({ "name": name, "unit": unit, "values": values }).to_string(),
        });
    lines.collect()
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

/// Rows of columns and so on along all axes, as `numpy.array` takes them.
fn nested<T: Serialize>(axes: &Axes, values: &[T]) -> Value {
    let shape = axes.named().into_iter().map(|(_, _, axis)| axis.len());
    rows(&shape.collect::<Vec<_>>(), values)
}

fn rows<T: Serialize>(shape: &[usize], values: &[T]) -> Value {
    match shape {
        [] | [_] => json!(values),
        [rows_of, inner @ ..] => {
            let chunks = values.chunks_exact(values.len() / rows_of);
            Value::Array(chunks.map(|chunk| rows(inner, chunk)).collect())
        }
    }
}

fn check_line(check: &Check) -> String {
    let mut record = point_json(&check.point);
    if let Value::Object(map) = &mut record {
        let keys = check.solved.own_keys();
        for (key, value) in keys.into_iter().zip(check.solved.figures()) {
            map.insert(key.into(), json!(value));
        }
        if check.solved.method != Method::default() {
            map.insert("method".into(), json!(check.solved.method.name()));
        }
    }
    record.to_string()
}
