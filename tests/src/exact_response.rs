//! An independent contact solver: exact surface responses of the assembled bodies by sparse
//! Cholesky, and a primal-dual active set (M. Hintermüller, K. Ito and K. Kunisch, SIAM J. Optim.
//! 13 (2003) 865-888).
//!
//! Mesh, stiffness, displacements of fixed nodes and undeformed gap are those of the tested
//! solution. Contact set, forces and rigid motion are computed independently.

use std::collections::HashMap;

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use kufe_contact::{AssembledBody, Load, Options, Problem, Solution, StiffnessForm, Tilt, solve};

/// A solution and its differences from the independent one.
pub struct Compared {
    /// The solution.
    pub solution: Solution,
    /// Largest difference of a contact force, over the largest force.
    pub force: f64,
    /// Largest change of the gap by the difference of the rigid motions, over the largest change of
    /// the gap by displacements.
    pub motion: f64,
    /// Number of contact nodes, and of those at the hardness of the ice.
    pub nodes: [usize; 2],
}

/// Iteration limit of the active set; about ten are usual.
const SETS: usize = 100;
/// Tension over the largest force, and penetration over the largest gap, below which either is
/// rounding.
const SLACK: f64 = 1e-11;
/// Distance, in nodes, from the contact nodes to the outermost candidates.
const AROUND: usize = 3;

/// Solves on one mesh of `cells` cells over half the patch, by the library and by exact responses.
///
/// # Panics
/// If there is no solution or the active set does not converge.
pub fn by_exact_responses(problem: &Problem, cells: usize) -> Compared {
    let options = Options {
        cells: Some(cells),
        residual: 1e-11,
        stiffness: StiffnessForm::Assembled,
        ..Options::default()
    };
    let solution = solve(problem, &options).expect("a solution");
    let (force, motion, nodes) = Plane::of(problem, &solution).compared();
    println!(
        "p_max {:.3} MPa, {} unknowns: forces differ by {force:.1e}, motions by {motion:.1e}",
        1e-6 * solution.p_max,
        solution.dofs
    );
    Compared {
        solution,
        force,
        motion,
        nodes,
    }
}

/// One body and its nodes on the contact plane.
struct Body<'a> {
    assembled: &'a AssembledBody,
    displacement: Vec<f64>,
    /// Degree of freedom of the vertical displacement at each plane node; `None` outside the body.
    vertical: Vec<Option<usize>>,
    /// Sign of an upward displacement in the gap closure: 1 for the ice, -1 for the runner.
    sign: f64,
}

impl Body<'_> {
    fn product(&self) -> Vec<f64> {
        let mut force = vec![0.0; self.displacement.len()];
        self.assembled
            .stiffness
            .apply(&self.displacement, &mut force);
        force
    }

    /// Closure of the gap at `nodes` without contact forces, and under a unit force on each of them.
    fn response(&self, nodes: &[usize]) -> (Vec<f64>, Mat<f64>) {
        let dofs = self.displacement.len();
        let mut number = vec![usize::MAX; dofs];
        let mut fixed = vec![false; dofs];
        self.assembled
            .fixed
            .iter()
            .for_each(|&dof| fixed[dof] = true);
        let free: Vec<usize> = (0..dofs).filter(|&dof| !fixed[dof]).collect();
        free.iter()
            .enumerate()
            .for_each(|(k, &dof)| number[dof] = k);
        let entries = self.assembled.stiffness.lower();
        let entries = entries.filter(|(row, column, _)| !fixed[*row] && !fixed[*column]);
        let entries: Vec<Triplet<usize, usize, f64>> = entries
            .map(|(row, column, value)| Triplet::new(number[row], number[column], value))
            .collect();
        let n = free.len();
        let matrix = SparseColMat::try_new_from_triplets(n, n, &entries).expect("entries");
        let factor = matrix.sp_cholesky(Side::Lower).expect("positive definite");
        // Right-hand side without contact forces: K u - contact forces - K_fixed u_fixed.
        let mut load = self.product();
        self.vertical
            .iter()
            .flatten()
            .for_each(|&dof| load[dof] = 0.0);
        let mut prescribed = self.displacement.clone();
        free.iter().for_each(|&dof| prescribed[dof] = 0.0);
        let mut by_fixed = vec![0.0; dofs];
        self.assembled.stiffness.apply(&prescribed, &mut by_fixed);
        let at = |node: usize| self.vertical[node].map(|dof| number[dof]);
        let columns = Mat::from_fn(n, nodes.len() + 1, |row, column| {
            match column.checked_sub(1) {
                None => load[free[row]] - by_fixed[free[row]],
                Some(k) => f64::from(u8::from(at(nodes[k]) == Some(row))),
            }
        });
        let solved = factor.solve(&columns);
        let closing =
            |node: usize, column: usize| at(node).map_or(0.0, |row| solved[(row, column)]);
        let unpressed = nodes
            .iter()
            .map(|&node| self.sign * closing(node, 0))
            .collect();
        let own = |i: usize, j: usize| closing(nodes[i], j + 1);
        (unpressed, Mat::from_fn(nodes.len(), nodes.len(), own))
    }
}

