//! From a problem to a pressure field of the accuracy asked.

use faer::Mat;
use kufe_fem::Material;
use kufe_mesh::TensorGrid;

use crate::body::Side;
use crate::discretise::{Discretisation, Reach, Resolution, discretise};
use crate::far_field::{lumps, prescribe};
use crate::gap::Gap;
use crate::level::{Level, Progress, State};
use crate::measure::{Figures, PressureField};
use crate::plain::{active_set, projected_sor};
use crate::psor::PlaneState;
use crate::stretch::Stretch;
use crate::window::{Patch, first_guess};
use crate::{
    Error, Foundation, Iterate, Load, Method, Options, Problem, RunnerField, Solution,
    SurfaceField, VolumeField,
};

/// Cells over half the patch while it is being found.
const SCOUTING: Resolution = Resolution {
    cells: 7.0,
    growth: 0.7,
};
/// Growth of the spacing away from the patch in a mesh of `cells` cells over half the patch.
fn growth(cells: f64) -> f64 {
    3.0 / cells
}
/// Ratio of the resolutions of successive meshes.
const REFINEMENT: f64 = 1.5;

/// Solves a contact problem.
///
/// Linear elasticity on trilinear hexahedra, frictionless unilateral contact; see the crate's page for the
/// method. The mesh is refined until the estimated discretisation error of the peak pressure is below
/// `options.p_max_tolerance`.
///
/// # Errors
/// [`Error::OutOfRange`], [`Error::LoadMissesHull`], [`Error::TrackTooTight`] and [`Error::BeyondHardness`] for
/// problems without an answer; [`Error::NotConverged`] and [`Error::AccuracyNotReached`] where limits stop the
/// solve.
pub fn solve(problem: &Problem, options: &Options) -> Result<Solution, Error> {
    let material = check(problem, options)?;
    let gap = Gap::new(problem)?;
    let (mut patch, mut forces) = scout(problem, &gap, material)?;
    let mut cells = options
        .cells
        .map_or_else(|| first_resolution(options.p_max_tolerance), |c| c as f64);
    let mut history = Vec::new();
    let (mut earlier, mut previous): (Option<Raw>, Option<Raw>) = (None, None);
    for level in 0.. {
        let resolution = Resolution {
            cells,
            growth: growth(cells),
        };
        let mesh = discretise(problem, &gap, material, &patch, resolution, Reach::Patch)?;
        let dofs = mesh
            .level
            .bodies
            .iter()
            .map(|b| b.operator.free_dofs())
            .sum();
        let (state, progress) = solve_level(problem, material, &mesh, &patch, &forces, options)?;
        let pressure = field(&mesh, problem, &patch).of(&state);
        let raw = Raw {
            cells,
            p_max: pressure.figures.p_max,
            approach: mesh.level.depth(&state),
        };
        report(level, dofs, &progress, raw.p_max, &mut history, options);
        if options.cells.is_some() {
            let limit = Extrapolation {
                p_max: raw.p_max,
                error: f64::INFINITY,
                approach: raw.approach,
            };
            return Ok(solution(
                problem, &gap, mesh, state, progress, pressure, limit, dofs, history,
            ));
        }
        let smooth = patch.x.iter().chain([&patch.y]).all(|s| s.finest() == 1.0);
        let limit = previous.map(|before| {
            let limit = Extrapolation::new(before, raw, smooth);
            earlier
                .filter(|_| !smooth)
                .and_then(|first| Extrapolation::geometric(first, before, raw))
                .unwrap_or(limit)
        });
        if let Some(limit) = limit.filter(|l| l.error <= options.p_max_tolerance * l.p_max) {
            return Ok(solution(
                problem, &gap, mesh, state, progress, pressure, limit, dofs, history,
            ));
        }
        earlier = previous;
        previous = Some(raw);
        if dofs as f64 * REFINEMENT.powi(3) > options.max_dofs as f64 {
            let estimate = limit.map_or(f64::INFINITY, |l| l.error / l.p_max);
            return Err(Error::AccuracyNotReached {
                dofs,
                estimate,
                tolerance: options.p_max_tolerance,
            });
        }
        forces = lumped_forces(&mesh, &state);
        patch = pressure.patch.with_sizes_of(&patch);
        cells = (cells * REFINEMENT).round();
    }
    unreachable!("the loop ends by accuracy or by its limit of unknowns")
}

