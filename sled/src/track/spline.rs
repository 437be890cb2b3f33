//! Natural cubic splines, twice continuously differentiable, with fast evaluation.

/// A natural cubic spline; constant outside its ends.
#[derive(Clone, Debug)]
pub struct Spline {
    knots: Vec<f64>,
    /// Per segment: the value at the knot, and the coefficients of (x - knot), its square and its
    /// cube.
    pieces: Vec<[f64; 4]>,
    last: f64,
    /// First segment in each of equal buckets, which makes the search short for any spacing.
    buckets: Vec<u32>,
    per_metre: f64,
}

impl Spline {
    /// The spline through `values` at strictly increasing `knots`; at least two.
    ///
    /// Its second derivative is 0 at both ends.
    ///
    /// # Panics
    /// Panics if the lengths differ or there are fewer than two knots.
    pub fn natural(knots: &[f64], values: &[f64]) -> Spline {
        let n = knots.len();
        assert!(
            n >= 2 && values.len() == n,
            "{n} knots, {} values",
            values.len()
        );
        let h: Vec<f64> = knots.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let rise: Vec<f64> = (0..n - 1)
            .map(|i| (values[i + 1] - values[i]) / h[i])
            .collect();
        // Thomas algorithm for the second derivatives of the inner knots.
        let mut second = vec![0.0; n];
        let mut upper = vec![0.0; n];
        for i in 1..n - 1 {
            let diagonal = 2.0 * (h[i - 1] + h[i]) - h[i - 1] * upper[i - 1];
            upper[i] = h[i] / diagonal;
            second[i] = (6.0 * (rise[i] - rise[i - 1]) - h[i - 1] * second[i - 1]) / diagonal;
        }
        for i in (1..n - 1).rev() {
            second[i] -= upper[i] * second[i + 1];
        }
        let pieces = (0..n - 1)
            .map(|i| {
                [
                    values[i],
                    rise[i] - h[i] * (2.0 * second[i] + second[i + 1]) / 6.0,
                    0.5 * second[i],
                    (second[i + 1] - second[i]) / (6.0 * h[i]),
                ]
            })
            .collect();
        let span = knots[n - 1] - knots[0];
        let count = 2 * n;
        let mut segment = 0;
        let buckets = (0..count)
            .map(|bucket| {
                let start = knots[0] + span * bucket as f64 / count as f64;
                while segment + 2 < n && knots[segment + 1] <= start {
                    segment += 1;
                }
                segment as u32
            })
            .collect();
        Spline {
            knots: knots.to_vec(),
            pieces,
            last: values[n - 1],
            buckets,
            per_metre: count as f64 / span,
        }
    }

    /// Value, first and second derivative at `x`.
    #[inline]
    pub fn at(&self, x: f64) -> [f64; 3] {
        if x <= self.knots[0] {
            return [self.pieces[0][0], 0.0, 0.0];
        }
        if x >= self.knots[self.knots.len() - 1] {
            return [self.last, 0.0, 0.0];
        }
        let (i, d) = self.locate(x);
        let [a, b, c, e] = self.pieces[i];
        [
            a + d * (b + d * (c + d * e)),
            b + d * (2.0 * c + 3.0 * d * e),
            2.0 * c + 6.0 * d * e,
        ]
    }

    /// Value at `x`.
    #[inline]
    pub fn value(&self, x: f64) -> f64 {
        self.at(x)[0]
    }

    fn locate(&self, x: f64) -> (usize, f64) {
        let bucket = ((x - self.knots[0]) * self.per_metre) as usize;
        let mut i = self.buckets[bucket.min(self.buckets.len() - 1)] as usize;
        while i + 1 < self.pieces.len() && self.knots[i + 1] <= x {
            i += 1;
        }
        while i > 0 && self.knots[i] > x {
            i -= 1;
        }
        (i, x - self.knots[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spline_meets_its_knots_and_is_smooth_between() {
        let knots = [0.0, 1.0, 1.5, 4.0, 4.2, 9.0];
        let values = [1.0, -2.0, 0.5, 3.0, 2.5, 0.0];
        let spline = Spline::natural(&knots, &values);
        for (x, y) in knots.iter().zip(values) {
            assert!((spline.value(*x) - y).abs() < 1e-13);
        }
        for x in [1.0, 1.5, 4.0, 4.2] {
            let (below, above) = (spline.at(x - 1e-9), spline.at(x + 1e-9));
            for k in 0..3 {
                assert!((below[k] - above[k]).abs() < 1e-6, "derivative {k} at {x}");
            }
        }
        assert!(spline.at(1e-9)[2].abs() < 1e-6 && spline.at(9.0 - 1e-9)[2].abs() < 1e-6);
        assert_eq!((spline.value(-1.0), spline.value(10.0)), (1.0, 0.0));
    }

    #[test]
    fn spline_of_a_sine_converges_with_order_four() {
        let error = |n: usize| {
            let knots: Vec<f64> = (0..=n)
                .map(|i| std::f64::consts::PI * i as f64 / n as f64)
                .collect();
            let values: Vec<f64> = knots.iter().map(|x| x.sin()).collect();
            let spline = Spline::natural(&knots, &values);
            (0..1000)
                .map(|i| i as f64 * std::f64::consts::PI / 1000.0)
                .map(|x| (spline.value(x) - x.sin()).abs())
                .fold(0.0, f64::max)
        };
        let order = (error(20) / error(40)).log2();
        assert!((order - 4.0).abs() < 0.3, "order {order}");
    }
}
