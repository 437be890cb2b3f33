//! Reading a `.lut` file (docs/tables.md).

use std::io::Read;

use serde_json::{Map, Value};

use crate::error::Error;
use crate::file::format::{FORMAT, FORMAT_VERSION, REDUCED_VERSION, SLIDING_VERSION, figure};
use crate::file::json::{get, known, list, number, object, read_method, text, wrong};
use crate::table::axes::{Axes, MAX_AXIS};
use crate::table::flush::Flush;
use crate::table::nodes::{Check, Table};
use crate::table::solved::{Method, Point, Solved};

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
    const KEYS: [&str; 10] = [
        "format",
        "format_version",
        "version",
        "case_sha256",
        "case",
        "accuracy",
        "axes",
        "quantities",
        "method",
        "checks",
    ];
    known(top, &KEYS, "the file")?;
    if text(top, "format")? != FORMAT {
        return Err(wrong("format", text(top, "format")?, FORMAT));
    }
    let version = get(top, "format_version", "the file")?;
    let known_versions = [FORMAT_VERSION, REDUCED_VERSION, SLIDING_VERSION];
    let version = match version.as_u64() {
        Some(version) if known_versions.contains(&version) => version,
        _ => {
            let expected = format!("{FORMAT_VERSION}, {REDUCED_VERSION} or {SLIDING_VERSION}");
            return Err(wrong("format_version", &version.to_string(), &expected));
        }
    };
    let axes = read_axes(get(top, "axes", "the file")?, version)?;
    let quantities = object(get(top, "quantities", "the file")?, "quantities")?;
    let keys = Solved::keys(
        version == SLIDING_VERSION,
        quantities.contains_key("area_error"),
    );
    let mut nodes = read_nodes(&axes, &keys, quantities)?;
    // Absent: finite elements throughout.
    if let Some(methods) = top.get("method") {
        let mut nodes = nodes.iter_mut();
        let mut leaf = |value: &Value, place: &str| {
            let method = read_method(value, place)?;
            nodes
                .next()
                .into_iter()
                .for_each(|node| node.method = method);
            Ok(())
        };
        leaves(methods, &shape(&axes), "method", &mut leaf)?;
    }
    let checks = list(get(top, "checks", "the file")?, "checks")?
        .iter()
        .enumerate()
        .map(|(n, check)| read_check(check, &format!("checks[{n}]"), &axes, &keys))
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

