//! The sequence of meshes of one sliding contact.

use crate::accuracy::answer::SolvedMesh;
use crate::accuracy::mesh_solve::Forces;
use crate::accuracy::watched::{Limits, ShearHistory};
use crate::grid::first_guess::{fitted, sliding_guess};
use crate::grid::grading::Resolution;
use crate::grid::patch::Patch;
use crate::groove::measures::{GrooveReading, Measures};
use crate::groove::on_mesh::{MeshContact, SlidingState, Start, WarmStart};
use crate::groove::plastic_contact::Kind;
use crate::groove::solution::{
    Coarser, Groove, GrooveProfile, Section, SlidingIterate, SlidingMesh, SlidingSolution,
};
use crate::mesh::discretise::{Discretisation, Reach};
use crate::problem::check::CheckedProblem;
use crate::result::pressure::{Field, Pressure};
use crate::solve::{add_tilt_error, check_answer};
use crate::symmetry::unfolded;
use crate::{Error, Measure, Options, Problem};

/// Resolution of the search for the patch.
const COARSE_MESH: Resolution = Resolution {
    cells: 6.0,
    growth: 0.7,
};
/// Largest number of solutions on the contact plane in the search for the patch.
const MAX_ROUNDS: usize = 30;
/// Refinement ratio of successive meshes, and the smallest one if the largest mesh allows no more.
const REFINEMENT: f64 = 1.5;
const MIN_REFINEMENT: f64 = 1.1;

/// The solution of a sliding contact on a sequence of meshes.
struct SlidingMeshes<'a> {
    checked: &'a CheckedProblem<'a>,
    before: Option<&'a GrooveProfile>,
    patch: Patch,
    start: Start,
}

/// Results of the meshes solved so far.
struct SlidingHistory {
    /// The last forces.
    forces: Forces,
    measures: Vec<Measures>,
    sections: Vec<Section>,
    coarser: Option<Coarser<Vec<Section>>>,
    under: ShearHistory,
    meshes: Vec<SlidingMesh>,
}

impl<'a> SlidingMeshes<'a> {
    /// The patch, found on the contact plane alone, and the forces on it.
    fn find_patch(
        checked: &'a CheckedProblem<'a>,
        before: Option<&'a GrooveProfile>,
    ) -> Result<(Self, Forces), Error> {
        let patch = sliding_guess(checked);
        let mut meshes = SlidingMeshes {
            start: Start::AtRest(patch.motion),
            checked,
            before,
            patch,
        };
        for _ in 0..MAX_ROUNDS {
            checked.options.check_stop()?;
            let mesh = checked.mesh(&meshes.patch, COARSE_MESH, Reach::WholeHull)?;
            let slid = meshes.on(&mesh).on_plane(&meshes.start)?;
            let guessed = meshes.patch.clone();
            meshes.next_patch(&mesh, &slid);
            if similar(&guessed, &meshes.patch) {
                return Ok((meshes, Forces::of(&mesh, &slid.state)));
            }
        }
        Err(Error::no_patch(MAX_ROUNDS))
    }

    /// Solves mesh after mesh until two agree, and combines their figures.
    fn solve(mut self, forces: Forces) -> Result<SlidingSolution, Error> {
        let options = self.checked.options;
        let tolerance = options.p_max_tolerance;
        let mut history = SlidingHistory {
            forces,
            measures: Vec::new(),
            sections: Vec::new(),
            coarser: None,
            under: ShearHistory::new(),
            meshes: Vec::new(),
        };
        let mut cells = options
            .cells
            .map_or_else(|| first_cells(tolerance), |c| c as f64);
        // The first mesh is fitted to the rims found on the contact plane alone, so that it is
        // similar to the following ones.
        let mesh = self.mesh(cells)?;
        let slid = self.on(&mesh).on_plane(&self.start)?;
        self.next_patch(&mesh, &slid);
        let mut refined = 1.0;
        let mut estimate = f64::INFINITY;
        loop {
            let mesh = self.mesh(cells)?;
            let dofs = mesh.free_dofs();
            let level = history.meshes.len();
            let [slid, plain] = self.on(&mesh).solve(&self.start, &history.forces, |slid| {
                self.report(&mesh, slid, level, estimate);
            })?;
            let plain = self.reading(&mesh, &plain);
            let before = std::mem::take(&mut history.sections);
            let measures = self.record(&mesh, &slid, &mut history);
            history.coarser = (level > 0).then(|| Coarser {
                before,
                plain: plain.sections(),
                refined,
            });
            let errors = errors(&history.measures, plain.measures(), refined);
            estimate = largest(&errors, &measures);
            if options.cells.is_some() || estimate <= tolerance {
                return Ok(self.solution(mesh, slid, errors, history));
            }
            let room = (options.max_dofs as f64 / dofs as f64).cbrt();
            if room < MIN_REFINEMENT {
                return Err(Error::SlidingAccuracyNotReached {
                    dofs,
                    tolerance,
                    best: Box::new(self.solution(mesh, slid, errors, history)),
                });
            }
            self.next_patch(&mesh, &slid);
            let finer = (cells * REFINEMENT.min(room)).round();
            refined = finer / cells;
            cells = finer;
        }
    }

