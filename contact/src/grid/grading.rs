//! Graded axes: fine over the contact, growing away from it.

use crate::Error;
use crate::grid::patch::Patch;
use crate::grid::stretch::Stretch;

/// A stretch of an axis with its spacing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Zone {
    /// The stretch, with sizes of cells relative to `spacing`.
    pub stretch: Stretch,
    /// Spacing at places with a relative size of 1 [m].
    pub spacing: f64,
}

impl Zone {
    fn spacing_at(&self, x: f64) -> f64 {
        self.spacing * self.stretch.size(x)
    }

    /// Nodes at even steps of the integral of dx / h(x), ends included.
    fn nodes(&self) -> Result<Vec<f64>, Error> {
        let (low, high) = (self.stretch.low, self.stretch.high);
        if self.stretch.finest() == 1.0 {
            let cells = ((high - low) / self.spacing).round().max(1.0) as usize;
            if cells > MAX_ON_A_LINE {
                return Err(too_fine(low, high, self.spacing));
            }
            return Ok((0..=cells)
                .map(|i| low + (high - low) * i as f64 / cells as f64)
                .collect());
        }
        let mut nodes = vec![low];
        nodes.extend(even_steps(low, high, |x| self.spacing_at(x), f64::round)?);
        nodes.push(high);
        Ok(nodes)
    }
}

/// Start of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Start {
    /// Exactly here: a mirror plane [m].
    At(f64),
    /// At or below this place [m].
    AtOrBelow(f64),
}

/// Nodes over the zones and beyond them to `start` and to at least `high`.
///
/// Every zone is divided by its own rule, so that meshes of different resolution are similar and
/// their errors can be compared. Outside, the spacing grows by `growth` times the distance from the
/// zone, and the last node is at or beyond the requested end, as the growth determines. Between two
/// zones the nodes are at even steps of the integral of dx / h(x), with h the smaller of the
/// spacings that grow from both zones. Zones must be in order and disjoint.
///
/// # Errors
/// [`Error::TooFine`] if the zones need more nodes than a line may have, or nodes that rounding
/// cannot separate.
pub(crate) fn graded_axis(
    start: Start,
    high: f64,
    zones: &[Zone],
    growth: f64,
) -> Result<Vec<f64>, Error> {
    let (first, last) = (&zones[0], &zones[zones.len() - 1]);
    let (begin, end) = (first.stretch.low, last.stretch.high);
    let (reach, exact) = match start {
        Start::At(x) => (begin - x, true),
        Start::AtOrBelow(x) => (begin - x, false),
    };
    let mut before = outward(first.spacing_at(begin), reach, growth)?;
    if exact && let Some(&farthest) = before.last() {
        before.iter_mut().for_each(|d| *d *= reach / farthest);
    }
    let mut nodes: Vec<f64> = before.iter().rev().map(|d| begin - d).collect();
    for (index, zone) in zones.iter().enumerate() {
        if index > 0 {
            nodes.extend(between(&zones[index - 1], zone, growth)?);
        }
        // Adjacent zones share a node; rounding may end one just below the start of the other.
        let from = nodes.last().copied();
        let is_new = |x: &f64| from.is_none_or(|from| apart(from, *x));
        nodes.extend(zone.nodes()?.into_iter().filter(is_new));
    }
    nodes.extend(
        outward(last.spacing_at(end), high - end, growth)?
            .iter()
            .map(|d| end + d),
    );
    increasing(nodes)
}

fn too_fine(from: f64, to: f64, spacing: f64) -> Error {
    Error::TooFine { from, to, spacing }
}

/// Distances of the nodes outside a zone from its end, up to the first distance of at least
/// `reach`.
fn outward(spacing: f64, reach: f64, growth: f64) -> Result<Vec<f64>, Error> {
    let mut distances = Vec::new();
    let mut distance = 0.0;
    while distance < reach * (1.0 - 1e-9) {
        if distances.len() > MAX_ON_A_LINE {
            return Err(too_fine(0.0, reach, spacing));
        }
        // The size of a cell is evaluated in its middle.
        distance += (spacing + growth * distance) / (1.0 - 0.5 * growth).max(0.5);
        distances.push(distance);
    }
    Ok(distances)
}

/// Nodes strictly between two zones.
fn between(left: &Zone, right: &Zone, growth: f64) -> Result<Vec<f64>, Error> {
    let (low, high) = (left.stretch.high, right.stretch.low);
    let (from, to) = (left.spacing_at(low), right.spacing_at(high));
    even_steps(
        low,
        high,
        |x| (from + growth * (x - low)).min(to + growth * (high - x)),
        f64::ceil,
    )
}

