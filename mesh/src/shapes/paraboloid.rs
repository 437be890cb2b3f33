//! An unbounded paraboloid, for verification.

use crate::error::MeshError;
use crate::parameter::positive;
use crate::shapes::underside::Underside;

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
    /// [`MeshError::Parameter`] where a radius is not positive.
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
        [
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::INFINITY,
        ]
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        [true, true]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
