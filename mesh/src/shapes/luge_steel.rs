//! A luge steel.

use crate::error::MeshError;
use crate::shapes::rocker::Rocker;
use crate::shapes::section::Section;
use crate::shapes::swept::Swept;

/// A luge steel that stands on its inner edge: flat underside tilted on the runner, rounded edge,
/// upright flank, bent to its rocker radius. The edge's lowest point is at x = 0, y = 0; the flat rises
/// towards +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LugeSteel {
    /// Length along x [m].
    pub length: f64,
    /// Radius of the rocker [m]; infinite for a straight edge.
    pub rocker_radius: f64,
    /// Radius of the edge [m].
    pub edge_radius: f64,
    /// Angle of the flat underside to the ice [rad]. At 0 the whole flat touches while the origin
    /// stays at the edge.
    pub tilt: f64,
    /// Width [m].
    pub width: f64,
    /// Height from the lowest point to the flat top [m].
    pub height: f64,
    /// Radius of the ends [m].
    pub end_radius: f64,
}

impl Default for LugeSteel {
    /// 0.6 m long, rocker 25 m, edge 0.3 mm, tilt 0.02 rad, 20 mm wide, 8 mm high, end radius 0.1 m.
    fn default() -> Self {
        Self {
            length: 0.6,
            rocker_radius: 25.0,
            edge_radius: 0.3e-3,
            tilt: 0.02,
            width: 0.020,
            height: 0.008,
            end_radius: 0.1,
        }
    }
}

impl LugeSteel {
    /// The steel as a swept surface.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] where the numbers make no steel.
    pub fn swept(&self) -> Result<Swept, MeshError> {
        self.swept_with(Section::edge(self.edge_radius, self.tilt, self.width)?)
    }

    /// The steel with another section; the edge's radius, the tilt and the width are not used.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] where the numbers make no steel.
    pub fn swept_with(&self, section: Section) -> Result<Swept, MeshError> {
        let rocker = Rocker::arc(self.rocker_radius)?;
        Swept::with_rounded_ends(rocker, section, self.length, self.height, self.end_radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::linspace;
    use crate::shapes::underside::Underside;

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
