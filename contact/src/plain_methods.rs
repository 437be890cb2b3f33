//! Two slow ways to the same answer, for tests: plain projected SOR on the stiffness, and an active set on
//! exact surface responses by sparse Cholesky. Both find motion and set by themselves; of the fast way they share the mesh.

use faer::Mat;
use kufe_fem::{
    BlockMatrix, Body as Solid, Constraints, DofMap, ElementKind, Factor, Material, assemble,
    to_components, to_nodes,
};
use kufe_mesh::TensorGrid;
use nalgebra::{Matrix3, Vector3};

use crate::bodies::elastic_body::{ElasticBody, hexahedra};
use crate::mesh::contact_mesh::{ContactMesh, State};
use crate::mesh::discretise::Discretisation;
use crate::motion::{Motion, dot};
use crate::precondition::dense::DenseCholesky;

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

// The elastic runner in the slow way to the answer: its exact surface response by sparse Cholesky.

/// The factorised runner of a mesh, its held displacements and what loads it.
pub(crate) struct PlainRunner<'a> {
    body: &'a ElasticBody,
    stiffness: BlockMatrix,
    constraints: Constraints,
    map: DofMap,
    factor: Factor,
    /// Forces from outside, node by node [N].
    load: Vec<f64>,
}

impl<'a> PlainRunner<'a> {
    /// The runner of `mesh`, held where `state` has its held displacements. None where it cannot be factorised.
    pub fn new(mesh: &'a Discretisation, element: ElementKind, state: &State) -> Option<Self> {
        let body = mesh.contact.bodies.get(1)?;
        let solid = Solid::uniform(mesh.runner_mesh.clone()?, body.material, element).ok()?;
        let nodes = solid.node_count();
        let start = mesh.contact.bodies[0].len();
        let held = &state.displacement[start..start + body.len()];
        let free = body.free()?;
        let mut constraints = Constraints::new(nodes);
        for c in 0..3 {
            for node in 0..nodes {
                let at = c * nodes + node;
                if !free[at] {
                    constraints.prescribe(node, c, held[at]).ok()?;
                }
            }
        }
        let map = constraints.dof_map();
        let stiffness = assemble(&solid);
        let factor = Factor::of_body(&stiffness, &map, &solid.mesh().points).ok()?;
        let mut load = vec![0.0; 3 * nodes];
        if !body.load.is_empty() {
            to_nodes(&body.load, &mut load);
        }
        Some(PlainRunner {
            body,
            stiffness,
            constraints,
            map,
            factor,
            load,
        })
    }

    /// Displacements by components under forces (node of the plane, value), loads and held displacements.
    pub fn displacement(&self, forces: &[(usize, f64)]) -> Vec<f64> {
        let mut contact = vec![0.0; self.body.len()];
        self.body.trace.add_forces(forces, &mut contact);
        let mut loads = vec![0.0; contact.len()];
        to_nodes(&contact, &mut loads);
        for (load, own) in loads.iter_mut().zip(&self.load) {
            *load = own - *load;
        }
        let u = self
            .factor
            .displacement(&self.stiffness, &self.constraints, &self.map, &loads);
        let mut out = vec![0.0; u.len()];
        to_components(&u, &mut out);
        out
    }

    /// Closing of the plane's nodes by displacements.
    pub fn closing(&self, displacement: &[f64], plane_nodes: usize) -> Vec<f64> {
        let mut closing = vec![0.0; plane_nodes];
        self.body.trace.add_closing(displacement, &mut closing);
        closing
    }

    /// B K^-1 B^T between the plane's nodes `nodes`.
    pub fn response(&self, nodes: &[usize], plane_nodes: usize) -> Mat<f64> {
        let still = self.closing(&self.displacement(&[]), plane_nodes);
        let columns: Vec<Vec<f64>> = nodes
            .iter()
            .map(|&node| self.closing(&self.displacement(&[(node, 1.0)]), plane_nodes))
            .collect();
        Mat::from_fn(nodes.len(), nodes.len(), |i, j| {
            still[nodes[i]] - columns[j][nodes[i]]
        })
    }
}

// Contact on a plane whose response is known exactly, by a primal-dual active set of its own.

/// The contact problem: gap = `gap` - N q + S f, 0 <= f_i <= bound_i, N^T f = balance for the motions that are free.
pub(crate) struct OwnSet<'a> {
    /// S, symmetric positive definite [m/N].
    pub response: &'a Mat<f64>,
    /// Gap without motion and forces [m].
    pub gap: &'a [f64],
    /// Rows N.
    pub rows: &'a [[f64; 3]],
    /// Largest force of each node [N].
    pub bound: &'a [f64],
    /// Which motions are free, and the balance that they answer to.
    pub motion: &'a Motion,
}

