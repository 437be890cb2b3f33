//! `kufe info FILE`: a hull, a lookup table, a pressure map or a result in figures.

use std::io::BufReader;
use std::path::{Path, PathBuf};

use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use kufe::jobs::{Failure, json_number, percent, table::read_table};
use kufe::plot::{number4, quantity, unit_of};
use kufe_files::open_regular;
use kufe_lut::{Method, Mode, Quantity, Table, read_fmu};
use kufe_mesh::{HullOptions, load_hull};
use serde_json::{Map, Value, json};

use crate::output::documents::{figures, known_as, without_idle_steel};
use crate::output::global::Global;
use crate::output::say::say;
use crate::report::read_json;

/// Longest result [bytes].
const LONGEST: u64 = 1 << 24;

/// Arguments of `kufe info`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// A hull (.obj, .glb, .gltf, .stl, .3mf), a lookup table (.lut, .fmu), a map (.exr) or a result (.json)
    pub file: PathBuf,
}

/// Prints what the file contains.
///
/// # Errors
/// [`Failure::BadInput`] where the file is missing, of an unknown kind, or broken.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let path = &args.file;
    let failure =
        |reason: &dyn std::fmt::Display| Failure::BadInput(format!("{}: {reason}", path.display()));
    let found = path
        .metadata()
        .map_err(|error| failure(&format!("cannot be read: {error}")))?;
    if found.is_dir() {
        let reason = "is a folder: expected a file; kufe report shows folders";
        return Err(failure(&reason));
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let described = match ending.to_ascii_lowercase().as_str() {
        "obj" | "glb" | "gltf" | "stl" | "3mf" => hull(path)?,
        "lut" => table(&read_table(path)?).map_err(|error| failure(&error))?,
        "fmu" => {
            let file =
                open_regular(path).map_err(|error| failure(&format!("cannot be read: {error}")))?;
            let unit = read_fmu(BufReader::new(file)).map_err(|error| failure(&error))?;
            let mut facts = table(&unit.table).map_err(|error| failure(&error))?;
            facts["platforms"] = json!(unit.platforms.join(", "));
            facts
        }
        "exr" => map(path).map_err(|error| failure(&error))?,
        "json" => result(path)?,
        other => {
            return Err(failure(&format!(
                "kind \".{other}\" is not known: expected a hull (.obj, .glb, .gltf, .stl, .3mf), a lookup \
                 table (.lut, .fmu), a map (.exr) or a result (.json)"
            )));
        }
    };
    let mut facts = json!({ "file": path.display().to_string(), "size_bytes": found.len() });
    if let (Value::Object(facts), Value::Object(described)) = (&mut facts, described) {
        facts.extend(described);
    }
    without_idle_steel(&mut facts);
    say(&match global.json {
        true => format!("{facts:#}\n"),
        false => as_text(&facts, 0),
    });
    Ok(())
}

/// Size, holes and warnings of a hull, its coordinates taken as metres.
fn hull(path: &Path) -> Result<Value, Failure> {
    let (hull, report) = load_hull(path, &HullOptions::default()).map_err(Failure::bad_input)?;
    let [length, width, height] = report.extent;
    let warnings: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    Ok(json!({
        "kind": "hull",
        "vertices": hull.positions.len(),
        "triangles": hull.triangles.len(),
        "length_m": length,
        "width_m": width,
        "height_m": height,
        "volume_m3": report.volume,
        "open_edges": report.open_edges,
        "flipped_edges": report.flipped_edges,
        "warnings": warnings,
    }))
}

/// Kind, command, version and figures of a result.
fn result(path: &Path) -> Result<Value, Failure> {
    let document = read_json(path, LONGEST)?;
    let Some(known) = known_as(&document) else {
        return Err(Failure::BadInput(format!(
            "{}: not a result of kufe: expected result.json or another that a command writes",
            path.display()
        )));
    };
    let mut facts = Map::new();
    facts.insert("kind".into(), json!(known.kind));
    facts.insert("written_by".into(), json!(known.command));
    let version = document.get("version");
    facts.extend(version.map(|version| ("version".to_owned(), version.clone())));
    facts.extend(figures(&document));
    Ok(Value::Object(facts))
}

