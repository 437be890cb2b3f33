//! Zones of even or graded cells under a patch, and nodes where they must be.

use crate::Error;
use crate::grid::grading::{Start, Zone, graded_axis};
use crate::grid::stretch::Stretch;

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Resolution {
    /// Cells over half the patch, along and across.
    pub cells: f64,
    /// Growth of the spacing with the distance from the patch.
    pub growth: f64,
}

impl Resolution {
    /// Cells that half the patch really gets with these mirror planes, the mean of both axes: see [`widened`].
    pub fn real_cells(self, symmetry: [bool; 2]) -> f64 {
        self.cells
            + symmetry
                .iter()
                .map(|&s| if s { 0.25 } else { 0.0 })
                .sum::<f64>()
    }
}

/// Nodes under those of `z`, down to `thickness` below them, growing on from the cells above.
pub(crate) fn below(z: &[f64], thickness: f64, growth: f64) -> Result<Vec<f64>, Error> {
    let cell = (z[1] - z[0]).min(0.25 * thickness);
    let zone = Zone {
        stretch: Stretch::even(-cell, 0.0),
        spacing: cell,
    };
    let mut nodes = graded_axis(Start::Beyond(-thickness), 0.0, &[zone], growth)?;
    nodes.pop();
    let scale = thickness / -nodes[0];
    Ok(nodes.iter().map(|n| z[0] + n * scale).collect())
}

/// Moves the node nearest to `place` there where it is close, or adds one; nothing outside the axis.
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

/// The zone of a stretch: half a cell longer at its rims, so that all meshes cut them in the middle of a cell,
/// and only its upper half where a mirror plane cuts it. Nothing of a stretch below a mirror plane.
///
/// Half an even stretch, from a node on the mirror plane to the middle of a cell, is an odd number of half cells: half a
/// cell more than asked. A zone of no whole number of cells would leave their number to rounding errors.
pub(crate) fn widened(stretch: &Stretch, symmetric: bool, resolution: Resolution) -> Option<Zone> {
    let halved = symmetric && stretch.low == -stretch.high && stretch.finest() == 1.0;
    let spacing = stretch.half() / (resolution.cells + if halved { 0.5 } else { 0.0 });
    let margin = |x: f64| 0.5 * spacing * stretch.size(x);
    let low = stretch.low - margin(stretch.low);
    let high = stretch.high + margin(stretch.high);
    if symmetric && high <= 0.0 {
        return None;
    }
    let cut = symmetric && low <= 0.0;
    let (from, length) = (if cut { 0.0 } else { low }, stretch.high - stretch.low);
    // Places are relative to the stretch: carry them over to the zone.
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

/// Lets zones that their margins made overlap meet half-way.
///
/// One that lies within another's half is taken into it.
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