/// What one mesh says.
#[derive(Clone, Copy, Debug)]
struct Raw {
    cells: f64,
    p_max: f64,
    approach: f64,
}

/// Peak pressure and approach in the limit of fine meshes, from two similar meshes.
///
/// Similar meshes (the same zones, all spacings in proportion) have errors c h^2 + higher terms, so that
/// p = p2 + (p2 - p1) / (r^2 - 1) with r the ratio of their resolutions (L. F. Richardson, 1911).
#[derive(Clone, Copy, Debug)]
struct Extrapolation {
    p_max: f64,
    error: f64,
    approach: f64,
}

impl Extrapolation {
    /// Share of the extrapolation's step that is reported as error: on the closed forms that the tests compare
    /// with it holds the true error.
    const SHARE: f64 = 0.4;
    /// Scatter of the peak pressure with the place of the rim between nodes, times the square of the cells.
    const SCATTER: f64 = 0.03;

    /// The limit of two meshes. Where the patch is not smooth (it wanted uneven cells) nothing is known of the order,
    /// and the whole difference of the two is the error.
    fn new(coarse: Raw, fine: Raw, smooth: bool) -> Self {
        let scatter = Self::SCATTER / (fine.cells * fine.cells) * fine.p_max;
        if !smooth {
            let error = (fine.p_max - coarse.p_max).abs() + scatter;
            return Extrapolation {
                p_max: fine.p_max,
                error,
                approach: fine.approach,
            };
        }
        let divisor = (fine.cells / coarse.cells).powi(2) - 1.0;
        let step = (fine.p_max - coarse.p_max) / divisor;
        Extrapolation {
            p_max: fine.p_max + step,
            error: Self::SHARE * step.abs() + scatter,
            approach: fine.approach + (fine.approach - coarse.approach) / divisor,
        }
    }
}

impl Extrapolation {
    /// The limit of three meshes whose steps shrink steadily, as a geometric series (A. C. Aitken, 1926); half of what
    /// is added is the error. `None` where the steps do not shrink by at least 0.6 in one direction.
    fn geometric(first: Raw, second: Raw, third: Raw) -> Option<Self> {
        let steps = [second.p_max - first.p_max, third.p_max - second.p_max];
        let ratio = steps[1] / steps[0];
        if !(0.0..0.6).contains(&ratio) {
            return None;
        }
        let rest = steps[1] * ratio / (1.0 - ratio);
        let scatter = Self::SCATTER / (third.cells * third.cells) * third.p_max;
        Some(Extrapolation {
            p_max: third.p_max + rest,
            error: 0.5 * rest.abs() + 0.1 * steps[1].abs() + scatter,
            approach: third.approach,
        })
    }
}

/// Cells of the first of two meshes whose extrapolation should meet the tolerance on a smooth contact.
fn first_resolution(tolerance: f64) -> f64 {
    (0.21 / tolerance.sqrt()).ceil().clamp(4.0, 16.0)
}

