//! Sections across a runner and rockers along it.

use crate::error::MeshError;
use crate::parameter::{expect, positive, positive_finite};
use crate::shapes::profile::Profile;

/// Height of a runner's section over y, lowest at height 0; infinite outside the section.
#[derive(Clone, Debug, PartialEq)]
pub enum Section {
    /// A circular arc about y = 0. `width = 2 radius` is a half circle.
    Arc {
        /// Radius of the arc [m]; infinite for a flat section.
        radius: f64,
        /// Width [m].
        width: f64,
    },
    /// A luge steel's edge: a flat that rises with `tilt` towards +y, rounded into a vertical flank
    /// at y = -radius; the rounding's lowest point is at y = 0.
    Edge {
        /// Radius of the rounding [m].
        radius: f64,
        /// Angle of the flat to the ice [rad].
        tilt: f64,
        /// Width from flank to the flat's far side [m].
        width: f64,
    },
    /// A smooth curve through measured points.
    Points(Profile),
    /// A section whose lowest part is worn away to a flat:
    /// z = (v + sqrt(v^2 + e^2)) / 2 with v = z_new - depth and e = `edge` times the depth.
    Worn {
        /// The section when new.
        new: Box<Section>,
        /// Depth that is worn away at the lowest point [m].
        depth: f64,
        /// Roundness of the flat's edges: on an arc the ratio of their radius to the arc's; 0 for
        /// sharp edges.
        edge: f64,
    },
}

impl Section {
    /// An arc of `radius` [m] and `width` [m].
    ///
    /// # Errors
    /// [`MeshError::Value`] where a number is not positive or the width exceeds the diameter.
    pub fn arc(radius: f64, width: f64) -> Result<Self, MeshError> {
        positive("section radius [m]", radius)?;
        positive_finite("width [m]", width)?;
        // Rounding of the decimal numbers must not exclude a half circle.
        let fits = width <= 2.0 * radius * (1.0 + 1e-12);
        expect(fits, "width [m]", width, "at most two section radii")?;
        Ok(Self::Arc { radius, width })
    }

    /// A flat tilted by `tilt` [rad] with an edge of `radius` [m], `width` [m] across.
    ///
    /// # Errors
    /// [`MeshError::Value`] where a number is out of range.
    pub fn edge(radius: f64, tilt: f64, width: f64) -> Result<Self, MeshError> {
        positive_finite("edge radius [m]", radius)?;
        positive_finite("width [m]", width)?;
        expect((0.0..=0.8).contains(&tilt), "tilt [rad]", tilt, "0 to 0.8")?;
        let (narrow, expected) = (width > 2.0 * radius, "less than half the width");
        expect(narrow, "edge radius [m]", radius, expected)?;
        Ok(Self::Edge {
            radius,
            tilt,
            width,
        })
    }

    /// The smooth curve through `points` (y [m], height [m]), moved so that its lowest point has
    /// height 0.
    ///
    /// # Errors
    /// As [`Profile::new`].
    pub fn points(points: &[[f64; 2]]) -> Result<Self, MeshError> {
        Ok(Self::Points(Profile::new("section", points)?.levelled()))
    }

    /// This section after wear has removed `depth` [m] from its lowest point and rounded the flat's
    /// edges with `edge` times the section's own radius.
    ///
    /// On an arc of radius R the flat is 2 sqrt(2 R depth) wide and meets the flanks at the slope
    /// sqrt(2 depth / R). At a sharp edge (0) the pressure is singular, with the logarithm of the
    /// distance from the edge.
    ///
    /// # Errors
    /// [`MeshError::Value`] where the depth is negative or takes the whole section, or `edge`
    /// is not from 0 to 1.
    pub fn worn(self, depth: f64, edge: f64) -> Result<Self, MeshError> {
        expect((0.0..=1.0).contains(&edge), "worn edge", edge, "0 to 1")?;
        let fits = (0.0..self.rise()).contains(&depth);
        let expected = "not negative, and less than the section's rise to its sides";
        expect(fits, "wear depth [m]", depth, expected)?;
        Ok(Self::Worn {
            new: Box::new(self),
            depth,
            edge,
        })
    }

    /// Height [m] at `y` [m]; infinite outside the section.
    pub fn height(&self, y: f64) -> f64 {
        let [from, to] = self.extent();
        if !(from..=to).contains(&y) {
            return f64::INFINITY;
        }
        match self {
            Self::Arc { radius, .. } => arc_height(*radius, y),
            Self::Edge { radius, tilt, .. } => {
                let tangent = radius * tilt.sin();
                let flat = tilt.tan() * (y - tangent).max(0.0);
                arc_height(*radius, y.min(tangent)) + flat
            }
            Self::Points(curve) => curve.value(y),
            Self::Worn { new, depth, edge } => {
                let above = new.height(y) - depth;
                0.5 * (above + above.hypot(edge * depth))
            }
        }
    }

