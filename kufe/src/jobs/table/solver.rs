//! The contact solver as a sweep sees it.

use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::case::{Case, CaseError, FittedHull, TrackTable};
use kufe_contact::{Load, Options, Problem, Runner, Solution};
use kufe_lut::{Origin, Point, Solved, Spacing, Store, SweepError, sha256};

use crate::jobs::case_file::LoadedCase;
use crate::jobs::case_json::case_json;
use crate::jobs::failure::Failure;
use crate::jobs::slide::at;
use crate::jobs::table::anchors::Anchors;
use crate::jobs::table::best::{best, by_boundary_elements, figures};
use crate::jobs::table::wanted::Wanted;
use crate::jobs::watch::Watch;

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
    anchors: Vec<Point>,
    anchored: OnceLock<Anchors>,
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
            anchors: wanted.plan.anchors().map_err(Failure::bad_input)?,
            anchored: OnceLock::new(),
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
        let anchors = self.anchored.get_or_init(Anchors::none);
        if let Some(solved) = anchors.figures(point) {
            return Ok(solved);
        }
        let problem = self.problem(point)?;
        if let Some(found) = anchors.answer(&problem) {
            let hull = self.hull.as_ref();
            self.loaded.fine_within(hull, found.approach, found.patch)?;
            return Ok(by_boundary_elements(point, &found));
        }
        Ok(figures(&self.solution(&problem, watch)?))
    }

    /// What is pressed at a point.
    fn problem(&self, point: &Point) -> Result<Problem, SolveError> {
        let mut problem = match point.rocker_radius {
            None => self.base.clone(),
            Some(radius) => with_rocker(&self.loaded.case, radius).problem(&self.loaded.base)?,
        };
        problem.track_curvature = point.curvature;
        if let Load::Force { fz, .. } = &mut problem.load {
            *fz = point.fz;
        }
        Ok(problem)
    }

    /// A contact by finite elements.
    fn solution(&self, problem: &Problem, watch: &Watch) -> Result<Solution, SolveError> {
        if watch.stopped() {
            return Err(SolveError::Interrupted);
        }
        let options = Options {
            p_max_tolerance: self.tolerance,
            ..self.loaded.case.options()
        };
        let solution = best(problem, &options)?;
        self.loaded.fine_enough(self.hull.as_ref(), &solution)?;
        Ok(solution)
    }

    /// Solves the plan's anchors, once, where anything is left that they serve.
    ///
    /// A runner that slides has none.
    fn anchor(&self, store: &Store, watch: &Watch) -> Result<(), Failure> {
        if self.anchored.get().is_some() || self.loaded.case.sliding.is_some() {
            return Ok(());
        }
        let told = |point, source| self.failure(store, SweepError::Solve { point, source });
        let problem = |point: &Point| {
            let problem = self.problem(point);
            Ok((*point, problem.map_err(|error| told(*point, error))?))
        };
        let points: Result<Vec<_>, Failure> = self.anchors.iter().map(problem).collect();
        let solve = |problem: &Problem| self.solution(problem, watch);
        let anchors = Anchors::at(points?, self.tolerance, solve);
        let anchors = anchors.map_err(|(point, error)| told(point, error))?;
        self.anchored.get_or_init(|| anchors);
        Ok(())
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
        // A point that cannot be read is one to be solved.
        let left = |point: &Point| !matches!(store.get(point), Ok(Some(_)));
        if points.iter().any(left) {
            self.anchor(store, watch)?;
        }
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

pub(crate) fn with_rocker(case: &Case, radius: f64) -> Case {
    let mut case = case.clone();
    if let Some(shape) = &mut case.runner.shape {
        *shape.rocker_radius_m() = radius;
    }
    case
}
