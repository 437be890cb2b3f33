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

/// What the line of an index holds, by its chords.
type Holds<'a> = dyn Fn(usize, &[[f64; 2]]) -> f64 + 'a;

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
        let beyond = self.beyond(pressure);
        Figures {
            p_max: self.peak(pressure),
            area: area - beyond,
            length,
            width,
            off: [
                off(area, by_load[0]).max(beyond.abs()),
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
        let of = |_: usize, chords: &[[f64; 2]]| chords.iter().map(|c| c[1] - c[0]).sum();
        [self.integral(&columns, &rows, [&of; 2]), length, width]
    }

    /// What the area within the rims is too large by where the ice yields beside them [m2].
    ///
    /// A pressure that falls from the hardness H to 0 within a cell leaves its rim known to that cell. But what the pressures up to these
    /// rims would bear, Q, is more than the force F by H for each area too much, and by nothing where pressures go to 0 at a rim: (Q - F) / H.
    fn beyond(&self, pressure: &[f64]) -> f64 {
        if !pressure.iter().any(|&p| p >= self.bound()) {
            return 0.0;
        }
        let nx = self.x.len();
        let yielding = self.yielding_to_the_rim(pressure);
        let (columns, rows) = (
            self.chords_across(pressure, By::Shape),
            self.chords_along(pressure, By::Shape),
        );
        let (bound, yielding) = (self.bound(), &yielding);
        let across = |i: usize, chords: &[[f64; 2]]| {
            let line = |j: usize| yielding[j * nx + i];
            chords.iter().map(|c| borne(self.y, line, *c, bound)).sum()
        };
        let along = |j: usize, chords: &[[f64; 2]]| {
            let line = |i: usize| yielding[j * nx + i];
            chords.iter().map(|c| borne(self.x, line, *c, bound)).sum()
        };
        let within = self.integral(&columns, &rows, [&across, &along]);
        (within - self.copies() * self.force.iter().sum::<f64>()) / self.hardness
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

    /// What lines, each by its chords, make over the contact: the mean of columns (`of` first) and rows.
    fn integral(&self, columns: &[Vec<[f64; 2]>], rows: &[Vec<[f64; 2]>], of: [&Holds; 2]) -> f64 {
        let lines = |chords: &[Vec<[f64; 2]>], of: &Holds| {
            let values = chords.iter().enumerate().map(|(k, line)| of(k, line));
            values.collect::<Vec<f64>>()
        };
        let by_columns = area(self.x, &lines(columns, of[0]), rows);
        let by_rows = area(self.y, &lines(rows, of[1]), columns);
        0.5 * (by_columns + by_rows) * self.copies()
    }

    /// How often mirror planes repeat the field.
    fn copies(&self) -> f64 {
        let of = |&mirrored: &bool| if mirrored { 2.0 } else { 1.0 };
        self.symmetry.iter().map(of).product()
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

/// The integral of what lines of one axis hold (their chords' lengths, of which it makes the area), with its square linear
/// between lines (that of a chord is a parabola in an ellipse) and down to 0 at the contact's end.
fn area(nodes: &[f64], lines: &[f64], crossing: &[Vec<[f64; 2]>]) -> f64 {
    let mut sum = 0.0;
    for i in 0..nodes.len() {
        let here = lines[i];
        if here <= 0.0 {
            continue;
        }
        for next in [i.checked_sub(1), Some(i + 1).filter(|&n| n < nodes.len())]
            .into_iter()
            .flatten()
        {
            let there = lines[next];
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_that_yields_up_to_its_rim_has_the_area_that_its_load_takes() {
        let hardness = 20e6;
        for cells in [3.3, 4.6, 6.5, 9.2] {
            let size = 1.0 / cells;
            let nodes: Vec<f64> = (-12..=12).map(|k| size * f64::from(k)).collect();
            // Nodes bear the hardness up to half a cell inside the rim, and nothing from half a cell outside on.
            let bears = |x: f64, y: f64| {
                let part = ((1.0 - x.hypot(y)) / size + 0.5).clamp(0.0, 1.0);
                hardness * size * size * part
            };
            let force: Vec<f64> = nodes
                .iter()
                .flat_map(|&y| nodes.iter().map(move |&x| bears(x, y)))
                .collect();
            let borne = force.iter().sum::<f64>() / hardness;
            let lumped = vec![size; nodes.len()];
            let field = PressureField {
                x: &nodes,
                y: &nodes,
                force: &force,
                gap: None,
                lumped: [&lumped, &lumped],
                symmetry: [false; 2],
                hardness: hardness * (1.0 - 1e-6),
            };
            let pressure = field.pressures();
            let figures = field.figures(&pressure);
            let rims = field.extents(&pressure, By::Shape)[0];
            let off = |area: f64| (area / borne - 1.0).abs();
            let stated = figures.off[0] / borne;
            assert!(off(figures.area) <= stated, "{cells} {figures:?}");
            assert!(off(figures.area) < 0.5 * off(rims), "{cells} {rims}");
        }
    }
}
