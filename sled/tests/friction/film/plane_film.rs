//! The film on a patch with the two-dimensional Reynolds equation, a check of the strip closure.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

use kufe_sled::Error;
use kufe_sled::friction::film::{
    Film, FilmConditions, FilmOptions, Properties, Strip, film_with_outflow,
};

use super::pressure_map::PressureMap;

/// Maximum number of iterations between film and Reynolds equation.
const MOST_PASSES: usize = 100;

/// The film on a pressure map, with its pressure from the Reynolds equation.
#[derive(Clone, Debug, PartialEq)]
pub struct ReynoldsFilm {
    /// The film along the rows of the map.
    pub film: Film,
    /// The strip of the map.
    pub strip: Strip,
    /// Film pressure on all cells of the map [Pa].
    pub pressure: Vec<f64>,
    /// Outflow of each row relative to that of the closure for a long strip.
    pub outflow_factor: Vec<f64>,
    /// Number of iterations between film and Reynolds equation.
    pub passes: usize,
}

/// The melt film on `map` with the two-dimensional Reynolds equation instead of the closure for a
/// long strip.
///
/// The thickness `h(xi)` is uniform across each row, melts and freezes as in
/// [`film`](kufe_sled::friction::film::film), and carries the load of each row:
///
/// ```text
/// div( h^3/(12 mu) grad p_f ) = (V/2) dh/dxi - (rho_i/rho_w) v_m,   p_f = 0 at the rim,   mean of p_f = mean of p in each row
/// ```
///
/// Finite volumes on the cells of the map. For given `h` the outflow of each row follows from the
/// loads by a linear system. The film is integrated again with this outflow until it converges.
/// Memory and time grow with cells times rows. Intended for checks on patches with at least as many
/// cells along as across.
///
/// # Errors
/// As [`film`](kufe_sled::friction::film::film); also [`Error::NotConverged`] if film and pressure
/// do not converge.
pub fn reynolds_film(
    map: &PressureMap,
    conditions: &FilmConditions,
    properties: &Properties,
    options: &FilmOptions,
) -> Result<ReynoldsFilm, Error> {
    let strip = map.strip()?;
    let rows = map.rows();
    let mut outflow = strip.pressure().to_vec();
    let mut before: Option<Vec<f64>> = None;
    let mut change = f64::INFINITY;
    for passes in 1..=MOST_PASSES {
        let film = film_with_outflow(&strip, outflow.clone(), conditions, properties, options)?;
        let h: Vec<f64> = film.stations[..rows].iter().map(|s| s.thickness).collect();
        let losses = Losses::of(map, &h, &strip.pressure()[1..=rows])?;
        if let Some(before) = &before {
            let changes = h.iter().zip(before).map(|(h, old)| (h / old - 1.0).abs());
            change = changes.fold(0.0, f64::max);
        }
        for row in 0..rows {
            // Outflow of a long strip with the same load: s = p h^3/(mu w^2), without the
            // viscosity, which is not in `losses`.
            outflow[row + 1] = losses.rate[row] * strip.width()[row + 1].powi(2) / h[row].powi(3);
        }
        for (end, row) in [(0, 1), (rows + 1, rows)] {
            outflow[end] = strip.pressure()[end] * outflow[row] / strip.pressure()[row];
        }
        if change <= options.accuracy {
            let pressures = strip.pressure()[1..=rows].iter();
            return Ok(ReynoldsFilm {
                film,
                outflow_factor: pressures
                    .zip(&outflow[1..])
                    .map(|(p, out)| out / p)
                    .collect(),
                pressure: losses.pressure,
                passes,
                strip,
            });
        }
        before = Some(h);
    }
    Err(Error::NotConverged {
        what: "film and Reynolds equation",
        iterations: MOST_PASSES,
        residual: change,
        tolerance: options.accuracy,
    })
}

/// Outflow of each row for which the film carries the load of the row.
struct Losses {
    /// Volume per unit area and time of each row, times the viscosity [Pa m].
    rate: Vec<f64>,
    /// Film pressure on all cells of the map [Pa].
    pressure: Vec<f64>,
}

