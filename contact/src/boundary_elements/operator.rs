//! Pressures on cells to displacements at their centres: a convolution, by fast Fourier transforms
//! on a padded grid.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Matrix2, Matrix4};
use rayon::prelude::*;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};

use crate::Bed;
use crate::boundary_elements::window::{CheckUnavailable, Surface, Window};

/// Most cells' sizes over the upper layer's thickness.
const COARSEST: f64 = 12.0;

/// Lines of cells that one task transforms together: what it writes for one wave are whole lines of
/// the processor's memory.
const BLOCK: usize = 8;
/// Grids of fewer cells are transformed by one task: waking up others would take longer.
const ALONE: usize = 1 << 14;

/// Displacement at every cell's centre under a pressure on every cell.
///
/// The convolution with the response to one cell's pressure is a product on a ring of twice as many
/// cells each way, where pressures do not meet their own images (S. Liu, Q. Wang and G. Liu, Wear
/// 243, 2000): n log n operations for n cells. Cells across a mirror plane are copies.
pub(super) struct Operator {
    /// Cells along x and y.
    cells: [usize; 2],
    /// The first of the cells that are solved for; those before it are their images.
    first: [usize; 2],
    to_waves: Arc<dyn RealToComplex<f64>>,
    from_waves: Arc<dyn ComplexToReal<f64>>,
    /// Along y, forward and back.
    across: [Arc<dyn Fft<f64>>; 2],
    /// What each pair of waves is multiplied with [m/Pa], those along y of one along x together.
    response: Vec<f64>,
    /// Waves along x of the lines that are solved for, by blocks of lines.
    lines: Vec<Complex<f64>>,
    /// The same line by line after those along y, by waves.
    columns: Vec<Complex<f64>>,
}

impl Operator {
    /// For the cells of a window.
    pub fn new(window: &Window, surface: &Surface) -> Result<Self, CheckUnavailable> {
        let cells = window.cells();
        let [nx, ny] = cells;
        let table = kernel(cells, window.size(), surface)?;
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        let to_waves = real.plan_fft_forward(2 * nx);
        let across = [
            complex.plan_fft_forward(2 * ny),
            complex.plan_fft_inverse(2 * ny),
        ];
        // The response is even on the ring, so that its transforms are real.
        let by_waves: Vec<f64> = table
            .par_chunks(nx + 1)
            .flat_map_iter(|places| {
                let mut ring: Vec<f64> = (0..2 * nx).map(|i| places[i.min(2 * nx - i)]).collect();
                let mut waves = to_waves.make_output_vec();
                transformed(to_waves.process(&mut ring, &mut waves));
                waves.into_iter().map(|wave| wave.re)
            })
            .collect();
        let scale = 1.0 / (4 * nx * ny) as f64;
        let response = (0..=nx)
            .into_par_iter()
            .flat_map_iter(|wave| {
                let place = |j: usize| by_waves[j.min(2 * ny - j) * (nx + 1) + wave];
                let mut ring: Vec<_> = (0..2 * ny).map(|j| Complex::from(place(j))).collect();
                across[0].process(&mut ring);
                ring.into_iter().take(ny + 1).map(|value| scale * value.re)
            })
            .collect();
        let solved = window.solved()[1];
        let blocks = solved.div_ceil(BLOCK);
        Ok(Operator {
            cells,
            first: window.axes.map(|axis| axis.first_solved()),
            to_waves,
            from_waves: real.plan_fft_inverse(2 * nx),
            across,
            response,
            lines: vec![Complex::default(); blocks * BLOCK * (nx + 1)],
            columns: vec![Complex::default(); solved * (nx + 1)],
        })
    }

