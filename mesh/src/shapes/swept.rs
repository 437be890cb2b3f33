//! Runners made by sweeping a section along a rocker.

use crate::error::MeshError;
use crate::parameter::{expect, linspace, positive_finite};
use crate::shapes::section::{Rocker, Section};
use crate::shapes::underside::{Underside, lows};

/// Ends that turn up in an arc, tangent to the rocker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Radius of the arc [m].
    pub radius: f64,
    /// Length along x of each arc [m].
    pub length: f64,
}

/// A runner made by sweeping a section along a rocker:
///
/// `z(x, y) = rocker(x) + section(y)` for `|x| <= length/2`, up to a flat top.
///
/// Over the last `ends.length` the rocker continues as an arc of `ends.radius` (C1). Principal
/// curvatures at the lowest point are the rocker's and the section's.
#[derive(Clone, Debug, PartialEq)]
pub struct Swept {
    rocker: Rocker,
    section: Section,
    ends: Option<Ends>,
    length: f64,
    top: f64,
    /// Local minima of a measured section or rocker.
    lows: Vec<[f64; 2]>,
}

/// Radius of the rounded ends [m].
const END_RADIUS: f64 = 0.1;
/// Numbers of equidistant lines along and across, where the rocker or the section is not measured.
const EVEN: [usize; 2] = [400, 60];

impl Swept {
    /// A runner of `length` [m] whose flat top is `top` [m] above its lowest point.
    ///
    /// # Errors
    /// [`MeshError::Value`] where a number is not positive, the rocker is shorter than the
    /// runner, the ends are steeper than upright, or the underside reaches above the top.
    pub fn new(
        rocker: Rocker,
        section: Section,
        ends: Option<Ends>,
        length: f64,
        top: f64,
    ) -> Result<Self, MeshError> {
        positive_finite("length [m]", length)?;
        positive_finite("height [m]", top)?;
        let half = 0.5 * length;
        let mut needed = half;
        if let Some(ends) = ends {
            positive_finite("end radius [m]", ends.radius)?;
            positive_finite("end length [m]", ends.length)?;
            let expected = "at most half the runner's length";
            expect(ends.length <= half, "end length [m]", ends.length, expected)?;
            needed = half - ends.length;
        }
        let [from, to] = rocker.range();
        // Decimal positions of the rocker's ends may be rounded either way.
        let needed = needed * (1.0 - 1e-12);
        let spans = from <= -needed && to >= needed;
        expect(spans, "length [m]", length, "a rocker that spans it")?;
        let mut swept = Self {
            rocker,
            section,
            ends,
            length,
            top,
            lows: Vec::new(),
        };
        if let Some(ends) = ends {
            let expected = "ends that stay less than upright: a shorter end or a larger end radius";
            let finite = [-half, half].iter().all(|&x| swept.keel(x).is_finite());
            expect(finite, "end length [m]", ends.length, expected)?;
        }
        let expected = "a top above the underside's highest point: more height, or less width or \
                        end length";
        expect(swept.highest() < top, "height [m]", top, expected)?;
        swept.lows = swept.measured_lows();
        Ok(swept)
    }

    /// See [`Underside::lows`].
    fn measured_lows(&self) -> Vec<[f64; 2]> {
        let measured = [self.rocker.breaks(), self.section.breaks()];
        if measured.iter().all(|breaks| breaks.is_empty()) {
            return Vec::new();
        }
        let [x0, x1, y0, y1] = self.extent();
        let lines = [(0, x0, x1), (1, y0, y1)].map(|(axis, from, to)| -> Vec<f64> {
            let inside = |b: &f64| (from..=to).contains(b);
            match measured[axis] {
                [] => linspace(from, to, EVEN[axis]).collect(),
                breaks => breaks.iter().copied().filter(inside).collect(),
            }
        });
        let [xs, ys] = &lines;
        let keel: Vec<f64> = xs.iter().map(|&x| self.keel(x)).collect();
        let section: Vec<f64> = ys.iter().map(|&y| self.section.height(y)).collect();
        lows([xs, ys], |i, j| keel[i] + section[j])
    }

    /// [`Swept::new`] with ends of a radius of 0.1 m that rise by half the distance between the
    /// underside's corners and the top, or less where the runner is too short.
    ///
    /// # Errors
    /// As [`Swept::new`].
    pub fn with_rounded_ends(
        rocker: Rocker,
        section: Section,
        length: f64,
        top: f64,
    ) -> Result<Self, MeshError> {
        let sides = section.rise();
        let [keel, slope] = rocker.height_and_slope(0.5 * length);
        // `new` refuses a runner without room for ends, with the reason.
        let rise = (0.5 * (top - sides - keel)).clamp(1e-3 * END_RADIUS, 0.5 * END_RADIUS);
        // The ends meet at the middle at most, and stay less than upright.
        let steepest = 0.99 - slope.abs() / slope.hypot(1.0);
        let by_rise = (rise * (2.0 * END_RADIUS - rise)).sqrt();
        let ends = Ends {
            radius: END_RADIUS,
            length: by_rise.min(0.5 * length).min(steepest * END_RADIUS),
        };
        Self::new(rocker, section, Some(ends), length, top)
    }

