//! Figures of a sliding contact on one mesh: groove, ploughing, and the patch from front to back.

use crate::groove::on_mesh::SlidingState;
use crate::groove::plastic_contact::Kind;
use crate::groove::solution::{GrooveProfile, Section};
use crate::mesh::discretise::Discretisation;
use crate::motion::dot;
use crate::problem::check::CheckedProblem;
use crate::result::measure::{Chords, PressureField, differences, mean_of_root};
use crate::result::pressure::Field;
use crate::result::rim::{RimEstimator, rim_by_overlap};
use crate::symmetry::unfolded;

/// The figures of one mesh from which errors are estimated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measures {
    /// Peak pressure [Pa].
    pub p_max: f64,
    /// Largest depth of the remaining groove [m].
    pub depth: f64,
    /// Ploughing force [N]: for a rigid runner the mean of the next two, whose errors differ, for
    /// an elastic runner the first.
    pub ploughing: f64,
    /// Ploughing force from the plastic work per distance [N].
    pub plastic_work: f64,
    /// Ploughing force from pressures and the slope of the undeformed runner [N].
    pub by_slope: f64,
    /// Ends of the patch from the lowest point [m].
    pub front: f64,
    pub back: f64,
    /// Centre of pressure from the lowest point [m].
    pub load_ahead: f64,
    /// Normal force [N].
    pub fz: f64,
    /// Approach [m].
    pub approach: f64,
    /// The runner's lowest point along x [m].
    pub lowest: f64,
}

/// A mesh and its solution.
pub(crate) struct GrooveReading<'a> {
    checked: &'a CheckedProblem<'a>,
    mesh: &'a Discretisation,
    slid: &'a SlidingState,
    rims: Rims<'a>,
    field: PressureField<'a>,
    /// Nodal pressures [Pa].
    pressure: Vec<f64>,
}

impl<'a> GrooveReading<'a> {
    pub fn new(
        checked: &'a CheckedProblem<'a>,
        mesh: &'a Discretisation,
        slid: &'a SlidingState,
        field: &Field<'a>,
    ) -> Self {
        let field = field.pressure_field(&slid.state);
        GrooveReading {
            checked,
            mesh,
            slid,
            rims: Rims::new(mesh, slid),
            pressure: field.pressures(),
            field,
        }
    }

    /// The figures.
    pub fn measures(&self) -> Measures {
        let lowest = self.lowest();
        let [back, front] = self.ends();
        let contact = &self.mesh.contact;
        let resultant = contact.resultant(&self.slid.state);
        let centre_along = self.checked.gap.line_of_action[0] + resultant[1] / resultant[0];
        let (plastic_work, by_slope) = (self.plastic_work(), self.by_slope());
        Measures {
            p_max: if self.rims.full.contains(&true) {
                self.checked.hardness()
            } else {
                self.field.peak(&self.pressure)
            },
            depth: self.profile().deepest(),
            ploughing: match self.checked.problem.runner.elastic {
                // Without yielding the exact force is 0; that by slope is the mesh's error.
                _ if plastic_work == 0.0 => 0.0,
                None => 0.5 * (plastic_work + by_slope),
                Some(_) => plastic_work,
            },
            plastic_work,
            by_slope,
            front: front - lowest,
            back: back - lowest,
            load_ahead: centre_along - lowest,
            fz: self.mesh.image_count() * resultant[0],
            approach: contact.depth(&self.slid.state),
            lowest,
        }
    }

    /// Back and front ends of the patch [m].
    fn ends(&self) -> [f64; 2] {
        let chords = self.field.chords(0, &self.pressure, RimEstimator::Shape);
        self.rims.ends(&chords)
    }

    /// Both sides of the contact at every column; `None` where it is open.
    fn sides(&self) -> Vec<Option<[f64; 2]>> {
        let chords = self.field.chords(1, &self.pressure, RimEstimator::Shape);
        self.rims.sides(&chords)
    }