    /// `to` = displacements [m] under `pressure` [Pa], cell by cell, x fastest.
    pub fn apply(&mut self, pressure: &[f64], to: &mut [f64]) {
        let [nx, ny] = self.cells;
        let ([x0, y0], half) = (self.first, nx + 1);
        let width = nx - x0;
        let solved = ny - y0;
        let alone = nx * ny < ALONE;
        let tasks = |count: usize| if alone { count } else { 1 };
        let (to_waves, from_waves) = (&self.to_waves, &self.from_waves);
        let count = solved.div_ceil(BLOCK);
        self.lines
            .par_chunks_mut(BLOCK * half)
            .zip(pressure.par_chunks(BLOCK * width))
            .with_min_len(tasks(count))
            .for_each_init(
                || {
                    (
                        to_waves.make_input_vec(),
                        to_waves.make_output_vec(),
                        to_waves.make_scratch_vec(),
                    )
                },
                |(line, waves, scratch), (block, pressures)| {
                    for (r, pressures) in pressures.chunks_exact(width).enumerate() {
                        line[x0..nx].copy_from_slice(pressures);
                        line[nx..].fill(0.0);
                        for i in 0..x0 {
                            line[i] = pressures[x0 - 1 - i];
                        }
                        transformed(to_waves.process_with_scratch(line, waves, scratch));
                        for (values, wave) in block.chunks_exact_mut(BLOCK).zip(waves.iter()) {
                            values[r] = *wave;
                        }
                    }
                },
            );
        let (lines, [forward, back]) = (&self.lines, &self.across);
        let [length, other] = [forward, back].map(|plan| plan.get_inplace_scratch_len());
        let scratch = length.max(other);
        self.columns
            .par_chunks_mut(solved)
            .zip(self.response.par_chunks(ny + 1))
            .enumerate()
            .with_min_len(tasks(half))
            .for_each_init(
                || [2 * ny, scratch].map(|length| vec![Complex::default(); length]),
                |[ring, scratch], (wave, (column, response))| {
                    for (block, values) in ring[y0..ny].chunks_mut(BLOCK).enumerate() {
                        let start = (block * half + wave) * BLOCK;
                        values.copy_from_slice(&lines[start..start + values.len()]);
                    }
                    for j in 0..y0 {
                        ring[j] = ring[2 * y0 - 1 - j];
                    }
                    ring[ny..].fill(Complex::default());
                    forward.process_with_scratch(ring, scratch);
                    for (k, value) in ring.iter_mut().enumerate() {
                        *value *= response[k.min(2 * ny - k)];
                    }
                    back.process_with_scratch(ring, scratch);
                    column.copy_from_slice(&ring[y0..ny]);
                },
            );
        let columns = &self.columns;
        to.par_chunks_mut(BLOCK * width)
            .enumerate()
            .with_min_len(tasks(count))
            .for_each_init(
                || {
                    (
                        from_waves.make_input_vec(),
                        from_waves.make_output_vec(),
                        from_waves.make_scratch_vec(),
                    )
                },
                |(waves, line, scratch), (block, to)| {
                    for (r, to) in to.chunks_exact_mut(width).enumerate() {
                        let j = block * BLOCK + r;
                        for (wave, value) in waves.iter_mut().enumerate() {
                            *value = columns[wave * solved + j];
                        }
                        // Of a real line the longest and the shortest wave are real but for
                        // rounding.
                        (waves[0].im, waves[nx].im) = (0.0, 0.0);
                        transformed(from_waves.process_with_scratch(waves, line, scratch));
                        to.copy_from_slice(&line[x0..nx]);
                    }
                },
            );
    }
}

/// Passes the end of a transform on whose vectors are its plan's own.
fn transformed(done: Result<(), realfft::FftError>) {
    assert!(done.is_ok(), "{done:?}");
}