    /// The shape across.
    pub fn section(&self) -> &Section {
        &self.section
    }

    /// The ends' shape; `None` if the runner is cut off.
    pub fn ends(&self) -> Option<Ends> {
        self.ends
    }

    /// Length along x [m].
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Height of the flat top over the lowest point [m].
    pub fn top(&self) -> f64 {
        self.top
    }

    /// Height of the keel, the underside less its section, at `x` [m]; infinite outside the ends.
    pub fn keel(&self, x: f64) -> f64 {
        let half = 0.5 * self.length;
        if !(-half..=half).contains(&x) {
            return f64::INFINITY;
        }
        let [from, to] = self.rocker.range();
        let rocker = |x: f64| self.rocker.height_and_slope(x.clamp(from, to));
        let start = self.ends.map_or(half, |ends| half - ends.length);
        let Some(ends) = self.ends.filter(|_| x.abs() > start) else {
            return rocker(x)[0];
        };
        let [height, slope] = rocker(start.copysign(x));
        // Sine of the arc's angle at its beginning and at x; outwards is positive.
        let first = slope.copysign(slope * x.signum()) / slope.hypot(1.0);
        let last = first + (x.abs() - start) / ends.radius;
        let cosine = |sine: f64| ((1.0 - sine) * (1.0 + sine)).sqrt();
        if last >= 1.0 {
            return f64::INFINITY;
        }
        height + ends.radius * (cosine(first) - cosine(last))
    }

    /// Height of the underside's highest point [m].
    pub fn highest(&self) -> f64 {
        let [x0, x1, y0, y1] = self.extent();
        let keel = linspace(x0, x1, 200).map(|x| self.keel(x));
        let section = linspace(y0, y1, 200).map(|y| self.section.height(y));
        keel.fold(0.0, f64::max) + section.fold(0.0, f64::max)
    }
}

impl Underside for Swept {
    fn height(&self, x: f64, y: f64) -> f64 {
        self.keel(x) + self.section.height(y)
    }

    fn extent(&self) -> [f64; 4] {
        let [y0, y1] = self.section.extent();
        [-0.5 * self.length, 0.5 * self.length, y0, y1]
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        [self.rocker.is_even(), self.section.is_even()]
    }

    fn lows(&self) -> &[[f64; 2]] {
        &self.lows
    }
}

/// A bobsled runner: a rocker arc, a circular section across, ends that turn up.
///
/// The ends' arcs rise by about half the distance between the underside's corners and the top.
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
}

impl Default for BobRunner {
    /// One metre long, rocker 30 m, section 5 mm, 10 mm wide, 30 mm high.
    fn default() -> Self {
        Self {
            length: 1.0,
            rocker_radius: 30.0,
            section_radius: 0.005,
            width: 0.010,
            height: 0.030,
        }
    }
}

impl BobRunner {
    /// The runner as a swept surface.
    ///
    /// # Errors
    /// As [`Swept::new`].
    pub fn swept(&self) -> Result<Swept, MeshError> {
        let section = Section::arc(self.section_radius, self.width)?;
        let rocker = Rocker::arc(self.rocker_radius)?;
        Swept::with_rounded_ends(rocker, section, self.length, self.height)
    }
}

/// A luge steel on its inner edge: flat underside tilted on the runner, rounded edge, upright
/// flank, bent to its rocker radius. The edge's lowest point is at x = 0, y = 0; the flat rises
/// towards +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LugeSteel {
    /// Length along x [m].
    pub length: f64,
    /// Radius of the rocker [m]; infinite for a straight edge.
    pub rocker_radius: f64,
    /// Radius of the edge [m].
    pub edge_radius: f64,
    /// Angle of the flat underside to the ice [rad]. At 0 the whole flat is in contact, but the
    /// origin is at the edge.
    pub tilt: f64,
    /// Width [m].
    pub width: f64,
    /// Height from the lowest point to the flat top [m].
    pub height: f64,
}

impl Default for LugeSteel {
    /// 0.6 m long, rocker 25 m, edge 0.3 mm, tilt 0.02 rad, 20 mm wide, 8 mm high.
    fn default() -> Self {
        Self {
            length: 0.6,
            rocker_radius: 25.0,
            edge_radius: 0.3e-3,
            tilt: 0.02,
            width: 0.020,
            height: 0.008,
        }
    }
}