    fn on<'b>(&'b self, mesh: &'b Discretisation) -> MeshContact<'b> {
        MeshContact {
            checked: self.checked,
            mesh,
            before: self.before,
        }
    }

    fn mesh(&self, cells: f64) -> Result<Discretisation, Error> {
        let resolution = Resolution::of(cells);
        self.checked.mesh(&self.patch, resolution, Reach::Patch)
    }

    fn field<'b>(&'b self, mesh: &'b Discretisation) -> Field<'b> {
        Field::new(mesh, self.checked.problem, &self.patch)
    }

    fn reading<'b>(
        &'b self,
        mesh: &'b Discretisation,
        slid: &'b SlidingState,
    ) -> GrooveReading<'b> {
        GrooveReading::new(self.checked, mesh, slid, &self.field(mesh))
    }

    /// Fits the next mesh to the rims of this one.
    fn next_patch(&mut self, mesh: &Discretisation, slid: &SlidingState) {
        let rims = self.reading(mesh, slid).rims();
        self.patch = fitted(self.field(mesh).of(&slid.state).patch, rims);
        self.start = Start::From(WarmStart::of(mesh, slid));
    }

    /// Reports a state of a mesh, with the error of the previous meshes.
    fn report(&self, mesh: &Discretisation, slid: &SlidingState, level: usize, error: f64) {
        let Some(watcher) = &self.checked.options.sliding_progress else {
            return;
        };
        let reading = self.reading(mesh, slid);
        let measures = reading.measures();
        watcher(&SlidingIterate {
            hardness: self.checked.hardness(),
            level,
            dofs: mesh.free_dofs(),
            error_before: error.is_finite().then_some(error),
            corrections: slid.corrections,
            residual: slid.residual,
            fz: measures.fz,
            ploughing: measures.ploughing,
            sections: reading.sections(),
        });
    }

    /// Adds a mesh to the history; returns its figures.
    fn record(
        &self,
        mesh: &Discretisation,
        slid: &SlidingState,
        history: &mut SlidingHistory,
    ) -> Measures {
        let reading = self.reading(mesh, slid);
        let measures = reading.measures();
        history.sections = reading.sections();
        history.meshes.push(SlidingMesh {
            dofs: mesh.free_dofs(),
            contact_nodes: slid.state.force.iter().filter(|f| **f > 0.0).count(),
            corrections: slid.corrections,
            iterations: slid.iterations,
            residual: slid.residual,
            groove_depth: measures.depth,
            plastic_work: measures.plastic_work,
            ploughing_by_slope: measures.by_slope,
        });
        history.measures.push(measures);
        if self.checked.options.subsurface {
            let values = self.pressure(mesh, slid).values;
            let largest = mesh.largest_shear(self.checked.material, &values, &slid.state);
            // Each mesh is fitted to its own rims, so that differences of figures are errors.
            let number = history.meshes.len() as f64;
            history.under.push(largest, number, true);
        }
        history.forces = Forces::of(mesh, &slid.state);
        measures
    }

    /// The pressures of a state: the hardness wherever the ice yields.
    fn pressure(&self, mesh: &Discretisation, slid: &SlidingState) -> Pressure {
        let mut pressure = self.field(mesh).of(&slid.state);
        for (&node, &kind) in mesh.contact.candidates.iter().zip(&slid.grooved.kinds) {
            if kind == Kind::Full {
                pressure.values[node] = self.checked.hardness();
            }
        }
        pressure
    }

    fn solution(
        &self,
        mut mesh: Discretisation,
        slid: SlidingState,
        errors: Errors,
        history: SlidingHistory,
    ) -> SlidingSolution {
        let reading = self.reading(&mesh, &slid);
        let (profile, m) = (reading.profile(), reading.measures());
        let pressure = self.pressure(&mesh, &slid);
        let depth = over_mirror(&slid.depth, &mesh);
        let nx = mesh.grid.x.len();
        // The depth at the front of a row is that of the groove of earlier runners.
        let came = |n: usize| slid.depth[n - n % nx + nx - 1];
        let grown: Vec<f64> = (0..slid.depth.len())
            .map(|n| slid.depth[n] - came(n))
            .collect();
        let yielded = over_mirror(&grown, &mesh);
        // The gap is larger by the depth of the groove.
        for (gap, depth) in mesh.contact.gap.iter_mut().zip(&slid.depth) {
            *gap += depth;
        }
        let figures = pressure.figures;
        let relative = largest(&errors, &m);
        let [p_max, depth_error, ploughing, front, back, load_ahead] = errors;
        let length_error = front + back;
        // One mesh gives no estimate, and neither does a tilt of 0.
        let tilt_error = |tilt: f64| {
            if relative.is_finite() {
                tilt.abs() * relative
            } else {
                relative
            }
        };
        let [_, pitch, roll] = slid.state.motion;
        let of = |value, error| Measure { value, error };
        let limits = Limits {
            peak: of(m.p_max, p_max),
            approach: of(m.approach, m.approach * relative),
            // The relative error of the width is taken to be that of the length.
            area_error: 2.0 * length_error / (m.front - m.back) * figures.area,
            length_error,
            width_error: figures.width * length_error / figures.length,
            tilt_errors: self.checked.gap.tilt(pitch, roll).map(tilt_error),
            relative,
        };
        let solved = SolvedMesh {
            mesh,
            iterations: slid.iterations,
            state: slid.state,
            pressure,
        };
        let mut contact = solved.solution(self.checked, limits, Vec::new());
        contact.under_peak = history.under.under_peak(0.0, 0.0);
        contact.surface.yielded = yielded;
        SlidingSolution {
            contact,
            groove: Groove {
                deepest: of(m.depth, depth_error),
                ploughing: of(m.ploughing, ploughing),
                front: of(m.front, front),
                back: of(m.back, back),
                load_ahead: of(m.load_ahead, load_ahead),
                lowest: m.lowest,
                profile,
                depth,
                sections: history.sections,
                coarser: history.coarser,
                meshes: history.meshes,
            },
            relative_error: relative,
        }
    }
}