/// Size, channels and own attributes of a map; its pixels are not read.
fn map(path: &Path) -> exr::error::Result<Value> {
    let meta = MetaData::read_from_buffered(BufReader::new(open_regular(path)?), false)?;
    let header = meta.headers.first();
    let header = header.ok_or(exr::error::Error::Invalid("a map has a layer".into()))?;
    let channels: Vec<String> = header
        .channels
        .list
        .iter()
        .map(|channel| channel.name.to_string())
        .collect();
    let own = header.own_attributes.other.iter();
    let mut attributes: Vec<(String, Value)> = own
        .chain(&header.shared_attributes.other)
        .map(|(name, value)| (name.to_string(), attribute(value)))
        .collect();
    attributes.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(json!({
        "kind": "map",
        "width": header.layer_size.width(),
        "height": header.layer_size.height(),
        "channels": channels,
        "attributes": Map::from_iter(attributes),
    }))
}

fn attribute(value: &AttributeValue) -> Value {
    match value {
        AttributeValue::Text(text) => json!(text.to_string()),
        AttributeValue::F64(value) => json_number(*value),
        AttributeValue::F32(value) => json_number(f64::from(*value)),
        AttributeValue::I32(number) => json!(number),
        AttributeValue::FloatVec2(pair) => json!([pair.0, pair.1]),
        other => json!(format!("{other:?}")),
    }
}

/// Axes, quantities with their ranges and interpolation errors, the solver's error and the version.
fn table(table: &Table) -> Result<Value, kufe_lut::Error> {
    let mut quantities = Map::new();
    for &quantity in table.quantities() {
        quantities.insert(quantity.key().into(), range_of(table, quantity)?);
    }
    let mut axes = Map::new();
    let range = table.axes().curvature_range(table.axes().fz()[0]);
    axes.insert(
        "curvature_1pm".into(),
        json!({ "points": table.axes().curvature().len(), "from": range[0], "to": range[1] }),
    );
    for (name, _, values) in table.axes().named() {
        if !name.ends_with("curvature_1pm") && name != "reduced_curvature" {
            axes.insert(name.into(), axis(values));
        }
    }
    let solver = format!("solver_error_{}", table.judged().name());
    Ok(json!({
        "kind": "lookup table",
        "written_by": "kufe lut",
        "axes": axes,
        "quantities": quantities,
        "nodes": table.axes().node_count(),
        "checks": table.checks().len(),
        "by_boundary_elements": table.solved_by(Method::BoundaryElements),
        solver: table.solver_error(),
        "interpolation_requested": table.interpolation_requested,
        "case_sha256": table.origin.case_sha256(),
        "version": table.origin.version(),
    }))
}

fn axis(values: &[f64]) -> Value {
    json!({ "points": values.len(), "from": values.first(), "to": values.last() })
}

/// Smallest and largest value, and the largest relative error of each mode where there are checks.
fn range_of(table: &Table, quantity: Quantity) -> Result<Value, kufe_lut::Error> {
    let values = || table.values(quantity).unwrap_or_default().iter().copied();
    let mut figures = Map::new();
    figures.insert("min".into(), values().fold(f64::INFINITY, f64::min).into());
    figures.insert(
        "max".into(),
        values().fold(f64::NEG_INFINITY, f64::max).into(),
    );
    for mode in Mode::ALL {
        if let Some(measured) = table.interpolation_error(quantity, mode)? {
            figures.insert(format!("{}_error", mode.name()), measured.max.into());
        }
    }
    Ok(figures.into())
}

