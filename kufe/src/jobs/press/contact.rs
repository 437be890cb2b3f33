//! Solution of one contact problem with its checks and warnings; the prepared runner that several
//! problems share.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use kufe_contact::{CentreLine, Error, Options, Problem, Runner, RunnerLoads, Solution};
use kufe_contact::{boundary_elements_to_compare, centre_line, runner_loads, solve};
use kufe_mesh::Underside;

use crate::case::{Case, FittedHull, IceTable, LoadTable, RunnerTable, SlidingTable, TrackTable};
use crate::jobs::case_file::{LoadedCase, depth, patch};
use crate::jobs::failure::Failure;
use crate::jobs::press::check::Check;
use crate::jobs::press::hull_error::{
    HullError, bootstrap_scans, in_hole, noise_error, spacing_error,
};
use crate::jobs::slide::{SolvedSliding, solve_sliding};
use crate::jobs::watch::Watch;
use crate::plot::{percent, quantity};
use crate::results::{
    AsperitiesResult, CaseRecord, CheckResult, ContactResult, HullFit, Measured, MeshResult,
    PeakPressure, RunnerResult, ShearResult, SubsurfaceResult,
};

/// Pressure at which ice near 0 degrees Celsius begins to yield in indentation tests [Pa].
const ICE_STRENGTH: f64 = 10e6;

/// One contact problem, built step by step or from a case.
///
/// ```
/// use kufe::Contact;
/// use kufe::case::{IceTable, Shape};
/// let runner = Shape::Paraboloid { rocker_radius_m: 30.0, section_radius_m: 0.005 };
/// let ice = IceTable::half_space(9.0e9, 0.33);
/// let result = Contact::new(runner, ice).load(1000.0).solve()?.result();
/// // Hertz: 138.52 MPa.
/// assert!((result.p_max.value / 138.52e6 - 1.0).abs() < 0.01);
/// # Ok::<(), kufe::jobs::Failure>(())
/// ```
#[derive(Clone)]
pub struct Contact {
    loaded: LoadedCase,
    options: Options,
}

impl From<LoadedCase> for Contact {
    fn from(loaded: LoadedCase) -> Self {
        Contact {
            loaded,
            options: Options::default(),
        }
    }
}

impl Contact {
    /// A runner on ice on a straight track, under 1000 N and free to tilt.
    pub fn new(runner: impl Into<RunnerTable>, ice: IceTable) -> Self {
        let load = LoadTable {
            fz_n: 1000.0,
            ..LoadTable::default()
        };
        let case = Case {
            runner: runner.into(),
            ice,
            load,
            track: Default::default(),
            sliding: None,
            accuracy: Default::default(),
            solver: Default::default(),
            effects: Default::default(),
        };
        Contact::from(LoadedCase {
            name: "the contact".into(),
            base: PathBuf::new(),
            case,
            hull: None,
        })
    }

    /// Sets the normal force [N].
    #[must_use]
    pub fn load(mut self, fz_n: f64) -> Self {
        self.loaded.case.load.fz_n = fz_n;
        self
    }

    /// Sets the radius of the track in the vertical plane, positive in a valley [m].
    #[must_use]
    pub fn track_radius(mut self, radius_m: f64) -> Self {
        self.loaded.case.track = TrackTable {
            radius_m: Some(radius_m),
            curvature_1pm: None,
        };
        self
    }

    /// Lets the runner slide at a speed [m/s] on ice of a temperature [C].
    #[must_use]
    pub fn sliding(mut self, v_mps: f64, ice_c: f64) -> Self {
        self.loaded.case.sliding = Some(SlidingTable {
            v_mps,
            ice_c,
            ..SlidingTable::default()
        });
        self
    }

    /// Sets the requested relative error of the peak pressure.
    #[must_use]
    pub fn accuracy(mut self, p_max: f64) -> Self {
        self.loaded.case.accuracy.p_max = p_max;
        self
    }

    /// Sets limits and callbacks of the solver; accuracy and stiffness are taken from the case.
    #[must_use]
    pub fn options(mut self, options: Options) -> Self {
        self.options = options;
        self
    }

    /// The solution, to the requested accuracy.
    ///
    /// # Errors
    /// As [`best`](Self::best); [`Failure::NotConverged`] if the accuracy is not reached.
    pub fn solve(self) -> Result<SolvedContact, Failure> {
        let mut solved = self.best(&Watch::default())?;
        solved.short.take().map_or(Ok(solved), Err)
    }

