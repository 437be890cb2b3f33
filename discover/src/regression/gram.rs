//! Products of one run's columns.

use nalgebra::DMatrix;

use crate::regression::inverse::ridge_inverse;

/// Scalar product, in eight independent partial sums (for instruction-level parallelism).
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f64 = rest.map(|(x, y)| x * y).sum();
    let mut sums = [0.0; LANES];
    for (x, y) in a.zip(b) {
        for (sum, (x, y)) in sums.iter_mut().zip(x.iter().zip(y)) {
            *sum += x * y;
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Products of all columns with each other, `X'X`; each symmetric half is computed once.
pub fn squares(columns: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, m) = columns.shape();
    let column = |k: usize| &columns.as_slice()[k * rows..(k + 1) * rows];
    let mut squares = DMatrix::zeros(m, m);
    for j in 0..m {
        for i in 0..=j {
            let product = dot(column(i), column(j));
            (squares[(i, j)], squares[(j, i)]) = (product, product);
        }
    }
    squares
}

/// Indices of the columns before `first` that are not 0; columns of other tracks are 0.
pub fn acting(products: &DMatrix<f64>, first: usize) -> Vec<usize> {
    (0..first).filter(|k| products[(*k, *k)] != 0.0).collect()
}

/// Products of one run's columns (base, candidates, residual last) and of its windows.
#[derive(Clone, Debug)]
pub struct Gram {
    /// Products of the columns, each run's own level taken out.
    pub g: DMatrix<f64>,
    /// Products of the windows with the columns, one row per window.
    pub windows: DMatrix<f64>,
    /// Products of the windows with themselves.
    pub window_norms: Vec<f64>,
}

impl Gram {
    /// From the products of all columns; the first `levels` are the run's own level and are
    /// projected out.
    ///
    /// `windows`: products with the same columns (levels included), one row per window.
    pub fn new(full: &DMatrix<f64>, levels: usize, windows: &DMatrix<f64>, norms: &[f64]) -> Self {
        let m = full.ncols();
        let own = full.view((0, 0), (levels, levels)).into_owned();
        let inverse = ridge_inverse(own);
        let rest = m - levels;
        let cross = full.view((0, levels), (levels, rest));
        let g = full.view((levels, levels), (rest, rest)) - cross.tr_mul(&(&inverse * cross));
        let to_own = windows.columns(0, levels);
        let reduced = to_own * &inverse;
        let of_window = |(w, norm): (usize, &f64)| norm - reduced.row(w).dot(&to_own.row(w));
        let window_norms = norms.iter().enumerate().map(of_window);
        Self {
            g,
            windows: windows.columns(levels, rest) - &reduced * cross,
            window_norms: window_norms.map(|norm| norm.max(0.0)).collect(),
        }
    }

    /// Products of some columns of the base with the candidates, windows last; the first `base`
    /// columns are the base's.
    pub(crate) fn with_candidates(&self, columns: &[usize], base: usize) -> DMatrix<f64> {
        let regular = self.g.ncols() - base - 1;
        let windows = self.windows.nrows();
        let mut products = DMatrix::zeros(columns.len(), regular + windows);
        for (k, column) in columns.iter().enumerate() {
            let mut row = products.row_mut(k);
            let own = self.g.row(*column);
            row.columns_mut(0, regular)
                .copy_from(&own.columns(base, regular));
            let own = self.windows.column(*column);
            row.columns_mut(regular, windows)
                .copy_from(&own.transpose());
        }
        products
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_are_the_plain_product_of_a_matrix_with_itself() {
        let x = DMatrix::from_fn(29, 7, |i, k| (1.3 * i as f64 + 0.7 * k as f64).sin());
        let plain = x.transpose() * &x;
        // Sums of 29 products of size one in another order.
        assert!((squares(&x) - plain).amax() < 1e-13);
    }
}
