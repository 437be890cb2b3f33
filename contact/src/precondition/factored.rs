//! Exact preconditioner of a runner of unstructured hexahedra: its sparse factor.

use std::collections::BTreeMap;
use std::sync::Arc;

use faer::Mat;
use kufe_fem::{to_components, to_nodes};
use kufe_mesh::TensorGrid;

use crate::RunnerSolid;
use crate::precondition::planewise::InverseWork;

/// K^-1 by sparse Cholesky, with a mortar as trace on the contact plane.
pub(crate) struct FactoredInverse {
    solid: Arc<RunnerSolid>,
    mortar: Arc<Mortar>,
}

impl FactoredInverse {
    /// The inverse of a solid over the plane of `mortar`.
    pub fn new(solid: Arc<RunnerSolid>, mortar: Arc<Mortar>) -> Self {
        FactoredInverse { solid, mortar }
    }

    /// Vectors for the methods below.
    pub fn work(&self) -> InverseWork {
        let length = 3 * self.solid.mesh().points.len();
        InverseWork {
            intermediate: vec![0.0; length],
            scratch: vec![0.0; length],
            by_node: vec![0.0; length],
            ..InverseWork::default()
        }
    }

    /// K^-1 `r`, by components, through vectors node by node.
    fn solve(&self, r: &[f64], by_node: &mut [f64], out: &mut [f64]) {
        to_nodes(r, by_node);
        let mut free = self.solid.map.restrict(by_node);
        self.solid.factor.solve(&mut free);
        by_node.fill(0.0);
        self.solid.map.extend(&free, by_node);
        to_components(by_node, out);
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::begin`].
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut InverseWork) {
        work.intermediate.copy_from_slice(residual);
        self.solve(residual, &mut work.by_node, &mut work.scratch);
        self.mortar.add_closing(&work.scratch, closing);
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::finish`].
    pub fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64], work: &mut InverseWork) {
        self.mortar
            .add_forces(multipliers, -1.0, &mut work.intermediate);
        self.solve(&work.intermediate, &mut work.by_node, step);
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::respond`].
    pub fn respond(&self, forces: &[(usize, f64)], closing: &mut [f64], work: &mut InverseWork) {
        work.intermediate.fill(0.0);
        self.mortar.add_forces(forces, 1.0, &mut work.intermediate);
        self.solve(&work.intermediate, &mut work.by_node, &mut work.scratch);
        self.mortar.add_closing(&work.scratch, closing);
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::green`]; both are exact.
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        let row = |node: usize| self.mortar.rows[node].iter();
        let mut used: Vec<usize> = nodes
            .iter()
            .flat_map(|&n| row(n).map(|&(k, _)| k))
            .collect();
        used.sort_unstable();
        used.dedup();
        let numbers: Vec<usize> = used.iter().map(|&k| self.solid.surface[k]).collect();
        let responses = self.solid.responses(&numbers);
        // W S, then W S W^T.
        let n = nodes.len();
        let half = Mat::from_fn(n, used.len(), |i, k| {
            let response = &responses[k];
            row(nodes[i]).map(|&(k, w)| w * response[k]).sum::<f64>()
        });
        let place = |k: usize| used.partition_point(|&u| u < k);
        let lower = Mat::from_fn(n, n, |i, j| {
            let terms = row(nodes[j]).map(|&(k, w)| w * half[(i, place(k))]);
            terms.sum::<f64>()
        });
        let green = Mat::from_fn(n, n, |i, j| 0.5 * (lower[(i, j)] + lower[(j, i)]));
        [green.clone(), green]
    }
}

// Displacements at the ice's nodes from those of a runner's own mesh: a lumped mortar.