/// Ranges of the numbers in a problem.
fn check(problem: &Problem, options: &Options) -> Result<Material, Error> {
    let out = |name, value, expected| {
        Err(Error::OutOfRange {
            name,
            value,
            expected,
        })
    };
    let ice = &problem.ice;
    if !(ice.youngs_modulus > 0.0 && ice.youngs_modulus.is_finite()) {
        return out(
            "ice Young's modulus",
            ice.youngs_modulus,
            "a positive number of Pa",
        );
    }
    if !(ice.poissons_ratio > -1.0 && ice.poissons_ratio < 0.5) {
        return out(
            "ice Poisson's ratio",
            ice.poissons_ratio,
            "more than -1 and less than 0.5",
        );
    }
    if let Foundation::RigidBed { thickness } = ice.foundation
        && !(thickness > 0.0 && thickness.is_finite())
    {
        return out("ice thickness", thickness, "a positive number of m");
    }
    if let Some(hardness) = ice.hardness
        && !(hardness > 0.0 && hardness.is_finite())
    {
        return out("ice hardness", hardness, "a positive number of Pa");
    }
    if !problem.track_curvature.is_finite() {
        return out(
            "track curvature",
            problem.track_curvature,
            "a finite number of 1/m",
        );
    }
    match problem.load {
        Load::Force { fz, .. } if !(fz > 0.0 && fz.is_finite()) => {
            return out("normal force", fz, "a positive number of N");
        }
        Load::Approach { approach, .. } if !(approach > 0.0 && approach.is_finite()) => {
            return out("approach", approach, "a positive number of m");
        }
        _ => {}
    }
    if problem.runner.elastic.is_some() && options.method != Method::Accelerated {
        return out(
            "elastic bodies under a checking method",
            2.0,
            "1, the ice alone",
        );
    }
    if !(options.p_max_tolerance > 0.0 && options.p_max_tolerance.is_finite()) {
        return out(
            "accuracy of the peak pressure",
            options.p_max_tolerance,
            "a positive number",
        );
    }
    Material::new(ice.youngs_modulus, ice.poissons_ratio).map_err(|_| Error::OutOfRange {
        name: "ice material",
        value: ice.youngs_modulus,
        expected: "an elastic solid",
    })
}

/// Contact forces as they are known so far, on the plane they were found on.
struct Forces {
    x: Vec<f64>,
    y: Vec<f64>,
    force: Vec<f64>,
    symmetry: [bool; 2],
}

/// Finds the patch with contact problems on the plane alone, regrading until the grid fits what it finds.
fn scout(problem: &Problem, gap: &Gap, material: Material) -> Result<(Patch, Forces), Error> {
    let mut patch = first_guess(problem, gap);
    for _ in 0..20 {
        let mesh = discretise(problem, gap, material, &patch, SCOUTING, Reach::WholeHull)?;
        let level = &mesh.level;
        capacity(problem, level)?;
        let [_, scaled] = level.greens();
        let start = PlaneState {
            force: vec![0.0; level.candidates.len()],
            motion: [patch.motion, 0.0, 0.0],
            settled: false,
        };
        let base: Vec<f64> = level.candidates.iter().map(|&n| level.gap[n]).collect();
        let found = level.plane_contact(&scaled, &base, start);
        let mut force = vec![0.0; level.gap.len()];
        for (&node, f) in level.candidates.iter().zip(&found.force) {
            force[node] = *f;
        }
        let state = State {
            displacement: Vec::new(),
            force,
            motion: found.motion,
        };
        let next = field(&mesh, problem, &patch).of(&state).patch;
        let settled = similar(&patch, &next);
        patch = next;
        if settled {
            return Ok((patch, lumped_forces(&mesh, &state)));
        }
    }
    Err(Error::NotConverged {
        iterations: 20,
        residual: f64::INFINITY,
        tolerance: 0.15,
    })
}

/// Whether a grid made for one patch resolves the other.
fn similar(a: &Patch, b: &Patch) -> bool {
    let close = |a: &Stretch, b: &Stretch| {
        (a.low - b.low).abs() < 0.3 * a.half()
            && (a.high - b.high).abs() < 0.3 * a.half()
            && b.half() > 0.75 * a.half()
            && b.finest() > 0.7 * a.finest()
    };
    a.x.len() == b.x.len() && a.x.iter().zip(&b.x).all(|(a, b)| close(a, b)) && close(&a.y, &b.y)
}

