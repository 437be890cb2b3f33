//! A bobsled runner.

use crate::error::MeshError;
use crate::shapes::rocker::Rocker;
use crate::shapes::section::Section;
use crate::shapes::swept::Swept;

/// A bobsled runner: a rocker arc, a circular section across, ends that turn up.
///
/// The ends' arcs rise by about half of what lies between the underside's corners and the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BobRunner {
    /// Length along x [m].
    pub length: f64,
    /// Radius of the rocker [m]; infinite for a straight keel.
    pub rocker_radius: f64,
    /// Radius of the section [m].
    pub section_radius: f64,
    /// Width [m], at most two section radii.
    pub width: f64,
    /// Height from the lowest point to the flat top [m].
    pub height: f64,
    /// Radius of the ends [m].
    pub end_radius: f64,
}

impl Default for BobRunner {
    /// One metre long, rocker 30 m, section 5 mm, 10 mm wide, 30 mm high, end radius 0.1 m.
    fn default() -> Self {
        Self {
            length: 1.0,
            rocker_radius: 30.0,
            section_radius: 0.005,
            width: 0.010,
            height: 0.030,
            end_radius: 0.1,
        }
    }
}

impl BobRunner {
    /// The runner as a swept surface.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] where the numbers make no runner.
    pub fn swept(&self) -> Result<Swept, MeshError> {
        self.swept_along(Rocker::arc(self.rocker_radius)?)
    }

    /// The runner swept along another rocker, as one of several radii given by points; `rocker_radius` is not used.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] where the numbers make no runner.
    pub fn swept_along(&self, rocker: Rocker) -> Result<Swept, MeshError> {
        let section = Section::arc(self.section_radius, self.width)?;
        self.swept_with(rocker, section)
    }

    /// The runner with another rocker and another section; the radii and the width are not used.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] where the numbers make no runner.
    pub fn swept_with(&self, rocker: Rocker, section: Section) -> Result<Swept, MeshError> {
        Swept::with_rounded_ends(rocker, section, self.length, self.height, self.end_radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::underside::Underside;

    #[test]
    fn bob_runner_has_its_radii_at_the_keel_and_room_under_its_top() {
        let hull = BobRunner::default().swept().unwrap();
        let curvature = |dx: f64, dy: f64| {
            (hull.height(dx, dy) + hull.height(-dx, -dy) - 2.0 * hull.height(0.0, 0.0))
                / (dx * dx + dy * dy)
        };
        assert!((curvature(1e-2, 0.0) * 30.0 - 1.0).abs() < 1e-6);
        assert!((curvature(0.0, 1e-5) * 0.005 - 1.0).abs() < 1e-5);
        assert!(hull.highest() < 0.7 * hull.top());
        assert_eq!(hull.mirror_symmetric(), [true, true]);
        assert_eq!(hull.extent(), [-0.5, 0.5, -0.005, 0.005]);
    }

    #[test]
    fn a_bob_runner_without_height_is_refused() {
        let message = BobRunner {
            height: 0.004,
            ..Default::default()
        }
        .swept()
        .unwrap_err()
        .to_string();
        assert!(
            message.contains("height") || message.contains("end"),
            "{message}"
        );
    }

    proptest::proptest! {
        #![proptest_config(proptest::prelude::ProptestConfig { failure_persistence: None, ..Default::default() })]

        /// The highest point lies on the ends and sides, whose coordinates must not be exceeded by rounding.
        #[test]
        fn every_runner_below_its_top_is_built(
            length in 0.3..1.0f64,
            rocker_radius in 10.0..80.0f64,
            section_radius in 0.002..0.02f64,
            narrowing in 0.0..0.9f64,
        ) {
            let width = 2.0 * section_radius * (1.0 - narrowing);
            let height = 0.06;
            let runner = BobRunner { length, rocker_radius, section_radius, width, height, ..Default::default() };
            let hull = runner.swept().unwrap();
            let [_, x1, _, y1] = hull.extent();
            let highest = hull.highest();
            proptest::prop_assert_eq!(highest, hull.keel(x1) + hull.section().height(y1));
            proptest::prop_assert!(highest < height);
        }
    }
}