/// Cells over half the patch of the first mesh. A stricter tolerance continues the same sequence of
/// meshes: the error depends on the positions of nodes next to the rims, and other meshes might
/// have a larger one.
fn first_cells(tolerance: f64) -> f64 {
    (0.8 / tolerance.sqrt()).ceil().clamp(4.0, 6.0)
}

/// Whether a grid made for one patch resolves the other.
fn similar(a: &Patch, b: &Patch) -> bool {
    a.all_stretches(b, |a, b| a.ends_near(b, 0.2))
}

/// A plane field over the mirror plane y = 0, where it was used.
fn over_mirror(values: &[f64], mesh: &Discretisation) -> Vec<f64> {
    let nx = mesh.grid.x.len();
    let rows = unfolded(mesh.grid.y.len(), mesh.symmetry[1]);
    rows.flat_map(|(j, _)| values[j * nx..(j + 1) * nx].iter().copied())
        .collect()
}

// Solution of steady sliding.

/// Solves the steady sliding of a runner towards +x, on ice that yields at `problem.ice.hardness` H
/// and keeps its plastic depth.
///
/// ```text
/// 0 <= p <= H,   gap = h - N q + u_e(p) + u_p >= 0,   p gap = 0,   sum of p dA = F_z
/// u_p never falls towards the back, and p = H where it grows;   ploughing force = H times the section that is added
/// ```
///
/// `before` is the groove of an earlier runner. Meshes are refined until the estimated errors of
/// peak pressure, groove depth and ploughing force are below `options.p_max_tolerance`;
/// `options.sliding_progress` is called in place of `options.progress`. The load's line of action
/// is fixed: a runner that is free to tilt does so until the centre of pressure is on it. The
/// moment of the drag is not part of the balance, and neither is ice that the runner's sides push
/// up.
///
/// # Errors
/// - [`Error::NotSliding`]: ice without a hardness or of varying height.
/// - [`Error::LoadExceedsHardness`]: also if the hull carries the load at rest but not in sliding.
/// - [`Error::SlidingAccuracyNotReached`]: the largest mesh allowed is not accurate enough; the
///   error holds the best solution.
/// - [`Error::NotConverged`], [`Error::Unsolved`] and the other errors of
///   [`solve`](crate::solve()).
///
/// ```
/// use std::sync::Arc;
/// use kufe_contact::{Ice, Load, Options, Problem, Runner, Tilt, slide};
/// use kufe_mesh::Paraboloid;
///
/// let mut ice = Ice::half_space(9.0e9, 0.33);
/// ice.hardness = Some(17.7e6);
/// let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.004)?));
/// let problem = Problem::new(runner, ice, Load::central(950.0, Tilt::LEVEL));
/// let solution = slide(&problem, None, &Options { cells: Some(8), ..Options::default() })?;
/// // A groove of 36 µm; ploughing it is some 5e-4 of the load.
/// assert!((solution.groove.deepest.value / 35.6e-6 - 1.0).abs() < 0.03);
/// assert!((solution.groove.ploughing.value / 950.0 / 4.77e-4 - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn slide(
    problem: &Problem,
    before: Option<&GrooveProfile>,
    options: &Options,
) -> Result<SlidingSolution, Error> {
    rayon::scope(|_| {
        let mut checked = CheckedProblem::bearable(problem, options)?;
        let refused = |reason: &'static str| Err(Error::NotSliding { reason });
        if problem.ice.hardness.is_none() {
            return refused("ice without a hardness");
        }
        if problem.ice_surface.is_some() {
            return refused("ice of varying height, on which no sliding is steady");
        }
        let mirrored = before.is_none_or(GrooveProfile::mirror_symmetric);
        checked.gap.mirrored = [false, mirrored];
        let (meshes, forces) = SlidingMeshes::find_patch(&checked, before)?;
        let mut solved = meshes.solve(forces);
        let best = match &mut solved {
            Ok(solution) => solution,
            Err(Error::SlidingAccuracyNotReached { best, .. }) => best,
            Err(_) => return solved,
        };
        check_answer(problem, &best.contact)?;
        add_tilt_error(problem, &mut best.contact);
        solved
    })
}