/// Refuses a load that the hull cannot pass on at the stated hardness.
fn capacity(problem: &Problem, level: &Level) -> Result<(), Error> {
    let (Load::Force { fz, .. }, Some(hardness)) = (problem.load, problem.ice.hardness) else {
        return Ok(());
    };
    let [x0, x1, y0, y1] = problem.runner.underside.extent();
    let capacity = hardness * (x1 - x0) * (y1 - y0);
    let _ = level;
    if capacity <= fz {
        Err(Error::BeyondHardness { fz, capacity })
    } else {
        Ok(())
    }
}

/// The patch that a pressure field covers, and how fine it wants to be resolved.
///
/// Sizes start from those of `before`, the patch that the mesh was made for. Where the contact ends at the hull's
/// own sharp `edge` the pressure is singular, no mesh resolves it, and the sizes stay as they are.
fn found_patch(
    field: &PressureField,
    pressure: &[f64],
    motion: f64,
    before: &Patch,
    edge: bool,
) -> Patch {
    let nx = field.x.len();
    let mut x = merged(field.chords_along(pressure), field.symmetry[0]);
    let mut y = merged(field.chords_across(pressure), field.symmetry[1]);
    let last = y.pop().unwrap_or_else(|| before.y.clone());
    let mut y = Stretch::even(y.first().map_or(last.low, |first| first.low), last.high);
    let highest_at_x: Vec<f64> = (0..nx)
        .map(|i| highest(pressure.iter().skip(i).step_by(nx)))
        .collect();
    let highest_at_y: Vec<f64> = pressure
        .chunks_exact(nx)
        .map(|row| highest(row.iter()))
        .collect();
    for stretch in &mut x {
        if let Some(same) = before
            .x
            .iter()
            .find(|s| s.low < stretch.high && stretch.low < s.high)
        {
            stretch.sizes.clone_from(&same.sizes);
        }
        if !edge {
            stretch.adapt(field.x, &highest_at_x);
        }
    }
    y.sizes.clone_from(&before.y.sizes);
    if !edge {
        y.adapt(field.y, &highest_at_y);
    }
    if x.is_empty() {
        x.clone_from(&before.x);
    }
    Patch { x, y, motion }
}

fn highest<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    values.copied().fold(0.0, f64::max)
}

/// The union of the stretches on all lines; whole where a mirror plane cuts one.
///
/// Stretches closer together than a fifth of the longer one count as one: their grids would merge anyway.
fn merged(chords: Vec<Vec<[f64; 2]>>, symmetric: bool) -> Vec<Stretch> {
    let mut all: Vec<[f64; 2]> = chords.into_iter().flatten().collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut merged: Vec<[f64; 2]> = Vec::new();
    for stretch in all {
        match merged.last_mut() {
            Some(last)
                if stretch[0] - last[1]
                    < 0.2 * (stretch[1] - stretch[0]).max(last[1] - last[0]) =>
            {
                last[1] = last[1].max(stretch[1]);
            }
            _ => merged.push(stretch),
        }
    }
    if symmetric
        && let Some(first) = merged.first_mut()
        && first[0] == 0.0
    {
        first[0] = -first[1];
    }
    merged
        .iter()
        .map(|[low, high]| Stretch::even(*low, *high))
        .collect()
}

