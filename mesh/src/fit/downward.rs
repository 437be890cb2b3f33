//! The part of a hull that faces the ice.

use nalgebra::Vector3;

use crate::error::MeshError;
use crate::fit::spline::Sample;
use crate::hull::triangles::Hull;
use crate::parameter::{linspace, range};
use crate::shapes::profile::Profile;

/// Smallest cosine between the normal of a facet of the underside and straight down; others are
/// flanks.
const MIN_FACET_COSINE: f64 = 0.02;
/// Smallest cosine between the normal of a fitted vertex and straight down.
pub(crate) const MIN_VERTEX_COSINE: f64 = 0.1;
/// Number of stations along the hull at which its outline is stored.
const STATIONS: usize = 1024;

/// The downward-facing facets connected with the lowest vertex.
#[derive(Default)]
pub(crate) struct Downward {
    /// Vertices (x, y, z) [m].
    pub points: Vec<[f64; 3]>,
    /// Their numbers in the hull.
    pub vertices: Vec<u32>,
    /// Cosine between each vertex' normal and straight down.
    pub cosines: Vec<f64>,
    /// Facets' corners among the points.
    pub facets: Vec<[usize; 3]>,
}

impl Downward {
    /// The downward-facing part of `hull`.
    ///
    /// # Errors
    /// [`MeshError::Invalid`] if no facet faces down, or if none of these has the hull's lowest
    /// vertex.
    pub fn of(hull: &Hull) -> Result<Self, MeshError> {
        let facets = hull.triangles.iter();
        let facets = facets.map(|t| (t, Vector3::from(hull.normal(t))));
        let downward: Vec<(&[u32; 3], Vector3<f64>)> = facets
            .filter(|(_, n)| -n.z > MIN_FACET_COSINE * n.norm())
            .collect();
        let height = |facet: &usize| {
            let corners = downward[*facet].0.map(|i| hull.positions[i as usize][2]);
            corners.into_iter().fold(f64::INFINITY, f64::min)
        };
        let by_height = |a: &usize, b: &usize| height(a).total_cmp(&height(b));
        let lowest = (0..downward.len()).min_by(by_height).ok_or_else(|| {
            let problem = "no triangle of the hull faces down; check `up`, and that the \
                               triangles face outwards";
            MeshError::Invalid(problem.into())
        })?;

        // The facets at each vertex, one after the other.
        let mut first = vec![0; hull.positions.len() + 1];
        let corners = || downward.iter().flat_map(|(corners, _)| corners.iter());
        corners().for_each(|&c| first[c as usize + 1] += 1);
        (1..first.len()).for_each(|v| first[v] += first[v - 1]);
        let mut next = first.clone();
        let mut at_vertices = vec![0; 3 * downward.len()];
        for (k, &c) in corners().enumerate() {
            at_vertices[next[c as usize]] = k / 3;
            next[c as usize] += 1;
        }
        let mut reached = vec![false; downward.len()];
        reached[lowest] = true;
        let mut waiting = vec![lowest];
        while let Some(facet) = waiting.pop() {
            for corner in downward[facet].0.map(|c| c as usize) {
                for &next in &at_vertices[first[corner]..first[corner + 1]] {
                    if !std::mem::replace(&mut reached[next], true) {
                        waiting.push(next);
                    }
                }
            }
        }

        let mut part = Self::default();
        let mut number = vec![None; hull.positions.len()];
        let mut normals: Vec<Vector3<f64>> = Vec::new();
        let facets = downward.iter().zip(reached);
        for ((corners, normal), _) in facets.filter(|(_, reached)| *reached) {
            let facet = corners.map(|c| {
                *number[c as usize].get_or_insert_with(|| {
                    part.points.push(hull.positions[c as usize]);
                    part.vertices.push(c);
                    normals.push(Vector3::zeros());
                    normals.len() - 1
                })
            });
            facet.iter().for_each(|&i| normals[i] += normal);
            part.facets.push(facet);
        }
        part.refuse_stray_vertex(hull)?;
        part.cosines = normals.iter().map(|n| -n.z / n.norm()).collect();
        Ok(part)
    }

    /// Refuses a hull whose lowest vertex is not in the part, as the facets around it are flanks.
    fn refuse_stray_vertex(&self, hull: &Hull) -> Result<(), MeshError> {
        let lowest = self.range(2)[0];
        let corners = hull.triangles.iter().flatten();
        let corners = corners.map(|corner| hull.positions[*corner as usize]);
        match corners.min_by(|a, b| a[2].total_cmp(&b[2])) {
            Some([x, y, z]) if z < lowest => Err(MeshError::Invalid(format!(
                "the hull's lowest vertex, at x = {x:.6}, y = {y:.6}, z = {z:.6} m, lies {} m \
                 below the surface that faces down: a stray vertex?",
                lowest - z
            ))),
            _ => Ok(()),
        }
    }

    /// The points of a fit: those that are not too steep.
    pub fn gentle(&self) -> impl Iterator<Item = usize> {
        (0..self.points.len()).filter(|&n| self.cosines[n] > MIN_VERTEX_COSINE)
    }

