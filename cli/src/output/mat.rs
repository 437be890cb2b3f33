//! A command's document and its series as a MAT-file.

use std::io::Write;

use kufe_jobs::Failure;
use kufe_lut::{MatValue, write_mat_file};
use serde_json::Value;

/// Units by the last part of a name.
const UNITS: [(&str, &str); 24] = [
    ("1pm", "1/m"),
    ("bytes", "B"),
    ("c", "degC"),
    ("deg", "deg"),
    ("hz", "Hz"),
    ("j", "J"),
    ("k", "K"),
    ("kg", "kg"),
    ("kgm2", "kg m^2"),
    ("kgps", "kg/s"),
    ("m", "m"),
    ("m2", "m^2"),
    ("mps", "m/s"),
    ("mps2", "m/s^2"),
    ("ms", "ms"),
    ("n", "N"),
    ("nm", "N m"),
    ("pa", "Pa"),
    ("pct", "%"),
    ("rad", "rad"),
    ("radps", "rad/s"),
    ("radps2", "rad/s^2"),
    ("s", "s"),
    ("seconds", "s"),
];

/// Writes every key of `document` and `more` as variables, and `units`: the unit of each name in them that has one.
///
/// # Errors
/// Those of the writer.
pub fn write(
    writer: &mut dyn Write,
    document: &Value,
    more: Vec<(String, MatValue)>,
) -> Result<(), Failure> {
    let keys = document.as_object().into_iter().flatten();
    let mut variables: Vec<(String, MatValue)> = keys
        .map(|(key, value)| (key.clone(), MatValue::of_json(value)))
        .collect();
    variables.extend(more);
    let mut names = Vec::new();
    for (name, value) in &variables {
        names_in(name, value, &mut names);
    }
    let units = names.iter().filter_map(|name| {
        let last = name.rsplit('_').next()?;
        let (_, unit) = UNITS.iter().find(|(suffix, _)| *suffix == last)?;
        Some((name.to_string(), MatValue::Text(unit.to_string())))
    });
    let units = MatValue::structure(units.collect());
    variables.push(("units".into(), units));
    write_mat_file(writer, env!("CARGO_PKG_VERSION"), &variables).map_err(Failure::bad_input)
}

/// The names of numbers, those of structures' fields among them, each once.
fn names_in<'a>(name: &'a str, value: &'a MatValue, names: &mut Vec<&'a str>) {
    match value {
        MatValue::Numbers(..) if !names.contains(&name) => names.push(name),
        MatValue::Structures(fields, rows) => {
            for row in rows {
                for (field, value) in fields.iter().zip(row) {
                    names_in(field, value, names);
                }
            }
        }
        MatValue::Cells(values) => values.iter().for_each(|v| names_in(name, v, names)),
        _ => {}
    }
}
