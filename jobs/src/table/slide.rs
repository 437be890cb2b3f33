//! Points of a table whose runner slides: one groove, and the film at every speed.

use kufe_case::{Case, TrackTable};
use kufe_contact::{Options, SlidingSolution};
use kufe_lut::{Point, Sliding, Solved};

use crate::case_file::LoadedCase;
use crate::failure::Failure;
use crate::slide::{Friction, at, conditions, film_along, film_failure, groove};
use crate::table::solver::{LARGEST_ERROR, SolveError, Solver, figures, with_rocker};
use crate::watch::Watch;

impl Solver {
    /// Points that differ in speed alone; after a failure the rest is left out.
    pub(crate) fn slide(&self, points: &[Point], watch: &Watch) -> Vec<Result<Solved, SolveError>> {
        let Some(first) = points.first() else {
            return Vec::new();
        };
        let ploughed = match self.ploughed(first, watch) {
            Ok(ploughed) => ploughed,
            Err(error) => return vec![Err(error)],
        };
        points
            .iter()
            .map(|point| Ok(self.film(&ploughed, point)?))
            .collect()
    }

    /// The groove at a point; it does not depend on the speed.
    fn ploughed(&self, point: &Point, watch: &Watch) -> Result<SlidingSolution, SolveError> {
        if watch.stopped() {
            return Err(SolveError::Interrupted);
        }
        let case = self.case_at(point)?;
        let runner = match point.rocker_radius {
            None => self.runner.clone(),
            Some(_) => case.case.runner(&case.base)?.0,
        };
        let problem = case.case.problem_of(runner, &case.base)?;
        let mut tolerance = self.tolerance;
        loop {
            let options = Options {
                p_max_tolerance: tolerance,
                ..case.case.options()
            };
            match groove(&case, sliding(&case), &problem, &options) {
                // The best answer that there is, with its error, as of contacts at rest.
                Err(Failure::NotConverged(_)) if 2.0 * tolerance < LARGEST_ERROR => {
                    tolerance *= 2.0;
                }
                Err(failure) => return Err(failure.into()),
                Ok(solution) => {
                    case.fine_enough(self.hull.as_ref(), &solution.contact)?;
                    return Ok(solution);
                }
            }
        }
    }

    /// The film on a groove, at a point's speed.
    fn film(&self, ploughed: &SlidingSolution, point: &Point) -> Result<Solved, Failure> {
        let case = self.case_at(point)?;
        let along = film_along(ploughed, &conditions(sliding(&case)))
            .map_err(|error| film_failure(&case, &error))?;
        let friction = Friction::of(ploughed, &along);
        Ok(Solved {
            sliding: Some(Sliding {
                mu: friction.mu.value,
                mu_error: friction.mu.error,
                mu_ploughing: friction.ploughing.value,
                mu_viscous: friction.viscous.value,
                groove_depth: ploughed.groove_depth.value,
                film_mean: along.film.totals.mean_thickness,
            }),
            ..figures(&ploughed.contact)
        })
    }

    /// The case at a point.
    fn case_at(&self, point: &Point) -> Result<LoadedCase, Failure> {
        let own = sliding(&self.loaded);
        let [speed, ice_c] = [
            point.speed.unwrap_or(own.v_mps),
            point.ice_c.unwrap_or(own.ice_c),
        ];
        let mut loaded = at(&self.loaded, speed, ice_c)?;
        if let Some(radius) = point.rocker_radius {
            loaded.case = with_rocker(&loaded.case, radius);
        }
        let Case { load, track, .. } = &mut loaded.case;
        load.fz_n = point.fz;
        *track = TrackTable {
            curvature_1pm: Some(point.curvature),
            ..TrackTable::default()
        };
        Ok(loaded)
    }
}

fn sliding(loaded: &LoadedCase) -> &kufe_case::SlidingTable {
    let Some(sliding) = &loaded.case.sliding else {
        unreachable!("only a case that slides is asked for its sliding");
    };
    sliding
}