    /// The best solution: where the accuracy is not reached, [`SolvedContact::short`] is the
    /// reason.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for the case and a hull that is too coarse for its load,
    /// [`Failure::NotConverged`] if there is no solution, [`Failure::Partial`] if it was
    /// stopped.
    pub fn best(self, watch: &Watch) -> Result<SolvedContact, Failure> {
        let Contact { loaded, options } = self;
        let prepared = Prepared::of(&loaded, watch)?;
        press_prepared(loaded, &prepared, watch, options)
    }
}

/// A solved case with its checks and warnings.
pub struct SolvedContact {
    /// The case.
    pub loaded: LoadedCase,
    /// The problem of the case.
    pub problem: Problem,
    /// The hull, where the case names one.
    pub hull: Option<FittedHull>,
    /// The solution of the problem.
    pub solution: Solution,
    /// Stress and mount loads of an elastic runner.
    pub runner: Option<RunnerLoads>,
    /// 95 % bound of the errors due to noise of the hull's vertices or the mesh's nodes; `None`
    /// without noise, or where it could not be estimated.
    pub noise_error: Option<HullError>,
    /// Errors due to the spacing of a hull's vertices or a mesh's nodes; `None` for a sliding
    /// runner.
    pub spacing_error: Option<HullError>,
    /// The stress under the peak, where [`Options::subsurface`] requests it.
    pub line: Option<CentreLine>,
    /// The contact by boundary elements; `None` if the runner slides.
    pub check: Option<Check>,
    /// Groove, film and friction, where the case slides.
    pub sliding: Option<SolvedSliding>,
    /// Wall time of the solve [s].
    pub seconds: f64,
    /// Why the requested accuracy was not reached; the solution is then the best one, with its
    /// error. `None` if it was reached.
    pub short: Option<Failure>,
    /// The content of the case's files: [`LoadedCase::content`].
    pub content: String,
    /// Warnings and remarks.
    pub warnings: Vec<String>,
}

/// A case's runner with its files read and its hull fitted. Cases that differ only in load, track
/// and tilt share one.
pub struct Prepared {
    /// The content of the case's files: [`LoadedCase::content`].
    pub(crate) content: String,
    pub(crate) runner: Runner,
    /// The hull, where the case names one.
    pub(crate) hull: Option<FittedHull>,
    /// Undersides fitted to simulated scans with the hull's noise, computed on first use.
    scans: OnceLock<Option<Vec<Arc<dyn Underside>>>>,
}

impl Prepared {
    /// Reads the case's files and fits its hull.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the hull cannot be obtained, or the case is out of range.
    pub fn of(loaded: &LoadedCase, watch: &Watch) -> Result<Self, Failure> {
        let content = loaded.content()?;
        if loaded.case.runner.hull.is_some() || loaded.case.runner.mesh.is_some() {
            watch.progress("reading the hull and fitting its underside");
        }
        let runner = loaded.case.runner(&loaded.base, loaded.hull.as_deref());
        let (runner, hull) = loaded.valid(runner)?;
        Ok(Prepared {
            content,
            runner,
            hull,
            scans: OnceLock::new(),
        })
    }

    /// The problem of a case with this runner.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the case is out of range.
    pub fn problem(&self, loaded: &LoadedCase) -> Result<Problem, Failure> {
        loaded.valid(loaded.case.problem_of(self.runner.clone(), &loaded.base))
    }

    /// Simulated scans of the hull with its noise.
    fn scans(&self) -> Option<&[Arc<dyn Underside>]> {
        let scans = || bootstrap_scans(self.hull.as_ref()?);
        self.scans.get_or_init(scans).as_deref()
    }
}