/// The solved part of the contact plane.
struct Plane<'a> {
    bodies: Vec<Body<'a>>,
    /// Plane nodes that are candidates for contact.
    nodes: Vec<usize>,
    /// Gap with the rigid motion of the solution and without displacements [m].
    gap: Vec<f64>,
    /// Gap closure per unit approach, pitch and roll.
    rows: Vec<[f64; 3]>,
    /// Largest force of each node [N].
    bound: Vec<f64>,
    free: [bool; 3],
    balance: [f64; 3],
}

#[derive(Clone, Copy, PartialEq)]
enum Node {
    Open,
    Closed,
    Full,
}

impl<'a> Plane<'a> {
    fn of(problem: &Problem, solution: &'a Solution) -> Self {
        let ice = solution.volume.as_ref().expect("finite elements");
        let grid = &ice.grid;
        let [nx, ny, nz] = grid.shape();
        let surface = &solution.surface;
        // The surface is the whole patch. The solved part is its last rows and columns.
        let (all, rows) = (surface.x.len(), surface.y.len());
        let part = |field: &[f64]| -> Vec<f64> {
            let rows = field.chunks_exact(all).skip(rows - ny);
            rows.flat_map(|row| row[all - nx..].to_vec()).collect()
        };
        let by_component = |field: &[[f64; 3]]| -> Vec<f64> {
            (0..3)
                .flat_map(|c| field.iter().map(move |u| u[c]))
                .collect()
        };
        let top = 2 * nx * ny * nz + (nz - 1) * nx * ny;
        let mut bodies = vec![Body {
            assembled: &solution.assembled[0],
            displacement: by_component(&ice.displacement),
            vertical: (0..nx * ny).map(|n| Some(top + n)).collect(),
            sign: 1.0,
        }];
        if let Some(runner) = &solution.runner_volume {
            let points = &runner.mesh.points;
            // The lowest node of each column.
            let mut lowest: HashMap<[u64; 2], usize> = HashMap::new();
            for (node, p) in points.iter().enumerate() {
                let at = lowest
                    .entry([p[0].to_bits(), p[1].to_bits()])
                    .or_insert(node);
                if p[2] < points[*at][2] {
                    *at = node;
                }
            }
            let place = |n: usize| [grid.x[n % nx].to_bits(), grid.y[n / nx].to_bits()];
            let vertical = |n: usize| lowest.get(&place(n)).map(|node| 2 * points.len() + node);
            bodies.push(Body {
                assembled: &solution.assembled[1],
                displacement: by_component(&runner.displacement),
                vertical: (0..nx * ny).map(vertical).collect(),
                sign: -1.0,
            });
        }
        let (pressure, gaps) = (part(&surface.pressure), part(&surface.gap));
        let touches = |n: &usize| {
            let (i, j) = (n % nx, n / nx);
            let columns = i.saturating_sub(AROUND)..=(i + AROUND).min(nx - 1);
            let mut rows = j.saturating_sub(AROUND)..=(j + AROUND).min(ny - 1);
            rows.any(|j| columns.clone().any(|i| pressure[j * nx + i] > 0.0))
        };
        let nodes = (0..nx * ny).filter(|&n| gaps[n].is_finite());
        let nodes: Vec<usize> = nodes.filter(touches).collect();
        let closing = |n: usize| -> f64 {
            let of = |body: &Body| body.vertical[n].map_or(0.0, |dof| body.displacement[dof]);
            bodies.iter().map(|body| body.sign * of(body)).sum()
        };
        let (fz, line, tilt) = match problem.load {
            Load::Force {
                fz,
                offset_x,
                offset_y,
                tilt,
            } => (fz, [offset_x, offset_y], tilt),
            Load::Approach { .. } => panic!("a load is expected"),
        };
        let share: f64 = solution
            .symmetry
            .map(|s| if s { 0.5 } else { 1.0 })
            .iter()
            .product();
        let tilts = tilt == Tilt::Free;
        let width = |nodes: &[f64], k: usize| {
            0.5 * (nodes[(k + 1).min(nodes.len() - 1)] - nodes[k.saturating_sub(1)])
        };
        let area = |n: usize| width(&grid.x, n % nx) * width(&grid.y, n / nx);
        let hardness = problem.ice.hardness.unwrap_or(f64::INFINITY);
        Plane {
            gap: nodes.iter().map(|&n| gaps[n] + closing(n)).collect(),
            rows: nodes
                .iter()
                .map(|&n| [1.0, grid.x[n % nx] - line[0], line[1] - grid.y[n / nx]])
                .collect(),
            bound: nodes.iter().map(|&n| hardness * area(n)).collect(),
            // A mirror plane has no tilt across it.
            free: [
                true,
                tilts && !solution.symmetry[0],
                tilts && !solution.symmetry[1],
            ],
            balance: [fz * share, 0.0, 0.0],
            bodies,
            nodes,
        }
    }

