//! Pressures and figures of a state, and the patch that they cover.

use kufe_fem::love_depth;

use crate::Problem;
use crate::grid::patch::Patch;
use crate::grid::stretch::{ON_FACES, ON_RIDGES, Stretch};
use crate::mesh::contact_mesh::State;
use crate::mesh::discretise::Discretisation;
use crate::result::measure::{Figures, PressureField};
use crate::result::rim::RimEstimator;

/// Pressures and figures of a state.
pub(crate) struct Pressure {
    pub values: Vec<f64>,
    pub figures: Figures,
    pub patch: Patch,
}

/// Evaluates pressures and figures of the states of a mesh, which was made for `patch`.
pub(crate) struct Field<'a> {
    mesh: &'a Discretisation,
    patch: &'a Patch,
    hardness: f64,
    /// 1 / E* of ice and runner [1/Pa].
    compliance: f64,
    /// Ratio of the number of cells at ridges to that at even places; smaller under faces of
    /// hexahedra, whose edges look like ridges.
    finer: f64,
}

impl<'a> Field<'a> {
    /// The evaluation on a mesh that was made for `patch`.
    pub fn new(mesh: &'a Discretisation, problem: &Problem, patch: &'a Patch) -> Self {
        let elastic = problem.runner.elastic.as_ref();
        let faces = elastic.is_some_and(|elastic| elastic.solid.is_some());
        Field {
            mesh,
            patch,
            hardness: problem.ice.hardness.unwrap_or(f64::INFINITY),
            compliance: problem.compliance(),
            finer: if faces { ON_FACES } else { ON_RIDGES },
        }
    }

    /// The pressure field of a state.
    pub fn pressure_field<'b>(&self, state: &'b State) -> PressureField<'b>
    where
        'a: 'b,
    {
        let [along, across] = &self.mesh.contact.lumped;
        PressureField {
            nodes: [&self.mesh.grid.x, &self.mesh.grid.y],
            force: &state.force,
            gap: (!state.displacement.is_empty()).then(|| self.gaps(state)),
            lumped: [along, across],
            symmetry: self.mesh.symmetry,
            hardness: self.hardness,
        }
    }

    /// Gaps at the nodes, negative where the runner overlaps with the ice's elastic surface [m].
    ///
    /// A node at a fraction s of the hardness H has no gap of its own. Next to a jump of the
    /// pressure its surface sinks by its own load; raised by half of that, as at a rim through the
    /// node, the gap is (1/2 - s) H w, with w the depth of a half-space under unit pressure on the
    /// node's own part of the plane ([`love_depth`]).
    fn gaps(&self, state: &State) -> Vec<f64> {
        let contact = &self.mesh.contact;
        let mut gaps = contact.gaps(state);
        if self.hardness.is_infinite() {
            return gaps;
        }
        let [along, across] = &contact.lumped;
        let forces = state.force.iter().zip(&contact.bound);
        for (n, (gap, (force, bound))) in gaps.iter_mut().zip(forces).enumerate() {
            if *force > 0.0 && force < bound {
                let [a, b] = [0.5 * along[n % along.len()], 0.5 * across[n / along.len()]];
                let own = self.compliance * love_depth([0.0; 2], [a, b]);
                *gap = (0.5 - force / bound) * self.hardness * own;
            }
        }
        gaps
    }

    /// Whether a node in contact has a neighbour that is not under the hull.
    fn touches_edge(&self, state: &State) -> bool {
        let nx = self.mesh.grid.x.len();
        let gap = &self.mesh.contact.gap;
        (0..gap.len()).filter(|&n| state.force[n] > 0.0).any(|n| {
            let left = (n % nx > 0).then(|| n - 1);
            let right = (n % nx + 1 < nx).then_some(n + 1);
            let next = [left, right, n.checked_sub(nx), Some(n + nx)];
            let mut gaps = next.into_iter().flatten().filter_map(|n| gap.get(n));
            gaps.any(|gap| gap.is_infinite())
        })
    }

    /// The peak pressure of a state [Pa].
    pub fn p_max(&self, state: &State) -> f64 {
        let field = self.pressure_field(state);
        field.peak(&field.pressures())
    }

    /// Pressures and figures of a state, and the patch that they cover.
    pub fn of(&self, state: &State) -> Pressure {
        let field = self.pressure_field(state);
        let values = field.pressures();
        Pressure {
            figures: field.figures(&values),
            patch: self.found_patch(&field, &values, state),
            values,
        }
    }

    /// The patch that a pressure field covers, with the cell sizes that resolve it.
    ///
    /// Sizes start from those of the patch that the mesh was made for. They are kept where no mesh
    /// resolves the pressure: it is singular where the contact ends at a sharp edge of the hull,
    /// and jumps from the hardness to 0 at a rim where the ice yields.
    fn found_patch(&self, field: &PressureField, pressure: &[f64], state: &State) -> Patch {
        let before = self.patch;
        let [mut x, mut y] = [0, 1].map(|axis| {
            let chords = field.chords(axis, pressure, RimEstimator::Cells);
            merged(chords, field.symmetry[axis])
        });
        let last = y.pop().unwrap_or_else(|| before.y.clone());
        let mut y = Stretch::even(y.first().map_or(last.low, |first| first.low), last.high);
        // For each node of an axis, the highest pressure on the line across it.
        let highest = [0, 1].map(|axis| -> Vec<f64> {
            let across = 0..field.nodes[1 - axis].len();
            let line = |k: usize| across.clone().map(move |line| field.node(axis, line, k));
            let highest = |k: usize| line(k).map(|n| pressure[n]).fold(0.0, f64::max);
            (0..field.nodes[axis].len()).map(highest).collect()
        });
        let steep = self.touches_edge(state) || pressure.iter().any(|&p| p >= field.bound());
        for stretch in &mut x {
            if let Some(same) = before.x.iter().find(|s| s.meets(stretch)) {
                stretch.sizes.clone_from(&same.sizes);
            }
        }
        y.sizes.clone_from(&before.y.sizes);
        if !steep {
            for stretch in &mut x {
                stretch.adapt(field.nodes[0], &highest[0], self.finer);
            }
            y.adapt(field.nodes[1], &highest[1], self.finer);
        }
        if x.is_empty() {
            x.clone_from(&before.x);
        }
        let patch = Patch {
            x,
            y,
            motion: state.motion[0],
            corners: before.corners.clone(),
        };
        patch.refined_at_corners()
    }
}

/// The union of the stretches on all lines; stretches that a mirror plane cuts are completed.
///
/// Stretches closer together than a fifth of the longer one count as one: their grids would merge
/// anyway.
fn merged(chords: Vec<Vec<[f64; 2]>>, symmetric: bool) -> Vec<Stretch> {
    let mut all: Vec<[f64; 2]> = chords.into_iter().flatten().collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut merged: Vec<[f64; 2]> = Vec::new();
    for stretch in all {
        let length = |of: &[f64; 2]| of[1] - of[0];
        let near =
            |last: &[f64; 2]| stretch[0] - last[1] < 0.2 * length(&stretch).max(length(last));
        match merged.last_mut() {
            Some(last) if near(last) => last[1] = last[1].max(stretch[1]),
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
