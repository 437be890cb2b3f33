//! Pressures on cells to displacements at their centres: a convolution, by Fourier's functions of a
//! padded grid.

use std::f64::consts::PI;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use nalgebra::{Matrix2, Matrix4};

use crate::boundary_elements::window::{CheckUnavailable, Surface, Window};

/// Most cells' sizes over the upper layer's thickness.
const COARSEST: f64 = 12.0;

/// Fourier's functions of one axis at its cells: columns are modes of the ring of twice as many
/// cells, orthonormal on it.
struct Modes {
    values: Mat<f64>,
    /// The wave of each column.
    wave: Vec<usize>,
}

impl Modes {
    /// For `cells` cells, of which a mirror plane leaves half: even functions are all that is
    /// needed then. `cosines` are those of the ring's quarter cells.
    fn new(cells: usize, mirrored: bool, cosines: &[f64]) -> Self {
        let norm = |k: usize| {
            if k == 0 || k == cells {
                (0.5 / cells as f64).sqrt()
            } else {
                (1.0 / cells as f64).sqrt()
            }
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
            let of = if column <= cells {
                cosine(k, 2 * i)
            } else {
                cosines[(2 * k * i + 3 * cells) % (4 * cells)]
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
    pub fn new(window: &Window, surface: &Surface) -> Result<Self, CheckUnavailable> {
        let cells = window.cells;
        let [nx, ny] = cells;
        let table = kernel(cells, window.size(), surface)?;
        let cosines = cells.map(|n| -> Vec<f64> {
            let step = 0.5 * PI / n as f64;
            (0..4 * n).map(|m| (step * m as f64).cos()).collect()
        });
        // Sums over the ring: places 1..n represent their images too.
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
        .flat_map(|j| (0..=nx).map(move |i| corner(i, j)))
        .collect();
    let at = |i: usize, j: usize| corners[j * (nx + 1) + i];
    (0..ny)
        .flat_map(|j| (0..nx).map(move |i| [i, j]))
        .map(|[i, j]| at(i + 1, j + 1) - at(i, j + 1) - at(i + 1, j) + at(i, j))
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
    pub fn new(layers: &[Layer], reach: f64) -> Self {
        let own = layers[0].half_space();
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

/// A layer of one material.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Thickness [m].
    pub thickness: f64,
}

/// Largest wave number times thickness that one step in depth takes: its exponentials stay near 1.
const STEP: f64 = 2.0;
/// Thickness times k above which the layers below have no influence: e^-80.
const DEEP: f64 = 40.0;

impl Layer {
    /// k times the displacement of a half-space of this material under a pressure of amplitude 1
    /// and any wave number k: 2 (1 - nu^2) / E [1/Pa].
    pub fn half_space(&self) -> f64 {
        2.0 * (1.0 - self.poissons_ratio.powi(2)) / self.youngs_modulus
    }

    /// Takes the compliance of the plane below this layer (displacements u_r, u_z under tractions
    /// tau, sigma of wave number `k`) to that of its upper plane.
    ///
    /// In depth d/dz (U, W, T, S) = A (U, W, T, S) for u_r = U J1(k r), u_z = W J0(k r). A has the
    /// eigenvalues k and -k twice each, so that N = A^2 - k^2 has N^2 = 0 and e^(A t) = cosh kt + A
    /// sinh(kt)/k + N t sinh(kt)/(2k) + A N (kt cosh kt - sinh kt)/(2 k^3).
    fn raise(&self, k: f64, below: Matrix2<f64>) -> Matrix2<f64> {
        let (e, nu) = (self.youngs_modulus, self.poissons_ratio);
        let (lambda, mu) = (
            e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            e / (2.0 * (1.0 + nu)),
        );
        let plane = lambda + 2.0 * mu;
        // Lengths in 1/k and stresses in mu make every entry of order 1.
        let a = Matrix4::new(
            0.0,
            1.0,
            1.0,
            0.0,
            -lambda / plane,
            0.0,
            0.0,
            mu / plane,
            (plane - lambda * lambda / plane) / mu,
            0.0,
            0.0,
            lambda / plane,
            0.0,
            0.0,
            -1.0,
            0.0,
        );
        let deep = (k * self.thickness).min(DEEP);
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
}

/// Downward displacement of the surface of `layers` (from the top one down, the last bonded to a
/// rigid bed) under a pressure of amplitude 1 and wave number `k` [1/m], in m/Pa (I. N. Sneddon,
/// Fourier Transforms, 1951, chapter 10).
pub(super) fn compliance(layers: &[Layer], k: f64) -> f64 {
    let bed = Matrix2::zeros();
    layers.iter().rev().fold(bed, |c, layer| layer.raise(k, c))[(1, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

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

    const ICE: Layer = Layer {
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
            let closed = ICE.half_space() / (kh / ICE.thickness) * above / below;
            let found = compliance(&[ICE], kh / ICE.thickness);
            assert!(
                (found / closed - 1.0).abs() < 1e-6,
                "{kh}: {found} {closed}"
            );
        }
    }

    #[test]
    fn two_layers_of_one_material_are_one() {
        let half = Layer {
            thickness: 0.01,
            ..ICE
        };
        for k in [1.0, 100.0, 700.0] {
            let (one, two) = (compliance(&[ICE], k), compliance(&[half, half], k));
            assert!((one / two - 1.0).abs() < 1e-9, "{k}: {one} {two}");
        }
    }
}