    /// Their heights over x and the arc length across, weighted by their cosines.
    pub fn samples(&self, arc_length: &Profile) -> Vec<Sample> {
        let sample = |n: usize| {
            let [x, y, height] = self.points[n];
            Sample {
                at: [x, arc_length.value(y)],
                height,
                weight: self.cosines[n],
            }
        };
        self.gentle().map(sample).collect()
    }

    /// Smallest and largest value of coordinate `axis` [m].
    pub fn range(&self, axis: usize) -> [f64; 2] {
        range(self.points.iter().map(|p| p[axis]))
    }

    /// The part's sides along x.
    pub fn outline(&self) -> Outline {
        let [from, to] = self.range(0);
        let mut sides = vec![[f64::INFINITY, f64::NEG_INFINITY]; STATIONS + 1];
        let step = (to - from) / STATIONS as f64;
        for facet in &self.facets {
            let corners = facet.map(|i| self.points[i]);
            let [low, high] = range(corners.map(|p| p[0]));
            // A station at a vertex must not fall between two facets by rounding.
            let first = ((low - from) / step - 1e-6).ceil().max(0.0) as usize;
            let last = (((high - from) / step + 1e-6).floor() as usize).min(STATIONS);
            let [a, b, c] = corners;
            for (i, side) in sides.iter_mut().enumerate().take(last + 1).skip(first) {
                let x = if i == STATIONS {
                    to
                } else {
                    from + step * i as f64
                };
                for (p, q) in [(a, b), (b, c), (c, a)] {
                    if (p[0] - x) * (q[0] - x) <= 0.0 {
                        let y = p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0]);
                        let ends = if p[0] == q[0] { [p[1], q[1]] } else { [y, y] };
                        let [low, high] = range(ends);
                        *side = [side[0].min(low), side[1].max(high)];
                    }
                }
            }
        }
        Outline { from, to, sides }
    }
}

/// Interval of y of the hull as a function of x.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    from: f64,
    to: f64,
    /// Least and greatest y [m] at evenly spaced x; reversed where there is no hull.
    sides: Vec<[f64; 2]>,
}

impl Outline {
    /// Least and greatest y [m] at `x` [m].
    pub fn sides(&self, x: f64) -> Option<[f64; 2]> {
        if !(self.from..=self.to).contains(&x) {
            return None;
        }
        let place = (x - self.from) / (self.to - self.from) * STATIONS as f64;
        let i = (place as usize).min(STATIONS - 1);
        let part = place - i as f64;
        let [a, b] = [self.sides[i], self.sides[i + 1]];
        let sides = [0, 1].map(|k| a[k] + part * (b[k] - a[k]));
        (sides[0] <= sides[1]).then_some(sides)
    }

    /// The rectangle `[x_min, x_max, y_min, y_max]` [m] of the largest area within the outline,
    /// symmetric about the middle in x if `even`; `None` if there is none.
    pub fn rectangle(&self, even: bool) -> Option<[f64; 4]> {
        let step = (self.to - self.from) / STATIONS as f64;
        let mut best: Option<([f64; 4], f64)> = None;
        let mut consider = |first: usize, last: usize, [low, high]: [f64; 2]| {
            let area = (last - first) as f64 * (high - low);
            if best.is_none_or(|(_, most)| area > most) {
                let [x0, x1] = [first, last].map(|i| self.from + step * i as f64);
                best = Some(([x0, x1, low, high], area));
            }
        };
        // Rectangles begin at each station, or grow from the middle to both sides.
        let middle = STATIONS / 2;
        let starts = if even {
            middle..middle + 1
        } else {
            0..STATIONS
        };
        for start in starts {
            let mut within = self.sides[start];
            for last in start + 1..=STATIONS {
                let first = if even { 2 * start - last } else { start };
                for side in [first, last].map(|i| self.sides[i]) {
                    within = [within[0].max(side[0]), within[1].min(side[1])];
                }
                if within[0] >= within[1] {
                    break;
                }
                consider(first, last, within);
            }
        }
        best.map(|(rectangle, _)| rectangle)
    }

    /// The outline after bridging gaps in its sides that are not longer along x than it is wide:
    /// the hull is taken to continue across a notch, as across a hole.
    ///
    /// A morphological closing (J. Serra, Image Analysis and Mathematical Morphology, 1982); it
    /// adds nothing at the ends.
    pub fn bridged(mut self) -> Self {
        let widths = self.sides.iter().map(|side| side[1] - side[0]);
        let mut widths: Vec<f64> = widths.filter(|width| *width > 0.0).collect();
        widths.sort_by(f64::total_cmp);
        let width = widths.get(widths.len() / 2).copied().unwrap_or(0.0);
        let step = (self.to - self.from) / STATIONS as f64;
        let half = (0.5 * width / step) as usize;
        type Pick = fn(f64, f64) -> f64;
        let picked = |values: &[f64], pick: Pick| -> Vec<f64> {
            let windows = values.windows(2 * half + 1);
            windows
                .filter_map(|window| window.iter().copied().reduce(pick))
                .collect()
        };
        let [min, max]: [Pick; 2] = [f64::min, f64::max];
        let of_sides = [(f64::INFINITY, min, max), (f64::NEG_INFINITY, max, min)];
        for (k, (none, most, least)) in of_sides.into_iter().enumerate() {
            // The ends count as empty.
            let padding = || std::iter::repeat_n(none, 2 * half);
            let side = self.sides.iter().map(|side| side[k]);
            let side: Vec<f64> = padding().chain(side).chain(padding()).collect();
            let closed = picked(&picked(&side, most), least);
            let sides = self.sides.iter_mut().zip(closed);
            sides.for_each(|(side, closed)| side[k] = closed);
        }
        self
    }