/// Objects as indented `key: value` lines, numbers with the units of their keys, ranges on a line.
fn as_text(value: &Value, depth: usize) -> String {
    let Value::Object(entries) = value else {
        return format!("{value}\n");
    };
    let indent = "  ".repeat(depth);
    entries
        .iter()
        .map(|(key, value)| match value {
            Value::Object(inner) => match range(key, inner) {
                Some(range) => format!("{indent}{key}: {range}\n"),
                None => format!("{indent}{key}:\n{}", as_text(value, depth + 1)),
            },
            Value::Array(list) if list.iter().any(is_sentence) => {
                let lines = list
                    .iter()
                    .map(|one| format!("{indent}  {}\n", single(key, one)));
                format!("{indent}{key}:\n{}", lines.collect::<String>())
            }
            Value::Array(list) if !list.is_empty() && list.iter().all(Value::is_object) => {
                let each = list.iter().enumerate();
                let each = each.map(|(k, one)| {
                    let inner = as_text(one, depth + 1);
                    format!("{indent}{key} {}:\n{inner}", k + 1)
                });
                each.collect()
            }
            other => format!("{indent}{key}: {}\n", single(key, other)),
        })
        .collect()
}

fn is_sentence(value: &Value) -> bool {
    value.as_str().is_some_and(|text| text.contains(' '))
}

/// What stands on a line: words as they are, numbers with their key's unit, lists of them.
fn single(key: &str, value: &Value) -> String {
    match value {
        Value::String(text) if !text.is_empty() => text.clone(),
        Value::Number(number) => with_unit(key, number.as_f64().unwrap_or(f64::NAN)),
        Value::Array(list) if !list.is_empty() => {
            let between = if list.iter().any(Value::is_array) {
                "; "
            } else {
                ", "
            };
            let each: Vec<String> = list.iter().map(|one| single(key, one)).collect();
            each.join(between)
        }
        Value::Bool(holds) => holds.to_string(),
        _ => "none".to_owned(),
    }
}

/// A number with the unit that its key ends in; whole ones that need no digits more as they are.
fn with_unit(key: &str, number: f64) -> String {
    let whole = number.fract() == 0.0 && number.abs() < 1e15;
    match &*unit_of(key) {
        "" if whole => number.to_string(),
        "" => number4(number),
        "bytes" => format!("{number} bytes"),
        unit => quantity(number, unit),
    }
}

/// "12 to 31 m/s, 3 missing" of what has nothing but these; "12 (11 to 13) N" of a value with its interval.
fn range(key: &str, inner: &Map<String, Value>) -> Option<String> {
    const KEYS: [&str; 8] = [
        "points",
        "from",
        "to",
        "missing",
        "min",
        "max",
        "smooth_error",
        "bilinear_error",
    ];
    let number = |key: &str| inner.get(key).and_then(Value::as_f64);
    let between = |from: f64, to: f64| {
        let [from, to] = [from, to].map(|value| with_unit(key, value));
        // The unit once, where it is that of both.
        let unit = to.split_once(' ').map_or("", |(_, unit)| unit);
        let start = from.strip_suffix(unit).unwrap_or(&from).trim_end();
        if from == to {
            to
        } else {
            format!("{start} to {to}")
        }
    };
    if let (3, Some(value), Some(low), Some(high)) =
        (inner.len(), number("value"), number("low"), number("high"))
    {
        let value = with_unit(key, value);
        return Some(match low < high {
            true => format!("{value} ({})", between(low, high)),
            false => value,
        });
    }
    if inner.keys().any(|key| !KEYS.contains(&key.as_str())) {
        return None;
    }
    let ends = (
        number("from").or(number("min")),
        number("to").or(number("max")),
    );
    let mut parts = Vec::new();
    if let (Some(from), Some(to)) = ends {
        parts.push(between(from, to));
    }
    for key in ["points", "missing"] {
        parts.extend(inner.get(key).map(|count| format!("{count} {key}")));
    }
    for mode in ["smooth", "bilinear"] {
        let error = number(&format!("{mode}_error"));
        parts.extend(error.map(|error| format!("{mode} within {}", percent(error))));
    }
    Some(match parts.is_empty() {
        true => "none".to_owned(),
        false => parts.join(", "),
    })
}
