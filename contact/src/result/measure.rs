//! From nodal forces to pressures, and from pressures to the figures of a contact.

use crate::result::chords::{By, chords};

/// A pressure field on the graded nodes of the contact plane, x fastest, with the mirror planes it ends at.
pub(crate) struct PressureField<'a> {
    /// Nodes along x [m].
    pub x: &'a [f64],
    /// Nodes along y [m].
    pub y: &'a [f64],
    /// Nodal forces [N].
    pub force: &'a [f64],
    /// Gaps at the nodes, where they are to help to find rims [m].
    pub gap: Option<Vec<f64>>,
    /// Integrals of the nodes' hat functions, by x and by y [m].
    pub lumped: [&'a [f64]; 2],
    /// Mirror planes x = 0 and y = 0.
    pub symmetry: [bool; 2],
    /// Largest pressure the ice bears [Pa].
    pub hardness: f64,
}

/// The figures of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Figures {
    pub p_max: f64,
    pub area: f64,
    pub length: f64,
    pub width: f64,
    /// What rims by shape and by load make of area, length and width, one less the other.
    pub off: [f64; 3],
}

impl PressureField<'_> {
    /// Pressures from here on are the hardness but for rounding [Pa].
    pub fn bound(&self) -> f64 {
        self.hardness * (1.0 - 1e-9)
    }

    /// Nodal pressures [Pa].
    ///
    /// A node's force over the integral of its hat function is a weighted mean of the pressure:
    /// p + m1 p' + m2 p'' / 2 with the hat's first two moments. Where both neighbours along an axis are in
    /// contact the moments' share is taken out with the differences of the means themselves.
    pub fn pressures(&self) -> Vec<f64> {
        let (nx, ny) = (self.x.len(), self.y.len());
        let mean: Vec<f64> = (0..nx * ny)
            .map(|n| self.force[n] / (self.lumped[0][n % nx] * self.lumped[1][n / nx]))
            .collect();
        let mut pressure = mean.clone();
        for j in 0..ny {
            for i in 0..nx {
                let n = j * nx + i;
                if mean[n] <= 0.0 || mean[n] >= self.bound() {
                    continue;
                }
                let along_x = moment_share(self.x, i, self.symmetry[0], |k| mean[j * nx + k]);
                let along_y = moment_share(self.y, j, self.symmetry[1], |k| mean[k * nx + i]);
                pressure[n] = (mean[n] - along_x - along_y).clamp(0.0, self.hardness);
            }
        }
        pressure
    }

    /// Peak, area, length and width of the contact.
    pub fn figures(&self, pressure: &[f64]) -> Figures {
        let ([area, length, width], by_load) = (
            self.extents(pressure, By::Shape),
            self.extents(pressure, By::Load),
        );
        let off = |a: f64, b: f64| (a - b).abs();
        Figures {
            p_max: self.peak(pressure),
            area,
            length,
            width,
            off: [
                off(area, by_load[0]),
                off(length, by_load[1]),
                off(width, by_load[2]),
            ],
        }
    }

    /// Area, length and width of the contact.
    pub fn extents(&self, pressure: &[f64], by: By) -> [f64; 3] {
        let (columns, rows) = (
            self.chords_across(pressure, by),
            self.chords_along(pressure, by),
        );
        let copies: f64 = self
            .symmetry
            .iter()
            .map(|&s| if s { 2.0 } else { 1.0 })
            .product();
        let extent = |chords: &[Vec<[f64; 2]>], axis: usize| {
            let ends = chords
                .iter()
                .flatten()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |e, c| {
                    [e[0].min(c[0]), e[1].max(c[1])]
                });
            match ends[1] - ends[0] {
                _ if ends[1] < ends[0] => 0.0,
                _ if self.symmetry[axis] => 2.0 * ends[1],
                length => length,
            }
        };
        let (length, width) = (extent(&rows, 0), extent(&columns, 1));
        let by_columns = area(self.x, &columns, &rows);
        let by_rows = area(self.y, &rows, &columns);
        [0.5 * (by_columns + by_rows) * copies, length, width]
    }

    /// Contact intervals of every line across (one for each x).
    pub fn chords_across(&self, pressure: &[f64], by: By) -> Vec<Vec<[f64; 2]>> {
        let nx = self.x.len();
        (0..nx)
            .map(|i| {
                let column = |of: &[f64]| -> Vec<f64> {
                    (0..self.y.len()).map(|j| of[j * nx + i]).collect()
                };
                let gap = self.gap.as_deref().map(column);
                chords(
                    self.y,
                    &column(pressure),
                    gap.as_deref(),
                    (self.bound(), self.symmetry[1]),
                    by,
                )
            })
            .collect()
    }

    /// Contact intervals of every line along (one for each y).
    pub fn chords_along(&self, pressure: &[f64], by: By) -> Vec<Vec<[f64; 2]>> {
        let nx = self.x.len();
        pressure
            .chunks_exact(nx)
            .enumerate()
            .map(|(j, row)| {
                let gap = self.gap.as_ref().map(|gap| &gap[j * nx..(j + 1) * nx]);
                chords(self.x, row, gap, (self.bound(), self.symmetry[0]), by)
            })
            .collect()
    }

    /// The largest pressure: at a node, raised by the vertex of the parabola through its neighbours on each axis.
    pub fn peak(&self, pressure: &[f64]) -> f64 {
        let nx = self.x.len();
        let Some(top) = (0..pressure.len()).max_by(|&a, &b| pressure[a].total_cmp(&pressure[b]))
        else {
            return 0.0;
        };
        let (i, j) = (top % nx, top / nx);
        let rise_x = vertex_rise(self.x, i, self.symmetry[0], |k| pressure[j * nx + k]);
        let rise_y = vertex_rise(self.y, j, self.symmetry[1], |k| pressure[k * nx + i]);
        (pressure[top] + rise_x + rise_y).min(self.hardness)
    }
}

