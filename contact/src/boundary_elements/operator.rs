//! Displacements at the centres of cells under pressures on the cells: DC-FFT, a discrete
//! convolution by fast Fourier transforms on a zero-padded grid.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Matrix2, Matrix4};
use rayon::prelude::*;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};

use crate::Bed;
use crate::boundary_elements::window::{CheckUnavailable, Surface, Window};

/// Largest ratio of the size of a cell to the thickness of the upper layer.
const MAX_CELL_RATIO: f64 = 12.0;

/// Lines of cells that one task transforms together: its writes for one wave number fill whole
/// cache lines.
const BLOCK: usize = 8;
/// Grids of fewer cells are expect_fft by one task: waking up others would take longer.
const MIN_PARALLEL_CELLS: usize = 1 << 14;

/// Linear map from the pressures on the cells to the displacements at their centres.
///
/// The convolution with the response to one cell's pressure is a product of spectra on a periodic
/// grid of twice as many cells in each direction, where the periodic images do not interact (S.
/// Liu, Q. Wang and G. Liu, Wear 243, 2000): n log n operations for n cells. Cells across a mirror
/// plane are copies.
pub(super) struct Operator {
    /// Cells along x and y.
    cells: [usize; 2],
    /// The first of the cells that are solved for; those before it are their images.
    first: [usize; 2],
    /// Transforms along x, real to complex and back.
    r2c_x: Arc<dyn RealToComplex<f64>>,
    c2r_x: Arc<dyn ComplexToReal<f64>>,
    /// Transforms along y, forward and inverse.
    fft_y: [Arc<dyn Fft<f64>>; 2],
    /// Transfer function divided by the length of the transforms [m/Pa], wave numbers along y
    /// fastest.
    transfer: Vec<f64>,
    /// Spectra along x of the solved lines, by blocks of lines.
    lines: Vec<Complex<f64>>,
    /// Spectra along x of the displacements, lines fastest.
    columns: Vec<Complex<f64>>,
}

impl Operator {
    /// For the cells of a window.
    pub fn new(window: &Window, surface: &Surface) -> Result<Self, CheckUnavailable> {
        let cells = window.cells();
        let [nx, ny] = cells;
        let table = kernel(cells, window.size(), surface)?;
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        let r2c_x = real.plan_fft_forward(2 * nx);
        let fft_y = [
            complex.plan_fft_forward(2 * ny),
            complex.plan_fft_inverse(2 * ny),
        ];
        // The response is even on the periodic grid, so that its transforms are real.
        let spectra_x: Vec<f64> = table
            .par_chunks(nx + 1)
            .flat_map_iter(|places| {
                let mut ring: Vec<f64> = (0..2 * nx).map(|i| places[i.min(2 * nx - i)]).collect();
                let mut waves = r2c_x.make_output_vec();
                expect_fft(r2c_x.process(&mut ring, &mut waves));
                waves.into_iter().map(|wave| wave.re)
            })
            .collect();
        let scale = 1.0 / (4 * nx * ny) as f64;
        let transfer = (0..=nx)
            .into_par_iter()
            .flat_map_iter(|wave| {
                let place = |j: usize| spectra_x[j.min(2 * ny - j) * (nx + 1) + wave];
                let mut ring: Vec<_> = (0..2 * ny).map(|j| Complex::from(place(j))).collect();
                fft_y[0].process(&mut ring);
                ring.into_iter().take(ny + 1).map(|value| scale * value.re)
            })
            .collect();
        let solved = window.solved()[1];
        let blocks = solved.div_ceil(BLOCK);
        Ok(Operator {
            cells,
            first: window.axes.map(|axis| axis.first_solved()),
            r2c_x,
            c2r_x: real.plan_fft_inverse(2 * nx),
            fft_y,
            transfer,
            lines: vec![Complex::default(); blocks * BLOCK * (nx + 1)],
            columns: vec![Complex::default(); solved * (nx + 1)],
        })
    }

