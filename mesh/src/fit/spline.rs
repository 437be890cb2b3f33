//! Bicubic splines on uneven knots and their least-squares fit.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Clamped cubic B-splines on a strictly increasing sequence of breaks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BSpline {
    /// The breaks, with the first and last four times.
    knots: Vec<f64>,
}

impl BSpline {
    /// The splines on at least two strictly increasing `breaks`.
    pub fn new(breaks: &[f64]) -> Self {
        assert!(breaks.len() >= 2, "{} breaks", breaks.len());
        let (first, last) = (breaks[0], breaks[breaks.len() - 1]);
        let knots = [&[first; 3], breaks, &[last; 3]].concat();
        Self { knots }
    }

    /// Number of splines.
    pub fn count(&self) -> usize {
        self.knots.len() - 4
    }

    /// The breaks.
    pub fn breaks(&self) -> &[f64] {
        &self.knots[3..self.knots.len() - 3]
    }

    /// First spline that is not zero at `x`, and the four values there. `x` is clamped to the
    /// breaks' range.
    pub fn values(&self, x: f64) -> (usize, [f64; 4]) {
        self.derivatives(x, 0)
    }

    /// First spline that is not zero at `x`, and the four derivatives of this order there.
    pub fn derivatives(&self, x: f64, order: usize) -> (usize, [f64; 4]) {
        let breaks = self.breaks();
        let x = x.clamp(breaks[0], breaks[breaks.len() - 1]);
        let after = breaks.partition_point(|&b| b <= x);
        let first = after.clamp(1, breaks.len() - 1) - 1;
        let mut values = [1.0, 0.0, 0.0, 0.0];
        for degree in 1..=3 {
            if degree + order <= 3 {
                self.raise_degree(first, x, degree, &mut values);
            } else {
                values = self.derived(first, degree, values);
            }
        }
        (first, values)
    }

    /// Values of `degree` from those of degree - 1 (recurrence of Cox and de Boor).
    fn raise_degree(&self, first: usize, x: f64, degree: usize, values: &mut [f64; 4]) {
        let span = first + 3;
        let mut carried = 0.0;
        for (r, value) in values.iter_mut().enumerate().take(degree) {
            let (right, left) = (self.knots[span + r + 1], self.knots[span + r + 1 - degree]);
            let part = *value / (right - left);
            *value = carried + (right - x) * part;
            carried = (x - left) * part;
        }
        values[degree] = carried;
    }

    /// The k-th derivatives of `degree` from the (k-1)-th of degree - 1.
    fn derived(&self, first: usize, degree: usize, lower: [f64; 4]) -> [f64; 4] {
        let span = first + 3;
        let mut values = [0.0; 4];
        for (r, value) in lower.iter().enumerate().take(degree) {
            let slope = degree as f64 * value
                / (self.knots[span + r + 1] - self.knots[span + r + 1 - degree]);
            values[r] -= slope;
            values[r + 1] += slope;
        }
        values
    }
}

/// One height: place, value and weight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Place along both axes [m].
    pub at: [f64; 2],
    /// Height [m].
    pub height: f64,
    /// Factor of the residual in the sum of squares.
    pub weight: f64,
}

/// A bicubic spline over two axes.
#[derive(Clone, Debug)]
pub(crate) struct Bicubic {
    /// The splines along both axes.
    pub axes: [BSpline; 2],
    /// Coefficients, the second axis running fastest.
    pub coefficients: Vec<f64>,
}

impl Bicubic {
    /// Height at `at`.
    pub fn value(&self, at: [f64; 2]) -> f64 {
        let (i, along) = self.axes[0].values(at[0]);
        let (j, across) = self.axes[1].values(at[1]);
        let count = self.axes[1].count();
        let mut sum = 0.0;
        for (k, a) in along.iter().enumerate() {
            let row = &self.coefficients[(i + k) * count + j..][..4];
            let [b, c, d, e] = [0, 1, 2, 3].map(|l| row[l] * across[l]);
            sum += a * (b + c + d + e);
        }
        sum
    }

