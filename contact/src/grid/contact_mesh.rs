//! The contact problem on one mesh.

use std::borrow::Cow;
use std::ops::Range;

use faer::Mat;
use rayon::prelude::*;

use crate::active_set::motion::dot;
use crate::active_set::motion::{Motion, dot_rows};
use crate::active_set::sets::Sets;
use crate::active_set::vector;
use crate::bodies::elastic_body::{BodyWork, ElasticBody};
use crate::green::matrix::{Green, Stored};
use crate::green::modal::ModalGreen;
use crate::precondition::inverse::Inverse;

/// A mesh with everything the iteration needs; plane arrays have x fastest.
pub(crate) struct ContactMesh {
    /// The elastic bodies, in the order of their parts of a displacement vector: the ice, then an elastic runner.
    pub bodies: Vec<ElasticBody>,
    /// Area of the plane that belongs to each line of nodes, along x and along y: node (i, j) has their product [m].
    pub lumped: [Vec<f64>; 2],
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

impl ContactMesh {
    /// The bodies, each with the place of its part in a displacement vector.
    pub fn parts(&self) -> impl Iterator<Item = (&ElasticBody, Range<usize>)> {
        self.bodies.iter().scan(0, |start, body| {
            let part = *start..*start + body.len();
            *start = part.end;
            Some((body, part))
        })
    }

    /// Vectors for the bodies' products and preconditioners.
    pub fn work(&self) -> Vec<BodyWork> {
        self.bodies.iter().map(ElasticBody::work).collect()
    }

    /// Length of a displacement vector.
    pub fn len(&self) -> usize {
        self.bodies.iter().map(ElasticBody::len).sum()
    }

    /// The Green's matrix of the candidates: that of the preconditioner, and that closer to elasticity's. Stored where there are
    /// at `most` so many candidates.
    pub fn greens(&self, most: Stored) -> [Green<'_>; 2] {
        let modal = |scaled: bool| {
            let (bodies, plane) = (&self.bodies, self.gap.len());
            ModalGreen::new(bodies, &self.candidates, plane, scaled)
        };
        let on_faces = |body: &ElasticBody| matches!(body.inverse, Inverse::Planewise(_));
        let most = match self.bodies.iter().all(on_faces) {
            true => most.faces,
            false => most.mounted,
        };
        if self.candidates.len() > most
            && let (Some(own), Some(scaled)) = (modal(false), modal(true))
        {
            return [own, scaled].map(|green| Green::Modal(Box::new(green)));
        }
        self.dense_greens()
            .map(|green| Green::Dense(Cow::Owned(green)))
    }

    /// As [`ContactMesh::greens`], stored.
    pub fn dense_greens(&self) -> [Mat<f64>; 2] {
        let mut bodies = self.bodies.iter().map(|body| body.green(&self.candidates));
        let first = bodies.next().unwrap_or_else(|| [0, 1].map(|_| Mat::new()));
        bodies.fold(first, |mut sums, greens| {
            for (sum, green) in sums.iter_mut().zip(greens) {
                *sum += &green;
            }
            sums
        })
    }

    /// Forces of the candidates and the motion with them, without displacements.
    pub fn state_of(&self, force: &[f64], motion: [f64; 3]) -> State {
        let mut forces = vec![0.0; self.gap.len()];
        for (&node, f) in self.candidates.iter().zip(force) {
            forces[node] = *f;
        }
        State {
            displacement: Vec::new(),
            force: forces,
            motion,
        }
    }

    /// Vertical closing of the gap by the displacements: B u.
    pub fn closing(&self, displacement: &[f64]) -> Vec<f64> {
        let mut closing = vec![0.0; self.gap.len()];
        for (body, part) in self.parts() {
            body.trace.add_closing(&displacement[part], &mut closing);
        }
        closing
    }

    /// Gap of the candidates without motion and contact forces: the undeformed one less what loads on the runner close.
    pub fn unpressed_gap(&self) -> Vec<f64> {
        let mut closing = vec![0.0; self.gap.len()];
        for body in self.bodies.iter().filter(|b| !b.load.is_empty()) {
            body.begin(&body.load, &mut closing, &mut body.work());
        }
        self.candidates
            .iter()
            .map(|&node| self.gap[node] - closing[node])
            .collect()
    }

    /// Vertical displacement of the ice surface: what it closes of the gap.
    pub fn ice_surface(&self, displacement: &[f64]) -> Vec<f64> {
        let mut surface = vec![0.0; self.gap.len()];
        if let Some((ice, part)) = self.parts().next() {
            ice.trace.add_closing(&displacement[part], &mut surface);
        }
        surface
    }

    /// Gap of every plane node in a state.
    pub fn gaps(&self, state: &State) -> Vec<f64> {
        let closing = self.closing(&state.displacement);
        (0..self.gap.len())
            .map(|i| self.gap[i] - dot(self.rows[i], state.motion) - closing[i])
            .collect()
    }

    /// What penetration is compared with [m]: the deepest interpenetration of the undeformed shapes, or how deep the ice sinks
    /// where a carried runner bends away from its own shape by more than it presses in.
    pub fn depth(&self, state: &State) -> f64 {
        let undeformed = (0..self.gap.len()).map(|i| dot(self.rows[i], state.motion) - self.gap[i]);
        let deepest = undeformed.fold(f64::MIN_POSITIVE, f64::max);
        if state.displacement.is_empty() {
            return deepest;
        }
        let surface = self.ice_surface(&state.displacement);
        surface.iter().fold(deepest, |most, up| most.max(-up))
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
    pub fn apply(&self, u: &[f64], out: &mut [f64], work: &mut [BodyWork]) {
        for ((body, part), work) in self.parts().zip(work) {
            body.apply(&u[part.clone()], &mut out[part], work);
        }
    }

    /// `out` += B^T f for the forces (node, value).
    pub fn add_forces(&self, forces: &[(usize, f64)], out: &mut [f64]) {
        for (body, part) in self.parts() {
            body.trace.add_forces(forces, &mut out[part]);
        }
    }

    /// `out` = load - K u - B^T f.
    pub fn residual(&self, state: &State, out: &mut [f64], work: &mut [BodyWork]) {
        self.apply(&state.displacement, out, work);
        let forces: Vec<(usize, f64)> = state
            .force
            .iter()
            .copied()
            .enumerate()
            .filter(|(_, f)| *f != 0.0)
            .collect();
        self.add_forces(&forces, out);
        for (body, part) in self.parts() {
            for (out, load) in out[part].iter_mut().zip(&body.load) {
                *out -= load;
            }
        }
        out.par_chunks_mut(vector::CHUNK)
            .for_each(|chunk| chunk.iter_mut().for_each(|r| *r = -*r));
    }
}