/// Solves on one mesh, beginning with the contact on the plane alone.
fn solve_level(
    problem: &Problem,
    material: Material,
    mesh: &Discretisation,
    patch: &Patch,
    forces: &Forces,
    options: &Options,
) -> Result<(State, Progress), Error> {
    let level = &mesh.level;
    let greens = level.greens();
    let base: Vec<f64> = level.candidates.iter().map(|&n| level.gap[n]).collect();
    let start = PlaneState {
        force: vec![0.0; level.candidates.len()],
        motion: [patch.motion, 0.0, 0.0],
        settled: false,
    };
    let found = level.plane_contact(&greens[1], &base, start);
    let mut force = vec![0.0; level.gap.len()];
    for (&node, f) in level.candidates.iter().zip(&found.force) {
        force[node] = *f;
    }
    let mut state = State {
        displacement: vec![0.0; level.len()],
        force,
        motion: found.motion,
    };
    hold_outer_faces(problem, material, mesh, forces, &mut state);
    let mut progress = one_solve(mesh, material, &greens, &mut state, options);
    if matches!(problem.load, Load::Approach { .. })
        && problem.ice.foundation == Foundation::HalfSpace
    {
        // The force, and with it the far field, follows from the solution.
        const ROUNDS: usize = 20;
        for _ in 0..ROUNDS {
            let before = level.resultant(&state)[0];
            hold_outer_faces(
                problem,
                material,
                mesh,
                &lumped_forces(mesh, &state),
                &mut state,
            );
            let again = one_solve(mesh, material, &greens, &mut state, options);
            progress.iterations += again.iterations;
            progress.converged &= again.converged;
            progress.residual = again.residual;
            progress.updates.extend(again.updates);
            if (level.resultant(&state)[0] - before).abs() <= 1e-6 * before {
                break;
            }
        }
    }
    if !progress.converged {
        return Err(Error::NotConverged {
            iterations: progress.iterations,
            residual: progress.residual,
            tolerance: options.residual,
        });
    }
    Ok((state, progress))
}

/// Writes the far field of the contact forces onto the outer faces of a half-space.
fn hold_outer_faces(
    problem: &Problem,
    material: Material,
    mesh: &Discretisation,
    forces: &Forces,
    state: &mut State,
) {
    let lumps = lumps(&forces.x, &forces.y, &forces.force, forces.symmetry);
    let grid = &mesh.grid;
    let (ice, runner) = state.displacement.split_at_mut(3 * grid.node_count());
    if problem.ice.foundation == Foundation::HalfSpace {
        prescribe(grid, mesh.symmetry, material, &lumps, Side::Below, ice);
    }
    // An unbounded runner stands on all columns: a half-space too.
    if let Some(body) = mesh
        .level
        .bodies
        .get(1)
        .filter(|b| b.columns == mesh.level.bodies[0].columns)
    {
        let grid = TensorGrid {
            x: grid.x.clone(),
            y: grid.y.clone(),
            z: body.operator.axes[2].nodes.clone(),
        };
        prescribe(
            &grid,
            mesh.symmetry,
            body.material,
            &lumps,
            Side::Above,
            runner,
        );
    }
}

/// Solves the equations of one mesh for held outer faces, from `state`.
fn one_solve(
    mesh: &Discretisation,
    material: Material,
    greens: &[Mat<f64>; 2],
    state: &mut State,
    options: &Options,
) -> Progress {
    const ITERATIONS: usize = 1000;
    const SWEEPS: usize = 200_000;
    let level = &mesh.level;
    match options.method {
        Method::Accelerated => level.solve(state, greens, options.residual, ITERATIONS),
        Method::CholeskyActiveSet => Progress::direct(active_set(mesh, material, state)),
        Method::PlainSor => {
            let held = state.displacement.clone();
            level.solve(state, greens, options.residual, ITERATIONS);
            let tolerance = 1e-3 * options.residual;
            let sweeps = projected_sor(mesh, material, &held, state, tolerance, SWEEPS);
            Progress {
                iterations: sweeps.unwrap_or(SWEEPS),
                ..Progress::direct(sweeps.is_some())
            }
        }
    }
}

fn lumped_forces(mesh: &Discretisation, state: &State) -> Forces {
    Forces {
        x: mesh.grid.x.clone(),
        y: mesh.grid.y.clone(),
        force: state.force.clone(),
        symmetry: mesh.symmetry,
    }
}

