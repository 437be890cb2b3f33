//! The lower surface of a hull as a height field.

use crate::error::MeshError;
use crate::parameter::positive;

/// The lower surface of a hull as a height over the contact plane.
///
/// Axes: x along the runner, y across, z up; the hull presses downwards. The origin is below the
/// load's line of action, and the lowest point of the hull is near height zero (the solver finds
/// the approach, so the level itself does not matter).
pub trait Underside: Send + Sync {
    /// Height of the lower surface at (`x` [m], `y` [m]), in [m]; `f64::INFINITY` where there is no
    /// hull.
    fn height(&self, x: f64, y: f64) -> f64;

    /// The rectangle `[x_min, x_max, y_min, y_max]` [m] that encloses the hull; infinite ends are
    /// allowed.
    fn extent(&self) -> [f64; 4];

    /// Whether the height is even in x and even in y, to rounding.
    fn mirror_symmetric(&self) -> [bool; 2];

    /// Local minima (x, y) [m], along x or across, of a surface through measured points, so that a
    /// burr between equidistant lines is not missed. Empty for a surface given by a formula.
    fn lows(&self) -> &[[f64; 2]] {
        &[]
    }
}

/// Largest number of minima that are returned, the lowest ones.
const MAX_LOWS: usize = 20_000;

/// Points of a grid whose heights are below the adjacent ones along x or along y, the lowest first:
/// a burr over its whole length, and every keel.
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
    found.truncate(MAX_LOWS);
    found.iter().map(|k| [xs[k % nx], ys[k / nx]]).collect()
}

/// The unbounded paraboloid `z = x^2/(2 R1) + y^2/(2 R2)`: no ends and no sides.
///
/// Radii are in [m]; an infinite radius is flat in its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paraboloid {
    rocker_curvature: f64,
    section_curvature: f64,
}

impl Paraboloid {
    /// A paraboloid with radius `rocker_radius` [m] along x and `section_radius` [m] across.
    ///
    /// # Errors
    /// [`MeshError::Value`] where a radius is not positive.
    pub fn new(rocker_radius: f64, section_radius: f64) -> Result<Self, MeshError> {
        Ok(Self {
            rocker_curvature: 1.0 / positive("rocker radius [m]", rocker_radius)?,
            section_curvature: 1.0 / positive("section radius [m]", section_radius)?,
        })
    }
}

impl Underside for Paraboloid {
    fn height(&self, x: f64, y: f64) -> f64 {
        0.5 * (self.rocker_curvature * x * x + self.section_curvature * y * y)
    }

    fn extent(&self) -> [f64; 4] {
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        [all[0], all[1], all[0], all[1]]
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        [true, true]
    }
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

    #[test]
    fn paraboloid_has_the_stated_curvatures_and_no_end() {
        let hull = Paraboloid::new(30.0, 0.005).unwrap();
        assert!((hull.height(3.0, 0.0) - 0.15).abs() < 1e-15);
        assert!((hull.height(0.0, 0.001) - 1e-4).abs() < 1e-18);
        assert!(hull.height(1e3, 1e3).is_finite());
        let cylinder = Paraboloid::new(f64::INFINITY, 0.005).unwrap();
        assert_eq!(cylinder.height(123.0, 0.0), 0.0);
    }

    #[test]
    fn a_radius_that_is_not_positive_is_refused_by_name() {
        for radius in [0.0, -1.0, f64::NAN] {
            let message = Paraboloid::new(radius, 0.005).unwrap_err().to_string();
            assert!(message.contains("rocker radius"), "{message}");
        }
    }
}