impl Losses {
    /// For the thickness `h` [m] and the mean pressure [Pa] of each row in contact.
    fn of(map: &PressureMap, h: &[f64], mean: &[f64]) -> Result<Self, Error> {
        let cells = Cells::of(map);
        let (n, rows) = (cells.row.len(), h.len());
        // Thickness and areas are relative, so that the matrix has entries near 1.
        let scale = h.iter().copied().fold(0.0, f64::max);
        let share: Vec<f64> = h.iter().map(|h| h / scale).collect();
        let matrix = cells.matrix(map, &share)?;
        let undetermined = |_| Error::Undetermined {
            what: "pressure of the film",
            ratio: 0.0,
        };
        let factor = matrix.sp_cholesky(Side::Lower).map_err(undetermined)?;
        let mut responses = Mat::from_fn(n, rows, |cell, row| {
            f64::from(u8::from(cells.row[cell] == row))
        });
        factor.solve_in_place(responses.as_mut());
        let mut means = Mat::<f64>::zeros(rows, rows);
        for (cell, &row) in cells.row.iter().enumerate() {
            for source in 0..rows {
                means[(row, source)] += responses[(cell, source)] / cells.count[row] as f64;
            }
        }
        let loads = Mat::from_fn(rows, 1, |row, _| mean[row]);
        let sources = means.partial_piv_lu().solve(&loads);
        let solved = &responses * &sources;
        let mut pressure = vec![0.0; map.pressure().len()];
        for (cell, &place) in cells.place.iter().enumerate() {
            pressure[place] = solved[(cell, 0)];
        }
        // Matrix: 12 mu times the outflow of a cell, divided by dy/dx and scale^3. Source: the same
        // divided by the area of the cell.
        let unit = scale.powi(3) / (12.0 * map.dx() * map.dx());
        Ok(Losses {
            rate: (0..rows).map(|row| sources[(row, 0)] * unit).collect(),
            pressure,
        })
    }
}

/// The cells in contact.
struct Cells {
    /// Row of each cell, among the rows in contact.
    row: Vec<usize>,
    /// Index of each cell in the map.
    place: Vec<usize>,
    /// Cell at each index of the rows in contact.
    number: Vec<Option<usize>>,
    /// Cells of each row.
    count: Vec<usize>,
}

impl Cells {
    fn of(map: &PressureMap) -> Self {
        let mut cells = Cells {
            row: Vec::new(),
            place: Vec::new(),
            number: Vec::new(),
            count: vec![0; map.rows()],
        };
        for row in 0..map.rows() {
            for (column, p) in map.row(row).iter().enumerate() {
                cells.number.push((*p > 0.0).then_some(cells.row.len()));
                if *p > 0.0 {
                    cells.row.push(row);
                    cells.count[row] += 1;
                    cells
                        .place
                        .push((map.rows_before() + row) * map.columns() + column);
                }
            }
        }
        cells
    }

    /// Outflow of each cell as a function of the pressures, for thicknesses `h` of the rows; lower
    /// triangle. The pressure is 0 halfway to a cell without contact. There is no flow through the
    /// leading edge, where the film begins.
    fn matrix(&self, map: &PressureMap, h: &[f64]) -> Result<SparseColMat<usize, f64>, Error> {
        let columns = map.columns();
        let stretch = (map.dx() / map.dy()).powi(2);
        let mut entries = Vec::with_capacity(4 * self.row.len());
        for (at, number) in self.number.iter().enumerate() {
            let Some(cell) = *number else { continue };
            let (row, column) = (at / columns, at % columns);
            let across = h[row].powi(3) * stretch;
            let along = |other: usize| (0.5 * (h[row] + h[other])).powi(3);
            let left = column.checked_sub(1).map(|_| at - 1);
            let right = (column + 1 < columns).then_some(at + 1);
            let ahead = row.checked_sub(1).map(|_| at - columns);
            let behind = (row + 1 < map.rows()).then_some(at + columns);
            let mut diagonal = 0.0;
            for (neighbour, conductance, rim) in [
                (left, across, 2.0 * across),
                (right, across, 2.0 * across),
                (
                    ahead,
                    along(row.saturating_sub(1)),
                    if row == 0 { 0.0 } else { 2.0 * h[row].powi(3) },
                ),
                (
                    behind,
                    along((row + 1).min(map.rows() - 1)),
                    2.0 * h[row].powi(3),
                ),
            ] {
                match neighbour.and_then(|place| self.number[place]) {
                    Some(other) => {
                        diagonal += conductance;
                        if other < cell {
                            entries.push(Triplet::new(cell, other, -conductance));
                        }
                    }
                    None => diagonal += rim,
                }
            }
            entries.push(Triplet::new(cell, cell, diagonal));
        }
        let n = self.row.len();
        SparseColMat::try_new_from_triplets(n, n, &entries).map_err(|_| Error::Undetermined {
            what: "pressure of the film",
            ratio: 0.0,
        })
    }
}