/// Neighbours' distances and values around node `k`; a mirror plane continues the field evenly.
fn neighbours(
    nodes: &[f64],
    k: usize,
    symmetric: bool,
    value: &impl Fn(usize) -> f64,
) -> Option<[[f64; 2]; 2]> {
    if k + 1 >= nodes.len() {
        return None;
    }
    let above = [nodes[k + 1] - nodes[k], value(k + 1)];
    match k {
        0 if symmetric => Some([above, above]),
        0 => None,
        _ => Some([[nodes[k] - nodes[k - 1], value(k - 1)], above]),
    }
}

/// Slope and curvature at a node from its neighbours.
fn differences([[h0, p0], [h1, p1]]: [[f64; 2]; 2], here: f64) -> (f64, f64) {
    let (down, up) = ((here - p0) / h0, (p1 - here) / h1);
    (
        (down * h1 + up * h0) / (h0 + h1),
        2.0 * (up - down) / (h0 + h1),
    )
}

/// m1 p' + m2 p'' / 2 of the hat function at node `k`; 0 at the rim, where the pressure is not smooth.
fn moment_share(nodes: &[f64], k: usize, symmetric: bool, value: impl Fn(usize) -> f64) -> f64 {
    match neighbours(nodes, k, symmetric, &value) {
        Some(sides) if sides[0][1] > 0.0 && sides[1][1] > 0.0 => {
            let [h0, h1] = [sides[0][0], sides[1][0]];
            let (slope, curvature) = differences(sides, value(k));
            let first = (h1 - h0) / 3.0;
            let second = (h0.powi(3) + h1.powi(3)) / (6.0 * (h0 + h1));
            first * slope + 0.5 * second * curvature
        }
        _ => 0.0,
    }
}

/// How far the parabola through three nodes rises above the middle one.
fn vertex_rise(nodes: &[f64], k: usize, symmetric: bool, value: impl Fn(usize) -> f64) -> f64 {
    match neighbours(nodes, k, symmetric, &value) {
        Some(sides) if sides[0][1] > 0.0 && sides[1][1] > 0.0 => {
            let (slope, curvature) = differences(sides, value(k));
            if curvature < 0.0 {
                -0.5 * slope * slope / curvature
            } else {
                0.0
            }
        }
        _ => 0.0,
    }
}

/// Area from the chords on the lines of one axis, with the square of the chord linear between lines (it is a
/// parabola in an ellipse) and down to 0 at the contact's end.
fn area(nodes: &[f64], chords: &[Vec<[f64; 2]>], crossing: &[Vec<[f64; 2]>]) -> f64 {
    let length = |i: usize| chords[i].iter().map(|c| c[1] - c[0]).sum::<f64>();
    let mut sum = 0.0;
    for i in 0..nodes.len() {
        let here = length(i);
        if here <= 0.0 {
            continue;
        }
        for next in [i.checked_sub(1), Some(i + 1).filter(|&n| n < nodes.len())]
            .into_iter()
            .flatten()
        {
            let there = length(next);
            if there > 0.0 {
                // Each interval is met from both of its ends.
                let mean =
                    2.0 / 3.0 * (here * here + here * there + there * there) / (here + there);
                sum += 0.5 * mean * (nodes[next] - nodes[i]).abs();
            } else {
                let end = tip(nodes[i], nodes[next], crossing);
                sum += 2.0 / 3.0 * here * (end - nodes[i]).abs();
            }
        }
    }
    sum
}

/// The farthest end of a crossing line's contact between the last line in contact and the first one out of it.
fn tip(last: f64, outside: f64, crossing: &[Vec<[f64; 2]>]) -> f64 {
    let (low, high) = (last.min(outside), last.max(outside));
    let ends = crossing
        .iter()
        .flatten()
        .flatten()
        .filter(|e| (low..=high).contains(*e));
    let farthest = ends.map(|e| (e - last).abs()).fold(0.0, f64::max);
    let reach = if farthest > 0.0 {
        farthest
    } else {
        0.5 * (high - low)
    };
    last + reach * (outside - last).signum()
}
