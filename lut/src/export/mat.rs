//! A table as a MATLAB version 5 MAT-file, uncompressed.
//!
//! Layout after MathWorks, "MAT-File Format" (version 5): a 128-byte header, then one `miMATRIX` element
//! a variable, each made of tagged parts padded to 8 bytes. Everything is little-endian.

use std::io::Write;

use crate::error::Error;
use crate::table::nodes::Table;
use crate::table::solved::Solved;

const MI_INT8: u32 = 1;
const MI_UINT16: u32 = 4;
const MI_INT32: u32 = 5;
const MI_UINT32: u32 = 6;
const MI_DOUBLE: u32 = 9;
const MI_MATRIX: u32 = 14;
const MX_CHAR: u32 = 4;
const MX_DOUBLE: u32 = 6;

impl Table {
    /// Writes the axes (`fz_n`, `curvature_1pm`, perhaps `rocker_radius_m`, `v_mps`, `ice_c`, as rows) and every figure as an array
    /// over them, force first, named as in `result.json`; with `case_json`, `case_sha256` and `version` as text.
    ///
    /// Where the second axis holds reduced curvatures it is called `reduced_curvature`; `flush` holds the four numbers that
    /// define them (flush curvature, scale, ends) and `curvature_1pm` the curvature of every node.
    ///
    /// In Simulink's n-D Lookup Table: breakpoints 1 `fz_n`, breakpoints 2 `curvature_1pm`, table data `p_max_pa`.
    ///
    /// # Errors
    /// [`Error::Write`] where the writer fails.
    pub fn write_mat(&self, writer: &mut dyn Write) -> Result<(), Error> {
        let text = format!("MATLAB 5.0 MAT-file, written by kufe {}", self.version);
        let mut head = [b' '; 128];
        for (to, from) in head[..116].iter_mut().zip(text.bytes()) {
            *to = from;
        }
        head[116..124].fill(0);
        head[124..].copy_from_slice(&[0x00, 0x01, b'I', b'M']);
        writer.write_all(&head)?;

        let axes = self.axes();
        let row = |name, values: &[f64]| doubles(name, &[1, values.len()], values);
        let named = axes.named();
        let shape: Vec<usize> = named.iter().map(|(_, _, values)| values.len()).collect();
        for (name, _, values) in named {
            writer.write_all(&row(name, values))?;
        }
        if let Some(flush) = axes.flush() {
            writer.write_all(&row("flush", &flush.numbers()))?;
            let points = axes.points();
            let curvatures = self.column_major(&shape, |node| points[node].curvature);
            writer.write_all(&doubles("curvature_1pm", &shape, &curvatures))?;
        }
        for (n, key) in Solved::keys(self.is_sliding()).iter().enumerate() {
            writer.write_all(&doubles(
                key,
                &shape,
                &self.column_major(&shape, |node| self.nodes()[node].figures()[n]),
            ))?;
        }
        for (name, text) in [
            ("case_json", self.case.to_string()),
            ("case_sha256", self.case_sha256.clone()),
            ("version", self.version.clone()),
        ] {
            writer.write_all(&characters(name, &text))?;
        }
        Ok(())
    }

    /// A value of every node, force fastest.
    fn column_major(&self, shape: &[usize], value: impl Fn(usize) -> f64) -> Vec<f64> {
        let count = self.nodes().len();
        let node = |n: usize| {
            // Breakpoints from the first axis on, numbered with the last axis fastest.
            let (node, _) = shape.iter().fold((0, n), |(node, left), &length| {
                (node * length + left % length, left / length)
            });
            node
        };
        (0..count).map(|n| value(node(n))).collect()
    }
}

fn doubles(name: &str, shape: &[usize], values: &[f64]) -> Vec<u8> {
    let data: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    matrix(MX_DOUBLE, name, shape, &part(MI_DOUBLE, &data))
}

fn characters(name: &str, text: &str) -> Vec<u8> {
    let units: Vec<u16> = text.encode_utf16().collect();
    let data: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let shape = [1, units.len()];
    matrix(MX_CHAR, name, &shape, &part(MI_UINT16, &data))
}

fn matrix(class: u32, name: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let flags: Vec<u8> = [class, 0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let sizes: Vec<u8> = shape
        .iter()
        .flat_map(|&length| (length as i32).to_le_bytes())
        .collect();
    let mut body = part(MI_UINT32, &flags);
    body.extend(part(MI_INT32, &sizes));
    body.extend(part(MI_INT8, name.as_bytes()));
    body.extend(data);
    part(MI_MATRIX, &body)
}

/// A tag, its bytes, and zeros up to a multiple of 8.
fn part(kind: u32, bytes: &[u8]) -> Vec<u8> {
    let mut part = Vec::with_capacity(bytes.len() + 16);
    part.extend(kind.to_le_bytes());
    part.extend((bytes.len() as u32).to_le_bytes());
    part.extend(bytes);
    part.resize(part.len().next_multiple_of(8), 0);
    part
}