    /// `displacement` [m] under `pressure` [Pa], cell by cell, x fastest.
    pub fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.forward_x(pressure);
        self.convolve_y();
        self.inverse_x(displacement);
    }

    /// Items of a parallel loop of `count` that one task takes at least.
    fn min_len(&self, count: usize) -> usize {
        let [nx, ny] = self.cells;
        if nx * ny < MIN_PARALLEL_CELLS {
            count
        } else {
            1
        }
    }

    /// `lines` = spectra along x of the pressures.
    fn forward_x(&mut self, pressure: &[f64]) {
        let [nx, ny] = self.cells;
        let ([x0, y0], spectrum) = (self.first, nx + 1);
        let width = nx - x0;
        let min_len = self.min_len((ny - y0).div_ceil(BLOCK));
        let r2c_x = &self.r2c_x;
        self.lines
            .par_chunks_mut(BLOCK * spectrum)
            .zip(pressure.par_chunks(BLOCK * width))
            .with_min_len(min_len)
            .for_each_init(
                || {
                    (
                        r2c_x.make_input_vec(),
                        r2c_x.make_output_vec(),
                        r2c_x.make_scratch_vec(),
                    )
                },
                |(line, waves, scratch), (block, pressures)| {
                    for (r, pressures) in pressures.chunks_exact(width).enumerate() {
                        line[x0..nx].copy_from_slice(pressures);
                        line[nx..].fill(0.0);
                        for i in 0..x0 {
                            line[i] = pressures[x0 - 1 - i];
                        }
                        expect_fft(r2c_x.process_with_scratch(line, waves, scratch));
                        for (values, wave) in block.chunks_exact_mut(BLOCK).zip(waves.iter()) {
                            values[r] = *wave;
                        }
                    }
                },
            );
    }

    /// `columns` = `lines` convolved along y, for each wave number along x.
    fn convolve_y(&mut self) {
        let [nx, ny] = self.cells;
        let (y0, spectrum) = (self.first[1], nx + 1);
        let min_len = self.min_len(spectrum);
        let (lines, [forward, inverse]) = (&self.lines, &self.fft_y);
        let [length, other] = [forward, inverse].map(|plan| plan.get_inplace_scratch_len());
        let scratch = length.max(other);
        self.columns
            .par_chunks_mut(ny - y0)
            .zip(self.transfer.par_chunks(ny + 1))
            .enumerate()
            .with_min_len(min_len)
            .for_each_init(
                || [2 * ny, scratch].map(|length| vec![Complex::default(); length]),
                |[ring, scratch], (wave, (column, transfer))| {
                    for (block, values) in ring[y0..ny].chunks_mut(BLOCK).enumerate() {
                        let start = (block * spectrum + wave) * BLOCK;
                        values.copy_from_slice(&lines[start..start + values.len()]);
                    }
                    for j in 0..y0 {
                        ring[j] = ring[2 * y0 - 1 - j];
                    }
                    ring[ny..].fill(Complex::default());
                    forward.process_with_scratch(ring, scratch);
                    for (k, value) in ring.iter_mut().enumerate() {
                        *value *= transfer[k.min(2 * ny - k)];
                    }
                    inverse.process_with_scratch(ring, scratch);
                    column.copy_from_slice(&ring[y0..ny]);
                },
            );
    }

    /// Displacements from their spectra along x, `columns`.
    fn inverse_x(&self, displacement: &mut [f64]) {
        let [nx, ny] = self.cells;
        let [x0, y0] = self.first;
        let (width, solved) = (nx - x0, ny - y0);
        let (columns, c2r_x) = (&self.columns, &self.c2r_x);
        displacement
            .par_chunks_mut(BLOCK * width)
            .enumerate()
            .with_min_len(self.min_len(solved.div_ceil(BLOCK)))
            .for_each_init(
                || {
                    (
                        c2r_x.make_input_vec(),
                        c2r_x.make_output_vec(),
                        c2r_x.make_scratch_vec(),
                    )
                },
                |(waves, line, scratch), (block, to)| {
                    for (r, to) in to.chunks_exact_mut(width).enumerate() {
                        let j = block * BLOCK + r;
                        for (wave, value) in waves.iter_mut().enumerate() {
                            *value = columns[wave * solved + j];
                        }
                        // The mean and the Nyquist coefficient of a real signal are real up to
                        // rounding; realfft requires exact zeros.
                        (waves[0].im, waves[nx].im) = (0.0, 0.0);
                        expect_fft(c2r_x.process_with_scratch(waves, line, scratch));
                        to.copy_from_slice(&line[x0..nx]);
                    }
                },
            );
    }
}

