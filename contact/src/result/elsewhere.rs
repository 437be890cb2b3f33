//! Where the runner touches that no contact was looked for.

use kufe_fem::boussinesq;
use rayon::prelude::*;

use crate::active_set::motion::dot;
use crate::bodies::far_field::{Lump, lumps};
use crate::grid::contact_mesh::State;
use crate::grid::discretise::{Discretisation, expected};
use crate::grid::patch::Patch;
use crate::grid::stretch::Stretch;
use crate::problem::gap::Gap;
use crate::{Foundation, Problem};

/// A place where runner and ice would lie in one another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Penetration {
    /// x and y [m].
    pub at: [f64; 2],
    /// How deep [m].
    pub depth: f64,
}

/// Lines across the hull that are looked at, and points of each.
const STATIONS: usize = 400;
const POINTS: usize = 60;
/// Steps of a search between two of them.
const STEPS: usize = 40;
/// Depth over the approach that counts: what is less carries a thousandth of the load at most.
const LEAST: f64 = 1e-2;

/// A solved mesh and what it was made for.
pub(crate) struct Solved<'a> {
    pub problem: &'a Problem,
    pub gap: &'a Gap<'a>,
    pub patch: &'a Patch,
    pub mesh: &'a Discretisation,
    pub state: &'a State,
}

impl Solved<'_> {
    /// Places outside of where contact was looked for, on a hull with ends: the deepest of each valley along it, in order.
    pub fn elsewhere(&self) -> Vec<Penetration> {
        let extent = self.problem.runner.underside.extent();
        if extent.iter().any(|end| !end.is_finite()) {
            return Vec::new();
        }
        let surface = Surface::new(self);
        let [low, high, right, left] = extent;
        let (dx, dy) = (
            (high - low) / STATIONS as f64,
            (left - right) / POINTS as f64,
        );
        let height = |x: f64, y: f64| match expected(self.patch, x, y) {
            true => f64::INFINITY,
            false => surface.gap(x, y),
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
            let mut beside = next.filter_map(|k| line.get(k));
            line[*i][1].is_finite() && beside.all(|other| other[1] >= line[*i][1])
        };
        let depth = self.mesh.contact.depth(self.state);
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
        found.filter(|at| at.depth > LEAST * depth).collect()
    }

    /// The patch with these places of contact more.
    pub fn patch_with(&self, found: &[Penetration]) -> Patch {
        let surface = Surface::new(self);
        let mut patch = self.patch.clone();
        for place in found {
            self.add(place, &surface, &mut patch);
        }
        patch.x.sort_by(|a, b| a.low.total_cmp(&b.low));
        patch
    }

    fn add(&self, found: &Penetration, surface: &Surface, patch: &mut Patch) {
        let mirrored = self.mesh.symmetry;
        // Of two places that a mirror plane makes one the positive one is meshed.
        let [x, y] = [0, 1].map(|axis| match mirrored[axis] {
            true => found.at[axis].abs(),
            false => found.at[axis],
        });
        patch.y.low = patch.y.low.min(if mirrored[1] { -y } else { y });
        patch.y.high = patch.y.high.max(y);
        let [low, high, ..] = self.problem.runner.underside.extent();
        let end = |sign: f64, limit: f64| {
            let mut step = 1e-6 * (high - low);
            while surface.gap(x + sign * step, y) < 0.0 && step < limit {
                step *= 1.3;
            }
            x + sign * step.min(limit)
        };
        let new = Stretch::even(end(-1.0, x - low), end(1.0, high - x));
        match patch.x.iter_mut().find(|stretch| stretch.meets(&new)) {
            Some(stretch) => {
                stretch.low = stretch.low.min(new.low);
                stretch.high = stretch.high.max(new.high);
            }
            None => patch.x.push(new),
        }
    }
}

/// The place of the least value near `middle`, within `reach` of it and the ends, by golden sections (J. Kiefer, 1953).
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

/// How far a curved surface may lie below what is interpolated between the corners of a cell, over the range of its values there.
const CURVED: f64 = 0.5;

/// The gap of a state anywhere on the plane.
struct Surface<'a> {
    of: &'a Solved<'a>,
    /// What displacements close at the mesh's nodes [m].
    closing: Vec<f64>,
    /// The forces on a half-space beyond the mesh.
    lumps: Vec<Lump>,
}

impl<'a> Surface<'a> {
    fn new(of: &'a Solved<'a>) -> Self {
        let (mesh, state) = (of.mesh, of.state);
        let lumps = match of.problem.ice.foundation {
            Foundation::HalfSpace => lumps(&mesh.grid.x, &mesh.grid.y, &state.force, mesh.symmetry),
            // A layer is at rest some thicknesses away.
            _ => Vec::new(),
        };
        Surface {
            of,
            closing: mesh.contact.closing(&state.displacement),
            lumps,
        }
    }

    /// The gap at (x, y) [m].
    fn gap(&self, x: f64, y: f64) -> f64 {
        let Solved {
            gap, mesh, state, ..
        } = self.of;
        let undeformed = gap.at(x, y) - dot(gap.motion_row(x, y), state.motion);
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
                let material = mesh.contact.bodies[0].material;
                let sunk = |lump: &Lump| {
                    let point = [x - lump.at[0], y - lump.at[1], 0.0];
                    boussinesq(point, lump.force, material)[2]
                };
                self.lumps.iter().map(sunk).sum()
            }
        };
        undeformed - closing
    }
}

/// The cell of a line that holds a place, and where in it; `None` outside.
fn cell(nodes: &[f64], at: f64) -> Option<(usize, f64)> {
    let next = nodes.partition_point(|&node| node <= at);
    let i = next.checked_sub(1).filter(|&i| i + 1 < nodes.len())?;
    Some((i, (at - nodes[i]) / (nodes[i + 1] - nodes[i])))
}
