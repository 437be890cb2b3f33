//! `kufe info FILE`: what a file holds.

use std::path::{Path, PathBuf};

use kufe_jobs::Failure;
use kufe_plot::{number4, quantity, unit_of};
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
        "exr" => exr_file::describe(path)?,
        "lut" => lut_file::describe(path)?,
        "obj" | "glb" | "gltf" | "stl" => hull_file::describe(path)?,
        other => {
            return Err(told(format!(
                "kind \".{other}\" is not known: expected a hull (.obj, .glb, .gltf, .stl), or what kufe writes or reads (.json, .csv, \
                 .parquet, .toml, .lut, .exr, .vtu, .vtp, .pvd, .png, .mat, .fmu, .html, .h, .c, .m, .inp, .mtx, .sh)"
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
            Value::Number(number) => format!(
                "{indent}{key}: {}\n",
                with_unit(key, number.as_f64(), value)
            ),
            Value::Array(list) if !list.is_empty() && list.iter().all(is_figure) => {
                let list = list.iter().map(|one| match one {
                    Value::String(text) => text.clone(),
                    one => with_unit(key, one.as_f64(), one),
                });
                format!("{indent}{key}: {}\n", list.collect::<Vec<_>>().join(", "))
            }
            Value::Null => format!("{indent}{key}: none\n"),
            Value::Array(lines) if lines.is_empty() => format!("{indent}{key}: none\n"),
            Value::String(text) => format!("{indent}{key}: {text}\n"),
            other => format!("{indent}{key}: {other}\n"),
        })
        .collect()
}

fn is_figure(value: &Value) -> bool {
    let told = ["inf", "-inf", "nan"];
    value.is_number() || value.as_str().is_some_and(|text| told.contains(&text))
}

/// A number with the unit that its key ends in; whole ones without a unit as they are.
fn with_unit(key: &str, number: Option<f64>, value: &Value) -> String {
    match (number, unit_of(key)) {
        (Some(number), "") if !value.is_u64() && !value.is_i64() => number4(number),
        (Some(number), unit) if !unit.is_empty() => quantity(number, unit),
        _ => value.to_string(),
    }
}

/// "12 to 31 m/s, 3 missing" of what has nothing but these.
fn range(key: &str, inner: &Map<String, Value>) -> Option<String> {
    const KEYS: [&str; 4] = ["points", "from", "to", "missing"];
    if inner.is_empty() || inner.keys().any(|key| !KEYS.contains(&key.as_str())) {
        return None;
    }
    let mut parts = Vec::new();
    if let (Some(from), Some(to)) = (inner.get("from"), inner.get("to")) {
        let [from, to] = [from, to].map(|value| with_unit(key, value.as_f64(), value));
        // The unit once, where it is that of both.
        let unit = to.split_once(' ').map_or("", |(_, unit)| unit);
        let from = from.strip_suffix(unit).unwrap_or(&from).trim_end();
        parts.push(format!("{from} to {to}"));
    }
    for key in ["points", "missing"] {
        parts.extend(inner.get(key).map(|count| format!("{count} {key}")));
    }
    Some(parts.join(", "))
}