/// Panics if a buffer of a transform had another length than its plan.
fn expect_fft(done: Result<(), realfft::FftError>) {
    assert!(done.is_ok(), "{done:?}");
}

/// Displacement of the cell at offset (i, j) under unit pressure on the cell at (0, 0), x fastest
/// [m/Pa].
fn kernel(
    cells: [usize; 2],
    size: [f64; 2],
    surface: &Surface,
) -> Result<Vec<f64>, CheckUnavailable> {
    let mut table = rectangles(cells, size);
    let factor = surface.compliance / PI;
    table.iter_mut().for_each(|value| *value *= factor);
    let Some(upper) = surface.layers.first() else {
        return Ok(table);
    };
    if size[0].max(size[1]) > MAX_CELL_RATIO * upper.thickness {
        return Err(CheckUnavailable::ThinLayer);
    }
    let reach = [0, 1].map(|axis| (cells[axis] as f64 + 1.0) * size[axis]);
    let radial = LayerCorrection::new(&surface.layers, reach[0].hypot(reach[1]));
    // Quadrature points of a cell, as offsets from its middle, with weights.
    let points = size.map(|size| averaging_rule(size, upper.thickness));
    let half = [0, 1].map(|axis| 0.5 * size[axis]);
    table
        .par_chunks_mut(cells[0] + 1)
        .enumerate()
        .for_each(|(j, row)| {
            for (i, value) in row.iter_mut().enumerate() {
                let (x, y) = (i as f64 * size[0], j as f64 * size[1]);
                if (x - half[0]).max(0.0).hypot((y - half[1]).max(0.0)) > radial.cutoff {
                    // The displacement is 0 there; the two parts would cancel up to quadrature.
                    *value = 0.0;
                    continue;
                }
                let mut sum = 0.0;
                for [dy, wy] in &points[1] {
                    for [dx, wx] in &points[0] {
                        sum += wx * wy * radial.at((x + dx).hypot(y + dy));
                    }
                }
                *value += size[0] * size[1] * sum;
            }
        });
    Ok(table)
}

