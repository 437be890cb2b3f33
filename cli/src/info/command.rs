//! `kufe info FILE`: what a file holds.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, percent};
use kufe::plot::{number4, quantity, unit_of};
use serde_json::{Map, Value, json};

use crate::info::{
    columns_file, exr_file, hull_file, json_file, lut_file, marked_file, mat_file, png_file,
    toml_file, vtk_file,
};
use crate::output::documents;
use crate::output::global::Global;
use crate::output::say::say;

/// Arguments of `kufe info`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// A hull, or any file that a command of kufe has written or reads
    pub file: PathBuf,
}

/// Prints what the file holds.
///
/// # Errors
/// [`Failure::BadInput`] where the file is missing, of an unknown kind, or broken.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let mut facts = describe(&args.file)?;
    documents::without_idle_steel(&mut facts);
    if global.json {
        say(&format!("{facts:#}\n"));
    } else {
        say(&as_text(&facts, 0));
    }
    Ok(())
}

fn describe(path: &Path) -> Result<Value, Failure> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase())
        .unwrap_or_default();
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let found = path
        .metadata()
        .map_err(|error| told(format!("cannot be read: {error}")))?;
    if found.is_dir() {
        return Err(told(
            "is a folder: expected a file; kufe report shows folders".into(),
        ));
    }
    let mut facts = json!({ "file": path.display().to_string(), "size_bytes": found.len() });
    let more = match ending.as_str() {
        "json" => json_file::describe(path)?,
        "csv" | "parquet" => columns_file::describe(path)?,
        "toml" => toml_file::describe(path)?,
        "vtu" | "vtp" | "pvd" => vtk_file::describe(path)?,
        "png" => png_file::describe(path)?,
        "mat" => mat_file::describe(path)?,
        "fmu" => lut_file::describe_fmu(path)?,
        "html" => marked_file::describe(
            path,
            "a page for a browser",
            "kufe report, kufe discover, kufe runs check",
        )?,
        "h" => marked_file::describe(path, "a lookup table in C", "kufe lut --header")?,
        "m" => marked_file::describe(
            path,
            "a script that builds a Simulink block",
            "kufe lut --simulink",
        )?,
        "c" => marked_file::describe(
            path,
            "an S-function of a lookup table",
            "kufe lut --simulink",
        )?,
        "inp" => {
            marked_file::describe(path, "an input deck of CalculiX", "kufe export --calculix")?
        }
        "mtx" => marked_file::describe(
            path,
            "the stiffness of a contact's bodies",
            "kufe export --stiffness",
        )?,
        "sh" => marked_file::describe(
            path,
            "a script that solves a table's points",
            "kufe lut plan",
        )?,
        "1" => marked_file::describe(path, "a manual page", "kufe man")?,
        "md" => marked_file::describe(path, "the command's reference", "kufe man --markdown")?,
        "exr" => exr_file::describe(path)?,
        "lut" => lut_file::describe(path)?,
        "obj" | "glb" | "gltf" | "stl" | "3mf" => hull_file::describe(path)?,
        other => {
            return Err(told(format!(
                "kind \".{other}\" is not known: expected a hull (.obj, .glb, .gltf, .stl, .3mf), or what kufe writes or reads (.json, .csv, \
                 .parquet, .toml, .lut, .exr, .vtu, .vtp, .pvd, .png, .mat, .fmu, .html, .h, .c, .m, .inp, .mtx, .sh, .1, .md)"
            )));
        }
    };
    if let (Some(facts), Value::Object(more)) = (facts.as_object_mut(), more) {
        facts.extend(more);
        if !facts.contains_key("version")
            && let Some((key, value)) = written_with(path, found.len())
        {
            facts.insert(key, value);
        }
    }
    Ok(facts)
}

/// What the document of the file's folder says: that it was written with this file, or that it stands beside it.
fn written_with(path: &Path, length: u64) -> Option<(String, Value)> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let (known, document) = documents::of_folder(folder)?;
    let name = path.file_name()?.to_str()?;
    let listed = document["files"].get(name).and_then(Value::as_u64);
    let key = match listed {
        Some(listed) if listed == length => "written_with",
        Some(_) => "changed_since",
        None => "beside",
    };
    let mut facts = Map::new();
    facts.insert(
        "document".into(),
        json!(folder.join(known.name).display().to_string()),
    );
    facts.insert("kind".into(), json!(known.kind));
    facts.insert("written_by".into(), json!(known.command));
    for key in ["version", "case"] {
        facts.extend(
            document
                .get(key)
                .map(|value| (key.to_owned(), value.clone())),
        );
    }
    Some((key.to_owned(), Value::Object(facts)))
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
