//! Ice that yields and does not spring back: the closed form of the models that take it so.

use std::f64::consts::PI;

use crate::Error;

/// A round runner that slides on rigid-plastic ice.
///
/// With rocker radius R, section radius r, load F and hardness H the patch is the front half of the ellipse that the cut at depth D
/// removes, under H everywhere:
///
/// ```text
/// l = sqrt( 2 F sqrt(R/r) / (pi H) ),   D = l^2/(2 R),   width = 2 sqrt(2 r D),   mu = 4 l/(3 pi R)
/// ```
///
/// from F = H pi l width/4 and the ploughing force H (2/3) D width, the section times the hardness; the first assumption of
/// the models of skates and runners after E. Lozowski and K. Szilder, Int. J. Offshore Polar Eng. 23 (2013).
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
///
/// # Errors
/// [`Error::OutOfRange`] for a number that is not positive, and where they are so far apart that a figure is no number.
///
/// ```
/// let groove = kufe_contact::rigid_plastic(30.0, 0.004, 950.0, 17.7e6)?;
/// assert!((groove.depth / 49.3e-6 - 1.0).abs() < 1e-3);
/// assert!((groove.ploughing_friction / 0.770e-3 - 1.0).abs() < 1e-3);
/// # Ok::<(), kufe_contact::Error>(())
/// ```
pub fn rigid_plastic(
    rocker_radius: f64,
    section_radius: f64,
    fz: f64,
    hardness: f64,
) -> Result<RigidPlastic, Error> {
    for (name, value) in [
        ("rocker radius", rocker_radius),
        ("section radius", section_radius),
        ("normal force", fz),
        ("ice hardness", hardness),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::OutOfRange {
                name,
                value,
                expected: "a positive number",
            });
        }
    }
    let length = (2.0 * fz * (rocker_radius / section_radius).sqrt() / (PI * hardness)).sqrt();
    let depth = length * length / (2.0 * rocker_radius);
    let found = RigidPlastic {
        length,
        width: 2.0 * (2.0 * section_radius * depth).sqrt(),
        depth,
        ploughing_friction: 4.0 * length / (3.0 * PI * rocker_radius),
    };
    for (name, value) in [
        ("length of the patch", length),
        ("width of the groove", found.width),
        ("depth of the groove", depth),
        ("ploughing force over load", found.ploughing_friction),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::OutOfRange {
                name,
                value,
                expected: "radii, a load and a hardness that are nearer to one another",
            });
        }
    }
    Ok(found)
}
