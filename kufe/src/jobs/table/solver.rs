//! Solves the points of a sweep for one case, and fills a table with the results.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use indexmap::IndexMap;
use kufe_contact::{
    BoundaryElements, Load, Options, Problem, Solution, VerifiedBem, boundary_elements,
};
use kufe_files::sha256;
use kufe_lut::{
    AxisKind, Figures, Method, Origin, Outside, Point, Progress, Quantity, Solve, SweepResult,
    check_finite, each, replay,
};

use crate::case::TrackTable;
use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::press::Prepared;
use crate::jobs::slide::{
    Ploughing, SolvedGroove, conditions, film_along, sliding_table, with_speed_and_temperature,
};
use crate::jobs::table::points::{Key, PointStore, key};
use crate::jobs::table::spec::TableSpec;
use crate::jobs::watch::Watch;
use crate::results::{CaseRecord, Friction};

/// Relative error of the peak pressure up to which a point that misses its tolerance is accepted.
const MAX_RELATIVE_ERROR: f64 = 0.2;

/// Solves points of one case.
pub struct Solver {
    loaded: LoadedCase,
    prepared: Prepared,
    /// The problem of the case, with the load and the track that it states.
    base: Problem,
    tolerance: f64,
    /// The rules of the axes for inputs outside.
    outside: Vec<(AxisKind, Outside)>,
    /// The points at the ends of the plan's axes.
    ends: Vec<Point>,
    anchors: OnceLock<Anchors>,
}

/// Verification of the boundary elements by finite elements at the ends of the axes.
#[derive(Debug, Default)]
struct Anchors {
    /// The points at the ends, solved by finite elements; empty if all points are solved by finite
    /// elements.
    solved: Vec<(Point, Figures)>,
    verified: Option<VerifiedBem>,
}

impl Solver {
    /// The solver of a table, of the case `loaded`.
    ///
    /// The tolerance is `accuracy.p_max` of the table file. Without that key it is the tolerance of
    /// the case, and at most half of the requested interpolation error, so that no nodes are added
    /// because of the solver's error.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the case's hull cannot be obtained or an axis does not apply to it.
    pub fn new(spec: &TableSpec, loaded: LoadedCase, watch: &Watch) -> Result<Solver, Failure> {
        let case = &loaded.name;
        let refused = |reason: String| Err(Failure::in_file(&spec.path, reason));
        if spec.plan.get(AxisKind::RockerRadius).is_some() && loaded.case.runner.shape.is_none() {
            return refused(format!(
                "axes.rocker_radius_m: the runner of {case} is a hull, expected a shape with a rocker radius"
            ));
        }
        if spec.plan.is_sliding() && loaded.case.sliding.is_none() {
            return refused(format!(
                "axes: {case} has no [sliding]: expected a runner that slides where an axis is v_mps or ice_c"
            ));
        }
        check_axes(spec, &loaded)?;
        let prepared = Prepared::of(&loaded, watch)?;
        let base = prepared.problem(&loaded)?;
        loaded.hull_warnings(prepared.hull.as_ref(), watch);
        let mut requested = loaded.case.accuracy.p_max;
        if !spec.plan.is_fixed() {
            requested = requested.min(0.5 * spec.plan.interpolation);
        }
        Ok(Solver {
            tolerance: spec.p_max.unwrap_or(requested),
            loaded,
            prepared,
            base,
            outside: spec.outside.clone(),
            ends: spec.plan.anchors()?,
            anchors: OnceLock::new(),
        })
    }

    /// Requested relative error of the peak pressure at every point.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// All input files: the table file, the case file and the files that the case names.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if a hull that names further files cannot be read.
    pub fn inputs(&self, spec: &TableSpec) -> Result<Vec<PathBuf>, Failure> {
        let files = self.loaded.files()?.into_iter().map(|(_, path)| path);
        Ok(files
            .chain([spec.path.clone(), spec.case.clone()])
            .collect())
    }

    /// The origin of every result: the version of kufe and a checksum of the case, the content of
    /// its files and the tolerance.
    ///
    /// # Errors
    /// None, since the version consists of letters, digits, dots and signs.
    pub fn origin(&self) -> Result<Origin, Failure> {
        // Each point replaces load and track, so they are not part of the origin.
        let mut case = self.loaded.case.clone();
        case.load.fz_n = 1.0;
        case.track = TrackTable::default();
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
        let marks = format!("{}\n{}", CaseRecord::of(&case), self.prepared.content);
        let version = env!("CARGO_PKG_VERSION").into();
        Ok(Origin::new(version, sha256(marks.as_bytes()))?)
    }

