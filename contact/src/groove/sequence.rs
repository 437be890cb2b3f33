//! Finer and finer meshes of one sliding contact.

use kufe_fem::Material;

use crate::accuracy::answer::Answer;
use crate::accuracy::estimators::{Limit, grid_convergence_index};
use crate::accuracy::mesh_solve::Forces;
use crate::accuracy::watched::{Limits, ShearHistory};
use crate::active_set::contact_set::Progress;
use crate::grid::first_guess::{fitted, sliding_guess};
use crate::grid::grading::Resolution;
use crate::grid::patch::Patch;
use crate::groove::measures::{GrooveReading, Measures, Rims};
use crate::groove::on_mesh::{MeshContact, SlidingState, Start, WarmStart};
use crate::groove::plastic_contact::Kind;
use crate::groove::solution::{
    Groove, GrooveProfile, Measure, SlidingIterate, SlidingMesh, SlidingSolution,
};
use crate::mesh::discretise::{Discretisation, MeshPlan, Reach};
use crate::problem::check::{capacity, check};
use crate::problem::gap::Gap;
use crate::result::pressure::{Field, Pressure};
use crate::solve::answered;
use crate::{Error, Options, Problem};

/// Cells over half the patch while it is being found.
const COARSE_MESH: Resolution = Resolution {
    cells: 6.0,
    growth: 0.7,
};
/// Meshes on the contact plane alone until one fits the patch found on it.
const ROUNDS: usize = 30;
/// Ratio of the resolutions of successive meshes, and the least where the largest mesh allowed
/// leaves no more.
const REFINEMENT: f64 = 1.5;
const LEAST_REFINEMENT: f64 = 1.1;

/// What is known of a sliding contact, mesh by mesh.
pub(crate) struct SlidingMeshes<'a> {
    problem: &'a Problem,
    options: &'a Options,
    gap: Gap<'a>,
    material: Material,
    before: Option<&'a GrooveProfile>,
    patch: Patch,
    forces: Forces,
    start: Start,
    measures: Vec<Measures>,
    under: ShearHistory,
    meshes: Vec<SlidingMesh>,
}

impl<'a> SlidingMeshes<'a> {
    /// Finds the patch on the contact plane alone.
    pub fn find_patch(
        problem: &'a Problem,
        gap: Gap<'a>,
        material: Material,
        before: Option<&'a GrooveProfile>,
        options: &'a Options,
    ) -> Result<Self, Error> {
        let mut patch = sliding_guess(problem, &gap);
        let mut start = Start::AtRest(patch.motion);
        for _ in 0..ROUNDS {
            if options.stopped() {
                return Err(Error::Stopped);
            }
            let plan = MeshPlan {
                problem,
                gap: &gap,
                material,
                patch: &patch,
                resolution: COARSE_MESH,
                reach: Reach::WholeHull,
            };
            let mesh = plan.mesh()?;
            let on = MeshContact {
                problem,
                material,
                mesh: &mesh,
                before,
                options,
            };
            let slid = on.on_plane(&start)?;
            let field = Field::new(&mesh, problem, &patch);
            let rims = Rims::new(&mesh, &slid).rims(&field.pressure_field(&slid.state));
            let found = fitted(field.of(&slid.state).patch, rims);
            start = Start::From(WarmStart::of(&mesh, &slid));
            let settled = similar(&patch, &found);
            patch = found;
            if settled {
                let forces = Forces::of(&mesh, &slid.state);
                return Ok(SlidingMeshes {
                    problem,
                    options,
                    gap,
                    material,
                    before,
                    patch,
                    forces,
                    start,
                    measures: Vec::new(),
                    under: ShearHistory::new(),
                    meshes: Vec::new(),
                });
            }
        }
        Err(Error::no_patch(ROUNDS))
    }