/// Weights of runner nodes in the displacement of the runner at a node of the ice's plane.
///
/// With the ice's bilinear functions phi_i and the runner's psi_j on their faces seen from above,
///
/// ```text
/// W_ij = integral of phi_i psi_j / integral of phi_i,
/// ```
///
/// both over the part of the plane that lies under the runner's faces. Rows sum to 1, so rigid
/// motions are exact. The forces p * integral of phi_i of a constant pressure become p * integral
/// of psi_j on the runner, its consistent forces: the patch test of constant pressure is passed.
/// Faces are cut along the ice's grid lines; the integration of each piece is exact for faces that
/// are parallelograms.
pub(crate) type Rows = Vec<Vec<(usize, f64)>>;

/// The trace of a body on the contact plane by W.
pub(crate) struct Mortar {
    /// For each plane node the weights of nodes of the runner's underside.
    pub rows: Rows,
    /// Index in the body's vector of the vertical displacement of each node of the underside.
    pub entries: Vec<usize>,
}

impl Mortar {
    /// `closing` += B u for a body above, whose upward displacement opens the gap.
    pub fn add_closing(&self, u: &[f64], closing: &mut [f64]) {
        for (closing, row) in closing.iter_mut().zip(&self.rows) {
            let terms = row.iter().map(|&(k, w)| w * u[self.entries[k]]);
            *closing -= terms.sum::<f64>();
        }
    }

    /// `out` += `factor` B^T f for the forces (node, value).
    pub fn add_forces(&self, forces: &[(usize, f64)], factor: f64, out: &mut [f64]) {
        for &(node, force) in forces {
            for &(k, w) in &self.rows[node] {
                out[self.entries[k]] -= w * (factor * force);
            }
        }
    }
}

/// The rows of W for the nodes of the plane of `grid`, x fastest; empty if no face overlaps a
/// node's function.
///
/// `faces` are four positions each with their nodes' numbers.
pub(crate) fn mortar_rows(grid: &TensorGrid, faces: &[([usize; 4], [[f64; 2]; 4])]) -> Rows {
    let [nx, ny, _] = grid.shape();
    let mut sums: Vec<(f64, BTreeMap<usize, f64>)> = vec![(0.0, BTreeMap::new()); nx * ny];
    for (nodes, corners) in faces {
        let bounds = |axis: usize| {
            let places = corners.map(|corner| corner[axis]);
            let low = places.into_iter().fold(f64::INFINITY, f64::min);
            [low, places.into_iter().fold(f64::NEG_INFINITY, f64::max)]
        };
        let cells = |nodes: &[f64], [low, high]: [f64; 2]| {
            let first = nodes.partition_point(|&v| v <= low).saturating_sub(1);
            let last = nodes.partition_point(|&v| v < high).min(nodes.len() - 1);
            first..last
        };
        for j in cells(&grid.y, bounds(1)) {
            for i in cells(&grid.x, bounds(0)) {
                let cell = [grid.x[i], grid.x[i + 1], grid.y[j], grid.y[j + 1]];
                let piece = clip(corners.to_vec(), cell);
                for [a, b, c] in (2..piece.len()).map(|k| [piece[0], piece[k - 1], piece[k]]) {
                    let area =
                        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
                    for (weight, l) in TRIANGLE {
                        let at = [0, 1].map(|d| l[0] * a[d] + l[1] * b[d] + l[2] * c[d]);
                        let Some(psi) = face_functions(corners, at) else {
                            continue;
                        };
                        let s = (at[0] - cell[0]) / (cell[1] - cell[0]);
                        let t = (at[1] - cell[2]) / (cell[3] - cell[2]);
                        for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                            let phi = [1.0 - s, s][di] * [1.0 - t, t][dj];
                            let (total, row) = &mut sums[(j + dj) * nx + i + di];
                            *total += weight * area * phi;
                            for (node, psi) in nodes.iter().zip(psi) {
                                *row.entry(*node).or_default() += weight * area * phi * psi;
                            }
                        }
                    }
                }
            }
        }
    }
    sums.into_iter()
        .map(|(total, row)| {
            if total <= 0.0 {
                return Vec::new();
            }
            row.into_iter().map(|(n, w)| (n, w / total)).collect()
        })
        .collect()
}