    /// The patch's rims, with sub-cell resolution: [x low, x high, y low, y high] [m].
    pub fn rims(&self) -> [f64; 4] {
        let [back, front] = self.ends();
        let sides = self.sides();
        let touched = || sides.iter().flatten();
        let left = touched().fold(f64::NEG_INFINITY, |left, s| left.max(s[1]));
        let right = touched().fold(f64::INFINITY, |right, s| right.min(s[0]));
        let right = if self.mesh.symmetry[1] { -left } else { right };
        [back, front, right, left]
    }

    /// The section of the remaining groove, over the whole width.
    pub fn profile(&self) -> GrooveProfile {
        let (nx, ys) = (self.mesh.grid.x.len(), &self.mesh.grid.y);
        let nodes = unfolded(ys.len(), self.mesh.symmetry[1]);
        let (y, depth) = nodes
            .map(|(j, sign)| (sign * ys[j], self.slid.depth[j * nx]))
            .unzip();
        GrooveProfile::new(y, depth).expect("nodes ascend and no groove is negative")
    }

    /// Plastic work per distance: H times the section that this runner adds to the groove.
    fn plastic_work(&self) -> f64 {
        let widths = self.mesh.contact.lumped[1].iter().enumerate();
        let added: f64 = widths.map(|(j, w)| w * self.rims.grown(0, j)).sum();
        self.mesh.image_count() * self.checked.hardness() * added
    }

    /// Sum of the forces times the slope of the undeformed runner.
    fn by_slope(&self) -> f64 {
        let (grid, state) = (&self.mesh.grid, &self.slid.state);
        let nx = grid.x.len();
        let slope = |n: usize| {
            let (x, y) = (grid.x[n % nx], grid.y[n / nx]);
            let step = 0.01 * (grid.x[n % nx + 1] - x);
            let rise = self.checked.gap.at(x + step, y) - self.checked.gap.at(x - step, y);
            rise / (2.0 * step) - state.motion[1]
        };
        let touching = (0..state.force.len()).filter(|&n| state.force[n] > 0.0);
        self.mesh.image_count() * touching.map(|n| state.force[n] * slope(n)).sum::<f64>()
    }

    /// Stations from the front to the back: width and mean pressure.
    pub fn sections(&self) -> Vec<Section> {
        let hardness = self.checked.hardness();
        let sides = self.sides();
        let section = |i: usize| {
            let [right, left] = sides[i]?;
            Some(Section {
                x: self.mesh.grid.x[i],
                width: self.mesh.image_count() * (left - right),
                pressure: self.rims.mean_pressure(i, left - right, hardness),
            })
        };
        let sections = (0..sides.len()).rev().filter_map(section).collect();
        with_ends(sections, self.ends())
    }

    /// Position along x of the lowest point of the tilted runner over the track; the middle of a
    /// level stretch.
    fn lowest(&self) -> f64 {
        let [nx, ny] = self.rims.shape;
        let contact = &self.mesh.contact;
        let height = |n: usize| contact.gap[n] - dot(contact.rows[n], self.slid.state.motion);
        let height = |i: usize| {
            let heights = (0..ny).map(|j| height(self.rims.node(i, j)));
            heights.fold(f64::INFINITY, f64::min)
        };
        let heights: Vec<f64> = (0..nx).map(height).collect();
        let least = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let level: Vec<usize> = (0..nx).filter(|&i| heights[i] - least <= 1e-12).collect();
        let x = &self.mesh.grid.x;
        let finite = |i: usize| heights.get(i).is_some_and(|height| height.is_finite());
        match level[..] {
            [i] if i > 0 && finite(i - 1) && finite(i + 1) => {
                let below = [x[i] - x[i - 1], heights[i - 1]];
                let above = [x[i + 1] - x[i], heights[i + 1]];
                let (slope, bend) = differences([below, above], heights[i]);
                x[i] - slope / bend
            }
            _ => level.iter().map(|&i| x[i]).sum::<f64>() / level.len() as f64,
        }
    }
}