/// Pressures and figures of a state.
struct Pressure {
    values: Vec<f64>,
    figures: Figures,
    patch: Patch,
}

struct Field<'a> {
    mesh: &'a Discretisation,
    patch: &'a Patch,
    hardness: f64,
}

fn field<'a>(mesh: &'a Discretisation, problem: &Problem, patch: &'a Patch) -> Field<'a> {
    Field {
        mesh,
        patch,
        hardness: problem.ice.hardness.unwrap_or(f64::INFINITY),
    }
}

impl Field<'_> {
    fn pressure_field<'b>(&'b self, state: &'b State) -> PressureField<'b> {
        let operator = &self.mesh.level.bodies[0].operator;
        PressureField {
            x: &self.mesh.grid.x,
            y: &self.mesh.grid.y,
            force: &state.force,
            lumped: [&operator.axes[0].lumped_mass, &operator.axes[1].lumped_mass],
            symmetry: self.mesh.symmetry,
            hardness: self.hardness,
        }
    }

    /// Whether a node in contact has a neighbour under no hull.
    fn touches_edge(&self, state: &State) -> bool {
        let nx = self.mesh.grid.x.len();
        let gap = &self.mesh.level.gap;
        (0..gap.len()).filter(|&n| state.force[n] > 0.0).any(|n| {
            let left = (n % nx > 0).then(|| n - 1);
            let right = (n % nx + 1 < nx).then_some(n + 1);
            let below = n.checked_sub(nx);
            let above = (n + nx < gap.len()).then_some(n + nx);
            [left, right, below, above]
                .into_iter()
                .flatten()
                .any(|n| gap[n].is_infinite())
        })
    }

    fn of(&self, state: &State) -> Pressure {
        let field = self.pressure_field(state);
        let values = field.pressures();
        let figures = field.figures(&values);
        let edge = self.touches_edge(state);
        let patch = found_patch(&field, &values, state.motion[0], self.patch, edge);
        Pressure {
            values,
            figures,
            patch,
        }
    }
}

fn report(
    level: usize,
    dofs: usize,
    progress: &Progress,
    p_max: f64,
    history: &mut Vec<Iterate>,
    options: &Options,
) {
    for update in &progress.updates {
        let iterate = Iterate {
            level,
            dofs,
            contact_nodes: update.contact_nodes,
            iterations: update.iterations,
            residual: update.residual,
            p_max,
        };
        if let Some(callback) = &options.progress {
            callback(&iterate);
        }
        history.push(iterate);
    }
}

#[allow(clippy::too_many_arguments)]
fn solution(
    problem: &Problem,
    gap: &Gap,
    mesh: Discretisation,
    state: State,
    progress: Progress,
    pressure: Pressure,
    limit: Extrapolation,
    dofs: usize,
    history: Vec<Iterate>,
) -> Solution {
    let Pressure {
        values, figures, ..
    } = pressure;
    let share = mesh
        .symmetry
        .iter()
        .map(|&s| if s { 0.5 } else { 1.0 })
        .product::<f64>();
    let resultant = mesh.level.resultant(&state);
    let fz = resultant[0] / share;
    // A mirror plane holds the centre of pressure; otherwise it follows from the moments about the line of action.
    let centre = |axis: usize, moment: f64| match mesh.symmetry[axis] {
        true => 0.0,
        false => gap.line_of_action[axis] + moment / resultant[0],
    };
    let centre_of_pressure = [centre(0, resultant[1]), centre(1, -resultant[2])];
    let [pitch, roll] = gap.tilt(state.motion[1], state.motion[2]);
    let gaps = mesh.level.gaps(&state);
    let ice_surface = mesh.level.ice_surface(&state.displacement);
    let surface = unfold(
        &mesh.grid.x,
        &mesh.grid.y,
        mesh.symmetry,
        [values, gaps, ice_surface],
    );
    let depth = mesh.level.depth(&state);
    let kkt_residual = kkt(&mesh.level, &state, &progress, depth);
    let nodes = mesh.grid.node_count();
    let u = &state.displacement;
    let displacement = by_node(&u[..3 * nodes]);
    Solution {
        p_max: limit.p_max,
        p_max_error: limit.error,
        p_mean: fz / figures.area,
        area: figures.area,
        length: figures.length,
        width: figures.width,
        approach: limit.approach,
        pitch,
        roll,
        fz,
        centre_of_pressure,
        kkt_residual,
        dofs,
        iterations: progress.iterations,
        history,
        surface,
        volume: VolumeField {
            grid: mesh.grid,
            displacement,
            youngs_modulus: problem.ice.youngs_modulus,
            poissons_ratio: problem.ice.poissons_ratio,
        },
        runner_volume: mesh.runner_mesh.map(|mesh| RunnerField {
            displacement: by_node(&u[3 * nodes..]),
            mesh,
        }),
        symmetry: mesh.symmetry,
    }
}