/// Weights and area coordinates of the rule of degree 4 on a triangle (D. A. Dunavant, Int. J.
/// Numer. Meth. Engng 21 (1985), 1129-1148).
const TRIANGLE: [(f64, [f64; 3]); 6] = {
    const P: (f64, f64, f64) = (0.223381589678011, 0.108103018168070, 0.445948490915965);
    const Q: (f64, f64, f64) = (0.109951743655322, 0.816847572980459, 0.091576213509771);
    [
        (P.0, [P.1, P.2, P.2]),
        (P.0, [P.2, P.1, P.2]),
        (P.0, [P.2, P.2, P.1]),
        (Q.0, [Q.1, Q.2, Q.2]),
        (Q.0, [Q.2, Q.1, Q.2]),
        (Q.0, [Q.2, Q.2, Q.1]),
    ]
};

/// The part of a convex polygon in the rectangle [x_min, x_max, y_min, y_max].
fn clip(mut polygon: Vec<[f64; 2]>, cell: [f64; 4]) -> Vec<[f64; 2]> {
    for (axis, bound, sign) in [
        (0, cell[0], 1.0),
        (0, cell[1], -1.0),
        (1, cell[2], 1.0),
        (1, cell[3], -1.0),
    ] {
        let inside = |p: [f64; 2]| sign * (p[axis] - bound);
        let mut clipped = Vec::with_capacity(polygon.len() + 1);
        for (k, &p) in polygon.iter().enumerate() {
            let q = polygon[(k + 1) % polygon.len()];
            let (from, to) = (inside(p), inside(q));
            if from >= 0.0 {
                clipped.push(p);
            }
            if from * to < 0.0 {
                let t = from / (from - to);
                clipped.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
            }
        }
        polygon = clipped;
    }
    polygon
}

