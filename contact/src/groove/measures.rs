//! What a sliding contact's mesh says: groove, ploughing, and the patch from its front to its back.

use crate::groove::memory::Kind;
use crate::groove::on_mesh::{OnMesh, Slid};
use crate::groove::profile::GrooveProfile;
use crate::groove::solution::Section;
use crate::problem::gap::Gap;
use crate::result::measure::PressureField;

/// The figures that errors are stated of, as one mesh has them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measures {
    /// Peak pressure [Pa].
    pub p_max: f64,
    /// Largest depth of the groove that is left [m].
    pub depth: f64,
    /// Force that ploughs: of a rigid runner the mean of the next two, whose errors differ, else the first [N].
    pub ploughing: f64,
    /// The same from the plastic work over the way [N].
    pub plastic_work: f64,
    /// The same from pressures and the slope of the undeformed runner [N].
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

/// A mesh, its solution, and the nodes' states on the whole plane.
pub(crate) struct Reading<'a> {
    on: &'a OnMesh<'a>,
    gap: &'a Gap<'a>,
    slid: &'a Slid,
    full: Vec<bool>,
    gaps: Vec<f64>,
}

impl<'a> Reading<'a> {
    pub fn new(on: &'a OnMesh<'a>, gap: &'a Gap<'a>, slid: &'a Slid) -> Self {
        let contact = &on.mesh.contact;
        let mut full = vec![false; contact.gap.len()];
        let mut gaps = vec![f64::INFINITY; contact.gap.len()];
        for (k, &node) in contact.candidates.iter().enumerate() {
            full[node] = slid.grooved.kinds[k] == Kind::Full;
            gaps[node] = slid.grooved.gap[k];
        }
        Reading {
            on,
            gap,
            slid,
            full,
            gaps,
        }
    }

    /// The figures; `field` reads the pressure.
    pub fn measures(&self, field: &PressureField) -> Measures {
        let pressure = field.pressures();
        let lowest = self.lowest();
        let [back, front] = self.ends(&field.chords_along(&pressure));
        let contact = &self.on.mesh.contact;
        Measures {
            p_max: if self.full.contains(&true) {
                field.hardness
            } else {
                field.peak(&pressure)
            },
            depth: self.profile().deepest(),
            ploughing: match self.on.problem.runner.elastic {
                // Nothing yields: what is left of pressures on slopes is the mesh's error.
                _ if self.plastic_work() == 0.0 => 0.0,
                None => 0.5 * (self.plastic_work() + self.by_slope()),
                Some(_) => self.plastic_work(),
            },
            plastic_work: self.plastic_work(),
            by_slope: self.by_slope(),
            front: front - lowest,
            back: back - lowest,
            load_ahead: self.centre_along() - lowest,
            fz: self.copies() * contact.resultant(&self.slid.state)[0],
            approach: contact.depth(&self.slid.state),
            lowest,
        }
    }

    /// The section that is left, over the whole width.
    pub fn profile(&self) -> GrooveProfile {
        let [nx, _] = self.shape();
        let ys = &self.on.mesh.grid.y;
        let depth = |j: usize| self.slid.depth[j * nx];
        let mirrored = (1..ys.len()).rev().filter(|_| self.on.mesh.symmetry[1]);
        let pairs = mirrored.map(|j| (-ys[j], depth(j)));
        let (y, depth) = pairs
            .chain((0..ys.len()).map(|j| (ys[j], depth(j))))
            .unzip();
        GrooveProfile::new(y, depth).expect("nodes ascend and no groove is negative")
    }

    /// Work of the plastic depth over the way: H times the section that this runner adds.
    fn plastic_work(&self) -> f64 {
        let [nx, ny] = self.shape();
        let hardness = self.on.problem.ice.hardness.unwrap_or(0.0);
        let across = &self.on.mesh.contact.lumped[1];
        let added: f64 = (0..ny)
            .map(|j| across[j] * (self.slid.depth[j * nx] - self.slid.depth[j * nx + nx - 1]))
            .sum();
        self.copies() * hardness * added
    }