/// Nodes strictly between `low` and `high` at even steps of the integral of dx / `spacing`, the
/// number of steps rounded by `round`.
pub(crate) fn even_steps(
    low: f64,
    high: f64,
    spacing: impl Fn(f64) -> f64,
    round: impl Fn(f64) -> f64,
) -> Result<Vec<f64>, Error> {
    let (mut stations, mut counts) = (vec![low], vec![0.0]);
    let (mut x, mut count) = (low, 0.0);
    while x < high {
        // Short relative to the spacing at both ends of the step.
        let trial = 0.1 * spacing(x);
        let step = trial
            .min(0.2 * spacing((x + trial).min(high)))
            .min(high - x);
        let next = if high - (x + step) < 1e-6 * step {
            high
        } else {
            x + step
        };
        // Ten stations per node; with a step below rounding the loop would not end.
        if next <= x || stations.len() > 10 * MAX_ON_A_LINE {
            return Err(too_fine(low, high, spacing(x)));
        }
        count += (next - x) / spacing(0.5 * (x + next));
        x = next;
        stations.push(x);
        counts.push(count);
    }
    let cells = round(count).max(1.0) as usize;
    Ok((1..cells)
        .map(|i| {
            let target = count * i as f64 / cells as f64;
            let station = counts
                .partition_point(|c| *c < target)
                .clamp(1, counts.len() - 1);
            let weight = (target - counts[station - 1]) / (counts[station] - counts[station - 1]);
            stations[station - 1] + weight * (stations[station] - stations[station - 1])
        })
        .collect())
}

// Limits of a mesh: increasing nodes of a line, and numbers of nodes.

/// Largest number of nodes of a line.
pub(crate) const MAX_ON_A_LINE: usize = 100_000;
/// Largest number of nodes of the ice: 12 million unknowns, about 4 GB.
const MAX_NODES: usize = 4_000_000;
/// Smallest ratio of the distance of adjacent nodes to the sum of their coordinates.
const MIN_DISTANCE: f64 = 1e-12;

/// Smallest distance of adjacent nodes, by rounding.
fn least(a: f64, b: f64) -> f64 {
    MIN_DISTANCE * (a.abs() + b.abs())
}

/// Whether `b` is above `a` by more than rounding.
fn apart(a: f64, b: f64) -> bool {
    b - a > least(a, b)
}

/// The line itself if its nodes increase by more than rounding.
pub(crate) fn increasing(nodes: Vec<f64>) -> Result<Vec<f64>, Error> {
    match nodes.windows(2).find(|w| !apart(w[0], w[1])) {
        None if nodes.len() > 1 => Ok(nodes),
        found => Err(Error::TooFine {
            from: nodes.first().copied().unwrap_or(f64::NAN),
            to: nodes.last().copied().unwrap_or(f64::NAN),
            spacing: found.map_or(0.0, |w| least(w[0], w[1])),
        }),
    }
}

/// Checks that a grid of this many nodes along each axis is not too large.
pub(crate) fn storable(shape: [usize; 3]) -> Result<(), Error> {
    let nodes = shape.iter().fold(1usize, |n, &k| n.saturating_mul(k));
    if nodes > MAX_NODES {
        let [nx, ny, nz] = shape;
        return Err(Error::Unsolved(format!(
            "a mesh of {nx} x {ny} x {nz} nodes is the coarsest that resolves the contact, \
             {MAX_NODES} nodes are the most: expected lengths (ice, runner, waves, mount) that are \
             nearer to one another, or less accuracy"
        )));
    }
    Ok(())
}

// Zones of even or graded cells under a patch, and nodes at given places.

/// Resolution of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Resolution {
    /// Cells over half the patch, along and across.
    pub cells: f64,
    /// Growth of the spacing with the distance from the patch.
    pub growth: f64,
}

impl Resolution {
    /// This number of cells, with the growth that keeps meshes of different resolution similar.
    pub fn of(cells: f64) -> Self {
        Resolution {
            cells,
            growth: 3.0 / cells,
        }
    }

