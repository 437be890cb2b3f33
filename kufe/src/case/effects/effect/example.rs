//! Examples: what an effect makes of a known problem or map.

use kufe_contact::Problem;

use crate::case::effects::effect::map::Map;

/// A size and the number that it must give.
///
/// The problem is a rigid paraboloid of radii 30 m and 5 mm on a half-space of 9 GPa under 1 kN, free to turn; the map has
/// 41 by 31 pixels of 1 mm, 1 MPa on the one in the middle.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// Size of the effect.
    pub size: f64,
    /// What is measured, in words, with its unit.
    pub of: &'static str,
    /// How it is measured.
    pub measure: Measure,
    /// What must come out.
    pub gives: f64,
}

/// What is measured after an effect has acted.
#[derive(Clone, Copy, Debug)]
pub enum Measure {
    /// Of the problem.
    OfProblem(fn(&Problem) -> f64),
    /// Of the map.
    OfMap(fn(&Map) -> f64),
}
