//! The solve on one mesh.

use faer::Mat;
use kufe_fem::Material;
use kufe_mesh::TensorGrid;

use crate::active_set::plane_problem::PlaneState;
use crate::active_set::progress::{Limit, Progress};
use crate::bodies::columns::Side;
use crate::bodies::far_field::{lumps, prescribe};
use crate::grid::contact_mesh::State;
use crate::grid::discretise::Discretisation;
use crate::grid::patch::Patch;
use crate::reference::plain::{active_set, projected_sor};
use crate::{Error, Foundation, Load, Method, Options, Problem};

/// Contact forces as they are known so far, on the plane they were found on.
pub(crate) struct Forces {
    x: Vec<f64>,
    y: Vec<f64>,
    force: Vec<f64>,
    symmetry: [bool; 2],
}

/// Solves on one mesh, beginning with the contact on the plane alone.
pub(crate) fn solve_mesh(
    problem: &Problem,
    material: Material,
    mesh: &Discretisation,
    patch: &Patch,
    forces: &Forces,
    options: &Options,
) -> Result<(State, Progress), Error> {
    let contact = &mesh.contact;
    let greens = contact.greens();
    let base = contact.unpressed_gap();
    let start = PlaneState {
        force: vec![0.0; contact.candidates.len()],
        motion: [patch.motion, 0.0, 0.0],
        settled: false,
    };
    let found = contact.plane_contact(&greens[1], &base, start);
    let mut force = vec![0.0; contact.gap.len()];
    for (&node, f) in contact.candidates.iter().zip(&found.force) {
        force[node] = *f;
    }
    let mut state = State {
        displacement: vec![0.0; contact.len()],
        force,
        motion: found.motion,
    };
    hold_outer_faces(problem, material, mesh, forces, &mut state);
    let mut progress = one_solve(problem, mesh, material, &greens, &mut state, options)?;
    if matches!(problem.load, Load::Approach { .. })
        && problem.ice.foundation == Foundation::HalfSpace
    {
        // The force, and with it the far field, follows from the solution.
        const ROUNDS: usize = 20;
        for _ in 0..ROUNDS {
            let before = contact.resultant(&state)[0];
            hold_outer_faces(
                problem,
                material,
                mesh,
                &lumped_forces(mesh, &state),
                &mut state,
            );
            if options.stopped() {
                break;
            }
            let again = one_solve(problem, mesh, material, &greens, &mut state, options)?;
            progress.iterations += again.iterations;
            progress.converged &= again.converged;
            progress.residual = again.residual;
            progress.updates.extend(again.updates);
            if (contact.resultant(&state)[0] - before).abs() <= 1e-6 * before {
                break;
            }
        }
    }
    if options.stopped() {
        return Err(Error::Stopped);
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
    let (on_ice, on_runner) = state.displacement.split_at_mut(3 * grid.node_count());
    if problem.ice.foundation == Foundation::HalfSpace {
        prescribe(grid, mesh.symmetry, material, &lumps, Side::Below, on_ice);
    }
    // An unbounded runner stands on all columns: a half-space too.
    if let [ice, body] = &mesh.contact.bodies[..]
        && body.columns() == ice.columns()
        && let Some(operator) = body.stiffness.grid()
    {
        let grid = TensorGrid {
            x: grid.x.clone(),
            y: grid.y.clone(),
            z: operator.axes[2].nodes.clone(),
        };
        prescribe(
            &grid,
            mesh.symmetry,
            body.material,
            &lumps,
            Side::Above,
            on_runner,
        );
    }
}

/// Solves the equations of one mesh for held outer faces, from `state`.
fn one_solve(
    problem: &Problem,
    mesh: &Discretisation,
    material: Material,
    greens: &[Mat<f64>; 2],
    state: &mut State,
    options: &Options,
) -> Result<Progress, Error> {
    let limit = Limit {
        iterations: 1000,
        options,
    };
    const SWEEPS: usize = 200_000;
    let contact = &mesh.contact;
    #[cfg(feature = "gpu")]
    if let Some(device) = &options.device {
        return contact.solve_on_device(device, state, greens, options.residual, &limit);
    }
    Ok(match options.method {
        Method::Accelerated => contact.solve(state, greens, options.residual, &limit),
        Method::CholeskyActiveSet => {
            let element = problem.runner.elastic.as_ref().map(|e| e.element_kind());
            Progress::direct(active_set(mesh, material, element, state))
        }
        Method::PlainSor => {
            let held = state.displacement.clone();
            contact.solve(state, greens, options.residual, &limit);
            let tolerance = 1e-3 * options.residual;
            let sweeps = projected_sor(mesh, material, &held, state, tolerance, SWEEPS);
            Progress {
                iterations: sweeps.unwrap_or(SWEEPS),
                ..Progress::direct(sweeps.is_some())
            }
        }
    })
}

pub(crate) fn lumped_forces(mesh: &Discretisation, state: &State) -> Forces {
    Forces {
        x: mesh.grid.x.clone(),
        y: mesh.grid.y.clone(),
        force: state.force.clone(),
        symmetry: mesh.symmetry,
    }
}
