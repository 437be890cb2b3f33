//! Formats of other programs: CSV, MAT-files, C headers and their callers, blocks for Simulink,
//! FMUs, and scripts for clusters.

mod bindings;
mod escape;
mod fmu;
mod header;
mod mat;
mod script;
mod simulink;

pub use bindings::{OCTAVE_FUNCTION, binding_files};
pub use escape::shell_word;
pub use fmu::{Fmi, Fmu, read_fmu};
pub use mat::{MatValue, write_mat_file};
pub use script::{parallel_script, slurm_script};
pub use simulink::simulink_files;

use std::io::Write;

use crate::error::Error;
use crate::table::Table;

/// Writes a template with its slots `$NAME$` filled.
fn fill(writer: &mut dyn Write, template: &str, slots: &[(&str, &str)]) -> Result<(), Error> {
    for (place, part) in template.split('$').enumerate() {
        let slot = slots.iter().find(|(name, _)| *name == part);
        let text = match (place % 2, slot) {
            (0, _) => part,
            (_, Some((_, text))) => text,
            (_, None) => unreachable!("the slot {part} has no text"),
        };
        writer.write_all(text.as_bytes())?;
    }
    Ok(())
}

impl Table {
    /// The figures by their keys: values at the nodes, and errors if known.
    fn figures(&self) -> Vec<(&'static str, Vec<f64>)> {
        let figures = self.quantities().iter().flat_map(|&quantity| {
            let values = self.values(quantity).map(|values| (quantity.key(), values));
            let errors = self.errors(quantity);
            let errors = errors.map(|errors| (quantity.error_key(), errors));
            values.into_iter().chain(errors)
        });
        figures.collect()
    }

    /// Writes the nodes as CSV: the axes, then the figures, each with its unit in its name.
    ///
    /// # Errors
    /// [`Error::Csv`] if the writer fails.
    pub fn write_csv(&self, writer: &mut dyn Write) -> Result<(), Error> {
        let mut csv = csv::Writer::from_writer(writer);
        let points = self.axes().points();
        let figures = self.figures();
        let axes = points[0].named().map(|(key, _)| key);
        csv.write_record(axes.chain(figures.iter().map(|(key, _)| *key)))?;
        for (node, point) in points.iter().enumerate() {
            let values = figures.iter().map(|(_, values)| values[node]);
            let row = point.named().map(|(_, value)| value).chain(values);
            // `{}` of an f64 is the shortest text that reads back as equal bits.
            csv.write_record(row.map(|value| value.to_string()))?;
        }
        csv.flush()?;
        Ok(())
    }
}
