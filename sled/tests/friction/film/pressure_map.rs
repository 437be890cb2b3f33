//! Pressure map of a contact patch and its conversion to a strip.

use kufe_sled::Error;
use kufe_sled::friction::film::Strip;

/// Pressures of a contact patch on a regular grid. A cell is in contact if its pressure is above 0.
///
/// Rows follow the sliding direction, the leading edge first; the cells of a row are across it.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureMap {
    dx: f64,
    dy: f64,
    columns: usize,
    pressure: Vec<f64>,
    first: usize,
    rows: usize,
}

impl PressureMap {
    /// A map of cells `dx` long and `dy` wide [m], with `columns` cells per row and `pressure` row
    /// by row [Pa]. At least two rows are in contact, without a gap between them.
    pub fn new(dx: f64, dy: f64, columns: usize, pressure: Vec<f64>) -> Self {
        let touches = |row: &[f64]| row.iter().any(|p| *p > 0.0);
        let in_contact: Vec<bool> = pressure.chunks_exact(columns).map(touches).collect();
        let first = in_contact.iter().position(|row| *row).expect("a row");
        let rows = in_contact.iter().filter(|row| **row).count();
        PressureMap {
            dx,
            dy,
            columns,
            pressure,
            first,
            rows,
        }
    }

    /// Length of a cell along the sliding direction [m].
    pub fn dx(&self) -> f64 {
        self.dx
    }

    /// Width of a cell [m].
    pub fn dy(&self) -> f64 {
        self.dy
    }

    /// Number of cells per row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows in contact, from the leading edge.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Pressures of all rows, row by row [Pa].
    pub fn pressure(&self) -> &[f64] {
        &self.pressure
    }

    /// Number of rows ahead of the first row in contact.
    pub fn rows_before(&self) -> usize {
        self.first
    }

    /// Pressures of row `row` of the rows in contact [Pa].
    ///
    /// # Panics
    ///
    /// If there is no such row.
    pub fn row(&self, row: usize) -> &[f64] {
        assert!(row < self.rows, "row {row} of {}", self.rows);
        let at = (self.first + row) * self.columns;
        &self.pressure[at..at + self.columns]
    }

    /// The strip: a station in the middle of each row, and the leading and trailing edges.
    ///
    /// The width of a row is that of its cells in contact, contiguous or not. Its pressure is the
    /// mean over these cells, so that the load of every row is the same. At the two edges pressure
    /// and squared width are extrapolated linearly from the two nearest rows, with 0 as the
    /// minimum.
    ///
    /// # Errors
    ///
    /// As [`Strip::new`]; none for a map in contact without gaps.
    pub fn strip(&self) -> Result<Strip, Error> {
        let (mut xi, mut squared, mut pressure) = (vec![0.0], vec![0.0], vec![0.0]);
        for row in 0..self.rows {
            let cells = self.row(row);
            let touching = cells.iter().filter(|p| **p > 0.0).count() as f64;
            xi.push((row as f64 + 0.5) * self.dx);
            squared.push((touching * self.dy).powi(2));
            pressure.push(cells.iter().sum::<f64>() / touching);
        }
        xi.push(self.rows as f64 * self.dx);
        for values in [&mut squared, &mut pressure] {
            let n = self.rows;
            values[0] = (1.5 * values[1] - 0.5 * values[2]).max(0.0);
            values.push((1.5 * values[n] - 0.5 * values[n - 1]).max(0.0));
        }
        Strip::new(xi, squared.into_iter().map(f64::sqrt).collect(), pressure)
    }
}