// Errors of the last mesh's figures.

/// Estimated errors of peak pressure, groove's depth, ploughing force, front, back and place of the
/// load, in their own units.
type Errors = [f64; 6];

/// Ratio of ploughing force to load below which the error is relative to this ratio.
const MIN_PLOUGHING: f64 = 1e-4;
/// Ratio of groove depth to approach below which the error is relative to this ratio.
const MIN_DEPTH: f64 = 0.05;

/// Errors from the last two meshes and from `plain`, the last one without the area between nodes
/// and rims; infinite for one mesh.
fn errors(measures: &[Measures], plain: Measures, refined: f64) -> Errors {
    let of = |m: &Measures| [m.p_max, m.depth, m.ploughing, m.front, m.back, m.load_ahead];
    let [.., before, last] = measures else {
        return [f64::INFINITY; 6];
    };
    let coarser = Coarser {
        before: *before,
        plain,
        refined,
    };
    [0, 1, 2, 3, 4, 5].map(|k| coarser.error(of(last)[k], |m| of(m)[k]))
}

/// Largest relative error of peak pressure, groove and ploughing.
fn largest([p_max, depth, ploughing, ..]: &Errors, of: &Measures) -> f64 {
    let shares = [
        p_max / of.p_max,
        depth / of.depth.max(MIN_DEPTH * of.approach),
        ploughing / of.ploughing.max(MIN_PLOUGHING * of.fz),
    ];
    shares.into_iter().fold(0.0, f64::max)
}
