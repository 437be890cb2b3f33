//! Steady sliding of a case: the melt film on its contact patch, and the friction.

use kufe_contact::{
    Coarser, Groove, Measure, Options, Problem, Section, SlidingSolution, Solution,
};
use kufe_sled::friction::film::{
    BoundaryContact, Film, FilmConditions, FilmOptions, FilmTotals, Properties, Strip, film,
};

use crate::case::SlidingTable;
use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::ploughing::{Hardness, Ploughing, SolvedGroove};
use crate::results::{Friction, Measured, SensitivityResult, SlidingMeshResult, SlidingResult};

/// The melt film along the patch.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmAlong {
    /// Front end of the patch along the runner, where the film begins [m].
    pub front: f64,
    /// The film as a function of the distance from the front end.
    pub film: Film,
    /// Totals of the film on the patches of coarser solutions; `None` without such solutions.
    pub coarser: Option<Coarser<FilmTotals>>,
    /// Relative error of the patch: that of the groove's depth, or without a groove that of the
    /// peak pressure.
    pub patch_error: f64,
}

impl FilmAlong {
    /// A total of the film with its error: the sum of the errors of the integration, the stations,
    /// the mesh (by the change to coarser solutions) and the patch. The last is added because two
    /// meshes may agree by chance.
    pub fn total(&self, total_of: impl Fn(&FilmTotals) -> f64) -> Measure {
        let value = total_of(&self.film.totals);
        let stations = self.film.sampling.as_ref().map_or(0.0, &total_of);
        let meshes = self.coarser.as_ref();
        let meshes = meshes.map_or(f64::INFINITY, |coarser| coarser.error(value, &total_of));
        Measure {
            value,
            error: total_of(&self.film.errors) + stations + meshes + self.patch_error * value,
        }
    }
}

/// The melt film under `conditions` on the patch of a case's solution.
///
/// # Errors
/// [`Failure::BadInput`] and [`Failure::NotConverged`] as [`film_on`].
pub(crate) fn film_along(
    loaded: &LoadedCase,
    solution: &SlidingSolution,
    conditions: &FilmConditions,
) -> Result<FilmAlong, Failure> {
    let groove = &solution.groove;
    let solved_film = |sections: &[Section]| {
        let film = film_on(sections, solution.contact.fz, conditions);
        film.map_err(film_failure(loaded))
    };
    let coarser = groove.coarser.as_ref().map(|coarser| {
        Ok::<_, Failure>(Coarser {
            before: solved_film(&coarser.before)?.totals,
            plain: solved_film(&coarser.plain)?.totals,
            refined: coarser.refined,
        })
    });
    let deepest = groove.deepest;
    Ok(FilmAlong {
        patch_error: if deepest.value > 0.0 {
            deepest.error / deepest.value
        } else {
            solution.contact.p_max_error / solution.contact.p_max
        },
        front: groove.sections.first().map_or(0.0, |s| s.x),
        film: solved_film(&groove.sections)?,
        coarser: coarser.transpose()?,
    })
}

/// The melt film on the stations of a patch under `fz` [N], as a strip that carries the whole load.
///
/// The widths are scaled to the load: they are only known to a fraction of a cell, while pressures
/// are bounded by the hardness of the ice.
///
/// # Errors
/// [`kufe_sled::Error`] for conditions out of range, and for a patch that is not a valid strip.
pub(crate) fn film_on(
    sections: &[Section],
    fz: f64,
    conditions: &FilmConditions,
) -> Result<Film, kufe_sled::Error> {
    let front = sections.first().map_or(0.0, |s| s.x);
    let scale = fz / load(sections);
    let strip = Strip::new(
        sections.iter().map(|s| front - s.x).collect(),
        sections.iter().map(|s| scale * s.width).collect(),
        sections.iter().map(|s| s.pressure).collect(),
    )?;
    let options = FilmOptions::default();
    film(&strip, conditions, &Properties::WATER_AND_ICE, &options)
}

/// Load of the stations by Simpson's rule, with pressure and squared width linear in between [N].
fn load(sections: &[Section]) -> f64 {
    let between = |pair: &[Section]| {
        let [a, b] = [pair[0], pair[1]];
        let width = (0.5 * (a.width.powi(2) + b.width.powi(2))).sqrt();
        let middle = width * 0.5 * (a.pressure + b.pressure);
        (a.x - b.x) / 6.0 * (a.width * a.pressure + 4.0 * middle + b.width * b.pressure)
    };
    sections.windows(2).map(between).sum()
}

