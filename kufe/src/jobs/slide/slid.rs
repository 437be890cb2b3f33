//! A case's steady sliding.

use crate::case::SlidingTable;
use kufe_contact::{Groove, Options, Problem, Solution};

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::film::{FilmAlong, conditions, film_along, film_failure};
use crate::jobs::slide::friction::Friction;
use crate::jobs::slide::groove::{Grooved, Hardness, Ploughing};
use crate::jobs::slide::sensitivity::Sensitivity;

/// What sliding adds to a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Slid {
    /// The coefficient of friction.
    pub friction: Friction,
    /// The film.
    pub film: FilmAlong,
    /// Change of the coefficient with what it depends on.
    pub sensitivity: Sensitivity,
    /// Pressure at which the ice yielded.
    pub hardness: Hardness,
    /// The groove.
    pub groove: Groove,
}

/// Depth of a groove over its width beyond which its sides are steep.
const STEEP: f64 = 0.2;

impl Slid {
    /// A warning where the groove is too deep for what the model takes a contact to be: a height over a plane.
    pub(crate) fn too_deep(&self) -> Option<String> {
        let widest = self
            .groove
            .sections
            .iter()
            .map(|s| s.width)
            .fold(0.0, f64::max);
        let depth = self.groove.deepest.value;
        (depth > STEEP * widest).then(|| {
            format!(
                "the groove is {:.2} mm deep and {:.2} mm wide: so steep a contact is no height over a plane, read its figures as those of \
                 a runner that sinks in",
                1e3 * depth,
                1e3 * widest
            )
        })
    }
}

/// Solves the sliding of a case's problem.
pub(crate) fn solve_sliding(
    loaded: &LoadedCase,
    sliding: &SlidingTable,
    problem: &Problem,
    options: &Options,
) -> Result<(Solution, Slid), Failure> {
    let ploughing = Ploughing::new(loaded, sliding, problem)?;
    let grooved = ploughing.groove(options)?;
    let told = |error: &_| film_failure(loaded, error);
    let film = film_along(&grooved.solution, &conditions(sliding)).map_err(|e| told(&e))?;
    let sensitivity = Sensitivity::of(&ploughing, &grooved, &film, options)?;
    let Grooved { solution, hardness } = grooved;
    let slid = Slid {
        friction: Friction::of(&solution, &film),
        sensitivity,
        film,
        hardness,
        groove: solution.groove,
    };
    Ok((solution.contact, slid))
}
