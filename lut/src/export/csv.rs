//! A table as CSV, one row a node.

use std::io::Write;

use crate::error::Error;
use crate::table::nodes::Table;

impl Table {
    /// Writes the nodes as CSV: the axes, then the figures, each with its unit in its name.
    ///
    /// # Errors
    /// [`Error::Csv`] where the writer fails.
    pub fn write_csv(&self, writer: &mut dyn Write) -> Result<(), Error> {
        let mut csv = csv::Writer::from_writer(writer);
        let points = self.axes().points();
        let mut header: Vec<&str> = points[0].named().map(|(key, _)| key).collect();
        header.extend(self.keys());
        csv.write_record(&header)?;
        for (point, node) in points.iter().zip(self.nodes()) {
            let mut row: Vec<f64> = point.named().map(|(_, value)| value).collect();
            row.extend(node.figures());
            // `{}` of an f64 is the shortest text that reads back as the same bits.
            csv.write_record(row.iter().map(f64::to_string))?;
        }
        csv.flush()?;
        Ok(())
    }
}