/// Conditions of the film: speed, temperature, viscosity and boundary contact of a case.
pub(crate) fn conditions(sliding: &SlidingTable) -> FilmConditions {
    FilmConditions {
        viscosity_factor: sliding.viscosity_factor.unwrap_or(1.0),
        boundary: BoundaryContact {
            roughness: sliding.roughness_m.unwrap_or(0.0),
            shear: sliding.boundary_shear_pa.unwrap_or(0.0),
        },
        ..FilmConditions::new(sliding.v_mps, sliding.ice_c)
    }
}

/// Converts an error of the film to a failure of the job.
pub(crate) fn film_failure(loaded: &LoadedCase) -> impl Fn(kufe_sled::Error) -> Failure {
    |error| {
        let failure = Failure::from(error).within("the melt film");
        failure.within(&loaded.name)
    }
}

impl Friction {
    /// Friction of a groove and the film on it.
    pub(crate) fn of(solution: &SlidingSolution, along: &FilmAlong) -> Self {
        let fz = solution.contact.fz;
        let film = along.total(|totals| totals.friction);
        let Measure { value, error } = solution.groove.ploughing;
        let (value, error) = (value / fz, error / fz);
        Friction {
            mu: Measured::new(value + film.value, error + film.error),
            ploughing: Measured::new(value, error),
            viscous: along.total(|totals| totals.viscous_friction).into(),
            boundary: along.total(|totals| totals.boundary_friction).into(),
        }
    }
}

/// The results of sliding in addition to those of the contact.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedSliding {
    /// The coefficient of friction.
    pub friction: Friction,
    /// The melt film.
    pub film: FilmAlong,
    /// Sensitivity of the coefficient to its parameters.
    pub sensitivity: SensitivityResult,
    /// Pressure at which the ice yielded.
    pub hardness: Hardness,
    /// The groove.
    pub groove: Groove,
}

/// Ratio of a groove's depth to its width above which its sides are steep.
const STEEP_RATIO: f64 = 0.2;

impl SolvedSliding {
    /// The document's part on sliding.
    pub fn result(&self) -> SlidingResult {
        let (groove, film) = (&self.groove, &self.film);
        SlidingResult {
            friction: self.friction,
            boundary_share: film.total(|totals| totals.boundary_share).into(),
            groove_depth: groove.deepest.into(),
            load_ahead: groove.load_ahead.into(),
            front: groove.front.into(),
            back: groove.back.into(),
            film_mean: film.total(|totals| totals.mean_thickness).into(),
            film_max: film.total(|totals| totals.max_thickness).into(),
            melt_rate: film.total(|totals| totals.melted).into(),
            contact_time: self.hardness.contact_time.into(),
            hardness_pa: self.hardness.value,
            hardness_from: self.hardness.from.name().into(),
            mu_sensitivity: self.sensitivity.clone(),
            groove_area_m2: groove.profile.area(),
            sliding_history: groove.meshes.iter().map(SlidingMeshResult::from).collect(),
        }
    }

    /// A warning where the groove is too deep for the model, in which the contact is a height over
    /// a plane.
    pub(crate) fn too_deep(&self) -> Option<String> {
        let widths = self.groove.sections.iter().map(|s| s.width);
        let widest = widths.fold(0.0, f64::max);
        let depth = self.groove.deepest.value;
        (depth > STEEP_RATIO * widest).then(|| {
            format!(
                "the groove is {:.2} mm deep and {:.2} mm wide: the model treats the contact as a height over a plane, which holds for \
                 flat grooves only; read the figures as those of a runner that sinks in",
                1e3 * depth,
                1e3 * widest
            )
        })
    }
}

/// Solves the sliding of a case's problem. The last value is the reason where the accuracy is not
/// reached.
pub(crate) fn solve_sliding(
    loaded: &LoadedCase,
    sliding: &SlidingTable,
    problem: &Problem,
    options: &Options,
) -> Result<(Solution, SolvedSliding, Option<Failure>), Failure> {
    let ploughing = Ploughing::new(loaded, sliding, problem)?;
    let groove = ploughing.groove(options)?;
    let film = film_along(loaded, &groove.solution, &conditions(sliding))?;
    let sensitivity = ploughing.sensitivity(&groove, &film, options)?;
    let SolvedGroove {
        solution,
        hardness,
        short,
    } = groove;
    let sliding = SolvedSliding {
        friction: Friction::of(&solution, &film),
        sensitivity,
        film,
        hardness,
        groove: solution.groove,
    };
    Ok((solution.contact, sliding, short))
}
