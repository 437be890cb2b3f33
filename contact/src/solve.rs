//! From a problem to a pressure field of the accuracy asked.

use crate::accuracy::extrapolation::{Extrapolation, Raw, Sequence, first_resolution};
use crate::accuracy::mesh_solve::{lumped_forces, solve_mesh};
use crate::accuracy::scout::scout;
use crate::active_set::progress::Progress;
use crate::bodies::elastic_body::ElasticBody;
use crate::grid::assembled::assemble;
use crate::grid::discretise::{Reach, Resolution, discretise};
use crate::problem::check::check;
use crate::problem::gap::Gap;
use crate::result::answer::solution;
use crate::result::pressure::field;
use crate::{Error, Iterate, Options, Problem, Solution, StiffnessForm};

/// Growth of the spacing away from the patch in a mesh of `cells` cells over half the patch.
fn growth(cells: f64) -> f64 {
    3.0 / cells
}

/// A mesh whose own pressure asks somewhere for cells below this part of those there is graded anew, with as many cells: two
/// meshes that both miss the peaks at a runner's ends would agree on a wrong pressure.
const COARSE: f64 = 0.6;

/// How often a mesh is graded anew; each time its cells may become three times smaller.
const REGRADINGS: usize = 6;

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
    // Among the workers from the start: every parallel loop begun outside would wait for one to wake up.
    rayon::scope(|_| refine(problem, options))
}

/// Solves on finer and finer meshes.
fn refine(problem: &Problem, options: &Options) -> Result<Solution, Error> {
    let material = check(problem, options)?;
    let gap = Gap::new(problem)?;
    let (mut patch, mut forces) = scout(problem, &gap, material, options)?;
    let mut cells = options.cells.map_or_else(
        || first_resolution(options.p_max_tolerance, patch.is_even()),
        |c| c as f64,
    );
    let mut history = Vec::new();
    let mut meshes = Sequence::new();
    // Whether this mesh has the cells of the previous one, graded anew, and how often that was so.
    let (mut graded_anew, mut regraded) = (false, 0);
    for level in 0.. {
        let resolution = Resolution {
            cells,
            growth: growth(cells),
        };
        let mut mesh = discretise(problem, &gap, material, &patch, resolution, Reach::Patch)?;
        if options.stiffness == StiffnessForm::Assembled {
            let element = problem.runner.elastic.as_ref().map(|e| e.element_kind());
            assemble(&mut mesh, element, options.max_stiffness_bytes)?;
        }
        let dofs = mesh.contact.bodies.iter().map(ElasticBody::free_dofs).sum();
        let (state, progress) = solve_mesh(problem, material, &mesh, &patch, &forces, options)?;
        let pressure = field(&mesh, problem, &patch).of(&state);
        let raw = Raw {
            cells: resolution.real_cells(mesh.symmetry),
            p_max: pressure.figures.p_max,
            approach: mesh.contact.depth(&state),
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
        meshes.push(raw, graded_anew);
        let limit = meshes.limit(patch.is_even());
        let wants_finer = regraded < REGRADINGS && pressure.patch.wants_finer_than(&patch, COARSE);
        let reached = |l: &Extrapolation| l.error <= options.p_max_tolerance * l.p_max;
        // That a finer grading changes nothing is as good as that no finer one is wanted.
        let graded = !wants_finer || graded_anew;
        if let Some(limit) = limit.filter(|l| graded && reached(l)) {
            return Ok(solution(
                problem, &gap, mesh, state, progress, pressure, limit, dofs, history,
            ));
        }
        graded_anew = wants_finer;
        let refinement = if wants_finer { 1.0 } else { REFINEMENT };
        if dofs as f64 * REFINEMENT.max(refinement.powi(3)) > options.max_dofs as f64 {
            let estimate = limit.map_or(f64::INFINITY, |l| l.error / l.p_max);
            return Err(Error::AccuracyNotReached {
                dofs,
                estimate,
                tolerance: options.p_max_tolerance,
            });
        }
        forces = lumped_forces(&mesh, &state);
        patch = if wants_finer {
            regraded += 1;
            pressure.patch
        } else {
            pressure.patch.with_sizes_of(&patch)
        };
        cells = (cells * refinement).round();
    }
    unreachable!("the loop ends by accuracy or by its limit of unknowns")
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ice, Load, Runner, Tilt};
    use kufe_mesh::Paraboloid;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn a_solve_ends_when_it_is_asked_to_before_and_in_between()
    -> Result<(), Box<dyn std::error::Error>> {
        let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?));
        let ice = Ice::half_space(9e9, 0.33);
        let problem = Problem::new(runner, ice, Load::central(1000.0, Tilt::Free));
        let stop = Arc::new(AtomicBool::new(true));
        let options = Options {
            stop: Some(stop.clone()),
            ..Options::default()
        };
        assert_eq!(solve(&problem, &options).err(), Some(Error::Stopped));
        // Raised after the first mesh; the second one's solve ends.
        stop.store(false, Ordering::Relaxed);
        let raised = stop.clone();
        let options = Options {
            progress: Some(Arc::new(move |_| raised.store(true, Ordering::Relaxed))),
            ..options
        };
        assert_eq!(solve(&problem, &options).err(), Some(Error::Stopped));
        Ok(())
    }
}