    /// Sum of the forces times the slope of the undeformed runner.
    fn by_slope(&self) -> f64 {
        let [nx, _] = self.shape();
        let grid = &self.on.mesh.grid;
        let state = &self.slid.state;
        let slope = |n: usize| {
            let (x, y) = (grid.x[n % nx], grid.y[n / nx]);
            let step = 0.01 * (grid.x[n % nx + 1] - x);
            let rise = self.gap.at(x + step, y) - self.gap.at(x - step, y);
            rise / (2.0 * step) - state.motion[1]
        };
        let touching = (0..state.force.len()).filter(|&n| state.force[n] > 0.0);
        self.copies() * touching.map(|n| state.force[n] * slope(n)).sum::<f64>()
    }

    /// Stations from the front to the back: width and mean pressure.
    pub fn sections(&self, field: &PressureField) -> Vec<Section> {
        let pressure = field.pressures();
        let [nx, ny] = self.shape();
        let [back, front] = self.ends(&field.chords_along(&pressure));
        let hardness = self.on.problem.ice.hardness.unwrap_or(f64::INFINITY);
        let sides = self.sides(&field.chords_across(&pressure));
        let along = &self.on.mesh.contact.lumped[0];
        let section = |i: usize| {
            let [right, left] = sides[i]?;
            let force: f64 = (0..ny).map(|j| self.slid.state.force[j * nx + i]).sum();
            let pressure = force / (along[i] * (left - right));
            Some(Section {
                x: self.on.mesh.grid.x[i],
                width: self.copies() * (left - right),
                pressure: pressure.min(hardness),
            })
        };
        let sections = (0..nx).rev().filter_map(section).collect();
        with_ends(sections, [back, front])
    }

    /// The patch's rims, below the cell: [x low, x high, y low, y high] [m].
    pub fn rims(&self, field: &PressureField) -> [f64; 4] {
        let pressure = field.pressures();
        let [back, front] = self.ends(&field.chords_along(&pressure));
        let sides = self.sides(&field.chords_across(&pressure));
        let touched = sides.iter().flatten();
        let left = touched
            .clone()
            .fold(f64::NEG_INFINITY, |left, s| left.max(s[1]));
        let right = touched.fold(f64::INFINITY, |right, s| right.min(s[0]));
        let right = if self.on.mesh.symmetry[1] {
            -left
        } else {
            right
        };
        [back, front, right, left]
    }

    /// The area that yields, up to its rims below the cell, over that of the full nodes' parts of the plane: 1 where none is full.
    ///
    /// Rims are looked for across, where the patch is narrow and runs along the lines of nodes.
    pub fn full_area(&self) -> f64 {
        let [nx, ny] = self.shape();
        let [along, across] = &self.on.mesh.contact.lumped;
        let y = &self.on.mesh.grid.y;
        let (mut nodes, mut missing) = (0.0, 0.0);
        for i in 0..nx {
            let part: f64 = (0..ny)
                .filter(|j| self.full[j * nx + i])
                .map(|j| across[j])
                .sum();
            nodes += along[i] * part;
            for upper in [false, true] {
                if let Some(([j, k], side)) = self.yielding_side(i, upper) {
                    missing += along[i] * (side - 0.5 * (y[j] + y[k])) * (y[k] - y[j]).signum();
                }
            }
        }
        if nodes > 0.0 {
            (1.0 + missing / nodes).clamp(0.9, 1.1)
        } else {
            1.0
        }
    }