    /// The contact at rest at a point.
    fn press(&self, point: &Point, watch: &Watch) -> Result<Figures, Failure> {
        watch.check()?;
        let anchors = self.anchors.get_or_init(Anchors::default);
        if let Some((_, solved)) = anchors.solved.iter().find(|(anchor, _)| anchor == point) {
            return Ok(*solved);
        }
        let problem = self.problem(point)?;
        if let Some(found) = anchors.verified.and_then(|bem| bem.answer(&problem)) {
            let hull = self.prepared.hull.as_ref();
            self.loaded.fine_within(hull, found.approach, found.patch)?;
            return Ok(by_boundary_elements(point, &found));
        }
        Ok(figures(&self.solution(&problem, watch)?))
    }

    /// The problem at a point.
    fn problem(&self, point: &Point) -> Result<Problem, Failure> {
        if point.rocker_radius.is_some() {
            let case = case_at(&self.loaded, point)?;
            return case.valid(case.case.problem(&case.base));
        }
        let mut problem = self.base.clone();
        problem.track_curvature = point.curvature;
        if let Load::Force { fz, .. } = &mut problem.load {
            *fz = point.fz;
        }
        Ok(problem)
    }

    /// Solves a contact by finite elements.
    fn solution(&self, problem: &Problem, watch: &Watch) -> Result<Solution, Failure> {
        watch.check()?;
        let options = Options {
            p_max_tolerance: self.tolerance,
            ..self.loaded.case.options()
        };
        let solution = self.loaded.solved(best(problem, &options))?;
        let hull = self.prepared.hull.as_ref();
        self.loaded.fine_enough(hull, &solution)?;
        Ok(solution)
    }

    /// Solves the points at the ends of the axes once; not for a case with `[sliding]`.
    fn anchor(&self, watch: &Watch) -> Result<(), Failure> {
        if self.anchors.get().is_some() || self.loaded.case.sliding.is_some() {
            return Ok(());
        }
        watch.progress("comparing boundary elements with finite elements at the table's corners");
        let problem = |point: &Point| self.problem(point).map_err(at_point(point));
        let problems = self.ends.iter().map(problem);
        let problems = problems.collect::<Result<Vec<Problem>, Failure>>()?;
        let mut anchors = Anchors::default();
        if problems
            .iter()
            .all(|problem| boundary_elements(problem).is_ok())
        {
            let ends: Vec<(&Point, Problem)> = self.ends.iter().zip(problems).collect();
            let solutions = each(&ends, |(point, problem)| {
                self.solution(problem, watch).map_err(at_point(point))
            });
            let solutions = solutions.into_iter().collect::<Result<Vec<_>, _>>()?;
            let solved = solutions.iter().map(figures);
            anchors.solved = self.ends.iter().copied().zip(solved).collect();
            let problems = ends.into_iter().map(|(_, problem)| problem);
            let pairs: Vec<(Problem, Solution)> = problems.zip(solutions).collect();
            anchors.verified = VerifiedBem::at(&pairs, self.tolerance);
        }
        self.anchors.get_or_init(|| anchors);
        Ok(())
    }

    /// Solves points that differ only in speed; stops after the first failure.
    fn slide(&self, points: &[Point], watch: &Watch) -> Vec<Result<Figures, Failure>> {
        // A hardness that depends on the contact time depends on the speed, so the groove is solved
        // for each point.
        let depends_on_speed = sliding_table(&self.loaded).hardness.is_some();
        let mut last: Option<SolvedGroove> = None;
        let mut solved = Vec::with_capacity(points.len());
        for point in points {
            let groove = last.take().filter(|_| !depends_on_speed);
            match groove.map_or_else(|| self.solved_groove(point, watch), Ok) {
                Ok(groove) => {
                    solved.push(self.film(&groove, point));
                    last = Some(groove);
                }
                Err(failure) => {
                    solved.push(Err(failure));
                    break;
                }
            }
        }
        solved
    }

    /// Solves the groove at a point.
    fn solved_groove(&self, point: &Point, watch: &Watch) -> Result<SolvedGroove, Failure> {
        watch.check()?;
        let case = case_at(&self.loaded, point)?;
        let runner = match point.rocker_radius {
            None => self.prepared.runner.clone(),
            Some(_) => case.valid(case.case.runner(&case.base, None))?.0,
        };
        let problem = case.valid(case.case.problem_of(runner, &case.base))?;
        let ploughing = Ploughing::new(&case, sliding_table(&case), &problem)?;
        let options = Options {
            p_max_tolerance: self.tolerance,
            ..case.case.options()
        };
        let groove = ploughing.groove(&options)?;
        // A groove that misses its tolerance is accepted with its error, as a contact at rest is.
        if let Some(short) = &groove.short
            && groove.solution.relative_error >= MAX_RELATIVE_ERROR
        {
            return Err(short.clone());
        }
        case.fine_enough(self.prepared.hull.as_ref(), &groove.solution.contact)?;
        Ok(groove)
    }

