//! A table as a MATLAB version 5 MAT-file.

use std::io::Write;

use crate::error::Error;
use crate::export::mat_file::{characters, doubles, header};
use crate::table::nodes::Table;

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
        writer.write_all(&header(&self.version))?;
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
        for (n, key) in self.keys().into_iter().enumerate() {
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