    /// Solves mesh after mesh until two agree, and puts together what they say.
    pub fn solve(mut self) -> Result<SlidingSolution, Error> {
        let tolerance = self.options.p_max_tolerance;
        let mut cells = self
            .options
            .cells
            .map_or_else(|| first_cells(tolerance), |c| c as f64);
        self.fit(cells)?;
        let mut refined = 1.0;
        let mut estimate = f64::INFINITY;
        loop {
            let mesh = self.mesh(cells)?;
            let dofs = mesh.free_dofs();
            let on = self.on(&mesh);
            let [slid, plain] = on.solve(&self.start, &self.forces, |slid| {
                self.report(&mesh, slid, dofs, estimate);
            })?;
            let plain = self.measures(&mesh, &plain);
            self.take(&mesh, &slid, dofs);
            let errors = Errors::of(&self.measures, &plain, refined);
            estimate = errors.largest(&self.measures[self.measures.len() - 1]);
            if self.options.cells.is_some() || estimate <= tolerance {
                return Ok(self.put_together(mesh, slid, errors));
            }
            let room = (self.options.max_dofs as f64 / dofs as f64).cbrt();
            if room < LEAST_REFINEMENT {
                return Err(Error::SlidingAccuracyNotReached {
                    dofs,
                    estimate,
                    tolerance,
                });
            }
            self.next_patch(&mesh, &slid);
            let finer = (cells * REFINEMENT.min(room)).round();
            refined = finer / cells;
            cells = finer;
        }
    }

    /// Fits the patch to the rims that the first mesh finds on the contact plane alone, so that it
    /// is one of those that follow.
    fn fit(&mut self, cells: f64) -> Result<(), Error> {
        let mesh = self.mesh(cells)?;
        let slid = self.on(&mesh).on_plane(&self.start)?;
        self.next_patch(&mesh, &slid);
        Ok(())
    }

    fn on<'b>(&'b self, mesh: &'b Discretisation) -> MeshContact<'b> {
        MeshContact {
            problem: self.problem,
            material: self.material,
            mesh,
            before: self.before,
            options: self.options,
        }
    }

    fn mesh(&self, cells: f64) -> Result<Discretisation, Error> {
        let plan = MeshPlan {
            problem: self.problem,
            gap: &self.gap,
            material: self.material,
            patch: &self.patch,
            resolution: Resolution {
                cells,
                growth: 3.0 / cells,
            },
            reach: Reach::Patch,
        };
        plan.mesh()
    }

    /// Fits the next mesh to the rims that this one found.
    fn next_patch(&mut self, mesh: &Discretisation, slid: &SlidingState) {
        let field = Field::new(mesh, self.problem, &self.patch);
        let rims = Rims::new(mesh, slid).rims(&field.pressure_field(&slid.state));
        self.patch = fitted(field.of(&slid.state).patch, rims);
        self.start = Start::From(WarmStart::of(mesh, slid));
    }

    /// The figures of a state.
    fn measures(&self, mesh: &Discretisation, slid: &SlidingState) -> Measures {
        let field = Field::new(mesh, self.problem, &self.patch);
        let on = self.on(mesh);
        GrooveReading::new(&on, &self.gap, slid).measures(&field.pressure_field(&slid.state))
    }

    /// Passes a state of a mesh on, before which the meshes had this error.
    fn report(&self, mesh: &Discretisation, slid: &SlidingState, dofs: usize, error: f64) {
        let Some(watcher) = &self.options.sliding_progress else {
            return;
        };
        let field = Field::new(mesh, self.problem, &self.patch);
        let field = field.pressure_field(&slid.state);
        let on = self.on(mesh);
        let reading = GrooveReading::new(&on, &self.gap, slid);
        let measures = reading.measures(&field);
        watcher(&SlidingIterate {
            hardness: self.problem.ice.hardness.unwrap_or(f64::INFINITY),
            level: self.meshes.len(),
            dofs,
            error_before: error.is_finite().then_some(error),
            corrections: slid.corrections,
            residual: slid.residual,
            fz: measures.fz,
            ploughing: measures.ploughing,
            sections: reading.sections(&field),
        });
    }

    /// Keeps what a mesh says.
    fn take(&mut self, mesh: &Discretisation, slid: &SlidingState, dofs: usize) {
        let measures = self.measures(mesh, slid);
        self.meshes.push(SlidingMesh {
            dofs,
            contact_nodes: slid.state.force.iter().filter(|f| **f > 0.0).count(),
            corrections: slid.corrections,
            iterations: slid.iterations,
            residual: slid.residual,
            groove_depth: measures.depth,
            plastic_work: measures.plastic_work,
            ploughing_by_slope: measures.by_slope,
        });
        self.measures.push(measures);
        if self.options.subsurface {
            let pressure = self.pressure(mesh, slid);
            let largest = mesh.largest_shear(self.material, &pressure.values, &slid.state);
            // Each mesh is fitted to rims of its own: what they differ by is the error.
            self.under.push(largest, self.meshes.len() as f64, true);
        }
        self.forces = Forces::of(mesh, &slid.state);
    }
}

