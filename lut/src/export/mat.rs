//! MATLAB version 5 MAT-files, uncompressed: variables of numbers, text, structures and cells; and
//! tables in that form.
//!
//! Layout after MathWorks, "MAT-File Format" (version 5): a 128-byte header, then one `miMATRIX`
//! element per variable, each made of tagged parts padded to 8 bytes. Everything is little-endian.

use std::io::{Error, Result, Write};

use crate::axes::{AxisKind, Outside};
use crate::table::Table;
use crate::unit::unit_of;

const MI_INT8: u32 = 1;
const MI_UINT16: u32 = 4;
const MI_INT32: u32 = 5;
const MI_UINT32: u32 = 6;
const MI_DOUBLE: u32 = 9;
const MI_MATRIX: u32 = 14;
const MX_CELL: u32 = 1;
const MX_STRUCT: u32 = 2;
const MX_CHAR: u32 = 4;
const MX_DOUBLE: u32 = 6;
/// Largest length of a name in MATLAB, without the terminating zero.
const MAX_NAME: usize = 63;

/// A variable of a MAT-file.
#[derive(Clone, Debug, PartialEq)]
pub enum MatValue {
    /// Numbers over a shape, the first dimension fastest.
    Numbers(Vec<usize>, Vec<f64>),
    /// A line of text.
    Text(String),
    /// A row of structures: names of the fields, and values of the fields for each structure.
    Structures(Vec<String>, Vec<Vec<MatValue>>),
    /// A row of cells.
    Cells(Vec<MatValue>),
}

impl MatValue {
    /// One number.
    pub fn number(value: f64) -> Self {
        MatValue::Numbers(vec![1, 1], vec![value])
    }

    /// Numbers as a row.
    pub fn row(values: Vec<f64>) -> Self {
        MatValue::Numbers(vec![1, values.len()], values)
    }

    /// One structure of named fields.
    pub fn structure(fields: Vec<(String, MatValue)>) -> Self {
        let (names, values) = fields.into_iter().unzip();
        MatValue::Structures(names, vec![values])
    }

    fn element(&self, name: &str) -> Vec<u8> {
        match self {
            MatValue::Numbers(shape, values) => {
                let data: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
                matrix(MX_DOUBLE, name, shape, &part(MI_DOUBLE, &data))
            }
            MatValue::Text(text) => {
                let units: Vec<u16> = text.encode_utf16().collect();
                let data: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
                matrix(MX_CHAR, name, &[1, units.len()], &part(MI_UINT16, &data))
            }
            MatValue::Structures(names, rows) => {
                // In one word with its tag, as in MATLAB's own files: Octave reads the length of
                // names in this form only.
                let mut data = words(&[MI_INT32 | 4 << 16, MAX_NAME as u32 + 1]);
                let mut table = vec![0; names.len() * (MAX_NAME + 1)];
                for (to, name) in table.chunks_exact_mut(MAX_NAME + 1).zip(names) {
                    let name = variable_name(name);
                    to[..name.len()].copy_from_slice(name.as_bytes());
                }
                data.extend(part(MI_INT8, &table));
                data.extend(rows.iter().flatten().flat_map(|value| value.element("")));
                matrix(MX_STRUCT, name, &[1, rows.len()], &data)
            }
            MatValue::Cells(values) => {
                let data: Vec<u8> = values.iter().flat_map(|v| v.element("")).collect();
                matrix(MX_CELL, name, &[1, values.len()], &data)
            }
        }
    }
}

/// Writes variables as a MAT-file of version 5, followed by `units`, a structure with the unit of
/// each numeric name that has one. `version` is the version of kufe.
///
/// # Errors
/// Errors of the writer, and for a variable above the 2 GiB of the format.
pub fn write_mat_file(
    writer: &mut dyn Write,
    version: &str,
    mut variables: Vec<(String, MatValue)>,
) -> Result<()> {
    variables.push(("units".into(), units(&variables)));
    writer.write_all(&header(version))?;
    for (name, value) in &variables {
        let element = value.element(&variable_name(name));
        if element.len() > i32::MAX as usize {
            return Err(Error::other(format!(
                "{name} takes {} bytes: a MAT-file of version 5 holds variables up to 2 GiB",
                element.len()
            )));
        }
        writer.write_all(&element)?;
    }
    Ok(())
}

/// A structure with the unit of each numeric variable or field that has one.
fn units(variables: &[(String, MatValue)]) -> MatValue {
    let mut names = Vec::new();
    for (name, value) in variables {
        names_in(name, value, &mut names);
    }
    let units = names.into_iter();
    let units = units.filter_map(|name| Some((name.into(), MatValue::Text(unit(name)?))));
    MatValue::structure(units.collect())
}

/// Collects the names of numeric variables and fields, each once.
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

/// A valid name in MATLAB: letters, digits and underscores, a letter first, at most 63 characters.
fn variable_name(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let first = name.chars().next().is_some_and(|c| c.is_ascii_alphabetic());
    let start = if first { "" } else { "x" };
    let name = start.chars().chain(name.chars().map(plain));
    name.take(MAX_NAME).collect()
}

