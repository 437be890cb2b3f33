//! A table as a MATLAB version 5 MAT-file.

use std::io::Write;

use crate::error::Error;
use crate::export::mat_file::{MatValue, write_mat_file};
use crate::table::nodes::Table;

impl Table {
    /// Writes the axes (`fz_n`, `curvature_1pm`, perhaps `rocker_radius_m`, `v_mps`, `ice_c`, as rows) and every figure as an array
    /// over them, force first, named as in `result.json`; with `case_json`, `case_sha256` and `version` as text, and `units`.
    ///
    /// Where the second axis holds reduced curvatures it is called `reduced_curvature`; `flush` holds the four numbers that
    /// define them (flush curvature, scale, ends) and `curvature_1pm` the curvature of every node.
    ///
    /// In Simulink's n-D Lookup Table: breakpoints 1 `fz_n`, breakpoints 2 `curvature_1pm`, table data `p_max_pa`.
    ///
    /// # Errors
    /// [`Error::Write`] where the writer fails.
    pub fn write_mat(&self, writer: &mut dyn Write) -> Result<(), Error> {
        let axes = self.axes();
        let named = axes.named();
        let shape: Vec<usize> = named.iter().map(|(_, _, values)| values.len()).collect();
        let rows = named
            .iter()
            .map(|(name, _, values)| (name.to_string(), MatValue::row(values.to_vec())));
        let mut variables: Vec<(String, MatValue)> = rows.collect();
        let over_nodes = |value: &dyn Fn(usize) -> f64| {
            MatValue::Numbers(shape.clone(), self.column_major(&shape, value))
        };
        if let Some(flush) = axes.flush() {
            variables.push(("flush".into(), MatValue::row(flush.numbers().to_vec())));
            let points = axes.points();
            let curvatures = over_nodes(&|node| points[node].curvature);
            variables.push(("curvature_1pm".into(), curvatures));
        }
        for (n, key) in self.keys().into_iter().enumerate() {
            let figures = over_nodes(&|node| self.nodes()[node].figures()[n]);
            variables.push((key.to_string(), figures));
        }
        for (name, text) in [
            ("case_json", self.case.to_string()),
            ("case_sha256", self.case_sha256.clone()),
            ("version", self.version.clone()),
        ] {
            variables.push((name.into(), MatValue::Text(text)));
        }
        Ok(write_mat_file(writer, &self.version, variables)?)
    }

    /// A value of every node, force fastest.
    fn column_major(&self, shape: &[usize], value: &dyn Fn(usize) -> f64) -> Vec<f64> {
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
