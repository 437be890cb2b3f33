//! Search for contact outside the expected patch.

use kufe_fem::boussinesq;
use rayon::prelude::*;

use crate::Foundation;
use crate::accuracy::answer::SolvedMesh;
use crate::bodies::far_field::{PointForce, lumps};
use crate::grid::patch::Patch;
use crate::grid::stretch::Stretch;
use crate::mesh::discretise::expected;
use crate::motion::dot;
use crate::problem::check::CheckedProblem;

/// A place where runner and ice penetrate each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Penetration {
    /// x and y [m].
    pub at: [f64; 2],
    /// Depth of the penetration [m].
    pub depth: f64,
}

/// Lines across the hull that are checked, and points of each.
const STATIONS: usize = 400;
const POINTS: usize = 60;
/// Steps of a search between two of them.
const STEPS: usize = 40;
/// Smallest ratio of a penetration's depth to the approach that counts: smaller ones carry at most
/// a thousandth of the load.
const MIN_DEPTH: f64 = 1e-2;
/// Smallest such ratio between nodes of the expected contact: the remaining noise of a scan is
/// below.
const MIN_DEPTH_BETWEEN: f64 = 0.2;
/// Largest ratio of a place of contact to half of its stretch for which it has cells of its own:
/// all nodes of the stretch might miss it.
const NARROW: f64 = 0.35;

/// Largest depth of a curved surface below the interpolation between the corners of a cell,
/// relative to the range of its values there.
const CURVED: f64 = 0.5;

/// The gap of a solved mesh anywhere on the plane.
pub(crate) struct DeformedGap<'a> {
    checked: &'a CheckedProblem<'a>,
    /// The patch that the mesh was made for.
    patch: &'a Patch,
    solved: &'a SolvedMesh,
    /// Depth of the contact, with which penetrations are compared [m].
    depth: f64,
    /// Closing of the gap by displacements at the mesh's nodes [m].
    closing: Vec<f64>,
    /// The forces, on a half-space outside the mesh.
    lumps: Vec<PointForce>,
}

impl<'a> DeformedGap<'a> {
    pub fn new(checked: &'a CheckedProblem<'a>, patch: &'a Patch, solved: &'a SolvedMesh) -> Self {
        let (mesh, state) = (&solved.mesh, &solved.state);
        let lumps = match checked.problem.ice.foundation {
            Foundation::HalfSpace => lumps(&mesh.grid.x, &mesh.grid.y, &state.force, mesh.symmetry),
            // The displacement of a layer vanishes some thicknesses away.
            _ => Vec::new(),
        };
        DeformedGap {
            depth: mesh.contact.depth(state),
            closing: mesh.contact.closing(&state.displacement),
            checked,
            patch,
            solved,
            lumps,
        }
    }

    /// The gap at (x, y) without displacements [m].
    fn undeformed(&self, x: f64, y: f64) -> f64 {
        let gap = &self.checked.gap;
        gap.at(x, y) - dot(gap.motion_row(x, y), self.solved.state.motion)
    }

    /// The gap at (x, y) [m].
    fn gap(&self, x: f64, y: f64) -> f64 {
        let mesh = &self.solved.mesh;
        let undeformed = self.undeformed(x, y);
        let [sx, sy] = mesh.symmetry;
        let folded = |at: f64, symmetric: bool| if symmetric { at.abs() } else { at };
        let cells = [
            cell(&mesh.grid.x, folded(x, sx)),
            cell(&mesh.grid.y, folded(y, sy)),
        ];
        let closing = match cells {
            [Some((i, u)), Some((j, v))] => {
                let nx = mesh.grid.x.len();
                let at = |i: usize, j: usize| self.closing[j * nx + i];
                let corners = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
                let low = (1.0 - u) * corners[0] + u * corners[1];
                let high = (1.0 - u) * corners[2] + u * corners[3];
                let least = corners.iter().copied().fold(f64::INFINITY, f64::min);
                let most = corners.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                (1.0 - v) * low + v * high - CURVED * (most - least)
            }
            _ => {
                let material = mesh.contact.bodies[0].material();
                let sunk = |lump: &PointForce| {
                    let point = [x - lump.at[0], y - lump.at[1], 0.0];
                    boussinesq(point, lump.force, material)[2]
                };
                self.lumps.iter().map(sunk).sum()
            }
        };
        undeformed - closing
    }

    /// Penetrations outside the expected contact: on a bounded hull the deepest place of each
    /// valley along it, in order, and the minima of measured surfaces, the latter also between
    /// nodes of the expected contact.
    pub fn penetrations(&self) -> Vec<Penetration> {
        let mut found = if self.checked.problem.runner.is_bounded() {
            self.valleys()
        } else {
            Vec::new()
        };
        found.extend(self.checked.gap.lows().filter_map(|at| self.deep(at)));
        found
    }

    /// The penetration at a minimum of a measured surface; `None` if it is open.
    fn deep(&self, [x, y]: [f64; 2]) -> Option<Penetration> {
        let part = if expected(self.patch, x, y) {
            MIN_DEPTH_BETWEEN
        } else {
            MIN_DEPTH
        };
        let least = part * self.depth;
        // Displacements of the ice only open the gap; only elastic runners can close it.
        let rigid = self.checked.problem.runner.elastic.is_none();
        if rigid && self.undeformed(x, y) > -least {
            return None;
        }
        let depth = -self.gap(x, y);
        (depth > least).then_some(Penetration { at: [x, y], depth })
    }

