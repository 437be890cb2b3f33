//! Two slow ways to the same answer, for tests: plain projected SOR on the stiffness, and an active set on
//! exact surface responses by sparse Cholesky. Both find motion and set by themselves; of the fast way they share the mesh.

use faer::Mat;
use kufe_fem::{BlockMatrix, Constraints, ElementKind, Factor, Material, assemble, to_components};
use kufe_mesh::TensorGrid;

use crate::active_set::motion::dot;
use crate::bodies::hexahedra::hexahedra;
use crate::grid::contact_mesh::{ContactMesh, State};
use crate::grid::discretise::Discretisation;
use crate::reference::own_set::OwnSet;
use crate::reference::plain_runner::PlainRunner;

const RELAXATION: f64 = 1.7;

/// The assembled stiffness of the ice and its held displacements, node by node.
struct Assembled {
    stiffness: BlockMatrix,
    constraints: Constraints,
    points: Vec<[f64; 3]>,
    top: usize,
}

fn assembled(
    grid: &TensorGrid,
    contact: &ContactMesh,
    material: Material,
    held: &[f64],
) -> Option<Assembled> {
    let body = hexahedra(contact.bodies[0].stiffness.grid()?, material).ok()?;
    let points = body.mesh().points.clone();
    let nodes = points.len();
    let stiffness = assemble(&body);
    let free = contact.bodies[0].free()?;
    let mut constraints = Constraints::new(nodes);
    for c in 0..3 {
        for node in 0..nodes {
            if !free[c * nodes + node] {
                constraints
                    .prescribe(node, c, held[c * nodes + node])
                    .ok()?;
            }
        }
    }
    let [nx, ny, nz] = grid.shape();
    Some(Assembled {
        stiffness,
        constraints,
        points,
        top: (nz - 1) * nx * ny,
    })
}

/// Contact by an active set on S, the exact vertical surface response, column by column from a Cholesky factor.
///
/// `state` enters with the held displacements and leaves solved. Returns whether it settled.
pub(crate) fn active_set(
    mesh: &Discretisation,
    material: Material,
    element: Option<ElementKind>,
    state: &mut State,
) -> bool {
    let contact = &mesh.contact;
    let Some(ice) = assembled(&mesh.grid, contact, material, &state.displacement) else {
        return false;
    };
    let map = ice.constraints.dof_map();
    let Ok(factor) = Factor::of_body(&ice.stiffness, &map, &ice.points) else {
        return false;
    };
    let nodes = ice.points.len();
    let unloaded = factor.displacement(
        &ice.stiffness,
        &ice.constraints,
        &map,
        &vec![0.0; 3 * nodes],
    );
    let n = contact.candidates.len();
    let vertical = |candidate: usize| 3 * (ice.top + contact.candidates[candidate]) + 2;
    let mut sides = vec![0.0; n * map.free_count()];
    for j in 0..n {
        if let Some(index) = map.index(vertical(j)) {
            sides[j * map.free_count() + index] = 1.0;
        }
    }
    factor.solve(&mut sides);
    let mut response = Mat::from_fn(n, n, |i, j| {
        map.index(vertical(i))
            .map_or(0.0, |index| sides[j * map.free_count() + index])
    });
    let mut base: Vec<f64> = (0..n)
        .map(|i| contact.gap[contact.candidates[i]] - unloaded[vertical(i)])
        .collect();
    let mut runner = None;
    if let Some(element) = element {
        let Some(part) = PlainRunner::new(mesh, element, state) else {
            return false;
        };
        response += part.response(&contact.candidates, contact.gap.len());
        let still = part.closing(&part.displacement(&[]), contact.gap.len());
        for (base, &node) in base.iter_mut().zip(&contact.candidates) {
            *base -= still[node];
        }
        runner = Some(part);
    }
    let rows: Vec<[f64; 3]> = contact
        .candidates
        .iter()
        .map(|&c| contact.rows[c])
        .collect();
    let bound: Vec<f64> = contact
        .candidates
        .iter()
        .map(|&c| contact.bound[c])
        .collect();
    let set = OwnSet {
        response: &response,
        gap: &base,
        rows: &rows,
        bound: &bound,
        motion: &contact.motion,
    };
    let Some((found, motion)) = set.solve(state.motion) else {
        return false;
    };
    let mut loads = vec![0.0; 3 * nodes];
    state.force.fill(0.0);
    for (i, &force) in found.iter().enumerate() {
        loads[vertical(i)] = -force;
        state.force[contact.candidates[i]] = force.max(0.0);
    }
    state.motion = motion;
    let u = factor.displacement(&ice.stiffness, &ice.constraints, &map, &loads);
    let (on_ice, on_runner) = state.displacement.split_at_mut(3 * nodes);
    to_components(&u, on_ice);
    if let Some(part) = runner {
        let forces = state.force.iter().copied().enumerate();
        let forces: Vec<(usize, f64)> = forces.filter(|(_, f)| *f != 0.0).collect();
        on_runner.copy_from_slice(&part.displacement(&forces));
    }
    true
}

