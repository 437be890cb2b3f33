//! Where a surface through measured points is low.

/// Most places that are told: the lowest of a surface that is rough everywhere.
const MOST: usize = 20_000;

/// Where heights on lines of x and of y are below those beside them, along x or along y: a burr's whole length, and every keel's. The lowest
/// first.
pub(crate) fn lows([xs, ys]: [&[f64]; 2], height: impl Fn(usize, usize) -> f64) -> Vec<[f64; 2]> {
    let (nx, ny) = (xs.len(), ys.len());
    let heights: Vec<f64> = (0..nx * ny).map(|k| height(k % nx, k / nx)).collect();
    let at = |i: usize, j: usize| heights[j * nx + i];
    let low = |k: &usize| {
        let (i, j) = (k % nx, k / nx);
        let below = |a: f64, b: f64| heights[*k] < a && heights[*k] <= b;
        heights[*k].is_finite()
            && ((i > 0 && i + 1 < nx && below(at(i - 1, j), at(i + 1, j)))
                || (j > 0 && j + 1 < ny && below(at(i, j - 1), at(i, j + 1))))
    };
    let mut found: Vec<usize> = (0..nx * ny).filter(low).collect();
    found.sort_by(|&a, &b| heights[a].total_cmp(&heights[b]));
    found.truncate(MOST);
    found.iter().map(|k| [xs[k % nx], ys[k / nx]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burr_between_even_lines_and_a_ridge_along_them_are_found() {
        let xs: Vec<f64> = (-20..=20).map(|i| 0.1 * f64::from(i)).collect();
        let ys: Vec<f64> = (-5..=5).map(f64::from).collect();
        let height = |i: usize, j: usize| {
            let burr = if (i, j) == (31, 8) { 5.0 } else { 0.0 };
            xs[i] * xs[i] + if ys[j] == 2.0 { 0.5 } else { ys[j].abs() } - burr
        };
        let found = lows([&xs, &ys], height);
        assert_eq!(found[0], [xs[31], 3.0]);
        let along = |y: f64| found.iter().filter(|[_, at]| *at == y).count();
        assert_eq!([along(0.0), along(2.0), along(4.0)], [41, 40, 1]);
        // A plane has none.
        assert!(lows([&xs, &ys], |i, _| xs[i]).is_empty());
    }
}