impl SlidingMeshes<'_> {
    /// The pressures of a state: the hardness wherever the ice yields.
    fn pressure(&self, mesh: &Discretisation, slid: &SlidingState) -> Pressure {
        let mut pressure = Field::new(mesh, self.problem, &self.patch).of(&slid.state);
        for (k, &node) in mesh.contact.candidates.iter().enumerate() {
            if slid.grooved.kinds[k] == Kind::Full {
                pressure.values[node] = self.problem.ice.hardness.unwrap_or(f64::INFINITY);
            }
        }
        pressure
    }

    fn put_together(
        self,
        mut mesh: Discretisation,
        slid: SlidingState,
        errors: Errors,
    ) -> SlidingSolution {
        let on = self.on(&mesh);
        let field = Field::new(&mesh, self.problem, &self.patch);
        let reading = GrooveReading::new(&on, &self.gap, &slid);
        let (profile, sections) = (
            reading.profile(),
            reading.sections(&field.pressure_field(&slid.state)),
        );
        let pressure = self.pressure(&mesh, &slid);
        let m = self.measures[self.measures.len() - 1];
        let depth = unfolded(&slid.depth, &mesh);
        let nx = mesh.grid.x.len();
        // The groove is followed from the front to the back: ahead is the ice as it came.
        let came = |n: usize| slid.depth[n - n % nx + nx - 1];
        let grown: Vec<f64> = (0..slid.depth.len())
            .map(|n| slid.depth[n] - came(n))
            .collect();
        let yielded = unfolded(&grown, &mesh);
        // The ice that is met lies lower by the groove.
        for (gap, depth) in mesh.contact.gap.iter_mut().zip(&slid.depth) {
            *gap += depth;
        }
        let dofs = mesh.free_dofs();
        let (area, length_error) = (pressure.figures.area, errors.front + errors.back);
        let answer = Answer {
            problem: self.problem,
            gap: &self.gap,
            mesh,
            progress: Progress {
                iterations: slid.iterations,
                residual: slid.residual,
                converged: true,
            },
            state: slid.state,
            pressure,
            dofs,
        };
        let limits = Limits {
            peak: Limit {
                value: m.p_max,
                error: errors.p_max,
            },
            approach: m.approach,
            // The width is taken to be as uncertain as the length.
            area_error: 2.0 * length_error / (m.front - m.back) * area,
            length_error,
            relative: errors.largest(&m),
        };
        let mut contact = answer.solution(limits, Vec::new());
        contact.under_peak = self.under.under_peak(0.0, 0.0);
        contact.surface.yielded = yielded;
        let of = |value, error| Measure { value, error };
        SlidingSolution {
            contact,
            groove: Groove {
                deepest: of(m.depth, errors.depth),
                ploughing: of(m.ploughing, errors.ploughing),
                front: of(m.front, errors.front),
                back: of(m.back, errors.back),
                load_ahead: of(m.load_ahead, errors.load_ahead),
                lowest: m.lowest,
                profile,
                depth,
                sections,
                meshes: self.meshes,
            },
        }
    }
}

/// Cells over half the patch of the first mesh. A stricter request goes on with the same meshes:
/// where nodes lie next to the rims is chance, and meshes of its own could leave it a larger error.
fn first_cells(tolerance: f64) -> f64 {
    (0.8 / tolerance.sqrt()).ceil().clamp(4.0, 6.0)
}

/// Whether a grid made for one patch resolves the other.
fn similar(a: &Patch, b: &Patch) -> bool {
    a.all_stretches(b, |a, b| a.ends_near(b, 0.2))
}

/// A plane field over the mirror plane y = 0, where it was used.
fn unfolded(values: &[f64], mesh: &Discretisation) -> Vec<f64> {
    let [nx, ny] = [mesh.grid.x.len(), mesh.grid.y.len()];
    let mirrored = (1..ny).rev().filter(|_| mesh.symmetry[1]);
    let rows = mirrored.chain(0..ny);
    rows.flat_map(|j| values[j * nx..(j + 1) * nx].iter().copied())
        .collect()
}