/// Plain projected SOR on the stiffness, from the held displacements and the motion of `state`.
///
/// Every unknown in turn is relaxed towards its equation; the vertical displacement of a candidate is then
/// pushed down to the runner where it would penetrate. A motion that is free is an unknown like the others: it is relaxed towards its
/// balance with the gaps of all candidates as they are, that is with the ice below moving along, so that what is projected stays the
/// gap of one node at a time and the energy falls. Ends when a sweep changes nothing by more than `tolerance`
/// times the largest displacement. Returns the sweeps, or `None` where `limit` was reached.
pub(crate) fn projected_sor(
    mesh: &Discretisation,
    material: Material,
    state: &mut State,
    tolerance: f64,
    limit: usize,
) -> Option<usize> {
    let contact = &mesh.contact;
    let ice = assembled(&mesh.grid, contact, material, &state.displacement)?;
    let map = ice.constraints.dof_map();
    let nodes = ice.points.len();
    let mut u = vec![0.0; 3 * nodes];
    ice.constraints.write_values(&mut u);
    let mut ceiling = vec![f64::INFINITY; nodes];
    for &c in &contact.candidates {
        ceiling[ice.top + c] = contact.gap[c] - dot(contact.rows[c], state.motion);
    }
    let graph = &ice.stiffness.graph;
    let vertical = |u: &[f64], node: usize| -> f64 {
        let range = graph.row_start[node]..graph.row_start[node + 1];
        let blocks = ice.stiffness.blocks[range.clone()].iter();
        let others = blocks.zip(&graph.neighbours[range]);
        let terms = others.map(|(block, &other)| {
            let at = 3 * other as usize;
            block[2][0] * u[at] + block[2][1] * u[at + 1] + block[2][2] * u[at + 2]
        });
        terms.sum()
    };
    // A line of N^T K u, over the candidates.
    let pushed = |a: usize, u: &[f64]| -> f64 {
        let candidates = contact.candidates.iter();
        let terms = candidates.map(|&c| contact.rows[c][a] * vertical(u, ice.top + c));
        terms.sum()
    };
    let free = (0..3).filter(|&a| contact.motion.free[a]);
    let turns: Vec<(usize, f64)> = free
        .map(|a| {
            let mut along = vec![0.0; 3 * nodes];
            for &c in &contact.candidates {
                along[3 * (ice.top + c) + 2] = contact.rows[c][a];
            }
            (a, pushed(a, &along))
        })
        .filter(|(_, stiffness)| *stiffness > 0.0)
        .collect();
    let mut sweeps = None;
    for sweep in 1..=limit {
        let (mut change, mut largest) = (0.0f64, 0.0f64);
        for node in 0..nodes {
            let range = graph.row_start[node]..graph.row_start[node + 1];
            for c in 0..3 {
                if map.index(3 * node + c).is_none() {
                    continue;
                }
                let (mut sum, mut diagonal) = (0.0, 0.0);
                for (block, &other) in ice.stiffness.blocks[range.clone()]
                    .iter()
                    .zip(&graph.neighbours[range.clone()])
                {
                    let at = 3 * other as usize;
                    sum += block[c][0] * u[at] + block[c][1] * u[at + 1] + block[c][2] * u[at + 2];
                    if other as usize == node {
                        diagonal = block[c][c];
                    }
                }
                let wanted = u[3 * node + c] - RELAXATION * sum / diagonal;
                let value = if c == 2 {
                    wanted.min(ceiling[node])
                } else {
                    wanted
                };
                change = change.max((value - u[3 * node + c]).abs());
                largest = largest.max(value.abs());
                u[3 * node + c] = value;
            }
        }
        for &(a, stiffness) in &turns {
            let out = contact.motion.balance[a] + pushed(a, &u);
            let turn = RELAXATION * out / stiffness;
            state.motion[a] += turn;
            for &c in &contact.candidates {
                let down = contact.rows[c][a] * turn;
                u[3 * (ice.top + c) + 2] -= down;
                ceiling[ice.top + c] -= down;
                change = change.max(down.abs());
            }
        }
        if change <= tolerance * largest {
            sweeps = Some(sweep);
            break;
        }
    }
    let mut reaction = vec![0.0; 3 * nodes];
    ice.stiffness.apply(&u, &mut reaction);
    state.force.fill(0.0);
    for &c in &contact.candidates {
        let node = ice.top + c;
        if u[3 * node + 2] >= ceiling[node] {
            state.force[c] = (-reaction[3 * node + 2]).max(0.0);
        }
    }
    to_components(&u, &mut state.displacement);
    sweeps
}