    /// Height of the higher side [m].
    pub(crate) fn rise(&self) -> f64 {
        let [from, to] = self.extent();
        self.height(from).max(self.height(to))
    }

    /// The section's two sides [m].
    pub fn extent(&self) -> [f64; 2] {
        match self {
            Self::Arc { width, .. } => [-0.5 * width, 0.5 * width],
            Self::Edge { radius, width, .. } => [-radius, width - radius],
            Self::Points(curve) => curve.range(),
            Self::Worn { new, .. } => new.extent(),
        }
    }

    /// Positions between which a measured section is smooth [m]; empty for one given by a formula.
    pub(crate) fn breaks(&self) -> &[f64] {
        match self {
            Self::Arc { .. } | Self::Edge { .. } => &[],
            Self::Points(curve) => curve.breaks(),
            Self::Worn { new, .. } => new.breaks(),
        }
    }

    /// Whether the height is even in y.
    pub fn is_even(&self) -> bool {
        match self {
            Self::Arc { .. } => true,
            Self::Edge { .. } => false,
            Self::Points(curve) => curve.is_even(),
            Self::Worn { new, .. } => new.is_even(),
        }
    }
}

/// Height of a circle of `radius` over its lowest point, at `y`; |y| may exceed `radius` by
/// rounding.
fn arc_height(radius: f64, y: f64) -> f64 {
    if radius.is_infinite() {
        return 0.0;
    }
    y * y / (radius + ((radius - y) * (radius + y)).max(0.0).sqrt())
}

/// Height of a runner's keel along x, lowest at height 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Rocker {
    /// A circular arc, lowest at x = 0.
    Arc {
        /// Radius of the arc [m]; infinite for a straight keel.
        radius: f64,
    },
    /// A smooth curve through measured points, as for a rocker of several radii.
    Points(Profile),
}

impl Rocker {
    /// An arc of `radius` [m]; infinity gives a straight keel.
    ///
    /// # Errors
    /// [`MeshError::Value`] where the radius is not positive.
    pub fn arc(radius: f64) -> Result<Self, MeshError> {
        Ok(Self::Arc {
            radius: positive("rocker radius [m]", radius)?,
        })
    }

    /// The smooth curve through `points` (x [m], height [m]), moved so that its lowest point has
    /// height 0.
    ///
    /// # Errors
    /// As [`Profile::new`].
    pub fn points(points: &[[f64; 2]]) -> Result<Self, MeshError> {
        Ok(Self::Points(Profile::new("rocker", points)?.levelled()))
    }

    /// Height [m] and slope at `x` [m]; outside the rocker's range the height is infinite.
    pub fn height_and_slope(&self, x: f64) -> [f64; 2] {
        let [from, to] = self.range();
        if !(from..=to).contains(&x) {
            return [f64::INFINITY, f64::INFINITY.copysign(x)];
        }
        match self {
            Self::Arc { radius } if radius.is_infinite() => [0.0, 0.0],
            Self::Arc { radius } => {
                let depth = ((radius - x) * (radius + x)).sqrt();
                [x * x / (radius + depth), x / depth]
            }
            Self::Points(curve) => {
                let [height, slope, _] = curve.evaluate(x);
                [height, slope]
            }
        }
    }

    /// Positions between which a measured rocker is smooth [m]; empty for an arc.
    pub(crate) fn breaks(&self) -> &[f64] {
        match self {
            Self::Arc { .. } => &[],
            Self::Points(curve) => curve.breaks(),
        }
    }

    /// The positions [m] between which the rocker is defined.
    pub fn range(&self) -> [f64; 2] {
        match self {
            Self::Arc { radius } => [-radius, *radius],
            Self::Points(curve) => curve.range(),
        }
    }