/// The first 128 bytes.
fn header(version: &str) -> [u8; 128] {
    let text = format!("MATLAB 5.0 MAT-file, written by kufe {version}");
    let mut head = [b' '; 128];
    for (to, from) in head.iter_mut().zip(text.bytes().take(116)) {
        *to = from;
    }
    head[116..].copy_from_slice(b"\0\0\0\0\0\0\0\0\0\x01IM");
    head
}

fn matrix(class: u32, name: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let sizes: Vec<u32> = shape.iter().map(|&length| length as u32).collect();
    let mut body = part(MI_UINT32, &words(&[class, 0]));
    body.extend(part(MI_INT32, &words(&sizes)));
    body.extend(part(MI_INT8, name.as_bytes()));
    body.extend(data);
    part(MI_MATRIX, &body)
}

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// A tag, its bytes, and zeros up to a multiple of 8.
fn part(kind: u32, bytes: &[u8]) -> Vec<u8> {
    let mut part = words(&[kind, bytes.len() as u32]);
    part.extend(bytes);
    part.resize(part.len().next_multiple_of(8), 0);
    part
}

/// The unit of a name in MATLAB's spelling; `None` without a unit.
fn unit(name: &str) -> Option<String> {
    let unit = unit_of(name);
    let unit = match &*unit {
        "" => return None,
        "deg C" => "degC",
        "bytes" => "B",
        other => other,
    };
    // A digit after a letter is a power: m2 is m^2.
    let mut spelled = String::new();
    for letter in unit.chars() {
        if letter.is_ascii_digit() && spelled.ends_with(|c: char| c.is_ascii_alphabetic()) {
            spelled.push('^');
        }
        spelled.push(letter);
    }
    Some(spelled)
}

impl Table {
    /// Writes the axes (`fz_n`, `curvature_1pm`, perhaps `rocker_radius_m`, `v_mps`, `ice_c`, as
    /// rows) and every figure as an array over them, force first, named as in `result.json`; with
    /// `outside`, the rule of every axis, `case_json`, `case_sha256` and `version` as text, and
    /// `units`.
    ///
    /// If the second axis has reduced curvatures, its name is `reduced_curvature`; `flush` contains
    /// the four numbers that define them (flush curvature, scale, ends), and `curvature_1pm` the
    /// curvature of every node.
    ///
    /// In Simulink's n-D Lookup Table: breakpoints 1 `fz_n`, breakpoints 2 `curvature_1pm`, table
    /// data `p_max_pa`.
    ///
    /// # Errors
    /// [`crate::Error::Stream`] if the writer fails.
    pub fn write_mat(&self, writer: &mut dyn Write) -> std::result::Result<(), crate::Error> {
        let axes = self.axes();
        let named = axes.named();
        let shape = axes.shape();
        let row = |values: &[f64]| MatValue::row(values.to_vec());
        let rows = named.iter();
        let rows = rows.map(|(name, _, values)| (name.to_string(), row(values)));
        let mut variables: Vec<(String, MatValue)> = rows.collect();
        let over_nodes =
            |values: &[f64]| MatValue::Numbers(shape.clone(), column_major(&shape, values));
        let rules = axes.present().zip(&named).map(|((kind, _), (name, ..))| {
            // A rocker radius outside is refused.
            let rule = match kind {
                AxisKind::RockerRadius => Outside::Error.name(),
                _ => axes.outside(kind).name(),
            };
            (name.to_string(), MatValue::Text(rule.into()))
        });
        variables.push(("outside".into(), MatValue::structure(rules.collect())));
        if let Some(flush) = axes.flush() {
            variables.push(("flush".into(), row(&flush.numbers())));
            let points = axes.points();
            let curvatures: Vec<f64> = points.iter().map(|point| point.curvature).collect();
            variables.push(("curvature_1pm".into(), over_nodes(&curvatures)));
        }
        let figures = self.figures().into_iter();
        variables.extend(figures.map(|(key, values)| (key.into(), over_nodes(&values))));
        for (name, text) in [
            ("case_json", self.case.as_str()),
            ("case_sha256", self.origin.case_sha256()),
            ("version", self.origin.version()),
        ] {
            variables.push((name.into(), MatValue::Text(text.into())));
        }
        Ok(write_mat_file(writer, self.origin.version(), variables)?)
    }
}

/// The values of all nodes, force fastest.
fn column_major(shape: &[usize], values: &[f64]) -> Vec<f64> {
    let node = |n: usize| {
        // Index with the last axis fastest, from an index with the first axis fastest.
        let (node, _) = shape.iter().fold((0, n), |(node, rest), &length| {
            (node * length + rest % length, rest / length)
        });
        node
    };
    (0..values.len()).map(|n| values[node(n)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_spelled_as_matlab_has_them() {
        for (name, spelled) in [
            ("area_m2", "m^2"),
            ("j_zz_kgm2", "kg m^2"),
            ("ax_mps2", "m/s^2"),
            ("curvature_1pm", "1/m"),
            ("ice_c", "degC"),
            ("melt_rate_kgps", "kg/s"),
            ("k_n_per_rad", "N/rad"),
            ("peak_memory_bytes", "B"),
        ] {
            assert_eq!(unit(name).as_deref(), Some(spelled), "{name}");
        }
        assert_eq!(unit("dofs"), None);
    }
}