impl LugeSteel {
    /// The steel as a swept surface.
    ///
    /// # Errors
    /// As [`Swept::new`].
    pub fn swept(&self) -> Result<Swept, MeshError> {
        let section = Section::edge(self.edge_radius, self.tilt, self.width)?;
        let rocker = Rocker::arc(self.rocker_radius)?;
        Swept::with_rounded_ends(rocker, section, self.length, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runner() -> Swept {
        let ends = Ends {
            radius: 0.1,
            length: 0.05,
        };
        Swept::new(
            Rocker::arc(30.0).unwrap(),
            Section::arc(0.005, 0.01).unwrap(),
            Some(ends),
            1.0,
            0.03,
        )
        .unwrap()
    }

    #[test]
    fn ends_turn_up_smoothly_on_their_radius() {
        let hull = runner();
        let slope = |x: f64| (hull.keel(x + 1e-7) - hull.keel(x - 1e-7)) / 2e-7;
        for sign in [-1.0, 1.0] {
            let start = 0.45 * sign;
            assert!((slope(start - 1e-6) - slope(start + 1e-6)).abs() < 1e-4);
            let x = 0.48 * sign;
            let second = (hull.keel(x + 1e-4) - 2.0 * hull.keel(x) + hull.keel(x - 1e-4)) / 1e-8;
            let curvature = second / (1.0 + slope(x).powi(2)).powf(1.5);
            assert!((curvature * 0.1 - 1.0).abs() < 1e-3, "{curvature}");
        }
        assert_eq!(hull.height(0.5001, 0.0), f64::INFINITY);
        assert!(hull.height(0.5, 0.005) < hull.top());
    }

    #[test]
    fn ends_of_a_rocker_given_as_points_turn_up_on_both_sides_of_a_slope() {
        let points: Vec<_> = (-50..=50)
            .map(|i| 0.01 * f64::from(i))
            .map(|x| [x, 0.01 * x])
            .collect();
        let ends = Ends {
            radius: 0.1,
            length: 0.04,
        };
        let section = Section::arc(0.005, 0.006).unwrap();
        let hull = Swept::new(
            Rocker::points(&points).unwrap(),
            section,
            Some(ends),
            1.0,
            0.03,
        )
        .unwrap();
        let slope = |x: f64| (hull.keel(x + 1e-7) - hull.keel(x - 1e-7)) / 2e-7;
        for x in [-0.46, 0.46] {
            assert!((slope(x) - 0.01).abs() < 1e-4, "{x}: {}", slope(x));
        }
        assert!(slope(-0.49) < -0.25 && slope(0.49) > 0.25);
    }

    #[test]
    fn flat_rocker_gives_the_section_alone() {
        let section = Section::arc(0.005, 0.01).unwrap();
        let hull = Swept::new(
            Rocker::arc(f64::INFINITY).unwrap(),
            section,
            None,
            1.0,
            0.03,
        )
        .unwrap();
        assert_eq!(hull.height(0.4, 0.003), hull.height(0.0, 0.003));
        assert_eq!(hull.mirror_symmetric(), [true, true]);
    }

    #[test]
    fn shapes_that_cannot_be_are_refused_by_name() {
        let make = |ends: Option<Ends>, length: f64, top: f64| {
            let (rocker, section) = (
                Rocker::arc(30.0).unwrap(),
                Section::arc(0.005, 0.01).unwrap(),
            );
            Swept::new(rocker, section, ends, length, top)
                .unwrap_err()
                .to_string()
        };
        assert!(make(None, f64::NAN, 0.03).contains("length"));
        assert!(make(None, 1.0, 0.004).contains("top above"));
        assert!(make(None, 61.0, 0.03).contains("spans"));
        assert!(
            make(
                Some(Ends {
                    radius: 0.01,
                    length: 0.02
                }),
                1.0,
                0.03
            )
            .contains("upright")
        );
        assert!(
            make(
                Some(Ends {
                    radius: 0.01,
                    length: 0.6
                }),
                1.0,
                0.03
            )
            .contains("half")
        );
    }

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

        /// The highest point lies on the ends and sides, whose coordinates must not be exceeded by
        /// rounding.
        #[test]
        fn every_runner_below_its_top_is_built(
            length in 0.3..1.0f64,
            rocker_radius in 10.0..80.0f64,
            section_radius in 0.002..0.02f64,
            narrowing in 0.0..0.9f64,
        ) {
            let width = 2.0 * section_radius * (1.0 - narrowing);
            let height = 0.06;
            let runner = BobRunner { length, rocker_radius, section_radius, width, height };
            let hull = runner.swept().unwrap();
            let [_, x1, _, y1] = hull.extent();
            let highest = hull.highest();
            proptest::prop_assert_eq!(highest, hull.keel(x1) + hull.section().height(y1));
            proptest::prop_assert!(highest < height);
        }
    }

    #[test]
    fn luge_steel_is_lowest_at_the_origin_and_mirrored_along_its_length_only() {
        let hull = LugeSteel::default().swept().unwrap();
        let [x0, x1, y0, y1] = hull.extent();
        assert_eq!([x0, x1], [-0.3, 0.3]);
        assert!((y1 - y0 - 0.020).abs() < 1e-15);
        assert_eq!(hull.height(0.0, 0.0), 0.0);
        assert!(linspace(y0, y1, 100).all(|y| hull.height(0.0, y) >= 0.0));
        assert_eq!(hull.mirror_symmetric(), [true, false]);
    }
}
