//! A half-space under a rectangle of uniform pressure.

/// Displacements at the centres of a grid's cells under unit pressure on the first one, times pi E*: entry (i, j) is that of the cell i
/// steps along x and j along y away, row by row of x, 0..=`cells` each way [m].
///
/// Each is a sum over the rectangle's corners of x asinh(y/x) + y asinh(x/y) = x ln((y + r)/x) + y ln((x + r)/y), which is odd in
/// x and y (A. E. H. Love, Phil. Trans. R. Soc. A 228, 1929).
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