/// Nodes, as offsets from the middle, and weights of composite Gauss-Legendre averaging over an
/// interval of length `size`, for functions that are smooth on the length `scale`.
fn averaging_rule(size: f64, scale: f64) -> Vec<[f64; 2]> {
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

// A half-space under a rectangle of uniform pressure.

/// Displacements at the centres of a grid's cells under unit pressure on the first one, times pi
/// E*: entry (i, j) is that of the cell i steps along x and j along y away, row by row of x,
/// 0..=`cells` each way [m].
///
/// Each is a sum over the rectangle's corners of x asinh(y/x) + y asinh(x/y) = x ln((y + r)/x) + y
/// ln((x + r)/y), which is odd in x and y (A. E. H. Love, Phil. Trans. R. Soc. A 228, 1929).
pub(super) fn rectangles(cells: [usize; 2], size: [f64; 2]) -> Vec<f64> {
    let [nx, ny] = cells.map(|n| n + 1);
    let corner = |i: usize, j: usize| {
        let (x, y) = (i as f64 - 0.5, j as f64 - 0.5);
        let sign = x.signum() * y.signum();
        let (x, y) = (x.abs() * size[0], y.abs() * size[1]);
        let r = (x * x + y * y).sqrt();
        sign * (x * ((y + r) / x).ln() + y * ((x + r) / y).ln())
    };
    let corners: Vec<f64> = (0..=ny)
        .into_par_iter()
        .flat_map_iter(|j| (0..=nx).map(move |i| corner(i, j)))
        .collect();
    let at = |i: usize, j: usize| corners[j * (nx + 1) + i];
    let cell = |i: usize, j: usize| at(i + 1, j + 1) - at(i, j + 1) - at(i + 1, j) + at(i, j);
    (0..ny)
        .into_par_iter()
        .flat_map_iter(|j| (0..nx).map(move |i| cell(i, j)))
        .collect()
}

// Difference between the displacements of layers and of a half-space under a point force.

/// Largest product of wave number and thickness of the upper layer in the quadrature: above it,
/// layers and half-space differ by e^-20.
const MAX_WAVE_NUMBER: f64 = 10.0;
/// Ratio of the cutoff distance to the total thickness of the layers: displacements over a rigid
/// bed fall exponentially.
const CUTOFF: f64 = 15.0;
/// Number of table entries per thickness of the upper layer.
const POINTS_PER_THICKNESS: f64 = 8.0;
/// Largest increment of k r over one panel of the quadrature.
const MAX_PANEL: f64 = 4.0;

/// Abscissae and weights of Gauss-Legendre quadrature on [-1, 1] (M. Abramowitz and I. A. Stegun,
/// Handbook, 1964, table 25.4).
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_29],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_47],
    [0.960_289_856_497_536_2, 0.101_228_536_290_376_26],
];

/// D(r): displacement at distance r of a unit force on layers less that on a half-space of the
/// upper layer's material [m/N].
///
/// D(r) = 1/(2 pi) int (k C(k) - c) J0(k r) dk with the layers' compliance C and c = k times the
/// half-space's.
pub(super) struct LayerCorrection {
    /// Values at equidistant r from 0.
    values: Vec<f64>,
    step: f64,
    /// r times the displacement of the half-space under a unit force, 1 / (pi E*) [1/Pa].
    half_space_factor: f64,
    /// Distance from which the displacement of the layers is taken as 0 [m].
    pub cutoff: f64,
}

impl LayerCorrection {
    /// A table up to `reach` [m].
    pub fn new(layers: &[Bed], reach: f64) -> Self {
        let half_space_compliance = half_space(&layers[0]);
        let upper = layers[0].thickness;
        let cutoff = CUTOFF * layers.iter().map(|layer| layer.thickness).sum::<f64>();
        let reach = reach.min(cutoff);
        let last = MAX_WAVE_NUMBER / upper;
        let panels = (MAX_WAVE_NUMBER.max(last * reach) / MAX_PANEL).ceil();
        let half = 0.5 * last / panels;
        let waves: Vec<[f64; 2]> = (0..panels as usize)
            .flat_map(|panel| {
                let middle = (2.0 * panel as f64 + 1.0) * half;
                GAUSS
                    .iter()
                    .flat_map(move |&[x, w]| [[middle - half * x, w], [middle + half * x, w]])
            })
            .map(|[k, w]| {
                [
                    k,
                    w * half * (k * compliance(layers, k) - half_space_compliance) / (2.0 * PI),
                ]
            })
            .collect();
        let step = upper / POINTS_PER_THICKNESS;
        let places = (reach / step).ceil() as usize + 3;
        let values = (0..places)
            .into_par_iter()
            .map(|i| {
                let r = i as f64 * step;
                waves.iter().map(|[k, w]| w * libm::j0(k * r)).sum()
            })
            .collect();
        LayerCorrection {
            values,
            step,
            half_space_factor: half_space_compliance / (2.0 * PI),
            cutoff,
        }
    }

