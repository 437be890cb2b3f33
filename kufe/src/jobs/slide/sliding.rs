//! A case's steady sliding, and the friction of it.

use crate::case::SlidingTable;
use kufe_contact::{Groove, Measure, Options, Problem, SlidingSolution, Solution};
use kufe_sled::friction::film::FilmTotals;

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::film::{FilmAlong, conditions, film_along, film_failure};
use crate::jobs::slide::groove::{Grooved, Hardness, Ploughing};
use crate::jobs::slide::sensitivity::Sensitivity;
use crate::results::{Measured, Quantity, SensitivityResult, SlidingMeshResult, SlidingResult};

/// The coefficient of friction and its parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// All parts together.
    pub mu: Measure,
    /// Force that ploughs the groove over the load.
    pub ploughing: Measure,
    /// Drag of the melt film over the load.
    pub viscous: Measure,
    /// Drag where steel and ice touch through the film over the load.
    pub boundary: Measure,
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
        let of_film = |part: fn(&FilmTotals) -> f64| {
            let value = part(&along.film.totals);
            Measure {
                value,
                error: along.error(part) + patch * value,
            }
        };
        let film = of_film(|totals| totals.friction);
        let ploughing = Measure {
            value: solution.groove.ploughing.value / fz,
            error: solution.groove.ploughing.error / fz,
        };
        Friction {
            mu: Measure {
                value: ploughing.value + film.value,
                error: ploughing.error + film.error,
            },
            ploughing,
            viscous: of_film(|totals| totals.viscous_friction),
            boundary: of_film(|totals| totals.boundary_friction),
        }
    }
}

/// What sliding adds to a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedSliding {
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

/// Depth of a groove over its width above which its sides are steep.
const STEEP: f64 = 0.2;

impl SolvedSliding {
    /// The document's part on sliding.
    pub fn result(&self) -> SlidingResult {
        let (friction, groove, by) = (&self.friction, &self.groove, &self.sensitivity);
        let film = &self.film.film;
        let (thickest, thickest_error) = film
            .thickest()
            .map_or((0.0, 0.0), |s| (s.thickness, s.thickness_error));
        SlidingResult {
            mu: friction.mu.into(),
            mu_ploughing: friction.ploughing.into(),
            mu_viscous: friction.viscous.into(),
            mu_boundary: friction.boundary.into(),
            boundary_share: self.of_film(|totals| totals.boundary_share),
            groove_depth: groove.deepest.into(),
            load_ahead: groove.load_ahead.into(),
            front: groove.front.into(),
            back: groove.back.into(),
            film_mean: self.of_film(|totals| totals.mean_thickness),
            film_max: Measured::new(thickest, thickest_error),
            melt_rate: self.of_film(|totals| totals.melted),
            contact_time: self.hardness.contact_time.into(),
            hardness_pa: self.hardness.value,
            hardness_from: self.hardness.from.name().into(),
            mu_sensitivity: SensitivityResult {
                hardness: by.hardness.into(),
                speed: by.speed.into(),
                viscosity: by.viscosity.into(),
                roughness: by.boundary.map(|[roughness, _]| roughness.into()),
                boundary_shear: by.boundary.map(|[_, shear]| shear.into()),
                temperature: by.temperature.into(),
            },
            groove_area_m2: groove.profile.area(),
            sliding_history: groove.meshes.iter().map(SlidingMeshResult::from).collect(),
        }
    }

    /// A total of the film with its error.
    fn of_film<Q: Quantity>(&self, total: impl Fn(&FilmTotals) -> f64) -> Measured<Q> {
        Measured::new(total(&self.film.film.totals), self.film.error(total))
    }

    /// A warning where the groove is too deep for what the model takes a contact to be: a height
    /// over a plane.
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
) -> Result<(Solution, SolvedSliding), Failure> {
    let ploughing = Ploughing::new(loaded, sliding, problem)?;
    let grooved = ploughing.groove(options)?;
    let film = film_along(&grooved.solution, &conditions(sliding))
        .map_err(|error| film_failure(loaded, &error))?;
    let sensitivity = Sensitivity::of(&ploughing, &grooved, &film, options)?;
    let Grooved { solution, hardness } = grooved;
    let slid = SolvedSliding {
        friction: Friction::of(&solution, &film),
        sensitivity,
        film,
        hardness,
        groove: solution.groove,
    };
    Ok((solution.contact, slid))
}