/// Adds stations at the ends, with pressure and squared width extrapolated linearly from the two
/// nearest stations.
fn with_ends(mut sections: Vec<Section>, [back, front]: [f64; 2]) -> Vec<Section> {
    let end = |near: &Section, next: &Section, x: f64| {
        let share = (x - near.x) / (near.x - next.x);
        let on = |a: f64, b: f64| (a + share * (a - b)).max(0.0);
        Section {
            x,
            width: on(near.width.powi(2), next.width.powi(2)).sqrt(),
            pressure: on(near.pressure, next.pressure),
        }
    };
    if let [first, second, .., before, last] = &sections[..] {
        let ends = [end(first, second, front), end(last, before, back)];
        let inside = |s: &Section| s.x < front && s.x > back;
        sections.retain(inside);
        sections.insert(0, ends[0]);
        sections.push(ends[1]);
    }
    sections
}

// Rims of the patch with sub-cell resolution.

/// A solution on its mesh, with the nodes' states on the whole plane.
pub(crate) struct Rims<'a> {
    mesh: &'a Discretisation,
    slid: &'a SlidingState,
    /// Nodes along x and y.
    shape: [usize; 2],
    full: Vec<bool>,
    gaps: Vec<f64>,
}

impl<'a> Rims<'a> {
    pub fn new(mesh: &'a Discretisation, slid: &'a SlidingState) -> Self {
        let contact = &mesh.contact;
        let mut full = vec![false; contact.gap.len()];
        let mut gaps = vec![f64::INFINITY; contact.gap.len()];
        for (k, &node) in contact.candidates.iter().enumerate() {
            full[node] = slid.grooved.kinds[k] == Kind::Full;
            gaps[node] = slid.grooved.gap[k];
        }
        Rims {
            mesh,
            slid,
            shape: [mesh.grid.x.len(), mesh.grid.y.len()],
            full,
            gaps,
        }
    }

    /// The node of column `i` and row `j`.
    fn node(&self, i: usize, j: usize) -> usize {
        j * self.shape[0] + i
    }

    fn full(&self, i: usize, j: usize) -> bool {
        self.full[self.node(i, j)]
    }

    fn force(&self, i: usize, j: usize) -> f64 {
        self.slid.state.force[self.node(i, j)]
    }

    /// Plastic depth [m].
    fn depth(&self, i: usize, j: usize) -> f64 {
        self.slid.depth[self.node(i, j)]
    }

    /// Plastic depth at a node below the groove of earlier runners [m].
    fn grown(&self, i: usize, j: usize) -> f64 {
        self.depth(i, j) - self.depth(self.shape[0] - 1, j)
    }

    /// Ratio of the yielding area, with rims of sub-cell resolution, to the area of the full nodes'
    /// parts of the plane; 1 if no node is full.
    ///
    /// Rims are searched across, as the patch is narrow and its rims are along the lines of nodes.
    /// Between columns, and from the last one to the front, the squared width is linear, as at the
    /// end of a round runner's patch. A sum over columns would have an error that depends on the
    /// position of the front between nodes.
    pub fn full_area(&self) -> f64 {
        let [along, across] = &self.mesh.contact.lumped;
        let (mut nodes, mut missing) = (0.0, 0.0);
        let mut before = None;
        for (i, length) in along.iter().enumerate() {
            let full = (0..across.len()).filter(|&j| self.full(i, j));
            let part: f64 = full.map(|j| across[j]).sum();
            let sides = [false, true].map(|upper| self.outside_node(i, upper));
            let outside: f64 = sides.iter().flatten().sum();
            nodes += length * part;
            missing += length * outside;
            // On a mirrored plane the lower side is the mirror.
            let [lower, upper] = sides.map(|side| side.is_some());
            let width = (upper && (lower || self.mesh.symmetry[1])).then_some(part + outside);
            if let (Some(before), Some(width)) = (before, width) {
                missing += self.between_columns(i, [before, width]);
            }
            before = width;
        }
        if nodes > 0.0 {
            (1.0 + missing / nodes).clamp(0.9, 1.1)
        } else {
            1.0
        }
    }

    /// Distance by which the yielding ice extends beyond the outermost node's part of the plane at
    /// a side of column `i`; negative if it ends within [m].
    fn outside_node(&self, i: usize, upper: bool) -> Option<f64> {
        let y = &self.mesh.grid.y;
        let ([j, k], side) = self.yielding_side(i, upper)?;
        Some((side - 0.5 * (y[j] + y[k])) * (y[k] - y[j]).signum())
    }

