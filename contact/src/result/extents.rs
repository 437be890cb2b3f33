//! How far a contact reaches: area, length and width, and what its load says of them where the ice yields up to its rim.

use crate::result::chords::By;
use crate::result::measure::{Holds, PressureField};

/// Contact intervals of all lines of nodes.
pub(crate) struct Lines {
    /// Of those across, one for each x.
    columns: Vec<Vec<[f64; 2]>>,
    /// Of those along, one for each y.
    rows: Vec<Vec<[f64; 2]>>,
}

impl Lines {
    /// Those that run along x, or along y.
    fn along(&self, axis: usize) -> &[Vec<[f64; 2]>] {
        match axis {
            0 => &self.rows,
            _ => &self.columns,
        }
    }

    /// The line along an axis whose chord ends first or last, with that chord.
    fn outermost(&self, axis: usize, last: bool) -> Option<(usize, [f64; 2])> {
        let lines = self.along(axis).iter().enumerate();
        let chords = lines.flat_map(|(line, chords)| chords.iter().map(move |c| (line, *c)));
        match last {
            false => chords.min_by(|a, b| a.1[0].total_cmp(&b.1[0])),
            true => chords.max_by(|a, b| a.1[1].total_cmp(&b.1[1])),
        }
    }
}

impl PressureField<'_> {
    /// Contact intervals of all lines, with ends `by` what is asked.
    pub(super) fn lines(&self, pressure: &[f64], by: By) -> Lines {
        Lines {
            columns: self.chords_across(pressure, by),
            rows: self.chords_along(pressure, by),
        }
    }

    /// Area, length and width of the contact.
    pub fn extents(&self, pressure: &[f64], by: By) -> [f64; 3] {
        self.extents_of(&self.lines(pressure, by))
    }

    /// The same from its lines.
    pub(super) fn extents_of(&self, lines: &Lines) -> [f64; 3] {
        let extent = |axis: usize| {
            let ends = [false, true].map(|last| lines.outermost(axis, last));
            match ends {
                [Some(_), Some((_, [_, high]))] if self.symmetry[axis] => 2.0 * high,
                [Some((_, [low, _])), Some((_, [_, high]))] => high - low,
                _ => 0.0,
            }
        };
        let of = |_: usize, chords: &[[f64; 2]]| chords.iter().map(|c| c[1] - c[0]).sum();
        let area = self.integral(&lines.columns, &lines.rows, [&of; 2]);
        [area, extent(0), extent(1)]
    }

    /// What the area within the rims is too large by where the ice yields beside them [m2].
    ///
    /// A pressure that falls from the hardness H to 0 within a cell leaves its rim known to a part of that cell. But what the pressures up to
    /// these rims would bear, Q, is more than the force F by H for each area too much, and by nothing where pressures go to 0 at a rim: (Q - F) / H.
    pub(super) fn beyond(&self, pressure: &[f64], lines: &Lines) -> f64 {
        if !pressure.iter().any(|&p| p >= self.bound()) {
            return 0.0;
        }
        let nx = self.x.len();
        let (bound, yielding) = (self.bound(), &self.yielding_to_the_rim(pressure));
        let across = |i: usize, chords: &[[f64; 2]]| {
            let line = |j: usize| yielding[j * nx + i];
            chords.iter().map(|c| borne(self.y, line, *c, bound)).sum()
        };
        let along = |j: usize, chords: &[[f64; 2]]| {
            let line = |i: usize| yielding[j * nx + i];
            chords.iter().map(|c| borne(self.x, line, *c, bound)).sum()
        };
        let of: [&Holds; 2] = [&across, &along];
        let within = self.integral(&lines.columns, &lines.rows, of);
        (within - self.copies() * self.force.iter().sum::<f64>()) / self.hardness
    }

    /// What the length or the width is too large by where the area is by `part` of itself: half of that part of the stretch at either end, if
    /// the ice yields there; ends where the pressure goes to 0 stay [m].
    pub(super) fn too_far(&self, axis: usize, pressure: &[f64], lines: &Lines, part: f64) -> f64 {
        let mirrored = self.symmetry[axis];
        let end = |last: bool| {
            let Some((line, [low, high])) = lines.outermost(axis, last) else {
                return 0.0;
            };
            let cut = mirrored && low <= [self.x, self.y][axis][0];
            let stretch = if cut { 2.0 * high } else { high - low };
            match self.yields_at(axis, pressure, line, ([low, high], last)) {
                true => 0.25 * part * stretch,
                false => 0.0,
            }
        };
        match mirrored {
            true => 2.0 * end(true),
            false => end(false) + end(true),
        }
    }

    /// Whether the outermost node inside an end of a line's chord bears all it can.
    fn yields_at(
        &self,
        axis: usize,
        pressure: &[f64],
        line: usize,
        ([low, high], last): ([f64; 2], bool),
    ) -> bool {
        let nx = self.x.len();
        let nodes = [self.x, self.y][axis];
        let full = |k: usize| {
            let node = [line * nx + k, k * nx + line][axis];
            pressure[node] >= self.bound()
        };
        let mut inside = (0..nodes.len()).filter(|&k| (low..=high).contains(&nodes[k]));
        let outermost = if last {
            inside.next_back()
        } else {
            inside.next()
        };
        outermost.is_some_and(full)
    }

    /// Pressures that are the hardness up to the rim where the next node inside has it.
    fn yielding_to_the_rim(&self, pressure: &[f64]) -> Vec<f64> {
        let (nx, ny) = (self.x.len(), self.y.len());
        let ends = |k: usize, count: usize, at: &dyn Fn(usize) -> f64| {
            let rim =
                |inside: usize, outside: usize| at(inside) >= self.bound() && at(outside) <= 0.0;
            k > 0 && k + 1 < count && (rim(k - 1, k + 1) || rim(k + 1, k - 1))
        };
        let of = |n: usize| {
            let (i, j) = (n % nx, n / nx);
            let along = ends(i, nx, &|k| pressure[j * nx + k]);
            let across = ends(j, ny, &|k| pressure[k * nx + i]);
            match pressure[n] > 0.0 && (along || across) {
                true => self.hardness,
                false => pressure[n],
            }
        };
        (0..nx * ny).map(of).collect()
    }
}

/// What a line's pressure bears over one of its chords [N/m]: linear between nodes, the hardness up to a rim that yields, and else to
/// 0 like the root of the distance.
fn borne(nodes: &[f64], pressure: impl Fn(usize) -> f64, [low, high]: [f64; 2], bound: f64) -> f64 {
    let inside: Vec<usize> = (0..nodes.len())
        .filter(|&k| (low..=high).contains(&nodes[k]))
        .collect();
    let (Some(&first), Some(&last)) = (inside.first(), inside.last()) else {
        return 0.0;
    };
    let between: f64 = (first..last)
        .map(|k| 0.5 * (pressure(k) + pressure(k + 1)) * (nodes[k + 1] - nodes[k]))
        .sum();
    let end = |p: f64, length: f64| match p >= bound {
        true => p * length,
        false => 2.0 / 3.0 * p * length,
    };
    between + end(pressure(first), nodes[first] - low) + end(pressure(last), high - nodes[last])
}