    /// The mean of the surface and its mirror image along `axis`; the breaks must be symmetric.
    pub fn symmetrise(&mut self, axis: usize) {
        let [rows, columns] = [self.axes[0].count(), self.axes[1].count()];
        let old = self.coefficients.clone();
        for (k, own) in self.coefficients.iter_mut().enumerate() {
            let (i, j) = (k / columns, k % columns);
            let mirror = match axis {
                0 => (rows - 1 - i) * columns + j,
                _ => i * columns + columns - 1 - j,
            };
            *own = 0.5 * (old[k] + old[mirror]);
        }
    }
}

/// Number of splines on either side of a given one that overlap it along an axis.
const REACH: usize = 3;
/// Number of splines across that overlap a given one, including itself.
const WIDTH: usize = 2 * REACH + 1;

/// Normal equations of the coefficients of a bicubic spline, the second axis running fastest.
///
/// The entry of coefficients (i, j) and (k, l) is not zero if |i - k| and |j - l| are at most 3.
pub(crate) struct NormalEquations {
    rows: usize,
    columns: usize,
    /// For each coefficient (i, j) its entries with (i, j - 3) to (i + 3, j + 3), row by row;
    /// entries with coefficients that do not exist, or precede it, are not used.
    entries: Vec<[f64; (REACH + 1) * WIDTH]>,
    right: Vec<f64>,
}

impl NormalEquations {
    /// Equations of zeros for `rows` times `columns` coefficients, at least four of each.
    pub fn new(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            entries: vec![[0.0; (REACH + 1) * WIDTH]; rows * columns],
            right: vec![0.0; rows * columns],
        }
    }

    /// Adds `weight (a . s - height)^2` for the coefficients s of the four by four splines from
    /// (`i`, `j`) on, the factors `a` being products of `along` and `across`.
    pub fn add(
        &mut self,
        [i, j]: [usize; 2],
        [along, across]: [&[f64; 4]; 2],
        weight: f64,
        height: f64,
    ) {
        let factors: [f64; 16] = std::array::from_fn(|k| along[k / 4] * across[k % 4]);
        let weighted = factors.map(|factor| weight * factor);
        for (n, &factor) in factors.iter().enumerate() {
            let own = (i + n / 4) * self.columns + j + n % 4;
            self.right[own] += weighted[n] * height;
            let others = weighted.chunks_exact(4).skip(n / 4);
            for (entries, others) in self.entries[own].chunks_exact_mut(WIDTH).zip(others) {
                for (entry, other) in entries[REACH - n % 4..].iter_mut().zip(others) {
                    *entry += other * factor;
                }
            }
        }
    }

    /// Cholesky factor of the matrix; `None` if it is singular.
    fn factored(&self) -> Option<Factored> {
        let size = self.right.len();
        // The lower triangle, column by column.
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for (own, entries) in self.entries.iter().enumerate() {
            let (i, j) = (own / self.columns, own % self.columns);
            for (n, value) in entries.iter().enumerate() {
                let (k, l) = (i + n / WIDTH, j + n % WIDTH);
                let exists = k < self.rows && (REACH..self.columns + REACH).contains(&l);
                if exists && k * self.columns + l >= own + REACH {
                    rows.push((k * self.columns + l - REACH) as u32);
                    values.push(*value);
                }
            }
            starts.push(rows.len() as u32);
        }
        let lower = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        let symbolic = factorize_symbolic_cholesky(
            lower,
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        let mut factor = vec![0.0; symbolic.len_val()];
        // One thread, so that the bits do not depend on the number of threads.
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                SparseColMatRef::new(lower, &values),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut MemBuffer::try_new(request).ok()?),
                Default::default(),
            )
            .ok()?;
        Some(Factored { symbolic, factor })
    }

    /// The coefficients; `None` if they are not determined.
    fn solve(self) -> Option<Vec<f64>> {
        self.factored()?.solve(self.right)
    }
}