/// Displacement of the cell i steps along x and j along y away under unit pressure on the first
/// one, x fastest [m/Pa].
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
    if size[0].max(size[1]) > COARSEST * upper.thickness {
        return Err(CheckUnavailable::ThinLayer);
    }
    let reach = [0, 1].map(|axis| (cells[axis] as f64 + 1.0) * size[axis]);
    let radial = Radial::new(&surface.layers, reach[0].hypot(reach[1]));
    // Points of a cell that a smooth function over a layer's thickness is averaged on, as offsets
    // from its middle, with weights.
    let points = size.map(|size| mean(size, upper.thickness));
    let half = [0, 1].map(|axis| 0.5 * size[axis]);
    table
        .par_chunks_mut(cells[0] + 1)
        .enumerate()
        .for_each(|(j, row)| {
            for (i, value) in row.iter_mut().enumerate() {
                let (x, y) = (i as f64 * size[0], j as f64 * size[1]);
                if (x - half[0]).max(0.0).hypot((y - half[1]).max(0.0)) > radial.end {
                    // Nothing moves there, whatever quadrature leaves of both parts.
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

// What layers change of a half-space's displacement, over the distance from a point force.

/// Largest wave number times the upper layer's thickness that is computed: above it, layers and
/// half-space differ by e^-20.
const LARGEST: f64 = 10.0;
/// Distance over the layers' whole thickness from which nothing moves: displacements over a rigid
/// bed fall exponentially.
const FARTHEST: f64 = 15.0;
/// Places of the table over the upper layer's thickness.
const PLACES: f64 = 8.0;
/// Most that k r may grow over one panel of the quadrature.
const PANEL: f64 = 4.0;

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
pub(super) struct Radial {
    /// Values at even steps from r = 0.
    values: Vec<f64>,
    step: f64,
    /// 1 / (pi E*) of the half-space [1/Pa].
    force: f64,
    /// From here on the layers do not move [m].
    pub end: f64,
}

impl Radial {
    /// A table up to `reach` [m].
    pub fn new(layers: &[Bed], reach: f64) -> Self {
        let own = half_space(&layers[0]);
        let upper = layers[0].thickness;
        let end = FARTHEST * layers.iter().map(|layer| layer.thickness).sum::<f64>();
        let reach = reach.min(end);
        let last = LARGEST / upper;
        let panels = (LARGEST.max(last * reach) / PANEL).ceil();
        let half = 0.5 * last / panels;
        let waves: Vec<[f64; 2]> = (0..panels as usize)
            .flat_map(|panel| {
                let middle = (2.0 * panel as f64 + 1.0) * half;
                GAUSS
                    .iter()
                    .flat_map(move |&[x, w]| [[middle - half * x, w], [middle + half * x, w]])
            })
            .map(|[k, w]| [k, w * half * (k * compliance(layers, k) - own) / (2.0 * PI)])
            .collect();
        let step = upper / PLACES;
        let places = (reach / step).ceil() as usize + 3;
        let values = (0..places)
            .into_par_iter()
            .map(|i| {
                let r = i as f64 * step;
                waves.iter().map(|[k, w]| w * libm::j0(k * r)).sum()
            })
            .collect();
        Radial {
            values,
            step,
            force: own / (2.0 * PI),
            end,
        }
    }

    /// D at a distance [m/N], by the cubic through the four nearest places.
    pub fn at(&self, r: f64) -> f64 {
        if r >= self.end {
            return -self.force / r;
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

// How much the surface of bonded elastic layers over a rigid bed gives, wave by wave.

/// Largest wave number times thickness that one step in depth takes: its exponentials stay near 1.
const STEP: f64 = 2.0;
/// Thickness times k above which the layers below have no influence: e^-80.
const DEEP: f64 = 40.0;

/// k times the displacement of a half-space of a layer's material under a pressure of amplitude 1
/// and any wave number k: 2 (1 - nu^2) / E [1/Pa].
fn half_space(layer: &Bed) -> f64 {
    2.0 * (1.0 - layer.poissons_ratio.powi(2)) / layer.youngs_modulus
}

/// Takes the compliance of the plane below a layer (displacements u_r, u_z under tractions
/// tau, sigma of wave number `k`) to that of its upper plane.
///
/// In depth d/dz (U, W, T, S) = A (U, W, T, S) for u_r = U J1(k r), u_z = W J0(k r). A has the
/// eigenvalues k and -k twice each, so that N = A^2 - k^2 has N^2 = 0 and e^(A t) = cosh kt + A
/// sinh(kt)/k + N t sinh(kt)/(2k) + A N (kt cosh kt - sinh kt)/(2 k^3).
fn raise(layer: &Bed, k: f64, below: Matrix2<f64>) -> Matrix2<f64> {
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
    let deep = (k * layer.thickness).min(DEEP);
    let steps = (deep / STEP).ceil().max(1.0);
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
    layers.iter().rev().fold(bed, |c, layer| raise(layer, k, c))[(1, 1)]
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
            let own = |[i, j]: [usize; 2]| {
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
                            * pressure[own([k, l])]
                    })
                    .sum();
                let off = (found[own([i, j])] - sum).abs();
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