    /// D at a distance [m/N], by the cubic through the four nearest table entries.
    pub fn at(&self, r: f64) -> f64 {
        if r >= self.cutoff {
            return -self.half_space_factor / r;
        }
        let place = r / self.step;
        let cell = (place as usize).min(self.values.len() - 3);
        let t = place - cell as f64;
        let before = match cell {
            0 => self.values[1],
            _ => self.values[cell - 1],
        };
        let [a, b, c] = [0, 1, 2].map(|k| self.values[cell + k]);
        let outer = (t + 1.0) * (t - 2.0);
        let inner = t * (t - 1.0);
        -before * inner * (t - 2.0) / 6.0 + a * outer * (t - 1.0) / 2.0 - b * outer * t / 2.0
            + c * inner * (t + 1.0) / 6.0
    }
}

// Surface compliance of bonded elastic layers over a rigid bed, by wave number.

/// Largest product of wave number and thickness of one step in depth: its exponentials stay near 1.
const MAX_STEP: f64 = 2.0;
/// Product of thickness and k above which the layers below have no influence: e^-80.
const MAX_DEPTH: f64 = 40.0;

/// k times the displacement of a half-space of a layer's material under a pressure of amplitude 1
/// and any wave number k: 2 (1 - nu^2) / E [1/Pa].
fn half_space(layer: &Bed) -> f64 {
    2.0 * (1.0 - layer.poissons_ratio.powi(2)) / layer.youngs_modulus
}

/// Compliance matrix of a layer's upper plane (displacements u_r, u_z under tractions tau, sigma of
/// wave number `k`) from that of its lower plane, `below`.
///
/// In depth d/dz (U, W, T, S) = A (U, W, T, S) for u_r = U J1(k r), u_z = W J0(k r). A has the
/// eigenvalues k and -k twice each, so that N = A^2 - k^2 has N^2 = 0 and e^(A t) = cosh kt + A
/// sinh(kt)/k + N t sinh(kt)/(2k) + A N (kt cosh kt - sinh kt)/(2 k^3).
fn through_layer(layer: &Bed, k: f64, below: Matrix2<f64>) -> Matrix2<f64> {
    let (e, nu) = (layer.youngs_modulus, layer.poissons_ratio);
    let (lambda, mu) = (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    );
    let plane = lambda + 2.0 * mu;
    // Lengths in 1/k and stresses in mu make every entry of order 1.
    let (p, q) = (lambda / plane, mu / plane);
    let r = (plane - lambda * lambda / plane) / mu;
    let rows = [
        [0.0, 1.0, 1.0, 0.0],
        [-p, 0.0, 0.0, q],
        [r, 0.0, 0.0, p],
        [0.0, 0.0, -1.0, 0.0],
    ];
    let a = Matrix4::from_row_slice(rows.as_flattened());
    let deep = (k * layer.thickness).min(MAX_DEPTH);
    let steps = (deep / MAX_STEP).ceil().max(1.0);
    let t = deep / steps;
    let n = a * a - Matrix4::identity();
    let through = Matrix4::identity() * t.cosh()
        + a * t.sinh()
        + n * (0.5 * t * t.sinh())
        + a * n * (0.5 * (t * t.cosh() - t.sinh()));
    let part = |row: usize, column: usize| -> Matrix2<f64> {
        through.fixed_view::<2, 2>(row, column).into_owned()
    };
    let mut c = below * (k * mu);
    for _ in 0..steps as usize {
        let (moved, loaded) = (part(0, 0) * c + part(0, 2), part(2, 0) * c + part(2, 2));
        // The traction of a finite layer's plane follows from any displacement: the matrix is
        // regular.
        c = moved * loaded.try_inverse().unwrap_or_else(Matrix2::zeros);
    }
    c / (k * mu)
}

