//! Reading a `.lut` file (docs/lut-format.md).

use std::io::Read;

use serde_json::{Map, Value};

use crate::error::Error;
use crate::file::format::{FORMAT, FORMAT_VERSION, REDUCED_VERSION, figure};
use crate::file::json::{get, known, list, number, object, text, wrong};
use crate::table::axes::{Axes, MAX_AXIS};
use crate::table::flush::Flush;
use crate::table::nodes::{Check, Table};
use crate::table::solved::{Point, Solved};

/// Most bytes that a reader of tables takes in.
pub const MAX_FILE_BYTES: u64 = 512 << 20;

impl Table {
    /// Reads a table and checks every number in it.
    ///
    /// # Errors
    /// [`Error::TooLarge`] past [`MAX_FILE_BYTES`]; [`Error::Format`] where the JSON is broken or a key is missing,
    /// unknown or of the wrong kind; the errors of [`Axes::new`] and [`Table::new`]; [`Error::Write`] where
    /// the reader itself fails.
    pub fn read(reader: &mut dyn Read) -> Result<Self, Error> {
        let mut bytes = Vec::new();
        reader.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > MAX_FILE_BYTES {
            return Err(Error::TooLarge {
                limit: MAX_FILE_BYTES,
            });
        }
        let value: Value = serde_json::from_slice(&bytes).map_err(|error| {
            wrong(
                &format!("line {}, column {}", error.line(), error.column()),
                &error.to_string(),
                "a table as JSON",
            )
        })?;
        from_value(&value)
    }
}

fn from_value(value: &Value) -> Result<Table, Error> {
    let top = object(value, "the file")?;
    const KEYS: [&str; 9] = [
        "format",
        "format_version",
        "version",
        "case_sha256",
        "case",
        "accuracy",
        "axes",
        "quantities",
        "checks",
    ];
    known(top, &KEYS, "the file")?;
    if text(top, "format")? != FORMAT {
        return Err(wrong("format", text(top, "format")?, FORMAT));
    }
    let version = get(top, "format_version", "the file")?;
    let reduced = match version.as_u64() {
        Some(FORMAT_VERSION) => false,
        Some(REDUCED_VERSION) => true,
        _ => {
            let expected = format!("{FORMAT_VERSION} or {REDUCED_VERSION}");
            return Err(wrong("format_version", &version.to_string(), &expected));
        }
    };
    let axes = read_axes(get(top, "axes", "the file")?, reduced)?;
    let nodes = read_nodes(
        &axes,
        object(get(top, "quantities", "the file")?, "quantities")?,
    )?;
    let checks = list(get(top, "checks", "the file")?, "checks")?
        .iter()
        .enumerate()
        .map(|(n, check)| read_check(check, &format!("checks[{n}]"), &axes))
        .collect::<Result<_, _>>()?;
    let accuracy = object(get(top, "accuracy", "the file")?, "accuracy")?;
    let asked = match accuracy.get("interpolation_asked") {
        None | Some(Value::Null) => None,
        Some(value) => Some(number(value, "accuracy.interpolation_asked")?),
    };
    let mut table = Table::new(axes, nodes, checks)?;
    table.interpolation_asked = asked;
    table.case = get(top, "case", "the file")?.clone();
    table.case_sha256 = text(top, "case_sha256")?.to_string();
    table.version = text(top, "version")?.to_string();
    Ok(table)
}

fn read_axes(value: &Value, reduced: bool) -> Result<Axes, Error> {
    let axes = list(value, "axes")?;
    let names = match reduced {
        false => ["fz_n", "curvature_1pm", "rocker_radius_m"],
        true => ["fz_n", "reduced_curvature", ""],
    };
    if axes.len() != 2 && (axes.len() != 3 || reduced) {
        return Err(wrong(
            "axes",
            &format!("{} axes", axes.len()),
            match reduced {
                false => "fz_n, curvature_1pm and perhaps rocker_radius_m",
                true => "fz_n and reduced_curvature",
            },
        ));
    }
    let mut read = Vec::new();
    let mut flush = None;
    for (n, axis) in axes.iter().enumerate() {
        let place = format!("axes[{n}]");
        let map = object(axis, &place)?;
        if reduced && n == 1 {
            let keys = ["name", "unit", "values", "flush", "curvature_1pm"];
            known(map, &keys, &place)?;
            flush = Some(read_flush(get(map, "flush", &place)?)?);
        } else {
            known(map, &["name", "unit", "values"], &place)?;
        }
        if text(map, "name")? != names[n] {
            return Err(wrong(&place, text(map, "name")?, names[n]));
        }
        let values = list(get(map, "values", &place)?, &place)?;
        if values.len() > MAX_AXIS {
            return Err(Error::AxisLength {
                axis: names[n],
                found: values.len(),
                limit: MAX_AXIS,
            });
        }
        let values: Result<Vec<f64>, Error> = values
            .iter()
            .enumerate()
            .map(|(i, value)| number(value, &format!("{place}.values[{i}]")))
            .collect();
        read.push(values?);
    }
    let rocker = (read.len() == 3).then(|| read.pop()).flatten();
    let curvature = read.pop().unwrap_or_default();
    let fz = read.pop().unwrap_or_default();
    match flush {
        None => Axes::new(fz, curvature, rocker),
        Some(flush) => Axes::reduced(fz, curvature, flush),
    }
}