    /// Mean pressure over the `width` of column `i` [Pa]; `hardness` if all of it yields.
    ///
    /// Forces belong to the nodes' parts of the plane, while the width has sub-cell resolution. The
    /// pressure on a full node's part, and between that part and the rim, is the hardness,
    /// regardless of the fitted force.
    fn mean_pressure(&self, i: usize, width: f64, hardness: f64) -> f64 {
        let [along, across] = &self.mesh.contact.lumped;
        let borne = (0..across.len()).map(|j| {
            if self.full(i, j) {
                hardness * across[j]
            } else {
                self.force(i, j) / along[i]
            }
        });
        let outside = [false, true].into_iter();
        let outside = outside.filter_map(|upper| self.outside_node(i, upper));
        let outside: f64 = outside.map(|length| hardness * length).sum();
        ((borne.sum::<f64>() + outside) / width).min(hardness)
    }

    /// Difference between the area with squared widths that are linear between column `i` and the
    /// one behind it, and on to the front if there is no contact ahead, and the sum over columns of
    /// the widths.
    fn between_columns(&self, i: usize, [before, width]: [f64; 2]) -> f64 {
        let ([_, ny], x) = (self.shape, &self.mesh.grid.x);
        let step = x[i] - x[i - 1];
        let mut missing = step * (mean_of_root(before, width) - 0.5 * (before + width));
        let open = |i: usize| (0..ny).all(|j| self.force(i, j) <= 0.0);
        // The foremost place where the ice begins to yield in the rows in contact here.
        let rows = (0..ny).filter(|&j| self.full(i, j));
        let mut fronts = rows.filter_map(|j| self.front(j));
        if i + 1 < x.len()
            && open(i + 1)
            && let Some(front) = fronts.by_ref().reduce(f64::max)
        {
            let slope = (width * width - before * before) / step;
            let tip = (width * width + slope * (front - x[i])).max(0.0).sqrt();
            missing += (front - x[i]) * mean_of_root(width, tip) - 0.5 * (x[i + 1] - x[i]) * width;
        }
        missing
    }

    /// Position at which the ice begins to yield at a side of column `i`, between the outermost
    /// node, if it is full, and the open one next to it: zero of the parabola of plastic depth and
    /// gap through these and the next node inside.
    fn yielding_side(&self, i: usize, upper: bool) -> Option<([usize; 2], f64)> {
        let [j, k] = self.outermost(i, upper)?;
        let outside = self.gaps[self.node(i, k)] - self.grown(i, k);
        if !self.full(i, j) || outside <= 0.0 || !outside.is_finite() {
            return None;
        }
        let y = &self.mesh.grid.y;
        let at = |j: usize| (y[j], self.grown(i, j));
        let within = match (upper, j) {
            // Across the mirror plane lies the open node's image.
            (true, 0) => self.mesh.symmetry[1].then_some((-y[k], -outside)),
            (true, _) => Some(at(j - 1)),
            (false, _) => (j + 1 < y.len()).then(|| at(j + 1)),
        };
        let side = rim_by_overlap(within, at(j), (y[k], -outside))?;
        Some(([j, k], side))
    }

    /// The outermost node in contact at a side of column `i` and the next one outwards.
    fn outermost(&self, i: usize, upper: bool) -> Option<[usize; 2]> {
        let ny = self.shape[1];
        let touching = |j: &usize| self.force(i, *j) > 0.0;
        if upper {
            let j = (0..ny).rfind(touching)?;
            (j + 1 < ny).then_some([j, j + 1])
        } else {
            let j = (0..ny).find(touching)?;
            Some([j, j.checked_sub(1)?])
        }
    }