    /// Whether the height is even in x.
    pub fn is_even(&self) -> bool {
        match self {
            Self::Arc { .. } => true,
            Self::Points(curve) => curve.is_even(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_circle_reaches_its_radius_at_the_flank_and_nothing_lies_beside_it() {
        let half = Section::arc(0.005, 0.010).unwrap();
        assert!((half.height(0.005) - 0.005).abs() < 1e-15);
        assert!((half.height(0.003) - 0.001).abs() < 1e-15);
        assert_eq!(half.height(0.005_000_1), f64::INFINITY);
        assert_eq!(half.height(f64::NAN), f64::INFINITY);
        let rounded_up = Section::arc(0.0035, 0.007_000_000_000_000_001).unwrap();
        assert!((rounded_up.height(rounded_up.extent()[1]) - 0.0035).abs() < 1e-10);
    }

    #[test]
    fn luge_edge_is_lowest_at_the_origin_and_smooth_into_its_flat() {
        let (radius, tilt) = (0.3e-3, 0.02f64);
        let edge = Section::edge(radius, tilt, 0.020).unwrap();
        assert_eq!(edge.height(0.0), 0.0);
        let lowest = (-300..=19_700)
            .map(|i| edge.height(1e-6 * f64::from(i)))
            .fold(f64::INFINITY, f64::min);
        assert_eq!(lowest, 0.0);
        let slope = |y: f64| (edge.height(y + 1e-9) - edge.height(y - 1e-9)) / 2e-9;
        assert!((slope(0.01) - tilt.tan()).abs() < 1e-6);
        let tangent = radius * tilt.sin();
        assert!((slope(tangent - 2e-9) - slope(tangent + 2e-9)).abs() < 1e-4);
        assert!((edge.height(-radius) - radius).abs() < 1e-15);
        assert_eq!(edge.height(-1.001 * radius), f64::INFINITY);
    }

    #[test]
    fn wear_leaves_a_flat_as_wide_as_the_chord_at_its_depth() {
        let (radius, depth) = (0.005f64, 20e-6);
        let worn = Section::arc(radius, 0.010)
            .unwrap()
            .worn(depth, 0.0)
            .unwrap();
        let chord = 2.0 * (2.0 * radius * depth - depth * depth).sqrt();
        let flat = (-5000..=5000)
            .filter(|&i| worn.height(1e-6 * f64::from(i)) == 0.0)
            .count();
        assert!((flat as f64 * 1e-6 - chord).abs() < 2e-6);
        assert!(worn.is_even());
    }

    #[test]
    fn the_edges_of_a_worn_flat_have_the_radius_that_was_asked() {
        let (radius, depth, edge) = (0.005f64, 1e-6, 0.2);
        let worn = Section::arc(radius, 0.010)
            .unwrap()
            .worn(depth, edge)
            .unwrap();
        let at = (2.0 * radius * depth).sqrt();
        let h = 1e-7;
        let bend = (worn.height(at + h) - 2.0 * worn.height(at) + worn.height(at - h)) / (h * h);
        // The edge's own curvature and half of the arc's.
        let expected = 1.0 / (edge * radius) + 0.5 / radius;
        assert!((bend / expected - 1.0).abs() < 0.02, "{bend} {expected}");
        assert!(worn.height(0.0) < 0.02 * depth);
    }

    #[test]
    fn measured_arc_gives_the_arc() {
        let arc = Section::arc(0.005, 0.006).unwrap();
        let points: Vec<_> = (-30..=30)
            .map(|i| 1e-4 * f64::from(i))
            .map(|y| [y, arc.height(y) + 0.2])
            .collect();
        let measured = Section::points(&points).unwrap();
        for i in -29..=29 {
            let y = 0.97e-4 * f64::from(i);
            assert!((measured.height(y) - arc.height(y)).abs() < 2e-9, "{y}");
        }
        assert!(measured.is_even());
    }

    #[test]
    fn impossible_sections_are_refused_by_name() {
        let refused = |section: Result<Section, MeshError>| section.unwrap_err().to_string();
        assert!(refused(Section::arc(0.005, 0.0101)).contains("width"));
        assert!(refused(Section::edge(3e-4, -0.1, 0.02)).contains("tilt"));
        assert!(refused(Section::edge(3e-2, 0.1, 0.02)).contains("edge radius"));
        assert!(
            refused(Section::arc(0.005, 0.01).unwrap().worn(0.006, 0.0)).contains("wear depth")
        );
        assert!(refused(Section::arc(0.005, 0.01).unwrap().worn(1e-6, 1.5)).contains("worn edge"));
    }

    #[test]
    fn arc_lies_on_its_circle_and_infinity_is_straight() {
        let arc = Rocker::arc(30.0).unwrap();
        let [z, slope] = arc.height_and_slope(0.5);
        assert!((0.25 + (z - 30.0) * (z - 30.0) - 900.0).abs() < 1e-12);
        assert!((slope - (0.5f64 / 30.0).asin().tan()).abs() < 1e-15);
        assert_eq!(
            Rocker::arc(f64::INFINITY).unwrap().height_and_slope(7.0),
            [0.0, 0.0]
        );
    }

    #[test]
    fn points_of_two_radii_give_both_radii_and_height_zero_at_the_keel() {
        let two_radii = |x: f64| if x < 0.0 { x * x / 40.0 } else { x * x / 80.0 };
        let points: Vec<_> = (-25..=25)
            .map(|i| 0.02 * f64::from(i))
            .map(|x| [x, 7.0 + two_radii(x)])
            .collect();
        let Rocker::Points(curve) = Rocker::points(&points).unwrap() else {
            unreachable!()
        };
        assert!(curve.lowest()[1].abs() < 1e-15);
        assert!((curve.evaluate(-0.3)[2] * 20.0 - 1.0).abs() < 0.01);
        assert!((curve.evaluate(0.3)[2] * 40.0 - 1.0).abs() < 0.01);
    }
}