/// What a node does.
#[derive(Clone, Copy, PartialEq)]
enum Node {
    Open,
    Closed,
    Full,
}

/// Most sets; a primal-dual active set takes some ten.
const SETS: usize = 100;
/// Tension over the largest force, and penetration over the deepest one, that are rounding.
const SLACK: f64 = 1e-11;

impl OwnSet<'_> {
    /// Forces and motion, from all nodes closed; the motions that are held are those of `held`. `None` where the sets go in circles.
    ///
    /// M. Hintermüller, K. Ito and K. Kunisch, SIAM J. Optim. 13 (2003) 865-888.
    pub fn solve(&self, held: [f64; 3]) -> Option<(Vec<f64>, [f64; 3])> {
        let n = self.gap.len();
        let mut nodes = vec![Node::Closed; n];
        for _ in 0..SETS {
            let (force, motion) = self.on(&nodes, held)?;
            let largest = force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
            let gaps: Vec<f64> = (0..n)
                .map(|i| {
                    let moved: f64 = (0..n).map(|j| self.response[(i, j)] * force[j]).sum();
                    self.gap[i] - dot(self.rows[i], motion) + moved
                })
                .collect();
            let deepest = (0..n).fold(0.0f64, |m, i| {
                m.max((self.gap[i] - dot(self.rows[i], motion)).abs())
            });
            let next: Vec<Node> = (0..n)
                .map(|i| match nodes[i] {
                    Node::Closed if force[i] < -SLACK * largest => Node::Open,
                    Node::Closed if force[i] > self.bound[i] + SLACK * largest => Node::Full,
                    Node::Open if gaps[i] < -SLACK * deepest => Node::Closed,
                    Node::Full if gaps[i] > SLACK * deepest => Node::Closed,
                    stays => stays,
                })
                .collect();
            if next == nodes {
                return Some((force, motion));
            }
            nodes = next;
        }
        None
    }

    /// Forces and motion with the nodes as they are: S_cc f_c = N_c q - gap_c - S_cf bound_f, and the balance by its Schur complement.
    fn on(&self, nodes: &[Node], held: [f64; 3]) -> Option<(Vec<f64>, [f64; 3])> {
        let (s, n) = (self.response, nodes.len());
        let mut force: Vec<f64> = (0..n)
            .map(|i| match nodes[i] {
                Node::Full => self.bound[i],
                Node::Open | Node::Closed => 0.0,
            })
            .collect();
        let closed: Vec<usize> = (0..n).filter(|&i| nodes[i] == Node::Closed).collect();
        let m = closed.len();
        if m == 0 {
            return None;
        }
        let factor = DenseCholesky::new(&Mat::from_fn(m, m, |i, j| s[(closed[i], closed[j])]))?;
        let solved = factor.solve(&Mat::from_fn(m, 4, |k, column| match column {
            3 => {
                let i = closed[k];
                self.gap[i] + (0..n).map(|j| s[(i, j)] * force[j]).sum::<f64>()
            }
            a => self.rows[closed[k]][a],
        }));
        let along = |a: usize, column: usize| -> f64 {
            let of = closed.iter().enumerate();
            of.map(|(k, &i)| self.rows[i][a] * solved[(k, column)])
                .sum()
        };
        let (mut matrix, mut side) = (Matrix3::identity(), Vector3::from(held));
        for a in (0..3).filter(|&a| self.motion.free[a]) {
            let full: f64 = (0..n).map(|i| self.rows[i][a] * force[i]).sum();
            side[a] = self.motion.balance[a] - full + along(a, 3);
            for b in 0..3 {
                matrix[(a, b)] = along(a, b);
            }
        }
        // A motion that no node feels (the roll on one row of nodes) has no line in the balance: the least motion is taken. Rows of
        // units apart are brought to one size first.
        let size = Vector3::from_fn(|a, _| match matrix[(a, a)] {
            d if d > 0.0 => f64::sqrt(d),
            _ => 1.0,
        });
        let scaled = Matrix3::from_fn(|a, b| matrix[(a, b)] / (size[a] * size[b]));
        let found = scaled.svd(true, true);
        let motion = found.solve(&side.component_div(&size), 1e-12).ok()?;
        let motion: [f64; 3] = motion.component_div(&size).into();
        for (k, &i) in closed.iter().enumerate() {
            force[i] = (0..3).map(|a| solved[(k, a)] * motion[a]).sum::<f64>() - solved[(k, 3)];
        }
        Some((force, motion))
    }
}
