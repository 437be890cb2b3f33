//! Products of one run's columns.

use nalgebra::DMatrix;

use crate::regression::inverse::ridge_inverse;

/// Sums of products of one run's columns: base, candidates, residual last; windows of local effects beside them.
#[derive(Clone, Debug)]
pub struct Gram {
    /// Products of the columns, each run's own level taken out.
    pub g: DMatrix<f64>,
    /// Products of the windows with the columns, one row a window.
    pub windows: DMatrix<f64>,
    /// Products of the windows with themselves.
    pub window_norms: Vec<f64>,
}

impl Gram {
    /// From the products of all columns with each other, the first `levels` of which are the run's own level and are
    /// taken out.
    ///
    /// `windows` holds, one row a window, products with the same columns (levels included).
    pub fn new(full: &DMatrix<f64>, levels: usize, windows: &DMatrix<f64>, norms: &[f64]) -> Self {
        let m = full.ncols();
        let own = full.view((0, 0), (levels, levels)).into_owned();
        let inverse = ridge_inverse(own);
        let rest = m - levels;
        let cross = full.view((0, levels), (levels, rest)).into_owned();
        let g = full.view((levels, levels), (rest, rest)) - cross.tr_mul(&(&inverse * &cross));
        let to_own = windows.columns(0, levels).into_owned();
        let reduced = &to_own * &inverse;
        let free = windows.columns(levels, rest) - &reduced * &cross;
        let window_norms = norms
            .iter()
            .enumerate()
            .map(|(w, norm)| (norm - reduced.row(w).dot(&to_own.row(w))).max(0.0))
            .collect();
        Self {
            g,
            windows: free,
            window_norms,
        }
    }
}
