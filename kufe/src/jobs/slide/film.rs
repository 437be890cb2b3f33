//! The melt film on a sliding contact's patch.

use crate::case::SlidingTable;
use kufe_contact::{Section, SlidingSolution};
use kufe_sled::friction::film::{
    BoundaryContact, Film, FilmConditions, FilmOptions, FilmTotals, Properties, Strip, film,
};

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;

/// The film along the patch, with the places of its stations.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmAlong {
    /// Front end of the patch along the runner, where the film begins [m].
    pub front: f64,
    /// The film by its distance from there.
    pub film: Film,
}

impl FilmAlong {
    /// Error of a total, of the integration and of the stations.
    pub fn error(&self, of: impl Fn(&FilmTotals) -> f64) -> f64 {
        of(&self.film.errors) + self.film.sampling.as_ref().map_or(0.0, of)
    }
}

/// The film under these conditions on the patch of a solution.
///
/// # Errors
/// As [`film_on`].
pub fn film_along(
    solution: &SlidingSolution,
    conditions: &FilmConditions,
) -> Result<FilmAlong, kufe_sled::Error> {
    film_on(&solution.groove.sections, solution.contact.fz, conditions)
}

/// The film on stations of a patch under `fz` [N], as a strip that bears the whole load: what
/// stations leave out of it is made up by their widths, which are known to a part of a cell, for
/// pressures are bounded by what the ice bears.
///
/// # Errors
/// [`kufe_sled::Error`] for conditions out of range, and for a patch that is no strip.
pub(crate) fn film_on(
    sections: &[Section],
    fz: f64,
    conditions: &FilmConditions,
) -> Result<FilmAlong, kufe_sled::Error> {
    let front = sections.first().map_or(0.0, |s| s.x);
    let share = fz / load(sections);
    let strip = Strip::new(
        sections.iter().map(|s| front - s.x).collect(),
        sections.iter().map(|s| share * s.width).collect(),
        sections.iter().map(|s| s.pressure).collect(),
    )?;
    let film = film(
        &strip,
        conditions,
        &Properties::WATER_AND_ICE,
        &FilmOptions::default(),
    )?;
    Ok(FilmAlong { front, film })
}

/// What the stations bear, with pressure and squared width linear in between, by Simpson's rule
/// [N].
fn load(sections: &[Section]) -> f64 {
    let between = |pair: &[Section]| {
        let [a, b] = [pair[0], pair[1]];
        let width = (0.5 * (a.width.powi(2) + b.width.powi(2))).sqrt();
        let middle = width * 0.5 * (a.pressure + b.pressure);
        (a.x - b.x) / 6.0 * (a.width * a.pressure + 4.0 * middle + b.width * b.pressure)
    };
    sections.windows(2).map(between).sum()
}

/// Speed, temperature, viscosity and boundary contact of a case.
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

/// The film's error as the job's.
pub(crate) fn film_failure(loaded: &LoadedCase, error: &kufe_sled::Error) -> Failure {
    let text = format!("{}: the melt film: {error}", loaded.name);
    match error {
        kufe_sled::Error::NotConverged { .. } => Failure::NotConverged(text),
        _ => Failure::BadInput(text),
    }
}