    /// The outline of a rectangle.
    pub fn of_rectangle([x0, x1, y0, y1]: [f64; 4]) -> Self {
        Self {
            from: x0,
            to: x1,
            sides: vec![[y0, y1]; STATIONS + 1],
        }
    }

    /// Mean of the outline and its mirror image in x, y or both.
    pub fn symmetrised(mut self, [in_x, in_y]: [bool; 2]) -> Self {
        if in_x {
            let half = 0.5 * (self.to - self.from);
            (self.from, self.to) = (-half, half);
            let sides = self.sides.clone();
            for (side, mirror) in self.sides.iter_mut().zip(sides.iter().rev()) {
                (0..2).for_each(|k| side[k] = 0.5 * (side[k] + mirror[k]));
            }
        }
        if in_y {
            for side in &mut self.sides {
                let half = 0.5 * (side[1] - side[0]);
                *side = [-half, half];
            }
        }
        self
    }
}

/// Arc length along the mean section as a function of y, from the facets' slopes averaged between
/// columns of vertices.
pub(crate) fn arc_length(part: &Downward, [y0, y1]: [f64; 2], mirrored: bool) -> Profile {
    const MAX_COLUMNS: usize = 48;
    let mut ys: Vec<f64> = part.points.iter().map(|p| p[1]).collect();
    ys.sort_by(f64::total_cmp);
    let mut columns = ys.clone();
    columns.dedup_by(|b, a| *b - *a < 1e-4 * (y1 - y0));
    if columns.len() > MAX_COLUMNS {
        columns = (0..=MAX_COLUMNS)
            .map(|i| ys[i * (ys.len() - 1) / MAX_COLUMNS])
            .collect();
        columns.dedup_by(|b, a| *b - *a < 1e-3 * (y1 - y0));
    }
    if mirrored {
        let mut half: Vec<f64> = columns.iter().map(|y| y.abs()).collect();
        half.sort_by(f64::total_cmp);
        half.dedup_by(|b, a| *b - *a < 1e-3 * y1);
        half.retain(|&y| y > 1e-3 * y1 && y < y1 * (1.0 - 1e-3));
        let below = half.iter().rev().map(|y| -y);
        columns = below.chain([0.0]).chain(half.iter().copied()).collect();
    } else {
        columns.retain(|&y| y > y0 + 1e-3 * (y1 - y0) && y < y1 - 1e-3 * (y1 - y0));
    }
    columns.insert(0, y0);
    columns.push(y1);
    // Mean slope of each strip, weighted by the facets' plan areas.
    let mut strips = vec![(0.0, 0.0); columns.len() - 1];
    for facet in &part.facets {
        let [a, b, c] = facet.map(|i| Vector3::from(part.points[i]));
        let (u, v) = (b - a, c - a);
        let area = u.x * v.y - u.y * v.x;
        let slope = (u.x * v.z - u.z * v.x) / area;
        let middle = (a.y + b.y + c.y) / 3.0;
        let after = columns.partition_point(|&y| y <= middle);
        let i = after.clamp(1, strips.len()) - 1;
        strips[i].0 += area.abs();
        strips[i].1 += slope.clamp(-10.0, 10.0) * area.abs();
    }
    let mean_slope = |(area, sum): &(f64, f64)| sum / area.max(f64::MIN_POSITIVE);
    let stretch = |i: usize| mean_slope(&strips[i]).hypot(1.0);
    let mut lengths = vec![0.0];
    for (i, pair) in columns.windows(2).enumerate() {
        let opposite = if mirrored { strips.len() - 1 - i } else { i };
        let stretch = 0.5 * (stretch(i) + stretch(opposite));
        lengths.push(lengths[i] + stretch * (pair[1] - pair[0]));
    }
    let shift = if mirrored {
        0.5 * lengths[strips.len()]
    } else {
        0.0
    };
    let points = columns.iter().zip(&lengths);
    let points: Vec<[f64; 2]> = points.map(|(&y, &t)| [y, t - shift]).collect();
    let plain = || Profile::new("section", &[[y0, y0], [y1, y1]]).expect("two finite points");
    match Profile::new("section", &points) {
        Ok(map) if linspace(y0, y1, 2000).all(|y| map.evaluate(y)[1] > 0.3) => map,
        _ => plain(),
    }
}