fn read_flush(value: &Value) -> Result<Flush, Error> {
    const PLACE: &str = "axes[1].flush";
    const KEYS: [&str; 4] = ["curvature_1pm", "scale_1pm_per_n", "from_1pm", "to_1pm"];
    let map = object(value, PLACE)?;
    known(map, &KEYS, PLACE)?;
    let at = |key: &str| number(get(map, key, PLACE)?, &format!("{PLACE}.{key}"));
    let [curvature, scale, from, to] = KEYS.map(at);
    Flush::new(curvature?, scale?, [from?, to?])
}

fn read_nodes(axes: &Axes, quantities: &Map<String, Value>) -> Result<Vec<Solved>, Error> {
    let names: Vec<&str> = (0..Solved::COUNT).map(|n| figure(n).0).collect();
    known(quantities, &names, "quantities")?;
    let mut shape = vec![axes.fz().len(), axes.curvature().len()];
    shape.extend(axes.rocker_radius().map(<[f64]>::len));
    let mut figures = vec![[0.0; Solved::COUNT]; axes.node_count()];
    for (n, name) in names.iter().enumerate() {
        let place = format!("quantities.{name}");
        let map = object(get(quantities, name, "quantities")?, &place)?;
        known(map, &["unit", "values"], &place)?;
        if text(map, "unit")? != figure(n).1 {
            return Err(wrong(&place, text(map, "unit")?, figure(n).1));
        }
        let mut flat = Vec::new();
        flatten(
            get(map, "values", &place)?,
            &shape,
            &format!("{place}.values"),
            &mut flat,
        )?;
        for (k, (node, value)) in figures.iter_mut().zip(flat).enumerate() {
            credible(name, value, || format!("{place}.values, number {}", k + 1))?;
            node[n] = value;
        }
    }
    Ok(figures.into_iter().map(Solved::from_array).collect())
}

/// Pressures and sizes of a contact are positive, errors are not negative.
fn credible(name: &str, value: f64, place: impl Fn() -> String) -> Result<(), Error> {
    let (holds, expected) = match name {
        "approach" => (true, ""),
        "p_max_error" => (value >= 0.0, "0 or a positive number"),
        _ => (value > 0.0, "a positive number"),
    };
    if holds {
        return Ok(());
    }
    Err(wrong(&place(), &value.to_string(), expected))
}

fn flatten(value: &Value, shape: &[usize], place: &str, into: &mut Vec<f64>) -> Result<(), Error> {
    let Some((&length, inner)) = shape.split_first() else {
        into.push(number(value, place)?);
        return Ok(());
    };
    let values = list(value, place)?;
    if values.len() != length {
        return Err(wrong(
            place,
            &format!("{} entries", values.len()),
            &format!("{length}"),
        ));
    }
    for (n, value) in values.iter().enumerate() {
        flatten(value, inner, &format!("{place}[{n}]"), into)?;
    }
    Ok(())
}

fn read_check(value: &Value, place: &str, axes: &Axes) -> Result<Check, Error> {
    let map = object(value, place)?;
    let at = |key: &str| number(get(map, key, place)?, &format!("{place}.{key}"));
    let rocker_radius = match axes.rocker_radius() {
        None => None,
        Some(radii) => {
            let radius = at("rocker_radius_m")?;
            if !(radii[0]..=radii[radii.len() - 1]).contains(&radius) {
                return Err(wrong(
                    &format!("{place}.rocker_radius_m"),
                    &radius.to_string(),
                    "a radius within the axis",
                ));
            }
            Some(radius)
        }
    };
    let mut figures = [0.0; Solved::COUNT];
    for (n, (value, key)) in figures.iter_mut().zip(Solved::KEYS).enumerate() {
        *value = at(key)?;
        credible(figure(n).0, *value, || format!("{place}.{key}"))?;
    }
    Ok(Check {
        point: Point {
            fz: at("fz_n")?,
            curvature: at("curvature_1pm")?,
            rocker_radius,
        },
        solved: Solved::from_array(figures),
    })
}
