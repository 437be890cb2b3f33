//! Pressures on cells to displacements at their centres: a convolution, by Fourier's functions of a padded grid.

use std::f64::consts::PI;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};

use super::NotChecked;
use super::radial::Radial;
use super::rectangle::rectangles;
use super::surface::Surface;
use super::window::Window;

/// Most cells' sizes over the upper layer's thickness.
const LARGEST: f64 = 12.0;

/// Fourier's functions of one axis at its cells: columns are modes of the ring of twice as many cells, orthonormal on it.
struct Modes {
    values: Mat<f64>,
    /// The wave of each column.
    wave: Vec<usize>,
}

impl Modes {
    /// For `cells` cells, of which a mirror plane leaves half: even functions are all that is needed then. `cosines` are those of the ring's
    /// quarter cells.
    fn new(cells: usize, mirrored: bool, cosines: &[f64]) -> Self {
        let norm = |k: usize| match k == 0 || k == cells {
            true => (0.5 / cells as f64).sqrt(),
            false => (1.0 / cells as f64).sqrt(),
        };
        // The cosine of wave k, `halves` half cells along the ring.
        let cosine = |k: usize, halves: usize| cosines[k * halves % (4 * cells)];
        if mirrored {
            let wave: Vec<usize> = (0..cells).collect();
            let at = |i: usize, k: usize| 2f64.sqrt() * norm(k) * cosine(k, 2 * i + 1);
            let values = Mat::from_fn(cells / 2, cells, at);
            return Modes { values, wave };
        }
        let wave: Vec<usize> = (0..=cells).chain(1..cells).collect();
        let at = |i: usize, column: usize| {
            let k = wave[column];
            // sin t = cos(t - pi / 2), a quarter of the ring's 4 n half cells.
            let of = match column <= cells {
                true => cosine(k, 2 * i),
                false => cosines[(2 * k * i + 3 * cells) % (4 * cells)],
            };
            norm(k) * of
        };
        let values = Mat::from_fn(cells, 2 * cells, at);
        Modes { values, wave }
    }
}

/// Displacement at every cell's centre under a pressure on every cell.
pub(super) struct Operator {
    modes: [Modes; 2],
    /// What each pair of modes is multiplied with [m/Pa].
    response: Mat<f64>,
    within: [Mat<f64>; 3],
}

impl Operator {
    /// For the cells of a window.
    pub fn new(window: &Window, surface: &Surface) -> Result<Self, NotChecked> {
        let cells = window.cells;
        let [nx, ny] = cells;
        let table = kernel(cells, window.size(), surface)?;
        let cosines = cells.map(|n| -> Vec<f64> {
            let step = 0.5 * PI / n as f64;
            (0..4 * n).map(|m| (step * m as f64).cos()).collect()
        });
        // Sums over the ring: places 1..n stand for their images too.
        let sums = |axis: usize| {
            let n = cells[axis];
            Mat::from_fn(n + 1, n + 1, |place, k| {
                let weight = if place == 0 || place == n { 1.0 } else { 2.0 };
                weight * cosines[axis][2 * place * k % (4 * n)]
            })
        };
        let table = MatRef::from_column_major_slice(&table, nx + 1, ny + 1);
        let response = sums(0).transpose() * table * sums(1);
        let modes =
            [0, 1].map(|axis| Modes::new(cells[axis], window.mirrored[axis], &cosines[axis]));
        let [mx, my] = [0, 1].map(|axis| modes[axis].wave.len());
        let response = Mat::from_fn(mx, my, |i, j| {
            response[(modes[0].wave[i], modes[1].wave[j])]
        });
        let rows = modes[0].values.nrows();
        let within = [(mx, my), (rows, my), (rows, my)].map(|(m, n)| Mat::zeros(m, n));
        Ok(Operator {
            modes,
            response,
            within,
        })
    }

    /// `to` = displacements [m] under `pressure` [Pa], cell by cell, x fastest.
    pub fn apply(&mut self, pressure: &[f64], to: &mut [f64]) {
        let [x, y] = [0, 1].map(|axis| self.modes[axis].values.as_ref());
        let (nx, ny) = (x.nrows(), y.nrows());
        let pressure = MatRef::from_column_major_slice(pressure, nx, ny);
        let [waves, half, back] = &mut self.within;
        let product = |to: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>| {
            matmul(to, Accum::Replace, a, b, 1.0, Par::Seq);
        };
        product(half.as_mut(), pressure, y);
        product(waves.as_mut(), x.transpose(), half.as_ref());
        for j in 0..waves.ncols() {
            let response = self.response.col_as_slice(j);
            for (wave, factor) in waves.col_as_slice_mut(j).iter_mut().zip(response) {
                *wave *= factor;
            }
        }
        product(back.as_mut(), x, waves.as_ref());
        let to = MatMut::from_column_major_slice_mut(to, nx, ny);
        product(to, back.as_ref(), y.transpose());
    }
}

/// Displacement of the cell i steps along x and j along y away under unit pressure on the first one, x fastest [m/Pa].
fn kernel(cells: [usize; 2], size: [f64; 2], surface: &Surface) -> Result<Vec<f64>, NotChecked> {
    let mut table = rectangles(cells, size);
    let factor = surface.compliance / PI;
    table.iter_mut().for_each(|value| *value *= factor);
    let Some(upper) = surface.layers.first() else {
        return Ok(table);
    };
    if size[0].max(size[1]) > LARGEST * upper.thickness {
        return Err(NotChecked::ThinLayer);
    }
    let reach = [0, 1].map(|axis| (cells[axis] as f64 + 1.0) * size[axis]);
    let radial = Radial::new(&surface.layers, reach[0].hypot(reach[1]));
    // Points of a cell that a smooth function over a layer's thickness is averaged on, as offsets from its middle, with weights.
    let points = size.map(|size| mean(size, upper.thickness));
    for j in 0..=cells[1] {
        for i in 0..=cells[0] {
            let (x, y) = (i as f64 * size[0], j as f64 * size[1]);
            let mut sum = 0.0;
            for [dy, wy] in &points[1] {
                for [dx, wx] in &points[0] {
                    sum += wx * wy * radial.at((x + dx).hypot(y + dy));
                }
            }
            table[j * (cells[0] + 1) + i] += size[0] * size[1] * sum;
        }
    }
    Ok(table)
}

/// Offsets and weights of the mean over `size` of a function that is smooth over `scale`.
fn mean(size: f64, scale: f64) -> Vec<[f64; 2]> {
    if size < 0.02 * scale {
        return vec![[0.0, 1.0]];
    }
    // Gauss-Legendre of 4 points on each of some parts.
    let gauss = [
        [-0.861_136_311_594_052_6, 0.347_854_845_137_453_85],
        [-0.339_981_043_584_856_26, 0.652_145_154_862_546_1],
        [0.339_981_043_584_856_26, 0.652_145_154_862_546_1],
        [0.861_136_311_594_052_6, 0.347_854_845_137_453_85],
    ];
    let parts = (0.5 * size / scale).ceil().max(1.0);
    let part = |k: usize| (k as f64 + 0.5) / parts - 0.5;
    (0..parts as usize)
        .flat_map(|k| gauss.map(|[x, w]| [size * (part(k) + 0.5 * x / parts), 0.5 * w / parts]))
        .collect()
}
