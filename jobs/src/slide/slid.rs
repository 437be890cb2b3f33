//! A case's steady sliding.

use kufe_case::SlidingTable;
use kufe_contact::{Error, Groove, Measure, Options, Problem, SlidingSolution, Solution, slide};
use kufe_friction::film::FilmConditions;

use crate::case_file::LoadedCase;
use crate::failure::Failure;
use crate::slide::film::{FilmAlong, film_along};
use crate::slide::groove_file::groove_left;

/// The coefficient of friction and its parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Both together.
    pub mu: Measure,
    /// Force that ploughs the groove over the load.
    pub ploughing: Measure,
    /// Drag of the melt film over the load.
    pub viscous: Measure,
}

impl Friction {
    /// Of a solution and the film on it.
    ///
    /// The film's error has that of the patch in it, whose share is taken as the groove's.
    pub fn of(solution: &SlidingSolution, along: &FilmAlong) -> Self {
        let fz = solution.contact.fz;
        let depth = solution.groove.deepest;
        let patch = if depth.value > 0.0 {
            depth.error / depth.value
        } else {
            solution.contact.p_max_error / solution.contact.p_max
        };
        let totals = &along.film.totals;
        let viscous = Measure {
            value: totals.friction,
            error: along.friction_error() + patch * totals.friction,
        };
        let ploughing = Measure {
            value: solution.groove.ploughing.value / fz,
            error: solution.groove.ploughing.error / fz,
        };
        Friction {
            mu: Measure {
                value: ploughing.value + viscous.value,
                error: ploughing.error + viscous.error,
            },
            ploughing,
            viscous,
        }
    }
}

/// What sliding adds to a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Slid {
    /// The coefficient of friction.
    pub friction: Friction,
    /// The film.
    pub film: FilmAlong,
    /// Hardness that the ice yielded at [Pa].
    pub hardness: f64,
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
    let solution = groove(loaded, sliding, problem, options)?;
    let film = film_along(&solution, &conditions(sliding)).map_err(|e| film_failure(loaded, &e))?;
    let friction = Friction::of(&solution, &film);
    let slid = Slid {
        friction,
        film,
        hardness: problem.ice.hardness.unwrap_or(f64::INFINITY),
        groove: solution.groove,
    };
    Ok((solution.contact, slid))
}

/// The groove alone.
pub(crate) fn groove(
    loaded: &LoadedCase,
    sliding: &SlidingTable,
    problem: &Problem,
    options: &Options,
) -> Result<SlidingSolution, Failure> {
    let before = match &sliding.previous {
        Some(folder) => Some(
            groove_left(&loaded.base.join(folder))
                .map_err(|failure| failure.within(&loaded.name))?,
        ),
        None => None,
    };
    let solution = slide(problem, before.as_ref(), options).map_err(|error| match error {
        Error::NotSliding { .. } => {
            Failure::BadInput(format!("{}: [sliding]: {error}", loaded.name))
        }
        error => loaded.failure(&error),
    })?;
    let parts = parts(&solution);
    if parts > 1 {
        return Err(Failure::BadInput(format!(
            "{}: [sliding]: the contact lies in {parts} parts, one behind the other: expected one, for the film begins at its front",
            loaded.name
        )));
    }
    Ok(solution)
}

pub(crate) fn conditions(sliding: &SlidingTable) -> FilmConditions {
    FilmConditions {
        viscosity_factor: sliding.viscosity_factor.unwrap_or(1.0),
        ..FilmConditions::new(sliding.v_mps, sliding.ice_c)
    }
}

pub(crate) fn film_failure(loaded: &LoadedCase, error: &kufe_friction::Error) -> Failure {
    let text = format!("{}: the melt film: {error}", loaded.name);
    match error {
        kufe_friction::Error::NotConverged { .. } => Failure::NotConverged(text),
        _ => Failure::BadInput(text),
    }
}

/// Stretches along x that touch.
fn parts(solution: &SlidingSolution) -> usize {
    let field = &solution.contact.surface;
    let nx = field.x.len();
    let touches = |i: usize| field.pressure.iter().skip(i).step_by(nx).any(|p| *p > 0.0);
    (0..nx)
        .filter(|&i| touches(i) && (i == 0 || !touches(i - 1)))
        .count()
}
