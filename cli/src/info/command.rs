//! `kufe info FILE`: what a file holds.

use std::path::{Path, PathBuf};

use kufe_jobs::Failure;
use serde_json::{Value, json};

use crate::info::{exr_file, hull_file, lut_file};
use crate::output::global::Global;
use crate::output::say::say;

/// Arguments of `kufe info`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// A hull (.obj, .glb, .gltf, .stl), a pressure map (.exr) or a lookup table (.lut)
    pub file: PathBuf,
}

/// Prints what the file holds.
///
/// # Errors
/// [`Failure::BadInput`] where the file is missing, of an unknown kind, or broken.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let facts = describe(&args.file)?;
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
    let mut facts = json!({ "file": path.display().to_string() });
    let more = match ending.as_str() {
        "exr" => exr_file::describe(path)?,
        "lut" => lut_file::describe(path)?,
        "obj" | "glb" | "gltf" | "stl" => hull_file::describe(path)?,
        other => {
            return Err(Failure::BadInput(format!(
                "{}: kind \".{other}\" is not known: expected .obj, .glb, .gltf, .stl, .exr or .lut",
                path.display()
            )));
        }
    };
    if let (Some(facts), Value::Object(more)) = (facts.as_object_mut(), more) {
        facts.extend(more);
    }
    Ok(facts)
}

/// Objects as indented `key: value` lines.
fn as_text(value: &Value, depth: usize) -> String {
    let Value::Object(entries) = value else {
        return format!("{value}\n");
    };
    let indent = "  ".repeat(depth);
    entries
        .iter()
        .map(|(key, value)| match value {
            Value::Object(_) => format!("{indent}{key}:\n{}", as_text(value, depth + 1)),
            Value::Array(lines) if lines.is_empty() => format!("{indent}{key}: none\n"),
            Value::String(text) => format!("{indent}{key}: {text}\n"),
            other => format!("{indent}{key}: {other}\n"),
        })
        .collect()
}