fn read_axes(value: &Value, version: u64) -> Result<Axes, Error> {
    let axes = list(value, "axes")?;
    let (first, further): (_, &[&str]) = match version {
        REDUCED_VERSION => (["fz_n", "reduced_curvature"], &[]),
        SLIDING_VERSION => (
            ["fz_n", "curvature_1pm"],
            &["rocker_radius_m", "v_mps", "ice_c"],
        ),
        _ => (["fz_n", "curvature_1pm"], &["rocker_radius_m"]),
    };
    if !(2..=2 + further.len()).contains(&axes.len()) {
        let mut expected = first.join(" and ");
        if !further.is_empty() {
            expected += &format!(" and perhaps {}", further.join(", "));
        }
        let found = format!("{} axes", axes.len());
        return Err(wrong("axes", &found, &expected));
    }
    let mut read: Vec<(&str, Vec<f64>)> = Vec::new();
    let mut flush = None;
    let mut left = further;
    for (n, axis) in axes.iter().enumerate() {
        let place = format!("axes[{n}]");
        let map = object(axis, &place)?;
        if version == REDUCED_VERSION && n == 1 {
            let keys = ["name", "unit", "values", "flush", "curvature_1pm"];
            known(map, &keys, &place)?;
            flush = Some(read_flush(get(map, "flush", &place)?)?);
        } else {
            known(map, &["name", "unit", "values"], &place)?;
        }
        let found = text(map, "name")?;
        let name = match (first.get(n), left.iter().position(|name| *name == found)) {
            (Some(&name), _) if name == found => name,
            (None, Some(k)) => {
                let name = left[k];
                left = &left[k + 1..];
                name
            }
            (Some(name), _) => return Err(wrong(&place, found, name)),
            (None, None) => return Err(wrong(&place, found, &left.join(" or "))),
        };
        let values = list(get(map, "values", &place)?, &place)?;
        if values.len() > MAX_AXIS {
            return Err(Error::AxisLength {
                axis: name,
                found: values.len(),
                limit: MAX_AXIS,
            });
        }
        let values: Result<Vec<f64>, Error> = values
            .iter()
            .enumerate()
            .map(|(i, value)| number(value, &format!("{place}.values[{i}]")))
            .collect();
        read.push((name, values?));
    }
    let mut take = |name: &str| {
        let place = read.iter().position(|(found, _)| *found == name);
        place.map(|n| read.swap_remove(n).1)
    };
    let [fz, curvature] = first.map(|name| take(name).unwrap_or_default());
    let axes = match flush {
        None => Axes::new(fz, curvature, take("rocker_radius_m")),
        Some(flush) => Axes::reduced(fz, curvature, flush),
    }?;
    axes.sliding(take("v_mps"), take("ice_c"))
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

fn read_nodes(
    axes: &Axes,
    keys: &[&'static str],
    quantities: &Map<String, Value>,
) -> Result<Vec<Solved>, Error> {
    let names: Vec<&str> = keys.iter().map(|key| figure(key).0).collect();
    known(quantities, &names, "quantities")?;
    let shape = shape(axes);
    let mut figures = vec![vec![0.0; keys.len()]; axes.node_count()];
    for (n, key) in keys.iter().enumerate() {
        let (name, unit) = figure(key);
        let place = format!("quantities.{name}");
        let map = object(get(quantities, name, "quantities")?, &place)?;
        known(map, &["unit", "values"], &place)?;
        if text(map, "unit")? != unit {
            return Err(wrong(&place, text(map, "unit")?, unit));
        }
        let mut flat = Vec::new();
        let mut leaf = |value: &Value, place: &str| {
            flat.push(number(value, place)?);
            Ok(())
        };
        let values = get(map, "values", &place)?;
        leaves(values, &shape, &format!("{place}.values"), &mut leaf)?;
        for (k, (node, value)) in figures.iter_mut().zip(flat).enumerate() {
            credible(name, value, || format!("{place}.values, number {}", k + 1))?;
            node[n] = value;
        }
    }
    let nodes = figures.iter().map(|node| Solved::from_figures(node));
    Ok(nodes.collect())
}

/// Pressures, sizes and friction of a contact are positive; errors and what an elastic contact has none of are not negative.
fn credible(name: &str, value: f64, place: impl Fn() -> String) -> Result<(), Error> {
    let (holds, expected) = match name {
        "approach" => (true, ""),
        "mu_ploughing" | "groove_depth" => (value >= 0.0, "0 or a positive number"),
        _ if name.ends_with("_error") => (value >= 0.0, "0 or a positive number"),
        _ => (value > 0.0, "a positive number"),
    };
    if holds {
        return Ok(());
    }
    Err(wrong(&place(), &value.to_string(), expected))
}

/// Length of every axis.
fn shape(axes: &Axes) -> Vec<usize> {
    axes.named().iter().map(|(_, _, axis)| axis.len()).collect()
}

/// Lists of this shape within lists, what they hold given to `leaf` with its place, the last axis fastest.
fn leaves(
    value: &Value,
    shape: &[usize],
    place: &str,
    leaf: &mut dyn FnMut(&Value, &str) -> Result<(), Error>,
) -> Result<(), Error> {
    let Some((&length, inner)) = shape.split_first() else {
        return leaf(value, place);
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
        leaves(value, inner, &format!("{place}[{n}]"), leaf)?;
    }
    Ok(())
}

fn read_check(
    value: &Value,
    place: &str,
    axes: &Axes,
    keys: &[&'static str],
) -> Result<Check, Error> {
    let map = object(value, place)?;
    let at = |key: &str| number(get(map, key, place)?, &format!("{place}.{key}"));
    let within = |key: &str, axis: Option<&[f64]>| {
        let Some(axis) = axis else { return Ok(None) };
        let value = at(key)?;
        if (axis[0]..=axis[axis.len() - 1]).contains(&value) {
            return Ok(Some(value));
        }
        let place = format!("{place}.{key}");
        Err(wrong(&place, &value.to_string(), "a value within the axis"))
    };
    let mut figures = Vec::with_capacity(keys.len());
    for key in keys {
        let value = at(key)?;
        credible(figure(key).0, value, || format!("{place}.{key}"))?;
        figures.push(value);
    }
    Ok(Check {
        point: Point {
            fz: at("fz_n")?,
            curvature: at("curvature_1pm")?,
            rocker_radius: within("rocker_radius_m", axes.rocker_radius())?,
            speed: within("v_mps", axes.speed())?,
            ice_c: within("ice_c", axes.ice_c())?,
        },
        solved: Solved {
            method: match map.get("method") {
                None => Method::default(),
                Some(value) => read_method(value, &format!("{place}.method"))?,
            },
            ..Solved::from_figures(&figures)
        },
    })
}