/// From component after component to node by node.
fn by_node(u: &[f64]) -> Vec<[f64; 3]> {
    let nodes = u.len() / 3;
    (0..nodes)
        .map(|n| [u[n], u[nodes + n], u[2 * nodes + n]])
        .collect()
}

/// Largest relative violation: equilibrium, balance, tension, penetration.
fn kkt(level: &Level, state: &State, progress: &Progress, depth: f64) -> f64 {
    let largest = state
        .force
        .iter()
        .fold(f64::MIN_POSITIVE, |m, f| m.max(f.abs()));
    let tension = state.force.iter().fold(0.0f64, |m, f| m.max(-f)) / largest;
    let penetration = level
        .gaps(state)
        .iter()
        .zip(&state.force)
        .zip(&level.bound)
        .fold(
            0.0f64,
            |m, ((g, f), b)| {
                if *f >= *b { m } else { m.max(-g) }
            },
        )
        / depth;
    // Moments are compared with the force times half the contact's extent.
    let reach = level
        .rows
        .iter()
        .zip(&state.force)
        .filter(|(_, f)| **f > 0.0)
        .fold([1.0f64, 1e-12, 1e-12], |m, (r, _)| {
            [1.0, m[1].max(r[1].abs()), m[2].max(r[2].abs())]
        });
    let resultant = level.resultant(state);
    let force = resultant[0].abs().max(f64::MIN_POSITIVE);
    let balance = (0..3)
        .filter(|&a| level.motion.free[a])
        .map(|a| (resultant[a] - level.motion.balance[a]).abs() / (force * reach[a]))
        .fold(0.0, f64::max);
    [progress.residual, tension, penetration, balance]
        .into_iter()
        .fold(0.0, f64::max)
}

/// Mirrors plane fields over the symmetry planes.
fn unfold(x: &[f64], y: &[f64], symmetry: [bool; 2], fields: [Vec<f64>; 3]) -> SurfaceField {
    let whole = |nodes: &[f64], symmetric: bool| -> (Vec<f64>, Vec<usize>) {
        if !symmetric {
            return (nodes.to_vec(), (0..nodes.len()).collect());
        }
        let mirrored = (1..nodes.len()).rev().map(|i| (-nodes[i], i));
        mirrored
            .chain((0..nodes.len()).map(|i| (nodes[i], i)))
            .unzip()
    };
    let (xs, is) = whole(x, symmetry[0]);
    let (ys, js) = whole(y, symmetry[1]);
    let spread = |values: &[f64]| -> Vec<f64> {
        js.iter()
            .flat_map(|&j| is.iter().map(move |&i| values[j * x.len() + i]))
            .collect()
    };
    let [pressure, gap, uz] = fields.map(|f| spread(&f));
    SurfaceField {
        x: xs,
        y: ys,
        pressure,
        gap,
        uz,
    }
}
