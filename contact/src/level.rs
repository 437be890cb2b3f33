//! The contact problem on one mesh.

use faer::Mat;
use rayon::prelude::*;

use crate::body::Body;
use crate::motion::{Motion, dot_rows};
use crate::psor::{Sets, dot};
use crate::vector;

/// A mesh with everything the iteration needs; plane arrays have x fastest.
pub(crate) struct Level {
    /// Elastic bodies that share the columns of the contact plane.
    pub bodies: Vec<Body>,
    /// Nodes along x on the contact plane.
    pub nx: usize,
    /// Undeformed gap; infinite where there is no hull [m].
    pub gap: Vec<f64>,
    /// Rows N of the rigid motion.
    pub rows: Vec<[f64; 3]>,
    /// Largest contact force of each node [N].
    pub bound: Vec<f64>,
    /// Nodes that may touch (indices on the plane).
    pub candidates: Vec<usize>,
    /// The runner's motion and the balance of the modelled part.
    pub motion: Motion,
}

/// Displacements, contact forces and motion on one mesh.
#[derive(Clone, Debug)]
pub(crate) struct State {
    /// Displacements of the bodies one after another, held values included [m].
    pub displacement: Vec<f64>,
    /// Contact forces on the plane [N].
    pub force: Vec<f64>,
    /// Approach [m], pitch and roll [rad].
    pub motion: [f64; 3],
}

impl Level {
    /// Length of a displacement vector.
    pub fn len(&self) -> usize {
        self.bodies.iter().map(Body::len).sum()
    }

    /// The dense Green's matrix of the candidates: that of P, and that scaled to elasticity's.
    pub fn greens(&self) -> [Mat<f64>; 2] {
        let n = self.candidates.len();
        let mut plain = Mat::zeros(n, n);
        let mut scaled = Mat::zeros(n, n);
        for body in &self.bodies {
            let [first_x, first_y] = body.columns.first;
            let nodes: Vec<[usize; 2]> = self
                .candidates
                .iter()
                .map(|&n| [n % self.nx - first_x, n / self.nx - first_y])
                .collect();
            let mut green = Mat::zeros(n, n);
            body.modes.add_green(&nodes, 1.0, &mut green);
            plain += &green;
            scaled += faer::Scale(body.response) * &green;
        }
        [plain, scaled]
    }

    /// Place of a plane node in a body's vector.
    pub fn entry(&self, body: &Body, node: usize) -> Option<usize> {
        body.columns
            .local([node % self.nx, node / self.nx])
            .map(|local| body.plane_start() + local)
    }

    /// Vertical closing of the gap by the displacements: sum of sign times u_z on the plane.
    pub fn closing(&self, displacement: &[f64]) -> Vec<f64> {
        let mut closing = vec![0.0; self.gap.len()];
        let mut start = 0;
        for body in &self.bodies {
            for (node, c) in closing.iter_mut().enumerate() {
                if let Some(entry) = self.entry(body, node) {
                    *c += body.sign * displacement[start + entry];
                }
            }
            start += body.len();
        }
        closing
    }

    /// Vertical displacement of the lowest body's plane, the ice surface.
    pub fn ice_surface(&self, displacement: &[f64]) -> Vec<f64> {
        let ice = &self.bodies[0];
        (0..self.gap.len())
            .map(|node| {
                self.entry(ice, node)
                    .map_or(0.0, |entry| displacement[entry])
            })
            .collect()
    }

    /// Gap of every plane node in a state.
    pub fn gaps(&self, state: &State) -> Vec<f64> {
        let closing = self.closing(&state.displacement);
        (0..self.gap.len())
            .map(|i| self.gap[i] - dot(self.rows[i], state.motion) - closing[i])
            .collect()
    }

    /// Deepest interpenetration of the undeformed shapes [m].
    pub fn depth(&self, state: &State) -> f64 {
        (0..self.gap.len())
            .map(|i| dot(self.rows[i], state.motion) - self.gap[i])
            .fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Sum of the contact forces' rows: normal force and moments of the modelled part.
    pub fn resultant(&self, state: &State) -> [f64; 3] {
        let force = Mat::from_fn(state.force.len(), 1, |i, _| state.force[i]);
        [0, 1, 2].map(|a| dot_rows(&self.rows, a, &force, 0))
    }

    /// Twice the energy stored by the contact forces: sum of force times closing.
    pub fn energy(&self, state: &State) -> f64 {
        let closing = self.closing(&state.displacement);
        state
            .force
            .iter()
            .zip(&closing)
            .map(|(f, c)| f * c)
            .sum::<f64>()
            .abs()
    }

    /// Forces 0 outside the set and at their bound where full.
    pub fn project_forces(&self, sets: &Sets, state: &mut State) {
        let mut kept = vec![0.0; state.force.len()];
        for &i in &sets.inside {
            let node = self.candidates[i];
            kept[node] = state.force[node].clamp(0.0, self.bound[node]);
        }
        for &i in &sets.full {
            kept[self.candidates[i]] = self.bound[self.candidates[i]];
        }
        state.force = kept;
    }

    /// `out` = K u, body by body.
    pub fn apply(&self, u: &[f64], out: &mut [f64]) {
        let mut start = 0;
        for body in &self.bodies {
            let range = start..start + body.len();
            body.apply(&u[range.clone()], &mut out[range]);
            start += body.len();
        }
    }

    /// `out` = - K u - B^T f.
    pub fn residual(&self, state: &State, out: &mut [f64]) {
        self.apply(&state.displacement, out);
        let mut start = 0;
        for body in &self.bodies {
            for (node, f) in state.force.iter().enumerate().filter(|(_, f)| **f != 0.0) {
                if let Some(entry) = self.entry(body, node) {
                    out[start + entry] += body.sign * f;
                }
            }
            start += body.len();
        }
        out.par_chunks_mut(vector::CHUNK)
            .for_each(|chunk| chunk.iter_mut().for_each(|r| *r = -*r));
    }
}