    fn compared(&self) -> (f64, f64, [usize; 2]) {
        let n = self.nodes.len();
        let (mut base, mut response) = (self.gap.clone(), Mat::<f64>::zeros(n, n));
        for body in &self.bodies {
            let (unpressed, own) = body.response(&self.nodes);
            base.iter_mut()
                .zip(unpressed)
                .for_each(|(gap, u)| *gap -= u);
            response += own;
        }
        let (force, change, nodes) = self.solved(&base, &response);
        // Contact is the only load on the surface of the ice.
        let ice = &self.bodies[0];
        let product = ice.product();
        let expected = self.nodes.iter();
        let expected = expected.map(|&node| ice.vertical[node].map_or(0.0, |dof| -product[dof]));
        let largest = force.iter().copied().fold(0.0, f64::max);
        let pairs = force.iter().zip(expected);
        let differ = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
        let moved = |row: &[f64; 3]| (0..3).map(|a| row[a] * change[a]).sum::<f64>().abs();
        let moved = self.rows.iter().map(moved).fold(0.0, f64::max);
        let deepest = (0..n).map(|i| (0..n).map(|j| response[(i, j)] * force[j]).sum::<f64>());
        let deepest = deepest.fold(0.0, f64::max);
        let count = |kind: Node| nodes.iter().filter(|node| **node == kind).count();
        let full = count(Node::Full);
        (differ, moved / deepest, [count(Node::Closed) + full, full])
    }

    /// Forces, change of the rigid motion and state of each node, starting with all nodes closed.
    fn solved(&self, base: &[f64], response: &Mat<f64>) -> (Vec<f64>, [f64; 3], Vec<Node>) {
        let n = base.len();
        let mut nodes = vec![Node::Closed; n];
        for _ in 0..SETS {
            let (force, motion) = self.for_states(&nodes, base, response);
            let largest = force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
            let gap = |i: usize| {
                let moved: f64 = (0..3).map(|a| self.rows[i][a] * motion[a]).sum();
                let pressed: f64 = (0..n).map(|j| response[(i, j)] * force[j]).sum();
                base[i] - moved + pressed
            };
            let gaps: Vec<f64> = (0..n).map(gap).collect();
            let size = gaps.iter().fold(0.0f64, |m, gap| m.max(gap.abs()));
            let next = (0..n).map(|i| match nodes[i] {
                Node::Closed if force[i] < -SLACK * largest => Node::Open,
                Node::Closed if force[i] > self.bound[i] + SLACK * largest => Node::Full,
                Node::Open if gaps[i] < -SLACK * size => Node::Closed,
                Node::Full if gaps[i] > SLACK * size => Node::Closed,
                same => same,
            });
            let next: Vec<Node> = next.collect();
            if next == nodes {
                return (force, motion, nodes);
            }
            nodes = next;
        }
        panic!("the active set did not converge in {SETS} iterations");
    }

    /// Forces and motion for given node states. Closed gaps and load balance form one linear system.
    fn for_states(
        &self,
        nodes: &[Node],
        base: &[f64],
        response: &Mat<f64>,
    ) -> (Vec<f64>, [f64; 3]) {
        let n = nodes.len();
        let at_bound = |i: usize| {
            if nodes[i] == Node::Full {
                self.bound[i]
            } else {
                0.0
            }
        };
        let mut force: Vec<f64> = (0..n).map(at_bound).collect();
        let closed: Vec<usize> = (0..n).filter(|&i| nodes[i] == Node::Closed).collect();
        let free: Vec<usize> = (0..3).filter(|&a| self.free[a]).collect();
        // Forces are scaled by the compliance of a node, so that all unknowns have the unit of a
        // length.
        let scale = response[(0, 0)];
        let m = closed.len();
        let matrix = Mat::from_fn(m + free.len(), m + free.len(), |i, j| {
            match (closed.get(i), closed.get(j)) {
                (Some(&i), Some(&j)) => response[(i, j)] / scale,
                (Some(&i), None) => -self.rows[i][free[j - m]],
                (None, Some(&j)) => self.rows[j][free[i - m]],
                (None, None) => 0.0,
            }
        });
        let side = Mat::from_fn(m + free.len(), 1, |i, _| match closed.get(i) {
            Some(&i) => -base[i] - (0..n).map(|j| response[(i, j)] * force[j]).sum::<f64>(),
            None => {
                let a = free[i - m];
                let full: f64 = (0..n).map(|j| self.rows[j][a] * force[j]).sum();
                scale * (self.balance[a] - full)
            }
        });
        let solved = matrix.partial_piv_lu().solve(&side);
        closed
            .iter()
            .enumerate()
            .for_each(|(k, &i)| force[i] = solved[(k, 0)] / scale);
        let mut motion = [0.0; 3];
        free.iter()
            .enumerate()
            .for_each(|(k, &a)| motion[a] = solved[(m + k, 0)]);
        (force, motion)
    }
}
