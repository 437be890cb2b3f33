//! The shape of a runner along its length.

use crate::error::MeshError;
use crate::parameter::positive;
use crate::shapes::profile::Profile;

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
    /// [`MeshError::Parameter`] where the radius is not positive.
    pub fn arc(radius: f64) -> Result<Self, MeshError> {
        Ok(Self::Arc {
            radius: positive("rocker radius [m]", radius)?,
        })
    }

    /// The smooth curve through `points` (x [m], height [m]), moved so that its lowest point has height 0.
    ///
    /// # Errors
    /// As [`Profile::new`].
    pub fn points(points: &[[f64; 2]]) -> Result<Self, MeshError> {
        let curve = Profile::new("rocker", points)?;
        let [_, lowest] = curve.lowest();
        Ok(Self::Points(curve.raised(-lowest)))
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

    /// Positions between which a measured rocker is smooth [m]; none of an arc.
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