    /// Actual number of cells over half of `patch` with these mirror planes, the mean of both axes;
    /// see [`widened`].
    pub fn real_cells(self, patch: &Patch, symmetry: [bool; 2]) -> f64 {
        let along = patch
            .x
            .iter()
            .any(|stretch| is_halved(stretch, symmetry[0]));
        let across = is_halved(&patch.y, symmetry[1]);
        let more = [along, across].map(|halved| if halved { 0.25 } else { 0.0 });
        self.cells + more.iter().sum::<f64>()
    }
}

/// Nodes below those of `z`, down to `thickness` below them, with cells that grow from those above.
pub(crate) fn below(z: &[f64], thickness: f64, growth: f64) -> Result<Vec<f64>, Error> {
    let cell = (z[1] - z[0]).min(0.25 * thickness);
    let zone = Zone {
        stretch: Stretch::even(-cell, 0.0),
        spacing: cell,
    };
    let mut nodes = graded_axis(Start::AtOrBelow(-thickness), 0.0, &[zone], growth)?;
    nodes.pop();
    let scale = thickness / -nodes[0];
    Ok(nodes.iter().map(|n| z[0] + n * scale).collect())
}

/// Moves the nearest node to `place` if it is close, otherwise adds a node; does nothing outside
/// the axis.
pub(crate) fn put_node(nodes: &mut Vec<f64>, place: f64) {
    let next = nodes.partition_point(|&v| v < place);
    if next == 0 || next == nodes.len() {
        return;
    }
    let cell = nodes[next] - nodes[next - 1];
    if next + 1 < nodes.len() && nodes[next] - place < 0.35 * cell {
        nodes[next] = place;
    } else if next > 1 && place - nodes[next - 1] < 0.35 * cell {
        nodes[next - 1] = place;
    } else {
        nodes.insert(next, place);
    }
}

/// The zone of a stretch. It is half a cell longer at its rims, so that the rims lie in the middle
/// of a cell on all meshes, and has only the upper half of a stretch that a mirror plane cuts.
/// `None` for a stretch below a mirror plane.
///
/// Half an even stretch, from a node on the mirror plane to the middle of a cell, is an odd number
/// of half cells: half a cell more than requested. In a zone without a whole number of cells,
/// rounding would determine their number.
pub(crate) fn widened(stretch: &Stretch, symmetric: bool, resolution: Resolution) -> Option<Zone> {
    let halved = is_halved(stretch, symmetric);
    let spacing = stretch.half() / (resolution.cells + if halved { 0.5 } else { 0.0 });
    let margin = |x: f64| 0.5 * spacing * stretch.size(x);
    let low = stretch.low - margin(stretch.low);
    let high = stretch.high + margin(stretch.high);
    if symmetric && high <= 0.0 {
        return None;
    }
    let cut = symmetric && low <= 0.0;
    let (from, length) = (if cut { 0.0 } else { low }, stretch.high - stretch.low);
    // Converts places relative to the stretch to places relative to the zone.
    let place = |t: f64| (stretch.low + t * length - from) / (high - from);
    let sizes = stretch.sizes.iter().map(|s| [place(s[0]), s[1]]).collect();
    Some(Zone {
        stretch: Stretch {
            low: from,
            high,
            sizes,
        },
        spacing,
    })
}

/// Whether a mirror plane cuts an even stretch in half.
fn is_halved(stretch: &Stretch, symmetric: bool) -> bool {
    symmetric && stretch.low == -stretch.high && stretch.finest() == 1.0
}