/// The factorised matrix of equations.
struct Factored {
    symbolic: SymbolicCholesky<u32>,
    factor: Vec<f64>,
}

impl Factored {
    /// The coefficients for a right-hand side; `None` if they are not finite.
    fn solve(&self, mut right: Vec<f64>) -> Option<Vec<f64>> {
        let size = right.len();
        let request = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut right, size, 1),
            Par::Seq,
            MemStack::new(&mut MemBuffer::try_new(request).ok()?),
        );
        let determined = right.iter().all(|value| value.is_finite());
        determined.then_some(right)
    }
}

/// Length scale c of the bending energy, in units of a cell's side.
const STIFFNESS: f64 = 0.03;
/// Orders of derivatives in the bending energy.
const ORDERS: [usize; 3] = [0, 1, 2];

/// Least squares on fixed breaks, regularised by a small bending energy:
/// `sum_i (w_i (s(x_i) - z_i))^2 + density * int (c hx)^4 s_xx^2 + 2 (c^2 hx hy)^2 s_xy^2 + (c
/// hy)^4 s_yy^2`, c = 0.03, hx and hy the cell's sides. The energy determines coefficients that no
/// height determines. `None` if the equations are singular.
pub(crate) fn fit(samples: &[Sample], breaks: &[Vec<f64>; 2]) -> Option<Bicubic> {
    let axes = [BSpline::new(&breaks[0]), BSpline::new(&breaks[1])];
    Some(Bicubic {
        coefficients: equations(samples, &axes).solve()?,
        axes,
    })
}

/// A fit with fixed breaks, places and weights: other heights cost one right-hand side each.
pub(crate) struct FactoredFit {
    axes: [BSpline; 2],
    factored: Factored,
}

impl FactoredFit {
    /// Factorises the equations of these samples on the axes of a fit; `None` if they are singular.
    pub fn new(samples: &[Sample], axes: [BSpline; 2]) -> Option<Self> {
        let factored = equations(samples, &axes).factored()?;
        Some(FactoredFit { axes, factored })
    }

    /// The fit of samples that differ from the first ones only in their heights.
    pub fn fit(&self, samples: impl Iterator<Item = Sample>) -> Option<Bicubic> {
        let [rows, columns] = self.axes.each_ref().map(BSpline::count);
        let mut right = vec![0.0; rows * columns];
        for sample in samples {
            let (i, along) = self.axes[0].values(sample.at[0]);
            let (j, across) = self.axes[1].values(sample.at[1]);
            let weighted = sample.weight * sample.weight * sample.height;
            for (k, a) in along.iter().enumerate() {
                let row = &mut right[(i + k) * columns + j..][..4];
                for (entry, b) in row.iter_mut().zip(across) {
                    *entry += weighted * a * b;
                }
            }
        }
        Some(Bicubic {
            coefficients: self.factored.solve(right)?,
            axes: self.axes.clone(),
        })
    }
}