/// As [`Contact::best`], with a runner that is read and fitted already.
///
/// # Errors
/// As [`Contact::best`].
pub fn press_prepared(
    loaded: LoadedCase,
    prepared: &Prepared,
    watch: &Watch,
    options: Options,
) -> Result<SolvedContact, Failure> {
    let problem = prepared.problem(&loaded)?;
    let hull = prepared.hull.as_ref();
    let mut warnings = loaded.hull_warnings(hull, watch);
    let started = Instant::now();
    let options = loaded.case.options_on(options);
    let (mut solution, sliding, mut short) = match &loaded.case.sliding {
        None => {
            let (solution, short) = best(&loaded, hull, &problem, &options)?;
            (solution, None, short)
        }
        Some(table) => {
            let (solution, slid, short) = solve_sliding(&loaded, table, &problem, &options)?;
            // The stated error of a sliding contact does not include that of the hull.
            loaded.fine_enough(hull, &solution)?;
            (solution, Some(slid), short)
        }
    };
    let seconds = started.elapsed().as_secs_f64();
    let requested = loaded.case.accuracy.p_max;
    let resting = hull.filter(|_| sliding.is_none());
    let noisy = hull.filter(|hull| hull.noise.found > 0.0);
    let by_spacing = resting
        .map(|hull| spacing_error(&problem, hull, patch(&solution.surface), depth(&solution)));
    // `scan` is present if there is noise, or if noise may be hidden between the vertices.
    let by_noise = resting.filter(|hull| hull.scan.is_some()).and_then(|_| {
        watch.progress("simulating scans, to see how far noise moves the peak");
        noise_error(&problem, || prepared.scans())
    });
    if let Some(hull) = resting {
        let errors = [by_noise, by_spacing].map(|by| by.map_or(0.0, |by| by.p_max));
        let error = errors[0].hypot(errors[1]);
        if error > requested {
            short.get_or_insert_with(|| loaded.peak_uncertain(hull, error));
        } else if noisy.is_some() && by_noise.is_none() {
            short.get_or_insert_with(|| loaded.noise_effect_unknown(hull.noise.found));
        }
    }
    let check = sliding.is_none().then(|| Check::of(&problem, &solution));
    let allowed = solution.p_max_error.max(requested * solution.p_max);
    let checked = check.as_ref().map(|check| check.widen(&mut solution));
    let mut differences = checked.unwrap_or_default();
    if short.is_none() && solution.p_max_error > allowed {
        let failure = Failure::NotConverged(differences.remove(0));
        short = Some(failure.within(&loaded.name));
    }
    // Not reported to `watch`: the command ends with this failure.
    let missed = short.iter();
    warnings.extend(missed.map(|why| format!("the requested accuracy was not reached: {why}")));
    let scanned = hull.filter(|_| loaded.case.runner.hull.is_some());
    let coarse = by_spacing.filter(|error| error.p_max > requested);
    let by_vertices = hull.and_then(|hull| match noisy {
        Some(_) => Some(noise_not_included(hull, &solution, by_noise)),
        None => undetected_noise(hull, by_noise, solution.approach),
    });
    let missed_scan = scanned.filter(|_| short.is_some());
    let remarks = [
        above_ice_strength(&problem, &solution),
        own_hexahedra(&loaded),
        by_vertices,
        coarse.map(|error| coarse_vertices(error, solution.approach)),
        scanned.and_then(|hull| at_rim(hull, &solution)),
        scanned.and_then(|hull| in_hole(hull, patch(&solution.surface))),
        missed_scan.and_then(|hull| loaded.turned(hull)),
    ];
    let deep = sliding.as_ref().and_then(SolvedSliding::too_deep);
    for warning in remarks.into_iter().flatten().chain(differences).chain(deep) {
        watch.warn(&warning);
        warnings.push(warning);
    }
    let line = options.subsurface.then(|| centre_line(&solution));
    Ok(SolvedContact {
        line: line.transpose().map_err(Failure::bad_input)?.flatten(),
        runner: loaded.solved(runner_loads(&problem, &solution))?,
        loaded,
        problem,
        hull: hull.cloned(),
        noise_error: by_noise,
        spacing_error: by_spacing,
        solution,
        check,
        sliding,
        seconds,
        short,
        content: prepared.content.clone(),
        warnings,
    })
}

/// The best solution of a contact at rest, and why it is short of the requested accuracy. Without
/// a solution, boundary elements estimate the contact, to report a hull that is too coarse for its
/// load.
fn best(
    loaded: &LoadedCase,
    hull: Option<&FittedHull>,
    problem: &Problem,
    options: &Options,
) -> Result<(Solution, Option<Failure>), Failure> {
    let error = match solve(problem, options) {
        Ok(solution) => return Ok((solution, None)),
        Err(error) => error,
    };
    let failure = loaded.failure(&error);
    match error {
        Error::AccuracyNotReached { best, .. } => return Ok((*best, Some(failure))),
        Error::Stopped => return Err(failure),
        _ => {}
    }
    if let Ok(estimate) = boundary_elements_to_compare(problem) {
        loaded.fine_within(hull, estimate.approach, estimate.patch)?;
    }
    Err(failure)
}

