//! A smooth curve through measured points.

use std::path::Path;

use crate::error::MeshError;
use crate::input::{read_columns, read_file};
use crate::parameter::expect;

/// A smooth curve `z(x)` through points: a cubic spline that keeps convex data convex.
///
/// The slopes at the points are those of the not-a-knot cubic spline (C2, curvature accurate to
/// second order). Where that spline would not be convex (concave) although the points are, the
/// slope is replaced by that of the parabola through three neighbouring points, and the piece by
/// two parabolas that meet with the secant's slope (after Schumaker 1983, doi 10.1137/0720057). The
/// curve is C1 there. Outside the points it continues straight.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    breaks: Vec<f64>,
    /// Coefficients of 1, t, t^2, t^3 with t = x - breaks[i].
    pieces: Vec<[f64; 4]>,
}

impl Profile {
    /// The curve through `points`, pairs (position [m], height [m]).
    ///
    /// # Errors
    /// [`MeshError::Value`] below two points, or where a number is not finite or the positions do
    /// not increase.
    pub fn new(name: &'static str, points: &[[f64; 2]]) -> Result<Self, MeshError> {
        if points.len() < 2 {
            let found = format!("{} points", points.len());
            return Err(MeshError::value(name, found, "at least 2"));
        }
        for (i, point) in points.iter().enumerate() {
            let place = format!("{name}, point {}", i + 1);
            if let Some(&value) = point.iter().find(|v| !v.is_finite()) {
                return Err(MeshError::value(place, value, "a finite number"));
            }
            let increases = i == 0 || point[0] > points[i - 1][0];
            let expected = "positions that increase from point to point";
            expect(increases, &place, point[0], expected)?;
        }
        let steps: Vec<f64> = points.windows(2).map(|p| p[1][0] - p[0][0]).collect();
        let secant = |p: &[[f64; 2]]| (p[1][1] - p[0][1]) / (p[1][0] - p[0][0]);
        let secants: Vec<f64> = points.windows(2).map(secant).collect();
        let slopes = shape_keeping_slopes(&steps, &secants);
        let mut profile = Self {
            breaks: vec![points[0][0]],
            pieces: Vec::new(),
        };
        for i in 0..steps.len() {
            let [x, z] = points[i];
            let ends = [slopes[i], slopes[i + 1]];
            let bend = bend(&secants, i, i + 1);
            profile.add_piece(x, z, steps[i], secants[i], ends, bend);
        }
        Ok(profile)
    }

    /// Appends the piece from (`x`, `z`); `bend` is the sign of the data's curvature there, 0 where
    /// mixed.
    fn add_piece(&mut self, x: f64, z: f64, step: f64, secant: f64, slopes: [f64; 2], bend: f64) {
        let (first, last) = (secant - slopes[0], slopes[1] - secant);
        let keeps_shape = bend * (2.0 * first - last) >= 0.0 && bend * (2.0 * last - first) >= 0.0;
        if keeps_shape || first * last <= 0.0 {
            let quadratic = (2.0 * first - last) / step;
            let cubic = (last - first) / (step * step);
            self.pieces.push([z, slopes[0], quadratic, cubic]);
        } else {
            let before = step * last / (first + last);
            let after = step - before;
            self.pieces.push([z, slopes[0], 0.5 * first / before, 0.0]);
            self.breaks.push(x + before);
            let middle = z + 0.5 * (slopes[0] + secant) * before;
            self.pieces.push([middle, secant, 0.5 * last / after, 0.0]);
        }
        self.breaks.push(x + step);
    }

    /// First and last position [m].
    pub fn range(&self) -> [f64; 2] {
        [self.breaks[0], self.breaks[self.breaks.len() - 1]]
    }

    /// Height [m], slope and second derivative [1/m] at `x` [m].
    pub fn evaluate(&self, x: f64) -> [f64; 3] {
        let [first, last] = self.range();
        let inside = x.clamp(first, last);
        let after = self.breaks.partition_point(|&b| b <= inside);
        let i = after.clamp(1, self.pieces.len()) - 1;
        let [a, b, c, d] = self.pieces[i];
        let t = inside - self.breaks[i];
        let slope = b + t * (2.0 * c + 3.0 * d * t);
        let height = a + t * (b + t * (c + d * t));
        if x == inside {
            [height, slope, 2.0 * c + 6.0 * d * t]
        } else {
            [height + slope * (x - inside), slope, 0.0]
        }
    }

    /// Height [m] at `x` [m].
    pub fn value(&self, x: f64) -> f64 {
        self.evaluate(x)[0]
    }

