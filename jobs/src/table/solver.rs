//! The contact solver as a sweep sees it.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use kufe_case::{Case, CaseError, FittedHull, TrackTable};
use kufe_contact::{Load, Options, Problem, Runner, Solution};
use kufe_lut::{Origin, Point, Solved, Spacing, Store, SweepError, sha256};

use crate::case_file::LoadedCase;
use crate::case_json::case_json;
use crate::failure::Failure;
use crate::slide::at;
use crate::table::wanted::Wanted;
use crate::watch::Watch;

/// Largest estimated error of the peak pressure that a point short of its tolerance may keep, relative.
pub(crate) const LARGEST_ERROR: f64 = 0.2;

/// Why a point has no result.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// The user asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// The solver's own answer.
    #[error(transparent)]
    Contact(#[from] kufe_contact::Error),
    /// The case at this point is no case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The hull is too coarse for the load there, or no groove or film is had.
    #[error(transparent)]
    Failed(#[from] Failure),
}

/// Solves points of one case.
pub struct Solver {
    pub(crate) loaded: LoadedCase,
    pub(crate) base: Problem,
    pub(crate) runner: Runner,
    pub(crate) hull: Option<FittedHull>,
    pub(crate) tolerance: f64,
    content: String,
}

impl Solver {
    /// The solver for a table: its case, at the tolerance that the table asks for.
    ///
    /// The tolerance is `accuracy.p_max` of the table's file; without it the case's own, and at most half of the
    /// interpolation error that is asked, so that refinement does not chase the solver's error.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the case cannot be had or has no rocker radius to sweep.
    pub fn new(wanted: &Wanted, watch: &Watch) -> Result<Solver, Failure> {
        let loaded = LoadedCase::read(&wanted.case)?;
        if wanted.plan.rocker_radius.is_some() && loaded.case.runner.shape.is_none() {
            return Err(Failure::BadInput(format!(
                "{}: axes.rocker_radius_m: the runner of {} is a hull, expected a shape with a rocker radius",
                wanted.path.display(),
                wanted.case.display()
            )));
        }
        if wanted.plan.is_sliding() && loaded.case.sliding.is_none() {
            return Err(Failure::BadInput(format!(
                "{}: axes: {} has no [sliding]: expected a runner that slides where an axis is v_mps or ice_c",
                wanted.path.display(),
                wanted.case.display()
            )));
        }
        check_axes(wanted, &loaded)?;
        let content = loaded.content()?;
        let named = |error: CaseError| Failure::BadInput(format!("{}: {error}", loaded.name));
        let (runner, hull) = loaded.case.runner(&loaded.base).map_err(named)?;
        let base = loaded.case.problem_of(runner.clone(), &loaded.base);
        let base = base.map_err(named)?;
        for warning in loaded.hull_warnings(hull.as_ref()) {
            watch.warn(&warning);
        }
        let own = loaded.case.accuracy.p_max;
        let asked = if wanted.plan.is_fixed() {
            own
        } else {
            own.min(0.5 * wanted.plan.interpolation)
        };
        Ok(Solver {
            tolerance: wanted.p_max.unwrap_or(asked),
            loaded,
            base,
            runner,
            hull,
            content,
        })
    }

    /// Relative error of the peak pressure that every point is asked for.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The case.
    pub fn case(&self) -> serde_json::Value {
        case_json(&self.loaded.case)
    }

    /// Every file that the table is made from: the table's own, the case and what it names.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where a hull that names further files cannot be read.
    pub fn inputs(&self, wanted: &Wanted) -> Result<Vec<PathBuf>, Failure> {
        let files = self.loaded.files()?;
        let mut inputs: Vec<PathBuf> = files.into_iter().map(|(_, path)| path).collect();
        inputs.extend([wanted.path.clone(), wanted.case.clone()]);
        Ok(inputs)
    }

    /// What every result belongs to: this version, the case with the content of its files, and the tolerance.
    pub fn origin(&self) -> Origin {
        // Load and track are replaced point by point: they are no part of what the results have in common.
        let mut case = self.loaded.case.clone();
        case.load.fz_n = 1.0;
        case.track = Default::default();
        case.accuracy.p_max = self.tolerance;
        case.runner.hull = None;
        case.runner.mesh = None;
        case.ice.surface = None;
        if let Some(section) = &mut case.runner.section {
            section.profile = None;
        }
        if let Some(sliding) = &mut case.sliding {
            sliding.previous = None;
        }
        let marks = format!("{}\n{}", case_json(&case), self.content);
        Origin {
            version: env!("CARGO_PKG_VERSION").into(),
            case_sha256: sha256(marks.as_bytes()),
        }
    }

    /// Points that differ in speed alone.
    fn solve(&self, points: &[Point], watch: &Watch) -> Vec<Result<Solved, SolveError>> {
        if self.loaded.case.sliding.is_some() {
            return self.slide(points, watch);
        }
        let solved = points.iter().map(|point| self.press(point, watch));
        solved.collect()
    }

    fn press(&self, point: &Point, watch: &Watch) -> Result<Solved, SolveError> {
        if watch.stopped() {
            return Err(SolveError::Interrupted);
        }
        let mut problem = match point.rocker_radius {
            None => self.base.clone(),
            Some(radius) => with_rocker(&self.loaded.case, radius).problem(&self.loaded.base)?,
        };
        problem.track_curvature = point.curvature;
        if let Load::Force { fz, .. } = &mut problem.load {
            *fz = point.fz;
        }
        let options = Options {
            p_max_tolerance: self.tolerance,
            ..self.loaded.case.options()
        };
        let solution = best(&problem, &options)?;
        self.loaded.fine_enough(self.hull.as_ref(), &solution)?;
        Ok(figures(&solution))
    }

    /// Solves what a store lacks of these points, telling how far it is; returns how many were solved.
    ///
    /// # Errors
    /// [`Failure::Partial`] where the watch stops it, [`Failure::NotConverged`] and [`Failure::BadInput`] with the point.
    pub fn solve_missing(
        &self,
        store: &Store,
        points: &[Point],
        label: &str,
        watch: &Watch,
    ) -> Result<usize, Failure> {
        let solved = AtomicUsize::new(0);
        let show = |n: usize| watch.progress(&format!("{label}: {n} of {} points", points.len()));
        show(0);
        let done = kufe_lut::solve_missing(store, points, |group| {
            let results = self.solve(group, watch);
            show(solved.fetch_add(results.len(), Ordering::Relaxed) + results.len());
            results
        });
        let done = done.map_err(|error| self.failure(store, error))?;
        for damage in &done.repaired {
            watch.warn(&format!("{damage}; solved again"));
        }
        Ok(done.solved)
    }

    fn failure(&self, store: &Store, error: SweepError<SolveError>) -> Failure {
        match error {
            SweepError::Solve {
                source: SolveError::Interrupted,
                ..
            } => Failure::Partial(format!(
                "interrupted; finished points are kept in {}, the same command resumes",
                store.folder().display()
            )),
            SweepError::Solve {
                point,
                source: SolveError::Contact(error),
            } => at_point(&point, self.loaded.failure(&error)),
            SweepError::Solve {
                point,
                source: SolveError::Failed(failure),
            } => at_point(&point, failure),
            other => Failure::bad_input(other),
        }
    }
}

/// Checks that the case is one at every end and value of the axes.
fn check_axes(wanted: &Wanted, loaded: &LoadedCase) -> Result<(), Failure> {
    let plan = &wanted.plan;
    let ends = |axis: &Spacing| match axis {
        Spacing::Values(values) => values.clone(),
        Spacing::Range { from, to } => vec![*from, *to],
    };
    let checked = |key: &str, case: Case| {
        case.check().map_err(|error| {
            Failure::BadInput(format!("{}: axes.{key}: {error}", wanted.path.display()))
        })
    };
    for fz in ends(&plan.fz) {
        let mut case = loaded.case.clone();
        case.load.fz_n = fz;
        checked("fz_n", case)?;
    }
    for curvature in ends(&plan.curvature) {
        let mut case = loaded.case.clone();
        case.track = TrackTable {
            curvature_1pm: Some(curvature),
            ..TrackTable::default()
        };
        checked("curvature_1pm", case)?;
    }
    for radius in plan.rocker_radius.iter().flat_map(ends) {
        checked("rocker_radius_m", with_rocker(&loaded.case, radius))?;
    }
    let Some(sliding) = &loaded.case.sliding else {
        return Ok(());
    };
    let told = |key: &str, slides: Result<LoadedCase, Failure>| match slides {
        Ok(_) => Ok(()),
        Err(failure) => Err(Failure::BadInput(format!(
            "{}: axes.{key}: {failure}",
            wanted.path.display()
        ))),
    };
    for speed in plan.speed.iter().flat_map(ends) {
        told("v_mps", at(loaded, speed, sliding.ice_c))?;
    }
    for ice_c in plan.ice_c.iter().flat_map(ends) {
        told("ice_c", at(loaded, sliding.v_mps, ice_c))?;
    }
    Ok(())
}

/// A failure with the point that it happened at.
fn at_point(point: &Point, failure: Failure) -> Failure {
    match failure {
        Failure::NotConverged(text) => Failure::NotConverged(format!("{text}, at {point}")),
        Failure::BadInput(text) => Failure::BadInput(format!("{text}, at {point}")),
        other => other,
    }
}

/// The solution at this tolerance or, where the largest mesh does not reach it, the best one that there is.
///
/// Its `p_max_error` tells which of the two it is: a table without such points would be no table.
fn best(problem: &Problem, options: &Options) -> Result<Solution, kufe_contact::Error> {
    match kufe_contact::solve(problem, options) {
        Err(kufe_contact::Error::AccuracyNotReached { best, estimate, .. })
            if estimate < LARGEST_ERROR =>
        {
            Ok(*best)
        }
        other => other,
    }
}

/// The figures of a contact.
pub(crate) fn figures(solution: &Solution) -> Solved {
    Solved {
        p_max: solution.p_max,
        p_max_error: solution.p_max_error,
        p_mean: solution.p_mean,
        area: solution.area,
        length: solution.length,
        width: solution.width,
        approach: solution.approach,
        sliding: None,
    }
}

pub(crate) fn with_rocker(case: &Case, radius: f64) -> Case {
    let mut case = case.clone();
    if let Some(shape) = &mut case.runner.shape {
        *shape.rocker_radius_m() = radius;
    }
    case
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn paraboloid() -> Problem {
        let text = "[runner]\nshape = { kind = \"paraboloid\", rocker_radius_m = 30, section_radius_m = 0.005 }\n\
                    [ice]\nyoungs_modulus_pa = 9e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n[load]\nfz_n = 1000";
        let case = Case::parse(text).unwrap_or_else(|error| panic!("{error}"));
        case.problem(Path::new(""))
            .unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn a_point_short_of_its_tolerance_keeps_the_best_answer_with_its_error() {
        let asked = 1e-4;
        let small = Options {
            max_dofs: 100_000,
            p_max_tolerance: asked,
            ..Options::default()
        };
        let solution = best(&paraboloid(), &small).expect("an answer");
        let error = solution.p_max_error / solution.p_max;
        assert!(error > asked && error < LARGEST_ERROR, "{error}");
        // Hertz's peak of this contact.
        assert!((solution.p_max / 138.52e6 - 1.0).abs() < error);
    }

    #[test]
    fn a_point_that_no_mesh_comes_near_is_an_error() {
        let tiny = Options {
            max_dofs: 100,
            p_max_tolerance: 1e-4,
            ..Options::default()
        };
        assert!(matches!(
            best(&paraboloid(), &tiny),
            Err(kufe_contact::Error::AccuracyNotReached { .. })
        ));
    }
}