    /// The deepest place of each valley along the hull, in order.
    fn valleys(&self) -> Vec<Penetration> {
        let [low, high, right, left] = self.checked.problem.runner.underside.extent();
        let (dx, dy) = (
            (high - low) / STATIONS as f64,
            (left - right) / POINTS as f64,
        );
        let height = |x: f64, y: f64| {
            if expected(self.patch, x, y) {
                f64::INFINITY
            } else {
                self.gap(x, y)
            }
        };
        let place = |k: usize| right + dy * k as f64;
        let lowest = |x: f64| {
            let heights = (0..=POINTS).map(|k| [place(k), height(x, place(k))]);
            heights.fold(
                [right, f64::INFINITY],
                |m, h| if h[1] < m[1] { h } else { m },
            )
        };
        let station = |i: usize| low + dx * i as f64;
        let line: Vec<[f64; 2]> = (0..=STATIONS)
            .into_par_iter()
            .map(|i| lowest(station(i)))
            .collect();
        let valley = |i: &usize| {
            let next = [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
            let mut neighbours = next.filter_map(|k| line.get(k));
            line[*i][1].is_finite() && neighbours.all(|other| other[1] >= line[*i][1])
        };
        let found = (0..=STATIONS).filter(valley).map(|i| {
            let mut at = [station(i), line[i][0]];
            for _ in 0..2 {
                at[1] = least(|y| height(at[0], y), at[1], dy, [right, left]);
                at[0] = least(|x| height(x, at[1]), at[0], dx, [low, high]);
            }
            Penetration {
                at,
                depth: -height(at[0], at[1]),
            }
        });
        found
            .filter(|at| at.depth > MIN_DEPTH * self.depth)
            .collect()
    }

    /// The patch extended by these places of contact.
    pub fn patch_with(&self, found: &[Penetration]) -> Patch {
        let mut patch = self.patch.clone();
        for place in found {
            self.add(place, &mut patch);
        }
        patch.x.sort_by(|a, b| a.low.total_cmp(&b.low));
        patch
    }

    fn add(&self, found: &Penetration, patch: &mut Patch) {
        let mirrored = self.solved.mesh.symmetry;
        // Of two mirror images the positive one is meshed.
        let [x, y] = [0, 1].map(|axis| {
            if mirrored[axis] {
                found.at[axis].abs()
            } else {
                found.at[axis]
            }
        });
        let half_width = patch.y.half();
        let stretch = |at: f64, [low, high]: [f64; 2], gap: &dyn Fn(f64) -> f64| {
            let whole = high - low;
            let size = if whole.is_finite() { whole } else { half_width };
            let end = |sign: f64, limit: f64| {
                let mut step = 1e-6 * size;
                while gap(at + sign * step) < 0.0 && step < limit {
                    step *= 1.3;
                }
                at + sign * step.min(limit)
            };
            Stretch::even(end(-1.0, at - low), end(1.0, high - at))
        };
        let [low, high, right, left] = self.checked.problem.runner.underside.extent();
        let along = stretch(x, [low, high], &|x| self.gap(x, y));
        let across = stretch(y, [right, left], &|y| self.gap(x, y));
        widen_to(&mut patch.y, [if mirrored[1] { -y } else { y }, y]);
        resolve(&mut patch.y, &across);
        if mirrored[1] {
            resolve(&mut patch.y, &Stretch::even(-across.high, -across.low));
        }
        match patch.x.iter_mut().find(|stretch| stretch.meets(&along)) {
            Some(stretch) => {
                widen_to(stretch, [along.low, along.high]);
                resolve(stretch, &along);
            }
            None => patch.x.push(along),
        }
    }
}

/// Extends a stretch to these ends; a former stretch that was much shorter keeps its cells.
fn widen_to(stretch: &mut Stretch, [low, high]: [f64; 2]) {
    let before = stretch.clone();
    stretch.low = stretch.low.min(low);
    stretch.high = stretch.high.max(high);
    resolve(stretch, &before);
}

/// Refines a stretch over a part of it that is narrow.
fn resolve(stretch: &mut Stretch, part: &Stretch) {
    let size = part.half() / stretch.half();
    if size < NARROW {
        for at in [part.low, 0.5 * (part.low + part.high), part.high] {
            stretch.refine_at(at, size);
        }
    }
}

/// The place of the smallest value within `reach` of `middle` and within the ends, by
/// golden-section search (J. Kiefer, 1953).
fn least(value: impl Fn(f64) -> f64, middle: f64, reach: f64, ends: [f64; 2]) -> f64 {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = ((middle - reach).max(ends[0]), (middle + reach).min(ends[1]));
    for _ in 0..STEPS {
        let part = golden * (high - low);
        let inner = [high - part, low + part];
        if value(inner[0]) < value(inner[1]) {
            high = inner[1];
        } else {
            low = inner[0];
        }
    }
    let found = 0.5 * (low + high);
    if value(found) < value(middle) {
        found
    } else {
        middle
    }
}

/// The cell of a line that contains a place, and the relative position in it; `None` outside.
fn cell(nodes: &[f64], at: f64) -> Option<(usize, f64)> {
    let next = nodes.partition_point(|&node| node <= at);
    let i = next.checked_sub(1).filter(|&i| i + 1 < nodes.len())?;
    Some((i, (at - nodes[i]) / (nodes[i + 1] - nodes[i])))
}