    /// Position and height [m] of the lowest point.
    pub fn lowest(&self) -> [f64; 2] {
        let mut best = [self.breaks[0], self.pieces[0][0]];
        for (i, &[_, b, c, d]) in self.pieces.iter().enumerate() {
            let step = self.breaks[i + 1] - self.breaks[i];
            let root = (c * c - 3.0 * b * d).max(0.0).sqrt();
            // Where the slope b + 2 c t + 3 d t^2 vanishes and grows: t = (root - c)/(3 d), written
            // without cancellation.
            let turn = if c + root != 0.0 {
                -b / (c + root)
            } else {
                step
            };
            for t in [turn, step] {
                if (0.0..=step).contains(&t) {
                    let x = self.breaks[i] + t;
                    let z = self.value(x);
                    if z < best[1] {
                        best = [x, z];
                    }
                }
            }
        }
        best
    }

    /// The curve moved so that its lowest point has height 0.
    pub(crate) fn levelled(mut self) -> Self {
        let [_, lowest] = self.lowest();
        self.pieces.iter_mut().for_each(|piece| piece[0] -= lowest);
        self
    }

    /// Positions between which it is one cubic [m].
    pub(crate) fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// Whether the curve is even in x, to 1e-12 of its size.
    pub fn is_even(&self) -> bool {
        let [first, last] = self.range();
        let scale = last - first;
        if (first + last).abs() > 1e-12 * scale {
            return false;
        }
        let pairs = self.breaks.windows(2);
        let probes = || pairs.clone().flat_map(|b| [b[0], 0.5 * (b[0] + b[1])]);
        let size = probes().map(|x| self.value(x).abs()).fold(0.0, f64::max);
        probes().all(|x| (self.value(x) - self.value(-x)).abs() <= 1e-12 * size)
    }
}

/// Sign of the data's curvature over the points `from..=to` (the end points have no curvature), 0
/// if it changes.
fn bend(secants: &[f64], from: usize, to: usize) -> f64 {
    let (mut up, mut down) = (false, false);
    for i in from.max(1)..=to.min(secants.len() - 1) {
        up |= secants[i] > secants[i - 1];
        down |= secants[i] < secants[i - 1];
    }
    f64::from(u8::from(up)) - f64::from(u8::from(down))
}

/// The slopes of the not-a-knot spline, limited by the neighbouring secants where the sign of the
/// data's curvature does not change.
fn shape_keeping_slopes(steps: &[f64], secants: &[f64]) -> Vec<f64> {
    let mut slopes = spline_slopes(steps, secants);
    let n = secants.len();
    for i in 0..=n {
        let sign = bend(secants, i.saturating_sub(1), i + 1);
        // In convex data the slope lies above the secant before and below the secant after.
        let falls_short = i > 0 && sign * (slopes[i] - secants[i - 1]) < 0.0;
        let overshoots = i < n && sign * (secants[i.min(n - 1)] - slopes[i]) < 0.0;
        if (falls_short || overshoots) && i > 0 && i < n {
            let weight = steps[i - 1] / (steps[i - 1] + steps[i]);
            slopes[i] = secants[i - 1] + weight * (secants[i] - secants[i - 1]);
        }
    }
    // At the ends the piece is a parabola where the spline's slope would bend the wrong way.
    for (end, next, secant) in [(0, 1, secants[0]), (n, n - 1, secants[n - 1])] {
        if (slopes[next] - secant) * (secant - slopes[end]) < 0.0 {
            slopes[end] = 2.0 * secant - slopes[next];
        }
    }
    slopes
}

/// Slopes of the not-a-knot cubic spline at its points (a parabola for three points, a line for
/// two).
fn spline_slopes(h: &[f64], d: &[f64]) -> Vec<f64> {
    let n = h.len();
    if n == 1 {
        return vec![d[0]; 2];
    }
    if n == 2 {
        let middle = (h[1] * d[0] + h[0] * d[1]) / (h[0] + h[1]);
        return vec![2.0 * d[0] - middle, middle, 2.0 * d[1] - middle];
    }
    let [mut lower, mut diagonal, mut upper, mut right] = [(); 4].map(|()| vec![0.0; n + 1]);
    let (first, last) = (h[0] + h[1], h[n - 2] + h[n - 1]);
    (diagonal[0], upper[0]) = (h[1], first);
    right[0] = ((h[0] + 2.0 * first) * h[1] * d[0] + h[0] * h[0] * d[1]) / first;
    for i in 1..n {
        (lower[i], diagonal[i], upper[i]) = (h[i], 2.0 * (h[i - 1] + h[i]), h[i - 1]);
        right[i] = 3.0 * (h[i] * d[i - 1] + h[i - 1] * d[i]);
    }
    (lower[n], diagonal[n]) = (last, h[n - 2]);
    right[n] =
        (h[n - 1] * h[n - 1] * d[n - 2] + (2.0 * last + h[n - 1]) * h[n - 2] * d[n - 1]) / last;
    for i in 1..=n {
        let factor = lower[i] / diagonal[i - 1];
        diagonal[i] -= factor * upper[i - 1];
        right[i] -= factor * right[i - 1];
    }
    right[n] /= diagonal[n];
    for i in (0..n).rev() {
        right[i] = (right[i] - upper[i] * right[i + 1]) / diagonal[i];
    }
    right
}

