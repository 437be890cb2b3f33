//! The units of a MAT-file's variables, by the last part of their names.

use crate::export::mat_file::MatValue;

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

/// A structure with the unit of each name of numbers in the variables that has one, those of structures' fields among them.
pub(super) fn units(variables: &[(String, MatValue)]) -> MatValue {
    let mut names = Vec::new();
    for (name, value) in variables {
        names_in(name, value, &mut names);
    }
    let units = names.iter().filter_map(|name| {
        let last = name.rsplit('_').next()?;
        let (_, unit) = UNITS.iter().find(|(suffix, _)| *suffix == last)?;
        Some((name.to_string(), MatValue::Text(unit.to_string())))
    });
    MatValue::structure(units.collect())
}

/// The names of numbers, each once.
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