/// A warning where the elastic peak is above the strength of ice.
fn above_ice_strength(problem: &Problem, solution: &Solution) -> Option<String> {
    (problem.ice.hardness.is_none() && solution.p_max > ICE_STRENGTH).then(|| {
        format!(
            "the peak of {} is above 10 MPa, and ice near 0 °C yields at 10 to 30 MPa: use this linear elastic result to \
             compare runners, or bound the pressure with ice.hardness_pa",
            quantity(solution.p_max, "Pa")
        )
    })
}

/// The remark that a runner mesh given by `runner.mesh` is not refined.
fn own_hexahedra(loaded: &LoadedCase) -> Option<String> {
    loaded.case.runner.mesh.is_some().then(|| {
        "the runner's own hexahedra are not refined: the stated errors include the discretisation error of hexahedra of their size under a \
         smooth contact; finer ones there lower them"
            .into()
    })
}

/// The warning that only the stated error of the peak includes the noise of vertices or nodes.
fn noise_not_included(hull: &FittedHull, solution: &Solution, error: Option<HullError>) -> String {
    let residual = hull.underside.quality().residual_rms;
    let moved = match error {
        Some(error) => format!(
            "in 95 of 100 such scans it moves the peak by less than {} (p_max_noise_pa), which the peak's error includes, and the \
             approach by less than {} (approach_noise_m); the other stated errors do not include it",
            percent(error.p_max),
            percent(error.approach / solution.approach)
        ),
        None => "no stated error includes it".into(),
    };
    format!(
        "the hull's vertices have noise of {}, and lie {} from the fit through them, {} of the approach: {moved}",
        quantity(hull.noise.found, "m"),
        quantity(residual, "m"),
        percent(residual / solution.approach)
    )
}

/// The warning that a hull may have noise which its vertices do not show.
fn undetected_noise(hull: &FittedHull, error: Option<HullError>, approach: f64) -> Option<String> {
    let error = error?;
    Some(format!(
        "noise of up to {} does not show between vertices so far apart; so much moves the peak by less than {} in 95 of 100 scans \
         (p_max_noise_pa), the approach by less than {} (approach_noise_m); runner.noise_m = 0 states that there is none",
        quantity(hull.noise.unseen, "m"),
        percent(error.p_max),
        percent(error.approach / approach)
    ))
}

/// The warning that the spacing of the vertices causes a larger error than requested.
fn coarse_vertices(error: HullError, approach: f64) -> String {
    format!(
        "the distances of the hull's vertices leave the peak uncertain by up to {} (p_max_hull_pa), which its error includes, and the \
         approach by {} (approach_hull_m), which its error does not include; vertices closer together lower that",
        percent(error.p_max),
        percent(error.approach / approach)
    )
}

/// The warning that the contact reaches the rim of an open hull, beyond which nothing was scanned.
fn at_rim(hull: &FittedHull, solution: &Solution) -> Option<String> {
    const MARGIN: f64 = 0.1;
    if hull.report.open_edges == 0 {
        return None;
    }
    let [x0, x1, y0, y1] = patch(&solution.surface);
    let [along, across] = [MARGIN * (x1 - x0), MARGIN * (y1 - y0)];
    let middle = [0.5 * (x0 + x1), 0.5 * (y0 + y1)];
    let sides = [
        ("rear, x", x0, [x0 - along, middle[1]]),
        ("front, x", x1, [x1 + along, middle[1]]),
        ("right, y", y0, [middle[0], y0 - across]),
        ("left, y", y1, [middle[0], y1 + across]),
    ];
    let reached = sides.into_iter().filter_map(|(side, end, [x, y])| {
        let outside = hull.underside.height(x, y).is_infinite();
        outside.then(|| format!("{side} = {}", quantity(end, "m")))
    });
    let reached: Vec<String> = reached.collect();
    (!reached.is_empty()).then(|| {
        format!(
            "the contact reaches the rim of what was scanned ({}): its pressure there is that of the rim; scan farther, or correct yaw, pitch \
             and roll (`kufe hull check`)",
            reached.join("; ")
        )
    })
}