// From a problem to steady sliding.

/// Solves the steady sliding of a runner towards +x, on ice that yields at `problem.ice.hardness` H
/// and keeps its plastic depth.
///
/// ```text
/// 0 <= p <= H,   gap = h - N q + u_e(p) + u_p >= 0,   p gap = 0,   sum of p dA = F_z
/// u_p never falls towards the back, and p = H where it grows;   ploughing force = H times the section that is added
/// ```
///
/// `before` is the groove in which the ice comes, that of an earlier runner. Meshes are refined
/// until the estimated errors of peak pressure, groove depth and ploughing force are below
/// `options.p_max_tolerance`; `options.sliding_progress` is called in place of `options.progress`. The load's line of action stays
/// where it is: a runner that is free to tilt turns until the pressure is under it, and the drag's
/// own moment is not in the balance. What the runner's sides push up is not in it either.
///
/// # Errors
/// [`Error::NotSliding`] for ice without a hardness or of varying height, a checking method; those
/// of [`solve`](crate::solve()) for problems without an answer and answers that are none:
/// [`Error::LoadExceedsHardness`] too where the hull bears the load at rest but not sliding;
/// [`Error::NotConverged`], [`Error::Unsolved`], and [`Error::SlidingAccuracyNotReached`] where the
/// largest mesh allowed does not do.
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
        let material = check(problem, options)?;
        refuse(problem)?;
        capacity(problem)?;
        let mirrored = before.is_none_or(GrooveProfile::mirror_symmetric);
        let gap = Gap::new(problem)?.mirrored_at_most([false, mirrored]);
        let solution =
            SlidingMeshes::find_patch(problem, gap, material, before, options)?.solve()?;
        Ok(SlidingSolution {
            contact: answered(problem, solution.contact)?,
            ..solution
        })
    })
}

/// What steady sliding does not take.
fn refuse(problem: &Problem) -> Result<(), Error> {
    if problem.ice.hardness.is_none() {
        return Err(Error::NotSliding {
            reason: "ice without a hardness",
        });
    }
    if problem.ice_surface.is_some() {
        return Err(Error::NotSliding {
            reason: "ice of varying height, on which no sliding is steady",
        });
    }
    Ok(())
}

// How far the last mesh's figures are from those of fine meshes.

/// Estimated errors, in the figures' own units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    pub p_max: f64,
    pub depth: f64,
    pub ploughing: f64,
    pub front: f64,
    pub back: f64,
    pub load_ahead: f64,
}

/// Ploughing force over the load below which its error is measured by this [1].
const LEAST_PLOUGHING: f64 = 1e-4;
/// Depth of the groove over the approach below which its error is measured by this.
const LEAST_DEPTH: f64 = 0.05;

impl Errors {
    /// The grid convergence index of the last two meshes, the last one `refined` times as fine as
    /// the one before, and what the area between nodes and rims changes on the last one: `plain` is
    /// that mesh's answer without it. The two add up as independent errors do. Infinite for one
    /// mesh.
    ///
    /// The index alone does not do: where nodes lie next to rims is chance, and two meshes may
    /// agree by it.
    pub fn of(measures: &[Measures], plain: &Measures, refined: f64) -> Self {
        let error = |of: fn(&Measures) -> f64| match measures {
            [.., before, last] => {
                grid_convergence_index(of(before), of(last), refined).hypot(of(plain) - of(last))
            }
            _ => f64::INFINITY,
        };
        Errors {
            p_max: error(|m| m.p_max),
            depth: error(|m| m.depth),
            ploughing: error(|m| m.ploughing),
            front: error(|m| m.front),
            back: error(|m| m.back),
            load_ahead: error(|m| m.load_ahead),
        }
    }

    /// Largest of the errors of peak pressure, groove and ploughing, over their values.
    pub fn largest(&self, of: &Measures) -> f64 {
        let shares = [
            self.p_max / of.p_max,
            self.depth / of.depth.max(LEAST_DEPTH * of.approach),
            self.ploughing / of.ploughing.max(LEAST_PLOUGHING * of.fz),
        ];
        shares.into_iter().fold(0.0, f64::max)
    }
}
