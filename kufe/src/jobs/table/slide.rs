//! Points of a table whose runner slides: one groove, and the film at every speed.

use crate::case::Case;
use kufe_contact::Options;
use kufe_lut::{Figures, Point, Quantity};

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::{Friction, Grooved, Ploughing, at, conditions, film_along, film_failure};
use crate::jobs::table::best::{LARGEST_ERROR, figures};
use crate::jobs::table::solver::{self, SolveError, Solver, with_rocker};
use crate::jobs::watch::Watch;

impl Solver {
    /// Points that differ in speed alone; after a failure the rest is omitted.
    pub(crate) fn slide(
        &self,
        points: &[Point],
        watch: &Watch,
    ) -> Vec<Result<Figures, SolveError>> {
        // A hardness over contact time is another at every speed.
        let own = sliding(&self.loaded).hardness.is_some();
        let mut grooved: Option<Grooved> = None;
        let mut solved = Vec::with_capacity(points.len());
        for point in points {
            let found = match grooved.take().filter(|_| !own) {
                Some(grooved) => Ok(grooved),
                None => self.grooved(point, watch),
            };
            let found = match found {
                Ok(found) => found,
                Err(error) => {
                    solved.push(Err(error));
                    break;
                }
            };
            solved.push(self.film(&found, point).map_err(SolveError::from));
            grooved = Some(found);
        }
        solved
    }

    /// The groove at a point.
    fn grooved(&self, point: &Point, watch: &Watch) -> Result<Grooved, SolveError> {
        if watch.stopped() {
            return Err(SolveError::Interrupted);
        }
        let case = self.case_at(point)?;
        let runner = match point.rocker_radius {
            None => self.runner.clone(),
            Some(_) => case.case.runner(&case.base, case.hull.as_deref())?.0,
        };
        let problem = case.case.problem_of(runner, &case.base)?;
        let ploughing = Ploughing::new(&case, sliding(&case), &problem)?;
        let mut tolerance = self.tolerance;
        loop {
            let options = Options {
                p_max_tolerance: tolerance,
                ..case.case.options()
            };
            match ploughing.groove(&options) {
                // The best answer that there is, with its error, as of contacts at rest.
                Err(Failure::NotConverged(_)) if 2.0 * tolerance < LARGEST_ERROR => {
                    tolerance *= 2.0;
                }
                Err(failure) => return Err(failure.into()),
                Ok(grooved) => {
                    case.fine_enough(self.hull.as_ref(), &grooved.solution.contact)?;
                    return Ok(grooved);
                }
            }
        }
    }

    /// The film on a groove, at a point's speed.
    fn film(&self, grooved: &Grooved, point: &Point) -> Result<Figures, Failure> {
        let case = self.case_at(point)?;
        let solution = &grooved.solution;
        let along = film_along(solution, &conditions(sliding(&case)))
            .map_err(|error| film_failure(&case, &error))?;
        let friction = Friction::of(solution, &along);
        Ok(figures(&solution.contact)
            .with(Quantity::Mu, friction.mu.value)
            .with_error(Quantity::Mu, friction.mu.error)
            .with(Quantity::MuPloughing, friction.ploughing.value)
            .with(Quantity::MuViscous, friction.viscous.value)
            .with(Quantity::MuBoundary, friction.boundary.value)
            .with(Quantity::GrooveDepth, solution.groove.deepest.value)
            .with(Quantity::FilmMean, along.film.totals.mean_thickness))
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
        *track = solver::track(point.curvature);
        Ok(loaded)
    }
}

fn sliding(loaded: &LoadedCase) -> &crate::case::SlidingTable {
    let Some(sliding) = &loaded.case.sliding else {
        unreachable!("only a case with [sliding] gets here");
    };
    sliding
}