impl SolvedContact {
    /// The peak pressure with the sum of its errors: discretisation, and noise and spacing of a
    /// hull's vertices.
    pub(crate) fn peak(&self) -> Measured<PeakPressure> {
        let by_hull = [self.noise_error, self.spacing_error];
        let by_hull = by_hull.into_iter().flatten().map(|error| error.p_max);
        let solution = &self.solution;
        let error = solution.p_max_error + solution.p_max * by_hull.sum::<f64>();
        Measured::new(solution.p_max, error)
    }

    /// The document of the contact, without the figures that are computed from exported files.
    pub fn result(&self) -> ContactResult {
        let solution = &self.solution;
        let check = self.check.as_ref();
        let second = check.and_then(|check| Some((check.found.as_ref().ok()?, check.seconds)));
        let reason = check.and_then(|check| check.found.as_ref().err());
        let (noise, spacing) = (self.noise_error, self.spacing_error);
        let by_surface = solution.volume.is_none();
        let asperities = by_surface.then(|| solution.surface.asperities());
        let history = solution.history.chunk_by(|a, b| a.level == b.level);
        ContactResult {
            p_max: self.peak(),
            p_max_discretisation_pa: noise.or(spacing).map(|_| solution.p_max_error),
            p_max_noise_pa: noise.map(|error| error.p_max * solution.p_max),
            p_max_hull_pa: spacing.map(|error| error.p_max * solution.p_max),
            p_max_mesh_pa: solution.p_max_mesh,
            p_max_map_pa: None,
            stress_max_pa: None,
            accuracy_asked: self.loaded.case.accuracy.p_max,
            accuracy_reached: self.short.is_none(),
            check: second.map(|(bem, check_seconds)| CheckResult {
                p_max: Measured::new(bem.p_max, bem.p_max_error),
                approach: Measured::new(bem.approach, bem.approach_error),
                check_seconds,
            }),
            check_absent: reason.map(ToString::to_string),
            p_mean: Measured::new(solution.p_mean, solution.p_mean_error),
            area: Measured::new(solution.area, solution.area_error),
            length: Measured::new(solution.length, solution.length_error),
            width: Measured::new(solution.width, solution.width_error),
            approach: Measured::new(solution.approach, solution.approach_error),
            approach_noise_m: noise.map(|error| error.approach),
            approach_hull_m: spacing.map(|error| error.approach),
            pitch: Measured::new(solution.pitch, solution.pitch_error),
            roll: Measured::new(solution.roll, solution.roll_error),
            fz_n: solution.fz,
            runner: self.runner.as_ref().map(RunnerResult::from),
            asperities: asperities.map(|found| AsperitiesResult::of(&found)),
            kkt_residual: solution.kkt_residual,
            stiffness: match &solution.volume {
                None => "boundary elements".into(),
                Some(_) if solution.assembled.is_empty() => "matrix-free".into(),
                Some(_) => "assembled".into(),
            },
            symmetry: solution.symmetry,
            dofs: solution.dofs,
            iterations: solution.iterations,
            seconds: self.seconds,
            peak_memory_bytes: peak_memory(),
            version: env!("CARGO_PKG_VERSION").into(),
            content_sha256: self.content.clone(),
            hull_fit: self.hull.as_ref().map(|hull| {
                let quality = hull.underside.quality();
                HullFit {
                    residual_rms_m: quality.residual_rms,
                    residual_max_m: quality.residual_max,
                    resolution_error_m: quality.resolution_error,
                    residual_over_approach: quality.residual_rms / solution.approach,
                    vertices: quality.vertices,
                    noise_m: hull.noise.found,
                    unseen_noise_m: hull.noise.unseen,
                }
            }),
            warnings: self.warnings.clone(),
            history: history.filter_map(MeshResult::of).collect(),
            case: CaseRecord::of(&self.loaded.case),
            sliding: self.sliding.as_ref().map(|sliding| sliding.result()),
            subsurface: self.line.as_ref().map(|line| SubsurfaceResult {
                x_m: line.at[0],
                y_m: line.at[1],
                shear: ShearResult::of(solution),
                max_shear_mesh_pa: line.largest_shear().map(|largest| largest.value),
            }),
        }
    }
}

impl From<&RunnerLoads> for RunnerResult {
    fn from(loads: &RunnerLoads) -> Self {
        RunnerResult {
            runner_von_mises_max_pa: loads.von_mises,
            runner_von_mises_at_m: loads.at,
            mounts: loads.mounts.iter().map(Into::into).collect(),
        }
    }
}

/// Largest resident memory of this process so far, where the system reports it [bytes].
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}