/// Largest size of a curve's file [bytes].
const MAX_BYTES: u64 = 1 << 26;

/// Reads two columns of a CSV file by their names, one point per row [m].
///
/// # Errors
/// [`MeshError::File`] with the row, the column and the text found.
pub fn load_points(path: &Path, columns: [&str; 2]) -> Result<Vec<[f64; 2]>, MeshError> {
    let bytes = read_file(path, MAX_BYTES)?;
    read_columns(&bytes[..], columns).map_err(|error| error.in_file(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(xs: &[f64], f: impl Fn(f64) -> f64) -> Profile {
        Profile::new("test", &xs.iter().map(|&x| [x, f(x)]).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn spline_reproduces_a_cubic_on_uneven_points() {
        let f = |x: f64| 1.0 + x * (2.0 + x * (-0.5 + 0.3 * x));
        let profile = sampled(&[0.0, 0.3, 1.0, 1.2, 2.0, 3.5], f);
        for i in 0..=350 {
            let x = 0.01 * f64::from(i);
            assert!((profile.value(x) - f(x)).abs() < 1e-13 * 12.0, "{x}");
        }
    }

    #[test]
    fn curvature_of_an_arc_is_right_within_a_tenth_of_a_percent() {
        let xs: Vec<f64> = (-10..=10).map(|i| 0.05 * f64::from(i)).collect();
        let profile = sampled(&xs, |x| x * x / (30.0 + (900.0 - x * x).sqrt()));
        for x in [-0.4, -0.13, 0.0, 0.21] {
            assert!((profile.evaluate(x)[2] * 30.0 - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn convex_points_give_a_convex_curve_even_where_the_radius_jumps() {
        let f = |x: f64| if x < 0.0 { 0.01 * x * x } else { 0.2 * x * x };
        let xs: Vec<f64> = (-6..=6).map(|i| 0.1 * f64::from(i)).collect();
        let profile = sampled(&xs, f);
        let slopes: Vec<f64> = (-600..=600)
            .map(|i| profile.evaluate(1e-3 * f64::from(i))[1])
            .collect();
        for (i, s) in slopes.windows(2).enumerate() {
            assert!(
                s[1] >= s[0] - 1e-13,
                "slope falls from {} to {} at {} mm",
                s[0],
                s[1],
                i as f64 - 600.0
            );
        }
        for &x in &xs {
            assert!((profile.value(x) - f(x)).abs() < 1e-14);
        }
        let kink = slopes.windows(2).map(|s| s[1] - s[0]).fold(0.0, f64::max);
        assert!(kink < 2e-3, "slope jumps by {kink} over 1 mm");
    }

    #[test]
    fn lowest_point_lies_between_points() {
        let profile = sampled(&[-1.0, 0.0, 1.0, 2.0], |x| (x - 0.3) * (x - 0.3));
        let [x, z] = profile.lowest();
        assert!((x - 0.3).abs() < 1e-12 && z.abs() < 1e-15);
        assert!(!profile.is_even());
        assert!(sampled(&[-1.0, 0.0, 1.0], |x| x * x).is_even());
    }

    #[test]
    fn bad_points_are_named() {
        let message = |points: &[[f64; 2]]| Profile::new("rocker", points).unwrap_err().to_string();
        assert!(message(&[[0.0, 0.0], [0.0, 1.0]]).contains("rocker, point 2"));
        assert!(message(&[[0.0, 0.0], [1.0, f64::NAN]]).contains("NaN"));
        assert!(message(&[[0.0, 0.0]]).contains("at least 2"));
    }

    #[test]
    fn points_are_read_and_what_is_none_is_refused_with_its_place() {
        let read = |text: &str| read_columns(text.as_bytes(), ["y_m", "z_m"]);
        assert_eq!(
            read("y_m,z_m\n-0.1, 2e-3\n0,0\n").unwrap(),
            [[-0.1, 2e-3], [0.0, 0.0]]
        );
        let refused = |text: &str| read(text).unwrap_err().to_string();
        let message = refused("y_m,z_m\n\n0,0\n\n0.1,wide\n");
        assert!(
            message.contains("row 5") && message.contains("z_m") && message.contains("wide"),
            "{message}"
        );
        assert!(refused("x_m,z_m\n0,0\n").contains("x_m,z_m"));
        assert!(refused("y_m,z_m\n0,inf\n").contains("inf"));
        assert!(refused("y_m,z_m\n0\n").contains("row 2"));
    }
}