/// The four bilinear functions of a convex quadrilateral at a point in it; `None` if the map cannot
/// be inverted there.
fn face_functions(corners: &[[f64; 2]; 4], at: [f64; 2]) -> Option<[f64; 4]> {
    const NATURAL: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let functions = |s: f64, t: f64| NATURAL.map(|n| 0.25 * (1.0 + n[0] * s) * (1.0 + n[1] * t));
    let (mut s, mut t) = (0.0f64, 0.0f64);
    for _ in 0..20 {
        let n = functions(s, t);
        let (mut r, mut js, mut jt) = ([-at[0], -at[1]], [0.0; 2], [0.0; 2]);
        for (k, corner) in corners.iter().enumerate() {
            for d in 0..2 {
                r[d] += n[k] * corner[d];
                js[d] += 0.25 * NATURAL[k][0] * (1.0 + NATURAL[k][1] * t) * corner[d];
                jt[d] += 0.25 * NATURAL[k][1] * (1.0 + NATURAL[k][0] * s) * corner[d];
            }
        }
        let determinant = js[0] * jt[1] - js[1] * jt[0];
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        let (ds, dt) = (
            (r[0] * jt[1] - r[1] * jt[0]) / determinant,
            (js[0] * r[1] - js[1] * r[0]) / determinant,
        );
        (s, t) = (s - ds, t - dt);
        if ds.abs() + dt.abs() < 1e-13 {
            break;
        }
    }
    Some(functions(s, t))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> TensorGrid {
        TensorGrid {
            x: vec![-1.0, -0.3, 0.0, 0.11, 0.5, 0.72, 1.0],
            y: vec![-1.0, -0.6, 0.07, 0.2, 1.0],
            z: vec![-1.0, 0.0],
        }
    }

    /// A square of 3 x 3 sheared faces over the whole grid, and outside it.
    fn faces() -> Vec<([usize; 4], [[f64; 2]; 4])> {
        let at = |i: usize, j: usize| {
            let (u, v) = (-1.5 + i as f64, -1.5 + j as f64);
            [u + 0.3 * v, v]
        };
        let number = |i: usize, j: usize| j * 4 + i;
        (0..3)
            .flat_map(|j| (0..3).map(move |i| [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]))
            .map(|c| (c.map(|(i, j)| number(i, j)), c.map(|(i, j)| at(i, j))))
            .collect()
    }

    #[test]
    fn linear_heights_pass_exactly_to_fully_covered_nodes() {
        let (grid, faces) = (grid(), faces());
        let rows = mortar_rows(&grid, &faces);
        let mut position = vec![[0.0; 2]; 16];
        for (nodes, corners) in &faces {
            for (n, c) in nodes.iter().zip(corners) {
                position[*n] = *c;
            }
        }
        for (node, row) in rows.iter().enumerate() {
            let sum: f64 = row.iter().map(|(_, w)| w).sum();
            assert!((sum - 1.0).abs() < 1e-12);
            // The weighted mean of a linear height is its value at the centroid of the node's
            // function.
            let [i, j] = [node % 7, node / 7];
            let centroid = |n: &[f64], k: usize| {
                let (mut m, mut mx) = (0.0, 0.0);
                for (a, b) in [
                    (k.checked_sub(1), k),
                    (k + 1 < n.len())
                        .then_some(k + 1)
                        .map_or((None, k), |b| (Some(b), k)),
                ] {
                    if let Some(a) = a {
                        let h = (n[a] - n[b]).abs();
                        m += 0.5 * h;
                        mx += 0.5 * h * (n[b] + (n[a] - n[b]) / 3.0);
                    }
                }
                mx / m
            };
            let expected = 0.3 * centroid(&grid.x, i) - 2.0 * centroid(&grid.y, j) + 0.1;
            let found: f64 = row
                .iter()
                .map(|&(n, w)| w * (0.3 * position[n][0] - 2.0 * position[n][1] + 0.1))
                .sum();
            assert!(
                (found - expected).abs() < 1e-12,
                "{node}: {found} {expected}"
            );
        }
    }

    /// What arrives at the runner's nodes is the pressure times their own functions' integrals:
    /// whatever the ice's lines, the same forces, with the pressure's resultant and moments.
    #[test]
    fn a_constant_pressure_arrives_as_the_same_forces_from_any_grid() {
        let hat = |n: &[f64], k: usize| {
            let low = if k > 0 { n[k] - n[k - 1] } else { 0.0 };
            0.5 * (low + n.get(k + 1).map_or(0.0, |next| next - n[k]))
        };
        let forces = |grid: &TensorGrid| {
            let mut forces = vec![0.0; 16];
            for (node, row) in mortar_rows(grid, &faces()).iter().enumerate() {
                let nx = grid.x.len();
                let force = 7.0 * hat(&grid.x, node % nx) * hat(&grid.y, node / nx);
                row.iter().for_each(|&(n, w)| forces[n] += w * force);
            }
            forces
        };
        let even = |n: i32| {
            (0..=n)
                .map(|i| -1.0 + 2.0 * f64::from(i) / f64::from(n))
                .collect()
        };
        let finer = TensorGrid {
            x: even(13),
            y: even(9),
            z: vec![-1.0, 0.0],
        };
        let (coarse, fine) = (forces(&grid()), forces(&finer));
        for (a, b) in coarse.iter().zip(&fine) {
            assert!((a - b).abs() < 1e-12, "{coarse:?} {fine:?}");
        }
        let moment = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
            let place = |n: usize| (-1.5 + (n % 4) as f64, -1.5 + (n / 4) as f64);
            (0..16)
                .map(|n| fine[n] * f(place(n).0 + 0.3 * place(n).1, place(n).1))
                .sum()
        };
        assert!((moment(&|_, _| 1.0) - 28.0).abs() < 1e-12);
        assert!(moment(&|x, _| x).abs() < 1e-12 && moment(&|_, y| y).abs() < 1e-12);
    }
}