/// Downward displacement of the surface of `layers` (from the top one down, the last bonded to a
/// rigid bed) under a pressure of amplitude 1 and wave number `k` [1/m], in m/Pa (I. N. Sneddon,
/// Fourier Transforms, 1951, chapter 10).
pub(super) fn compliance(layers: &[Bed], k: f64) -> f64 {
    let bed = Matrix2::zeros();
    layers
        .iter()
        .rev()
        .fold(bed, |c, layer| through_layer(layer, k, c))[(1, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_the_sums_over_all_cells_and_their_images() {
        let surface = Surface {
            compliance: 1e-10,
            layers: Vec::new(),
        };
        for (cells, mirrored) in [
            ([7, 12], [false, false]),
            ([12, 10], [true, false]),
            ([20, 30], [true, true]),
            // Enough for several tasks.
            ([150, 120], [false, true]),
        ] {
            let window = Window::of_cells([-1.0, -0.2, 1.0, 0.2], cells, mirrored);
            let [nx, ny] = window.solved();
            let pressure: Vec<f64> = (0..nx * ny).map(|c| (0.7 * c as f64).sin()).collect();
            let mut found = vec![f64::NAN; nx * ny];
            let mut operator = Operator::new(&window, &surface).expect("a half-space");
            operator.apply(&pressure, &mut found);
            let table = kernel(cells, window.size(), &surface).expect("a half-space");
            let whole = |c: usize| [c % cells[0], c / cells[0]];
            let index = |[i, j]: [usize; 2]| {
                let [x, y] = &window.axes;
                y.solved_cell(j) * nx + x.solved_cell(i)
            };
            let largest = found.iter().fold(0.0f64, |most, u| most.max(u.abs()));
            for c in (0..cells[0] * cells[1]).step_by(37) {
                let [i, j] = whole(c);
                let sum: f64 = (0..cells[0] * cells[1])
                    .map(|other| {
                        let [k, l] = whole(other);
                        table[j.abs_diff(l) * (cells[0] + 1) + i.abs_diff(k)]
                            * pressure[index([k, l])]
                    })
                    .sum();
                let off = (found[index([i, j])] - sum).abs();
                assert!(
                    off < 1e-12 * largest,
                    "{cells:?} {mirrored:?} {i} {j}: {off:e}"
                );
            }
        }
    }

    #[test]
    fn the_middle_of_a_square_and_far_points_move_as_their_formulas_say() {
        let table = rectangles([40, 40], [2.0, 2.0]);
        // Johnson, section 3.2: 8 ln(1 + sqrt 2) a for a square of half side a.
        assert!((table[0] - 8.0 * (1.0 + 2f64.sqrt()).ln()).abs() < 1e-12);
        let far = table[40 * 41 + 30] * 100.0 / 4.0;
        assert!((far - 1.0).abs() < 1e-4, "{far}");
    }
}

#[cfg(test)]
mod layers_tests {
    use super::*;

    const ICE: Bed = Bed {
        youngs_modulus: 9e9,
        poissons_ratio: 0.33,
        thickness: 0.02,
    };

    #[test]
    fn a_layer_on_a_rigid_bed_gives_as_the_closed_form_says() {
        // K. L. Johnson, Contact Mechanics, 1985, section 5.8; in this form for axial symmetry as
        // for a plane.
        for kh in [1e-3, 0.1, 1.0, 3.0, 9.0] {
            let nu = ICE.poissons_ratio;
            let (twice, kappa) = (2.0 * kh, 3.0 - 4.0 * nu);
            let above: f64 = kappa * f64::sinh(twice) - twice;
            let below = kappa * f64::cosh(twice) + 2.0 * kh * kh + 5.0 - 12.0 * nu + 8.0 * nu * nu;
            let closed = half_space(&ICE) / (kh / ICE.thickness) * above / below;
            let found = compliance(&[ICE], kh / ICE.thickness);
            assert!(
                (found / closed - 1.0).abs() < 1e-6,
                "{kh}: {found} {closed}"
            );
        }
    }

    #[test]
    fn two_layers_of_one_material_are_one() {
        let half = Bed {
            thickness: 0.01,
            ..ICE
        };
        for k in [1.0, 100.0, 700.0] {
            let (one, two) = (compliance(&[ICE], k), compliance(&[half, half], k));
            assert!((one / two - 1.0).abs() < 1e-9, "{k}: {one} {two}");
        }
    }
}
