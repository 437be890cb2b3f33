//! The contact solver of a sweep: solves points of one case.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::case::{Case, CaseError, FittedHull, TrackTable};
use kufe_contact::{Load, Options, Problem, Runner, Solution};
use kufe_files::sha256;
use kufe_lut::{AxisKind, Figures, Origin, Outside, Point, Solve, SweepResult, check_finite, each};

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::at;
use crate::jobs::table::anchors::Anchors;
use crate::jobs::table::best::{best, by_boundary_elements, figures};
use crate::jobs::table::points::PointStore;
use crate::jobs::table::spec::TableSpec;
use crate::jobs::watch::Watch;
use crate::results::CaseRecord;

/// Why a point has no result.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// The user stopped it.
    #[error("interrupted")]
    Interrupted,
    /// The solver's own error.
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
    /// The rules of the table's axes.
    outside: Vec<(AxisKind, Outside)>,
    anchors: Vec<Point>,
    anchored: OnceLock<Anchors>,
}

impl Solver {
    /// The solver for a table: its case, at the tolerance that the table requests.
    ///
    /// The tolerance is `accuracy.p_max` of the table's file; without it the case's own, and at
    /// most half of the requested interpolation error, so that refinement does not chase the
    /// solver's error.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the case cannot be had or has no rocker radius to sweep.
    pub fn new(spec: &TableSpec, watch: &Watch) -> Result<Solver, Failure> {
        let loaded = LoadedCase::read(&spec.case)?;
        if spec.plan.get(AxisKind::RockerRadius).is_some() && loaded.case.runner.shape.is_none() {
            return Err(Failure::BadInput(format!(
                "{}: axes.rocker_radius_m: the runner of {} is a hull, expected a shape with a rocker radius",
                spec.path.display(),
                spec.case.display()
            )));
        }
        if spec.plan.is_sliding() && loaded.case.sliding.is_none() {
            return Err(Failure::BadInput(format!(
                "{}: axes: {} has no [sliding]: expected a runner that slides where an axis is v_mps or ice_c",
                spec.path.display(),
                spec.case.display()
            )));
        }
        check_axes(spec, &loaded)?;
        let content = loaded.content()?;
        let named = |error: CaseError| Failure::BadInput(format!("{}: {error}", loaded.name));
        let found = loaded.case.runner(&loaded.base, loaded.hull.as_deref());
        let (runner, hull) = found.map_err(named)?;
        let base = loaded.case.problem_of(runner.clone(), &loaded.base);
        let base = base.map_err(named)?;
        for warning in loaded.hull_warnings(hull.as_ref()) {
            watch.warn(&warning);
        }
        let own = loaded.case.accuracy.p_max;
        let requested = if spec.plan.is_fixed() {
            own
        } else {
            own.min(0.5 * spec.plan.interpolation)
        };
        Ok(Solver {
            tolerance: spec.p_max.unwrap_or(requested),
            loaded,
            base,
            runner,
            hull,
            content,
            outside: spec.outside.clone(),
            anchors: spec.plan.anchors().map_err(Failure::bad_input)?,
            anchored: OnceLock::new(),
        })
    }

    /// Relative error of the peak pressure that is requested of every point.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Every file that the table is made from: the table's own, the case and what it names.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where a hull that names further files cannot be read.
    pub fn inputs(&self, spec: &TableSpec) -> Result<Vec<PathBuf>, Failure> {
        let files = self.loaded.files()?;
        let mut inputs: Vec<PathBuf> = files.into_iter().map(|(_, path)| path).collect();
        inputs.extend([spec.path.clone(), spec.case.clone()]);
        Ok(inputs)
    }

    /// The origin of every result: this version, the case with the content of its files, and the
    /// tolerance.
    ///
    /// # Errors
    /// None for a version that is made of letters, digits, dots and signs.
    pub fn origin(&self) -> Result<Origin, Failure> {
        // Load and track are replaced point by point: results do not have them in common.
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
        let marks = format!("{}\n{}", CaseRecord::of(&case), self.content);
        let version = env!("CARGO_PKG_VERSION").into();
        Origin::new(version, sha256(marks.as_bytes())).map_err(Failure::bad_input)
    }

    /// Points that differ in speed alone.
    fn solve(&self, points: &[Point], watch: &Watch) -> Vec<Result<Figures, SolveError>> {
        if self.loaded.case.sliding.is_some() {
            return self.slide(points, watch);
        }
        let solved = points.iter().map(|point| self.press(point, watch));
        solved.collect()
    }