    /// The results with the water film of a groove at the speed of a point.
    fn film(&self, groove: &SolvedGroove, point: &Point) -> Result<Figures, Failure> {
        let case = case_at(&self.loaded, point)?;
        let solution = &groove.solution;
        let along = film_along(&case, solution, &conditions(sliding_table(&case)))?;
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

    /// Solves the points that have no result in the store in parallel, stores each result and
    /// reports progress. Returns how many were solved.
    ///
    /// Points that differ only in speed are solved together, since they share a groove. If a group
    /// fails, the others are still solved and stored. If a point cannot be stored, no further group
    /// is started.
    ///
    /// # Errors
    /// [`Failure::Partial`] if the watch stops the work, [`Failure::NotConverged`] and
    /// [`Failure::BadInput`] with the first failed point.
    pub fn solve_missing(
        &self,
        store: &PointStore,
        points: &[Point],
        label: &str,
        watch: &Watch,
    ) -> Result<usize, Failure> {
        let interrupted = |failure: Failure| match failure {
            Failure::Partial(_) if store.is_empty() => {
                Failure::Partial("interrupted before the first point was solved".into())
            }
            Failure::Partial(_) => Failure::Partial(format!(
                "interrupted; finished points are stored in {}, the same command resumes",
                store.path().display()
            )),
            other => other,
        };
        let missing = points.iter().filter(|point| store.get(point).is_none());
        let groups = groups(missing);
        if !groups.is_empty() {
            self.anchor(watch).map_err(interrupted)?;
        }
        let solved = AtomicUsize::new(0);
        let show = |n: usize| watch.progress(&format!("{label}: {n} of {} points", points.len()));
        show(0);
        let store_failed = AtomicBool::new(false);
        let outcomes = each(&groups, |group| {
            if store_failed.load(Ordering::Relaxed) {
                return Ok(0);
            }
            let results = match self.loaded.case.sliding {
                Some(_) => self.slide(group, watch),
                None => group.iter().map(|point| self.press(point, watch)).collect(),
            };
            let count = results.len();
            for (&point, result) in group.iter().zip(results) {
                let figures = result.map_err(at_point(&point)).map_err(interrupted)?;
                check_finite(&point, &figures)?;
                let stored = store.append(&Solve { point, figures });
                store_failed.fetch_or(stored.is_err(), Ordering::Relaxed);
                stored?;
                show(solved.fetch_add(1, Ordering::Relaxed) + 1);
            }
            Ok(count)
        });
        outcomes.into_iter().sum()
    }

    /// Adds the case, the origin and the rules of the axes to the table of a finished sweep.
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
}

/// A filled table and its points on disk, which are no longer needed once the table is written.
pub struct FilledTable {
    /// The table, and by how much its interpolation misses the requested accuracy.
    pub swept: SweepResult,
    /// Number of points solved by this call; the others were on disk.
    pub solves: usize,
    store: PointStore,
}

/// Solves every point that is not on disk yet. Points are stored in `OUT.points` until
/// [`FilledTable::clear`], so that the same call resumes after an interruption.
///
/// # Errors
/// [`Failure::BadInput`] for invalid files and cases, [`Failure::NotConverged`] if a contact misses
/// its accuracy by far, [`Failure::Partial`] if the watch stops the work.
pub fn fill(
    spec: &TableSpec,
    solver: &Solver,
    out: &Path,
    watch: &Watch,
) -> Result<FilledTable, Failure> {
    let mut path = out.as_os_str().to_owned();
    path.push(".points");
    let store = PointStore::of_file(Path::new(&path), solver.origin()?)?;
    for damage in store.damaged() {
        watch.warn(&format!("{damage}; its point is solved again"));
    }
    let mut solves = 0;
    let swept = loop {
        match replay(&spec.plan, |point| store.get(point))? {
            Progress::Finished(swept) => break solver.finished(*swept)?,
            Progress::Batch { points, round, .. } => {
                let label = format!("round {round}");
                solves += solver.solve_missing(&store, &points, &label, watch)?;
            }
        }
    };
    Ok(FilledTable {
        swept,
        solves,
        store,
    })
}

impl FilledTable {
    /// Removes the points on disk, once the table is written.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the file cannot be removed.
    pub fn clear(&self) -> Result<(), Failure> {
        self.store.remove()
    }
}

/// The solution at the tolerance of `options` or, if the largest mesh does not reach it, the best
/// available one, with its error in `p_max_error`. An error here would fail the whole table.
fn best(problem: &Problem, options: &Options) -> Result<Solution, kufe_contact::Error> {
    match kufe_contact::solve(problem, options) {
        Err(kufe_contact::Error::AccuracyNotReached { best, estimate, .. })
            if estimate < MAX_RELATIVE_ERROR =>
        {
            Ok(*best)
        }
        other => other,
    }
}

/// The results of a contact.
fn figures(found: &Solution) -> Figures {
    at_rest([
        [found.p_max, found.p_max_error],
        [found.p_mean, found.p_mean_error],
        [found.area, found.area_error],
        [found.length, found.length_error],
        [found.width, found.width_error],
        [found.approach, found.approach_error],
    ])
}

/// The results of a contact solved by boundary elements.
fn by_boundary_elements(point: &Point, found: &BoundaryElements) -> Figures {
    let p_mean = point.fz / found.area;
    let figures = at_rest([
        [found.p_max, found.p_max_error],
        [p_mean, p_mean * found.area_error / found.area],
        [found.area, found.area_error],
        [found.length, found.length_error],
        [found.width, found.width_error],
        [found.approach, found.approach_error],
    ]);
    figures.by(Method::BoundaryElements)
}

/// Results from the value and error of each of the first six quantities.
fn at_rest(pairs: [[f64; 2]; 6]) -> Figures {
    let figures = Figures::at_rest(pairs.map(|[value, _]| value));
    let errors = Quantity::ALL.into_iter().zip(pairs);
    errors.fold(figures, |figures, (quantity, [_, error])| {
        figures.with_error(quantity, error)
    })
}

/// The case with the load, track and sliding conditions of a point.
fn case_at(loaded: &LoadedCase, point: &Point) -> Result<LoadedCase, Failure> {
    let mut loaded = loaded.clone();
    loaded.case.load.fz_n = point.fz;
    loaded.case.track = TrackTable {
        curvature_1pm: Some(point.curvature),
        radius_m: None,
    };
    if let (Some(shape), Some(radius)) = (&mut loaded.case.runner.shape, point.rocker_radius) {
        *shape.rocker_radius_m() = radius;
    }
    if let Some(sliding) = &loaded.case.sliding {
        let speed = point.speed.unwrap_or(sliding.v_mps);
        let ice_c = point.ice_c.unwrap_or(sliding.ice_c);
        return with_speed_and_temperature(&loaded, speed, ice_c);
    }
    loaded.valid(loaded.case.check())?;
    Ok(loaded)
}

/// Checks that the case is valid, and has a runner, at every value, or at both ends, of each axis.
fn check_axes(spec: &TableSpec, loaded: &LoadedCase) -> Result<(), Failure> {
    let stated = Point {
        fz: loaded.case.load.fz_n,
        curvature: loaded.case.track.curvature(),
        ..Point::default()
    };
    for kind in AxisKind::ALL {
        for value in spec.plan.get(kind).iter().flat_map(|axis| axis.ends()) {
            let case = case_at(loaded, &stated.with(kind, value));
            let checked = case.and_then(|case| match kind {
                AxisKind::RockerRadius => case.valid(case.case.problem(&case.base)).map(|_| ()),
                _ => Ok(()),
            });
            let place = format_args!("axes.{} = {value}", kind.key());
            checked.map_err(|failure| failure.within(place).within(spec.path.display()))?;
        }
    }
    Ok(())
}

/// Groups points that differ only in speed, in the order of the first point of each group.
fn groups<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<Vec<Point>> {
    let mut groups: IndexMap<Key, Vec<Point>> = IndexMap::new();
    for &point in points {
        let without_speed = Point {
            speed: None,
            ..point
        };
        groups.entry(key(&without_speed)).or_default().push(point);
    }
    groups.into_values().collect()
}

/// Adds the point to the text of a failure.
fn at_point(point: &Point) -> impl Fn(Failure) -> Failure {
    move |mut failure| {
        *failure.text() += &format!(", at {point}");
        failure
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Case;
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
        let tolerance = 1e-4;
        let small = Options {
            max_dofs: 100_000,
            p_max_tolerance: tolerance,
            ..Options::default()
        };
        let solution = best(&paraboloid(), &small).expect("an answer");
        let error = solution.p_max_error / solution.p_max;
        assert!(error > tolerance && error < MAX_RELATIVE_ERROR, "{error}");
        // Hertz's peak of this contact.
        assert!((solution.p_max / 138.52e6 - 1.0).abs() < error);
    }

    #[test]
    fn a_point_that_every_mesh_misses_is_an_error() {
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
