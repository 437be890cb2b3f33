//! Closed form of sliding on rigid-plastic ice.

use std::f64::consts::PI;

/// A round runner that slides on rigid-plastic ice.
///
/// R is the rocker radius, r the section radius, F the load, H the hardness and D the depth. The
/// patch is the front half of the ellipse in which the runner intersects the ice surface. The
/// pressure is H everywhere:
///
/// ```text
/// l = sqrt( 2 F sqrt(R/r) / (pi H) ),   D = l^2/(2 R),   width = 2 sqrt(2 r D),   mu = 4 l/(3 pi R)
/// ```
///
/// from F = H pi l width/4 and the ploughing force H (2/3) D width, which is the section of the
/// groove times the hardness.
///
/// Source: E. Lozowski and K. Szilder, Int. J. Offshore Polar Eng. 23 (2013).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidPlastic {
    /// Length of the patch, all of it ahead of the lowest point [m].
    pub length: f64,
    /// Width of the groove [m].
    pub width: f64,
    /// Depth of the groove [m].
    pub depth: f64,
    /// Ploughing force over load.
    pub ploughing_friction: f64,
}

/// The closed form [`RigidPlastic`] of radii [m], load [N] and hardness [Pa].
pub fn rigid_plastic(
    rocker_radius: f64,
    section_radius: f64,
    fz: f64,
    hardness: f64,
) -> RigidPlastic {
    let length = (2.0 * fz * (rocker_radius / section_radius).sqrt() / (PI * hardness)).sqrt();
    let depth = length * length / (2.0 * rocker_radius);
    RigidPlastic {
        length,
        width: 2.0 * (2.0 * section_radius * depth).sqrt(),
        depth,
        ploughing_friction: 4.0 * length / (3.0 * PI * rocker_radius),
    }
}