/// Separates zones whose margins overlap, half-way between them.
///
/// A zone within half of another one is merged with it.
pub(crate) fn part(zones: &mut Vec<Zone>) {
    let mut i = 1;
    while i < zones.len() {
        let (before, this) = (&zones[i - 1].stretch, &zones[i].stretch);
        let middle = 0.5 * (this.low + before.high);
        if this.low < before.high && (middle >= this.high || middle <= before.low) {
            let [low, high] = [before.low.min(this.low), before.high.max(this.high)];
            let finer = zones.remove(i);
            let whole = &mut zones[i - 1];
            whole.spacing = whole.spacing.min(finer.spacing);
            whole.stretch = Stretch::even(low, high);
            i = i.max(2) - 1;
        } else {
            i += 1;
        }
    }
    for i in 1..zones.len() {
        let (low, high) = (zones[i].stretch.low, zones[i - 1].stretch.high);
        if low < high {
            let middle = 0.5 * (low + high);
            zones[i - 1].stretch.high = middle;
            zones[i].stretch.low = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zone(low: f64, high: f64, spacing: f64) -> Zone {
        Zone {
            stretch: Stretch::even(low, high),
            spacing,
        }
    }

    #[test]
    fn axis_is_even_in_its_zones_and_grows_outside() {
        let zones = [zone(0.0, 1.0, 0.1), zone(5.0, 6.0, 0.2)];
        let nodes = graded_axis(Start::At(0.0), 100.0, &zones, 0.4).expect("a line");
        assert!(nodes[0] == 0.0 && nodes[nodes.len() - 1] >= 100.0);
        for pair in nodes.windows(2) {
            let (step, middle) = (pair[1] - pair[0], 0.5 * (pair[0] + pair[1]));
            let wish = |zone: &Zone| {
                let (low, high) = (zone.stretch.low, zone.stretch.high);
                zone.spacing + 0.4 * (low - middle).max(middle - high).max(0.0)
            };
            let expected = zones.iter().map(wish).fold(f64::INFINITY, f64::min);
            assert!(
                step > 0.0 && step < 1.3 * expected,
                "{step} at {middle}, expected {expected}"
            );
        }
        assert_eq!(
            nodes.iter().filter(|x| (0.0..=1.0).contains(*x)).count(),
            11
        );
    }

    #[test]
    fn finer_axis_of_the_same_zone_has_its_zone_nodes_in_the_same_proportion() {
        let nodes = |cells: f64| {
            graded_axis(
                Start::At(0.0),
                50.0,
                &[zone(0.0, 1.0, 1.0 / cells)],
                2.0 / cells,
            )
            .expect("a line")
        };
        let (coarse, fine) = (nodes(4.0), nodes(8.0));
        assert!(
            coarse
                .iter()
                .take(5)
                .zip(fine.iter().step_by(2))
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
    }

    #[test]
    fn axis_beyond_a_mirror_plane_begins_exactly_there() {
        let nodes = graded_axis(Start::At(0.0), 3.0, &[zone(1.0, 2.0, 0.1)], 0.3).expect("a line");
        assert_eq!(nodes[0], 0.0);
        assert!(nodes.windows(2).all(|w| w[1] > w[0]));
    }

    #[test]
    fn zones_that_meet_share_one_node() {
        // -0.3 + (0.05 + 0.3) rounds to just below 0.05, where the second zone begins.
        let zones = [zone(-0.3, 0.05, 0.05), zone(0.05, 0.4, 0.05)];
        let nodes = graded_axis(Start::AtOrBelow(-1.0), 1.0, &zones, 0.3).expect("a line");
        let within = |x: &&f64| (-0.3 - 1e-9..0.4 + 1e-9).contains(*x);
        assert_eq!(nodes.iter().filter(within).count(), 15);
    }

    #[test]
    fn zones_that_no_line_resolves_are_errors_and_end() {
        let mut graded = zone(0.0, 1.0, 0.1);
        graded.stretch.sizes = vec![[0.0, 1.0], [0.5, 1e-300], [1.0, 1.0]];
        for zones in [vec![zone(0.0, 1.0, 1e-300)], vec![graded]] {
            let line = graded_axis(Start::At(0.0), 3.0, &zones, 0.3);
            assert!(matches!(line, Err(Error::TooFine { .. })), "{zones:?}");
        }
    }
}

#[cfg(test)]
mod limits_tests {
    use super::*;

    #[test]
    fn lines_that_do_not_increase_are_refused() {
        assert!(increasing(vec![-1.0, 0.0, 1e-9]).is_ok());
        for nodes in [
            vec![0.0, 1.0, 1.0],
            vec![0.0, f64::NAN, 1.0],
            vec![1.0],
            vec![1.0, 1.0 + 1e-15],
        ] {
            assert!(increasing(nodes).is_err());
        }
    }

    #[test]
    fn what_is_refused_says_the_size_that_rounding_still_tells()
    -> Result<(), Box<dyn std::error::Error>> {
        let reported = |nodes| increasing(nodes).map_err(|error| error.to_string());
        let Err(text) = reported(vec![0.0, 1.0, 1.0]) else {
            return Err("equal nodes pass".into());
        };
        assert!(text.contains("cells of 2.000e-12 m or less"), "{text}");
        let Err(text) = reported(vec![0.0, 0.0]) else {
            return Err("nodes at one place pass".into());
        };
        assert!(text.contains("cells of no size"), "{text}");
        Ok(())
    }

    #[test]
    fn sizes_are_bounded_without_overflow() {
        assert!(storable([100, 100, 100]).is_ok());
        assert!(storable([usize::MAX, 3, 1]).is_err());
    }
}
