//! Cubic B-splines on uneven knots.

/// Clamped cubic B-splines on a strictly increasing sequence of breaks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BSpline {
    /// The breaks, with the first and last four times.
    knots: Vec<f64>,
}

impl BSpline {
    /// The splines on `breaks`, at least two, strictly increasing.
    pub fn new(breaks: &[f64]) -> Self {
        assert!(breaks.len() >= 2, "{} breaks", breaks.len());
        let (first, last) = (breaks[0], breaks[breaks.len() - 1]);
        let mut knots = vec![first; 3];
        knots.extend(breaks);
        knots.extend([last; 3]);
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

    /// First spline that is not zero at `x`, and the four values there. `x` is held to the breaks' range.
    pub fn values(&self, x: f64) -> (usize, [f64; 4]) {
        let (first, x) = self.interval(x);
        let mut values = [1.0, 0.0, 0.0, 0.0];
        for degree in 1..=3 {
            self.raise(first, x, degree, &mut values);
        }
        (first, values)
    }

    /// First spline that is not zero at `x`, and the four second derivatives there.
    pub fn second_derivatives(&self, x: f64) -> (usize, [f64; 4]) {
        let (first, x) = self.interval(x);
        let mut values = [1.0, 0.0, 0.0, 0.0];
        self.raise(first, x, 1, &mut values);
        for degree in 2..=3 {
            values = self.derived(first, degree, values);
        }
        (first, values)
    }

    /// First spline that is not zero at `x`, and the four first derivatives there.
    pub fn first_derivatives(&self, x: f64) -> (usize, [f64; 4]) {
        let (first, x) = self.interval(x);
        let mut values = [1.0, 0.0, 0.0, 0.0];
        for degree in 1..=2 {
            self.raise(first, x, degree, &mut values);
        }
        (first, self.derived(first, 3, values))
    }

    fn interval(&self, x: f64) -> (usize, f64) {
        let breaks = self.breaks();
        let x = x.clamp(breaks[0], breaks[breaks.len() - 1]);
        (
            breaks
                .partition_point(|&b| b <= x)
                .clamp(1, breaks.len() - 1)
                - 1,
            x,
        )
    }

    /// From the values of degree - 1 to those of `degree` (Cox and de Boor).
    fn raise(&self, first: usize, x: f64, degree: usize, values: &mut [f64; 4]) {
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

    /// From the (k-1)-th derivatives of degree - 1 to the k-th of `degree`.
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
            let (_, slopes) = splines.first_derivatives(x);
            let (_, bends) = splines.second_derivatives(x);
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
}