/// The normal equations of [`fit`].
fn equations(samples: &[Sample], axes: &[BSpline; 2]) -> NormalEquations {
    let breaks = [0, 1].map(|k| axes[k].breaks());
    let mut equations = NormalEquations::new(axes[0].count(), axes[1].count());
    for sample in samples {
        let (i, a) = axes[0].values(sample.at[0]);
        let (j, b) = axes[1].values(sample.at[1]);
        let weight = sample.weight * sample.weight;
        equations.add([i, j], [&a, &b], weight, sample.height);
    }
    let lengths = breaks.map(|breaks| breaks[breaks.len() - 1] - breaks[0]);
    let density = samples.len() as f64 / (lengths[0] * lengths[1]);
    let gauss = 0.5 / 3f64.sqrt();
    for x in breaks[0].windows(2) {
        for y in breaks[1].windows(2) {
            let (hx, hy) = (x[1] - x[0], y[1] - y[0]);
            let weight = density * 0.25 * hx * hy;
            let (cx, cy) = ((STIFFNESS * hx).powi(2), (STIFFNESS * hy).powi(2));
            for (sx, sy) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                let px = 0.5 * (x[0] + x[1]) + sx * gauss * hx;
                let py = 0.5 * (y[0] + y[1]) + sy * gauss * hy;
                let [(i, a0), (_, a1), (_, a2)] = ORDERS.map(|k| axes[0].derivatives(px, k));
                let [(j, b0), (_, b1), (_, b2)] = ORDERS.map(|k| axes[1].derivatives(py, k));
                equations.add([i, j], [&a2, &b0], weight * cx * cx, 0.0);
                equations.add([i, j], [&a1, &b1], weight * 2.0 * cx * cy, 0.0);
                equations.add([i, j], [&a0, &b2], weight * cy * cy, 0.0);
            }
        }
    }
    equations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_sum_to_one_and_their_derivatives_match_differences() {
        let splines = BSpline::new(&[0.0, 0.1, 0.5, 0.7, 1.5]);
        assert_eq!(splines.count(), 7);
        for i in 1..150 {
            let x = 0.01 * f64::from(i) + 0.003;
            let (first, values) = splines.values(x);
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            let h = 1e-5;
            let (low, before) = splines.values(x - h);
            let (high, after) = splines.values(x + h);
            if low != high {
                continue;
            }
            let (_, slopes) = splines.derivatives(x, 1);
            let (_, bends) = splines.derivatives(x, 2);
            for k in 0..4 {
                assert!(
                    ((after[k] - before[k]) / (2.0 * h) - slopes[k]).abs() < 1e-5,
                    "{first}"
                );
                assert!(
                    ((after[k] - 2.0 * values[k] + before[k]) / (h * h) - bends[k]).abs() < 1e-2
                );
            }
        }
    }

    /// Equations of many overlapping blocks, and the same as a full matrix.
    fn both(rows: usize, columns: usize) -> (NormalEquations, Vec<Vec<f64>>) {
        let size = rows * columns;
        let mut equations = NormalEquations::new(rows, columns);
        let mut full = vec![vec![0.0; size]; size];
        for block in 0..4 * size {
            let (i, j) = (block % (rows - 3), (block / (rows - 3)) % (columns - 3));
            let numbers = |seed: usize| [0, 1, 2, 3].map(|k| ((seed * 4 + k).pow(2) as f64).sin());
            let (along, across) = (numbers(block), numbers(block + 7919));
            let (weight, height) = (1.0 + (block % 3) as f64, (block as f64).cos());
            equations.add([i, j], [&along, &across], weight, height);
            let place = |k: usize| (i + k / 4) * columns + j + k % 4;
            for k in 0..16 {
                for l in 0..16 {
                    full[place(k)][place(l)] +=
                        weight * along[k / 4] * across[k % 4] * along[l / 4] * across[l % 4];
                }
            }
        }
        (equations, full)
    }

    #[test]
    fn the_solution_satisfies_the_equations() {
        for [rows, columns] in [[4, 4], [5, 9], [11, 6]] {
            let (equations, full) = both(rows, columns);
            let right = equations.right.clone();
            let solution = equations.solve().unwrap();
            let scale = solution.iter().fold(1.0f64, |m, v| m.max(v.abs()));
            for (row, wanted) in full.iter().zip(&right) {
                let found: f64 = row.iter().zip(&solution).map(|(a, s)| a * s).sum();
                assert!((found - wanted).abs() < 1e-11 * scale, "{found} {wanted}");
            }
        }
    }

    #[test]
    fn coefficients_that_nothing_determines_are_refused() {
        let mut equations = NormalEquations::new(5, 4);
        equations.add([0, 0], [&[1.0; 4], &[1.0; 4]], 1.0, 1.0);
        assert!(equations.solve().is_none());
        let (mut equations, _) = both(5, 5);
        equations.entries[0][REACH] = f64::NAN;
        assert!(equations.solve().is_none());
    }
}
