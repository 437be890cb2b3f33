//! What a sliding contact's mesh says: groove, ploughing, and the patch from its front to its back.

use crate::groove::on_mesh::OnMesh;
use crate::groove::profile::GrooveProfile;
use crate::groove::rims::Rims;
use crate::groove::slid::Slid;
use crate::groove::solution::Section;
use crate::problem::gap::Gap;
use crate::result::chords::By;
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

/// A mesh and its solution.
pub(crate) struct Reading<'a> {
    on: &'a OnMesh<'a>,
    gap: &'a Gap<'a>,
    slid: &'a Slid,
    rims: Rims<'a>,
}

impl<'a> Reading<'a> {
    pub fn new(on: &'a OnMesh<'a>, gap: &'a Gap<'a>, slid: &'a Slid) -> Self {
        Reading {
            on,
            gap,
            slid,
            rims: Rims::new(on.mesh, slid),
        }
    }

    /// The figures; `field` reads the pressure.
    pub fn measures(&self, field: &PressureField) -> Measures {
        let pressure = field.pressures();
        let lowest = self.lowest();
        let [back, front] = self.rims.ends(&field.chords_along(&pressure, By::Shape));
        let contact = &self.on.mesh.contact;
        let (plastic_work, by_slope) = (self.plastic_work(), self.by_slope());
        Measures {
            p_max: if self.rims.yields() {
                field.hardness
            } else {
                field.peak(&pressure)
            },
            depth: self.profile().deepest(),
            ploughing: match self.on.problem.runner.elastic {
                // Nothing yields: what is left of pressures on slopes is the mesh's error.
                _ if plastic_work == 0.0 => 0.0,
                None => 0.5 * (plastic_work + by_slope),
                Some(_) => plastic_work,
            },
            plastic_work,
            by_slope,
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
        let [nx, _] = self.shape();
        let [back, front] = self.rims.ends(&field.chords_along(&pressure, By::Shape));
        let hardness = self.on.problem.ice.hardness.unwrap_or(f64::INFINITY);
        let sides = self.rims.sides(&field.chords_across(&pressure, By::Shape));
        let section = |i: usize| {
            let [right, left] = sides[i]?;
            Some(Section {
                x: self.on.mesh.grid.x[i],
                width: self.copies() * (left - right),
                pressure: self.rims.mean_pressure(i, left - right, hardness),
            })
        };
        let sections = (0..nx).rev().filter_map(section).collect();
        with_ends(sections, [back, front])
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