    fn press(&self, point: &Point, watch: &Watch) -> Result<Figures, SolveError> {
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

    /// Solves the plan's anchors, once.
    ///
    /// A runner that slides has none.
    fn anchor(&self, store: &PointStore, watch: &Watch) -> Result<(), Failure> {
        if self.anchored.get().is_some() || self.loaded.case.sliding.is_some() {
            return Ok(());
        }
        let failed = |point, error| self.failure(store, &point, error);
        let problem = |point: &Point| {
            let problem = self.problem(point);
            Ok((*point, problem.map_err(|error| failed(*point, error))?))
        };
        let points: Result<Vec<_>, Failure> = self.anchors.iter().map(problem).collect();
        let solve = |problem: &Problem| self.solution(problem, watch);
        let anchors = Anchors::at(points?, self.tolerance, solve);
        let anchors = anchors.map_err(|(point, error)| failed(point, error))?;
        self.anchored.get_or_init(|| anchors);
        Ok(())
    }

    /// Solves the points that have no result in the store, in parallel, and stores each as soon as
    /// it is solved; reports progress, and returns how many were solved.
    ///
    /// Points that differ in speed alone are solved together, since they have their groove in
    /// common. A group that fails does not keep the others from being solved and stored; after a
    /// point that cannot be stored no further group is begun.
    ///
    /// # Errors
    /// [`Failure::Partial`] where the watch stops it, [`Failure::NotConverged`] and
    /// [`Failure::BadInput`] with the first failed point.
    pub fn solve_missing(
        &self,
        store: &PointStore,
        points: &[Point],
        label: &str,
        watch: &Watch,
    ) -> Result<usize, Failure> {
        let missing = points.iter().filter(|point| store.get(point).is_none());
        let groups = groups(missing);
        if !groups.is_empty() {
            self.anchor(store, watch)?;
        }
        let solved = AtomicUsize::new(0);
        let show = |n: usize| watch.progress(&format!("{label}: {n} of {} points", points.len()));
        show(0);
        let broken = AtomicBool::new(false);
        let outcomes = each(&groups, |group| {
            if broken.load(Ordering::Relaxed) {
                return Ok(0);
            }
            let results = self.solve(group, watch);
            show(solved.fetch_add(results.len(), Ordering::Relaxed) + results.len());
            let count = results.len();
            for (&point, result) in group.iter().zip(results) {
                let figures = result.map_err(|error| self.failure(store, &point, error))?;
                check_finite(&point, &figures).map_err(Failure::bad_input)?;
                let stored = store.append(&Solve { point, figures });
                broken.fetch_or(stored.is_err(), Ordering::Relaxed);
                stored?;
            }
            Ok(count)
        });
        outcomes.into_iter().sum()
    }

    /// The table of a finished sweep, with its case, origin and rules.
    ///
    /// # Errors
    /// As [`origin`](Self::origin).
    pub fn finished(&self, mut swept: SweepResult) -> Result<SweepResult, Failure> {
        swept.table.case = CaseRecord::of(&self.loaded.case).to_string();
        swept.table.origin = self.origin()?;
        let rules = self.outside.iter();
        swept.table = rules.fold(swept.table, |table, &(kind, rule)| {
            table.with_outside(kind, rule)
        });
        Ok(swept)
    }

    fn failure(&self, store: &PointStore, point: &Point, error: SolveError) -> Failure {
        match error {
            SolveError::Interrupted => Failure::Partial(format!(
                "interrupted; finished points are stored in {}, the same command resumes",
                store.path().display()
            )),
            SolveError::Contact(error) => at_point(point, self.loaded.failure(&error)),
            SolveError::Failed(failure) => at_point(point, failure),
            SolveError::Case(error) => Failure::BadInput(format!("{point}: {error}")),
        }
    }
}

/// Points that differ in speed alone, together, in the order of their first ones.
fn groups<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<Vec<Point>> {
    let mut groups: Vec<Vec<Point>> = Vec::new();
    let mut places: HashMap<String, usize> = HashMap::new();
    for &point in points {
        let alike = Point {
            speed: None,
            ..point
        };
        let place = *places.entry(alike.to_string()).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[place].push(point);
    }
    groups
}

/// Checks that the case is one at every end and value of the axes.
fn check_axes(spec: &TableSpec, loaded: &LoadedCase) -> Result<(), Failure> {
    let failed = |kind: AxisKind, reason: String| {
        let path = spec.path.display();
        Failure::BadInput(format!("{path}: axes.{}: {reason}", kind.key()))
    };
    for kind in AxisKind::ALL {
        for value in spec.plan.get(kind).iter().flat_map(|axis| axis.ends()) {
            let checked = match (kind, &loaded.case.sliding) {
                (AxisKind::Speed, Some(sliding)) => {
                    let slides = at(loaded, value, sliding.ice_c);
                    slides.map(|_| ()).map_err(|error| error.to_string())
                }
                (AxisKind::IceTemperature, Some(sliding)) => {
                    let slides = at(loaded, sliding.v_mps, value);
                    slides.map(|_| ()).map_err(|error| error.to_string())
                }
                _ => {
                    let mut case = loaded.case.clone();
                    match kind {
                        AxisKind::Fz => case.load.fz_n = value,
                        AxisKind::RockerRadius => case = with_rocker(&case, value),
                        _ => case.track = track(value),
                    }
                    case.check().map_err(|error| error.to_string())
                }
            };
            checked.map_err(|reason| failed(kind, reason))?;
        }
    }
    Ok(())
}

/// A track of this curvature [1/m].
pub(crate) fn track(curvature: f64) -> TrackTable {
    TrackTable {
        curvature_1pm: Some(curvature),
        ..TrackTable::default()
    }
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
