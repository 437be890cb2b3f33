//! The section of a groove that a runner left in the ice.

use crate::Error;

/// Depth of a groove over its section across the sliding direction.
///
/// Linear between the places, 0 beyond the first and the last.
#[derive(Clone, Debug, PartialEq)]
pub struct GrooveProfile {
    y: Vec<f64>,
    depth: Vec<f64>,
}

impl GrooveProfile {
    /// Depths [m] at ascending places `y` [m], two or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for places that do not ascend, a depth that is negative or not finite, or too few of them.
    pub fn new(y: Vec<f64>, depth: Vec<f64>) -> Result<Self, Error> {
        let bad = |name, value, expected| Error::OutOfRange {
            name,
            value,
            expected,
        };
        if y.len() < 2 || y.len() != depth.len() {
            let count = y.len().min(depth.len()) as f64;
            return Err(bad(
                "places of a groove",
                count,
                "2 or more, each with a depth",
            ));
        }
        if let Some(pair) = y
            .windows(2)
            .find(|pair| !(pair[1] > pair[0] && pair[1].is_finite()))
        {
            return Err(bad("place in a groove", pair[1], "places that ascend"));
        }
        if let Some(&wrong) = depth.iter().find(|d| !(**d >= 0.0 && d.is_finite())) {
            return Err(bad("depth of a groove", wrong, "0 m or more"));
        }
        Ok(GrooveProfile { y, depth })
    }

    /// Places across [m].
    pub fn y(&self) -> &[f64] {
        &self.y
    }

    /// Depths at the places [m].
    pub fn depth(&self) -> &[f64] {
        &self.depth
    }

    /// Depth at `y` [m].
    pub fn at(&self, y: f64) -> f64 {
        let next = self.y.partition_point(|&place| place < y);
        if next == self.y.len() || (next == 0 && self.y[0] > y) {
            return 0.0;
        }
        if next == 0 {
            return self.depth[0];
        }
        let share = (y - self.y[next - 1]) / (self.y[next] - self.y[next - 1]);
        self.depth[next - 1] + share * (self.depth[next] - self.depth[next - 1])
    }

    /// Deepest place [m].
    pub fn deepest(&self) -> f64 {
        self.depth.iter().copied().fold(0.0, f64::max)
    }

    /// Area of the section [m2].
    pub fn area(&self) -> f64 {
        let trapezoid =
            |k: usize| 0.5 * (self.depth[k] + self.depth[k + 1]) * (self.y[k + 1] - self.y[k]);
        (0..self.y.len() - 1).map(trapezoid).sum()
    }

    /// Whether it is its own image in the plane y = 0, to rounding of its depth.
    pub(crate) fn mirror_symmetric(&self) -> bool {
        let slack = 1e-9 * self.deepest();
        self.y
            .iter()
            .all(|&y| (self.at(y) - self.at(-y)).abs() <= slack)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_has_its_area_depth_and_mirror_image() -> Result<(), Error> {
        let groove = GrooveProfile::new(vec![-1.0, 0.0, 1.0], vec![0.0, 2.0, 0.0])?;
        assert_eq!(
            (groove.area(), groove.deepest(), groove.at(0.25)),
            (2.0, 2.0, 1.5)
        );
        assert_eq!((groove.at(-1.5), groove.at(1.5)), (0.0, 0.0));
        assert!(groove.mirror_symmetric());
        assert!(!GrooveProfile::new(vec![-1.0, 0.5, 1.0], vec![0.0, 2.0, 0.0])?.mirror_symmetric());
        for (y, depth) in [
            (vec![0.0], vec![1.0]),
            (vec![0.0, 0.0], vec![1.0, 1.0]),
            (vec![0.0, 1.0], vec![1.0, -1.0]),
            (vec![0.0, 1.0], vec![1.0, f64::NAN]),
            (vec![0.0, f64::NAN], vec![1.0, 1.0]),
        ] {
            assert!(GrooveProfile::new(y, depth).is_err());
        }
        Ok(())
    }
}
