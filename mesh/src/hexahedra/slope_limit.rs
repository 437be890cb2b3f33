//! A surface held to a largest slope.

/// Lowers `heights` over the columns `x` times `y`, x fastest, until no two neighbours differ by more than `slope` times
/// their distance: the largest such surface that is nowhere higher.
///
/// A convex section keeps its shape up to where it is that steep, and goes on straight from there.
///
/// # Panics
/// Where there is not one height a column.
pub fn limit_slope(x: &[f64], y: &[f64], heights: &mut [f64], slope: f64) {
    let nx = x.len();
    assert_eq!(heights.len(), nx * y.len());
    let mut relax = |from: usize, to: usize, distance: f64| {
        heights[to] = heights[to].min(heights[from] + slope * distance);
    };
    // Distances add up along x and along y, so that one sweep forth and one back on each axis is all.
    for j in 0..y.len() {
        (1..nx).for_each(|i| relax(j * nx + i - 1, j * nx + i, x[i] - x[i - 1]));
        (1..nx)
            .rev()
            .for_each(|i| relax(j * nx + i, j * nx + i - 1, x[i] - x[i - 1]));
    }
    for i in 0..nx {
        (1..y.len()).for_each(|j| relax((j - 1) * nx + i, j * nx + i, y[j] - y[j - 1]));
        (1..y.len())
            .rev()
            .for_each(|j| relax(j * nx + i, (j - 1) * nx + i, y[j] - y[j - 1]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::bob_runner::BobRunner;
    use crate::shapes::underside::Underside;

    fn even(from: f64, to: f64, count: usize) -> Vec<f64> {
        (0..=count)
            .map(|i| from + (to - from) * i as f64 / count as f64)
            .collect()
    }

    #[test]
    fn a_limited_surface_is_the_section_where_it_is_gentle_and_straight_beyond() {
        let runner = BobRunner::default().swept().unwrap();
        let (x, y) = (even(-0.4, 0.4, 8), even(-0.005, 0.005, 400));
        let original: Vec<f64> = y
            .iter()
            .flat_map(|&y| x.iter().map(|&x| runner.height(x, y)).collect::<Vec<_>>())
            .collect();
        let mut heights = original.clone();
        limit_slope(&x, &y, &mut heights, 0.5);
        // A circle of 5 mm is as steep as 0.5 at 5 mm sin(atan 0.5).
        let bend = 0.005 * (0.5f64.atan()).sin();
        for (j, &y) in y.iter().enumerate() {
            let at = j * x.len() + 4;
            if y.abs() < bend - 5e-5 {
                assert_eq!(heights[at], original[at]);
            } else if y.abs() > bend + 5e-5 {
                let line = runner.height(0.0, bend) + 0.5 * (y.abs() - bend);
                assert!((heights[at] - line).abs() < 1e-7 && heights[at] < original[at]);
            }
        }
        let slope = |a: usize, b: usize, d: f64| (heights[a] - heights[b]).abs() / d;
        assert!((1..y.len()).all(|j| {
            slope(j * x.len(), (j - 1) * x.len(), y[j] - y[j - 1]) < 0.5 * (1.0 + 1e-9)
        }));
    }
}
