//! A table as CSV, one row a node.

use std::io::Write;

use crate::error::Error;
use crate::table::nodes::Table;
use crate::table::solved::Solved;

impl Table {
    /// Writes the nodes as CSV: the axes, then the figures, each with its unit in its name.
    ///
    /// # Errors
    /// [`Error::Csv`] where the writer fails.
    pub fn write_csv(&self, writer: &mut dyn Write) -> Result<(), Error> {
        let mut csv = csv::Writer::from_writer(writer);
        let mut header = vec!["fz_n", "curvature_1pm"];
        if self.axes().rocker_radius().is_some() {
            header.push("rocker_radius_m");
        }
        header.extend(Solved::KEYS);
        csv.write_record(&header)?;
        for (point, node) in self.axes().points().iter().zip(self.nodes()) {
            let mut row = vec![point.fz, point.curvature];
            row.extend(point.rocker_radius);
            row.extend(node.to_array());
            // `{}` of an f64 is the shortest text that reads back as the same bits.
            csv.write_record(row.iter().map(f64::to_string))?;
        }
        csv.flush()?;
        Ok(())
    }
}
