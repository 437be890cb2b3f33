//! The contact problem on one mesh.

use std::borrow::Cow;
use std::ops::Range;

use faer::Mat;
use rayon::prelude::*;

use crate::bodies::elastic_body::{BodyWork, ElasticBody, Inverse};
use crate::green::matrix::{Green, StorageLimit};
use crate::green::modal::ModalGreen;
use crate::motion::{Motion, dot, dot_rows};
use crate::vector;

/// The discretised contact problem; plane arrays have x fastest.
pub(crate) struct ContactMesh {
    /// The elastic bodies, in the order of their parts of a displacement vector: the ice, then an
    /// elastic runner.
    pub bodies: Vec<ElasticBody>,
    /// Area of the plane that belongs to each line of nodes, along x and along y: node (i, j) has
    /// their product [m].
    pub lumped: [Vec<f64>; 2],
    /// Undeformed gap; infinite where there is no hull [m].
    pub gap: Vec<f64>,
    /// Rows of N, the closing of the gap by the rigid motion.
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
    /// Displacements of the bodies one after another, fixed values included [m].
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

    /// Values of a plane array at the candidates.
    pub fn on_candidates<T: Copy>(&self, plane: &[T]) -> Vec<T> {
        self.candidates.iter().map(|&node| plane[node]).collect()
    }

    /// Length of a displacement vector.
    pub fn len(&self) -> usize {
        self.bodies.iter().map(ElasticBody::len).sum()
    }

    /// The Green's matrix of the candidates: that of the preconditioner, and one closer to that of
    /// elasticity. Stored if the number of candidates is within the `limit`.
    pub fn greens(&self, limit: StorageLimit) -> [Green<'_>; 2] {
        let modal = |scaled: bool| {
            let (bodies, plane) = (&self.bodies, self.gap.len());
            ModalGreen::new(bodies, &self.candidates, plane, scaled)
        };
        let on_faces = |body: &ElasticBody| matches!(body.inverse, Inverse::Planewise(_));
        let limit = if self.bodies.iter().all(on_faces) {
            limit.faces
        } else {
            limit.mounted
        };
        if self.candidates.len() > limit
            && let (Some(own), Some(scaled)) = (modal(false), modal(true))
        {
            return [own, scaled].map(|green| Green::Modal(Box::new(green)));
        }
        self.dense_greens()
            .map(|green| Green::Dense(Cow::Owned(green)))
    }

    /// [`ContactMesh::greens`], stored.
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

    /// The state with these forces of the candidates and this motion, and zero displacements.
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

    /// Gap of the candidates without motion and contact forces: the undeformed gap less the closing
    /// by loads on the runner.
    pub fn unpressed_gap(&self) -> Vec<f64> {
        let mut closing = vec![0.0; self.gap.len()];
        for body in self.bodies.iter().filter(|b| !b.load.is_empty()) {
            body.begin(&body.load, &mut closing, &mut body.work());
        }
        let nodes = self.candidates.iter();
        nodes.map(|&node| self.gap[node] - closing[node]).collect()
    }

    /// Vertical displacement of the ice surface, upwards.
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

    /// Length scale of the contact, with which penetration is compared [m]: the deepest
    /// interpenetration of the undeformed shapes, or the deflection of the ice if a runner on
    /// mounts bends by more than it presses in.
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

    /// Twice the strain energy due to the contact forces: sum of force times closing.
    pub fn energy(&self, state: &State) -> f64 {
        let closing = self.closing(&state.displacement);
        let work = state.force.iter().zip(&closing).map(|(f, c)| f * c);
        work.sum::<f64>().abs()
    }

    /// Sets forces to 0 outside the set and to their bound on full nodes.
    pub fn project_forces(&self, sets: &Sets, state: &mut State) {
        let mut forces = vec![0.0; state.force.len()];
        for &i in &sets.inside {
            let node = self.candidates[i];
            forces[node] = state.force[node].clamp(0.0, self.bound[node]);
        }
        for &i in &sets.full {
            forces[self.candidates[i]] = self.bound[self.candidates[i]];
        }
        state.force = forces;
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
        let forces = state.force.iter().copied().enumerate();
        let forces: Vec<(usize, f64)> = forces.filter(|(_, f)| *f != 0.0).collect();
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

// Contact sets.

/// A contact set: nodes with a closed gap, and nodes at their upper bound.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sets {
    /// Gap zero, force between its bounds.
    pub inside: Vec<usize>,
    /// Force at its upper bound.
    pub full: Vec<usize>,
}

impl Sets {
    /// The sets that forces belong to.
    pub fn of(force: &[f64], bound: &[f64]) -> Self {
        let mut sets = Sets::default();
        for (i, (&f, &b)) in force.iter().zip(bound).enumerate() {
            if f >= b {
                sets.full.push(i);
            } else if f > 0.0 {
                sets.inside.push(i);
            }
        }
        sets
    }

    /// Adds one node to `inside` if it is empty and the full nodes do not balance the load.
    ///
    /// The forces of full nodes are fixed, so that full nodes alone determine no motion. If they
    /// carry less than the load, the open node with the smallest gap is added; if they carry more,
    /// the full node with the largest gap.
    pub fn free_one(&mut self, motion: &Motion, bound: &[f64], gap: impl Fn(usize) -> f64) {
        if !self.inside.is_empty() || self.full.is_empty() || !motion.free[0] {
            return;
        }
        let unbalanced = motion.balance[0] - self.full.iter().map(|&i| bound[i]).sum::<f64>();
        if unbalanced.abs() <= 1e-12 * motion.balance[0] {
            return;
        }
        if unbalanced > 0.0 {
            let open = (0..bound.len()).filter(|i| self.full.binary_search(i).is_err());
            self.inside
                .extend(open.min_by(|&i, &j| gap(i).total_cmp(&gap(j))));
        } else {
            let full = self.full.iter().copied();
            let least = full.max_by(|&i, &j| gap(i).total_cmp(&gap(j)));
            self.full.retain(|&i| Some(i) != least);
            self.inside.extend(least);
        }
    }
}

/// Step from forces within their bounds towards others, up to the first bound that is met: the step
/// length, at most 1, and the forces there.
pub(crate) fn clip(from: &[f64], to: &[f64], bound: &[f64]) -> (f64, Vec<f64>) {
    let end = |(f, (t, b)): (&f64, (&f64, &f64))| match t - f {
        down if down < 0.0 && *t < 0.0 => f / -down,
        up if up > 0.0 && t > b => (b - f) / up,
        _ => 1.0,
    };
    let pairs = || from.iter().zip(to.iter().zip(bound));
    let part = pairs().map(end).fold(1.0, f64::min);
    let force = pairs().map(|pair| {
        let (f, (t, b)) = pair;
        if end(pair) <= part && (*t < 0.0 || t > b) {
            // Exactly at the bound, so that the node leaves the set.
            t.clamp(0.0, *b)
        } else {
            (f + part * (t - f)).clamp(0.0, *b)
        }
    });
    (part, force.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clipped_way_ends_exactly_where_the_first_force_meets_its_bound() {
        let bound = [4.0, 4.0, 4.0, f64::INFINITY];
        let (part, force) = clip(&[1.0, 2.0, 3.0, 0.0], &[-1.0, -1.0, 5.0, 8.0], &bound);
        assert_eq!((part, force), (0.5, vec![0.0, 0.5, 4.0, 4.0]));
        let (part, force) = clip(&[1.0, 2.0, 3.0, 0.0], &[0.0, 4.0, 1.0, 8.0], &bound);
        assert_eq!((part, force), (1.0, vec![0.0, 4.0, 1.0, 8.0]));
    }
}