    /// Where the ice begins to yield at a side of column `i`, between the outermost node, if it is full, and the open one beyond it.
    fn yielding_side(&self, i: usize, upper: bool) -> Option<([usize; 2], f64)> {
        let [nx, ny] = self.shape();
        let touching = |j: &usize| self.slid.state.force[j * nx + i] > 0.0;
        let j = if upper {
            (0..ny).rfind(touching)
        } else {
            (0..ny).find(touching)
        }?;
        let k = if upper {
            (j + 1 < ny).then_some(j + 1)
        } else {
            j.checked_sub(1)
        }?;
        let outside = self.gaps[k * nx + i] - self.grown(i, k);
        let y = &self.on.mesh.grid.y;
        let inside = self.grown(i, j);
        (self.full[j * nx + i] && outside > 0.0 && outside.is_finite())
            .then(|| ([j, k], y[j] + inside / (inside + outside) * (y[k] - y[j])))
    }

    /// Depth at a node beyond that in which the ice came [m].
    fn grown(&self, i: usize, j: usize) -> f64 {
        let [nx, _] = self.shape();
        self.slid.depth[j * nx + i] - self.slid.depth[j * nx + nx - 1]
    }

    /// Both sides of the contact at every column; none where it is open.
    fn sides(&self, chords: &[Vec<[f64; 2]>]) -> Vec<Option<[f64; 2]>> {
        let [nx, _] = self.shape();
        let mut sides = vec![None; nx];
        let mut ahead = [0.0; 2];
        for i in (0..nx).rev() {
            if let (Some(first), Some(last)) = (chords[i].first(), chords[i].last()) {
                ahead = [
                    self.side(i, [first[0], ahead[0]], false),
                    self.side(i, [last[1], ahead[1]], true),
                ];
                sides[i] = Some(ahead);
            }
        }
        sides
    }

    /// The contact's side at column `i`: where the groove begins if the outermost node yields, where it began before if that lies in
    /// it, and else that of the pressure. `known` holds the last and what it was ahead.
    fn side(&self, i: usize, known: [f64; 2], upper: bool) -> f64 {
        let [nx, ny] = self.shape();
        let touching = |j: &usize| self.slid.state.force[j * nx + i] > 0.0;
        let outermost = if upper {
            (0..ny).rfind(touching)
        } else {
            (0..ny).find(touching)
        };
        let Some(j) = outermost else { return known[0] };
        let beyond = if upper {
            (j + 1 < ny).then_some(j + 1)
        } else {
            j.checked_sub(1)
        };
        let Some(k) = beyond else { return known[0] };
        let y = &self.on.mesh.grid.y;
        let inside = self.grown(i, j);
        if let Some((_, side)) = self.yielding_side(i, upper) {
            return side;
        }
        let within = if upper { j.checked_sub(1) } else { Some(j + 1) };
        if inside <= 0.0 && within.is_some_and(|w| self.full[w * nx + i]) {
            return self.partly(j * nx + i, y[j], [y[within.unwrap_or(j)], y[k]]);
        }
        let [by_pressure, ahead] = known;
        let between = (y[j].min(y[k])..=y[j].max(y[k])).contains(&ahead);
        if inside > 0.0 && self.grown(i, k) <= 0.0 && between {
            ahead
        } else {
            by_pressure
        }
    }

    /// The rim by the share of a node's part of the plane that yields, where it is the last one and the next one within yields.
    fn partly(&self, node: usize, at: f64, [within, beyond]: [f64; 2]) -> f64 {
        let share = self.slid.state.force[node] / self.on.mesh.contact.bound[node];
        let (from, to) = (0.5 * (at + within), 0.5 * (at + beyond));
        from + share * (to - from)
    }

    /// Back and front ends of the patch [m]; the front where the ice begins to yield, below the cell.
    fn ends(&self, chords: &[Vec<[f64; 2]>]) -> [f64; 2] {
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        for (j, chords) in chords.iter().enumerate() {
            let (Some(first), Some(last)) = (chords.first(), chords.last()) else {
                continue;
            };
            let front = self.front(j).unwrap_or(last[1]);
            let back = self.back(j).unwrap_or(first[0]);
            ends = [ends[0].min(back), ends[1].max(front)];
        }
        ends
    }