    /// Both sides of the contact at every column with these chords; `None` where it is open.
    fn sides(&self, chords: &Chords) -> Vec<Option<[f64; 2]>> {
        let mut ahead = [0.0; 2];
        let mut sides = vec![None; chords.len()];
        for (i, own) in chords.iter().enumerate().rev() {
            if let (Some(first), Some(last)) = (own.first(), own.last()) {
                ahead = [
                    self.side(i, [first[0], ahead[0]], false),
                    self.side(i, [last[1], ahead[1]], true),
                ];
                sides[i] = Some(ahead);
            }
        }
        sides
    }

    /// The contact's side at column `i`: the beginning of the groove if the outermost node yields,
    /// its beginning further ahead, `ahead`, if that is within the contact, otherwise the end of
    /// the pressure.
    fn side(&self, i: usize, [by_pressure, ahead]: [f64; 2], upper: bool) -> f64 {
        let Some([j, k]) = self.outermost(i, upper) else {
            return by_pressure;
        };
        if let Some((_, side)) = self.yielding_side(i, upper) {
            return side;
        }
        let (y, inside) = (&self.mesh.grid.y, self.grown(i, j));
        let within = if upper { j.checked_sub(1) } else { Some(j + 1) };
        if let Some(within) = within.filter(|&w| inside <= 0.0 && self.full(i, w)) {
            return self.partly(self.node(i, j), y[j], [y[within], y[k]]);
        }
        let between = (y[j].min(y[k])..=y[j].max(y[k])).contains(&ahead);
        if inside > 0.0 && self.grown(i, k) <= 0.0 && between {
            ahead
        } else {
            by_pressure
        }
    }

    /// The rim from the ratio of a node's force to its bound, if it is the last node and the next
    /// one inside yields.
    fn partly(&self, node: usize, at: f64, [within, outside]: [f64; 2]) -> f64 {
        let share = self.slid.state.force[node] / self.mesh.contact.bound[node];
        let (from, to) = (0.5 * (at + within), 0.5 * (at + outside));
        from + share * (to - from)
    }

    /// Back and front ends of the patch [m]; the front is where the ice begins to yield, with
    /// sub-cell resolution.
    fn ends(&self, chords: &Chords) -> [f64; 2] {
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        for (j, chords) in chords.iter().enumerate() {
            if let (Some(first), Some(last)) = (chords.first(), chords.last()) {
                let front = self.front(j).unwrap_or(last[1]);
                let back = self.back(j).unwrap_or(first[0]);
                ends = [ends[0].min(back), ends[1].max(front)];
            }
        }
        ends
    }

    /// The front of row `j`; `None` if the ice does not yield there.
    fn front(&self, j: usize) -> Option<f64> {
        let x = &self.mesh.grid.x;
        let i = (1..x.len() - 1).rfind(|&i| self.force(i, j) > 0.0)?;
        let outside = self.gaps[self.node(i + 1, j)];
        if self.full(i, j) && outside.is_finite() {
            let inside = self.depth(i, j) - self.depth(i + 1, j);
            return Some(x[i] + inside / (inside + outside) * (x[i + 1] - x[i]));
        }
        let partly = || self.partly(self.node(i, j), x[i], [x[i - 1], x[i + 1]]);
        self.full(i - 1, j).then(partly)
    }

    /// The back of row `j` if the ice yields up to there: the end of the deepening of the groove,
    /// whose rate decreases towards the runner's lowest point.
    fn back(&self, j: usize) -> Option<f64> {
        let x = &self.mesh.grid.x;
        let i = (1..x.len() - 2).find(|&i| self.force(i, j) > 0.0)?;
        if !self.full(i + 1, j) {
            return None;
        }
        if !self.full(i, j) {
            return Some(self.partly(self.node(i, j), x[i], [x[i + 1], x[i - 1]]));
        }
        let slope = |i: usize| (self.depth(i, j) - self.depth(i + 1, j)) / (x[i + 1] - x[i]);
        let middle = |i: usize| 0.5 * (x[i] + x[i + 1]);
        let bend = (slope(i + 1) - slope(i)) / (middle(i + 1) - middle(i));
        let end = middle(i) - slope(i) / bend;
        Some(if end.is_finite() {
            end.clamp(x[i - 1], x[i + 1])
        } else {
            middle(i - 1)
        })
    }
}