    /// The front of row `j` where the ice yields there.
    fn front(&self, j: usize) -> Option<f64> {
        let [nx, _] = self.shape();
        let x = &self.on.mesh.grid.x;
        let node = |i: usize| j * nx + i;
        let i = (1..nx - 1).rfind(|&i| self.slid.state.force[node(i)] > 0.0)?;
        let outside = self.gaps[node(i + 1)];
        if self.full[node(i)] && outside.is_finite() {
            let inside = self.slid.depth[node(i)] - self.slid.depth[node(i + 1)];
            return Some(x[i] + inside / (inside + outside) * (x[i + 1] - x[i]));
        }
        self.full[node(i - 1)].then(|| self.partly(node(i), x[i], [x[i - 1], x[i + 1]]))
    }

    /// The back of row `j` where the ice yields up to there: where the groove no longer deepens, which it does ever less towards
    /// the runner's lowest point.
    fn back(&self, j: usize) -> Option<f64> {
        let [nx, _] = self.shape();
        let x = &self.on.mesh.grid.x;
        let node = |i: usize| j * nx + i;
        let i = (1..nx - 2).find(|&i| self.slid.state.force[node(i)] > 0.0)?;
        if !self.full[node(i + 1)] {
            return None;
        }
        if !self.full[node(i)] {
            return Some(self.partly(node(i), x[i], [x[i + 1], x[i - 1]]));
        }
        let depth = |i: usize| self.slid.depth[node(i)];
        let slope = |i: usize| (depth(i) - depth(i + 1)) / (x[i + 1] - x[i]);
        let middle = |i: usize| 0.5 * (x[i] + x[i + 1]);
        let bend = (slope(i + 1) - slope(i)) / (middle(i + 1) - middle(i));
        let end = middle(i) - slope(i) / bend;
        Some(if end.is_finite() {
            end.clamp(x[i - 1], x[i + 1])
        } else {
            middle(i - 1)
        })
    }

    /// Where the runner, as it is turned, is lowest over the track along x; the middle of where it is level.
    fn lowest(&self) -> f64 {
        let [nx, ny] = self.shape();
        let contact = &self.on.mesh.contact;
        let motion = self.slid.state.motion;
        let height = |i: usize| {
            let heights = (0..ny).map(|j| {
                let n = j * nx + i;
                contact.gap[n] - crate::active_set::motion::dot(contact.rows[n], motion)
            });
            heights.fold(f64::INFINITY, f64::min)
        };
        let heights: Vec<f64> = (0..nx).map(height).collect();
        let least = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let level: Vec<usize> = (0..nx).filter(|&i| heights[i] - least <= 1e-12).collect();
        let x = &self.on.mesh.grid.x;
        match level[..] {
            [i] if i > 0
                && i + 1 < nx
                && heights[i - 1].is_finite()
                && heights[i + 1].is_finite() =>
            {
                let (h0, h1) = (x[i] - x[i - 1], x[i + 1] - x[i]);
                let (down, up) = (
                    (heights[i] - heights[i - 1]) / h0,
                    (heights[i + 1] - heights[i]) / h1,
                );
                let (slope, bend) = (
                    (down * h1 + up * h0) / (h0 + h1),
                    2.0 * (up - down) / (h0 + h1),
                );
                x[i] - slope / bend
            }
            _ => level.iter().map(|&i| x[i]).sum::<f64>() / level.len() as f64,
        }
    }

    fn centre_along(&self) -> f64 {
        let resultant = self.on.mesh.contact.resultant(&self.slid.state);
        self.gap.line_of_action[0] + resultant[1] / resultant[0]
    }

    fn shape(&self) -> [usize; 2] {
        [self.on.mesh.grid.x.len(), self.on.mesh.grid.y.len()]
    }

    fn copies(&self) -> f64 {
        if self.on.mesh.symmetry[1] { 2.0 } else { 1.0 }
    }
}

/// Stations at the ends, where pressure and squared width follow the line through the two nearest.
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
