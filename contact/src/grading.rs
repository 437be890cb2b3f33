//! Graded axes: fine over the contact, growing away from it.

/// A stretch of an axis that is to be resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Zone {
    /// Its start [m].
    pub low: f64,
    /// Its end [m].
    pub high: f64,
    /// Spacing inside [m].
    pub spacing: f64,
}

/// Nodes over the zones and beyond them to at least `low` and `high`.
///
/// Every zone is divided evenly, so that meshes of different fineness are images of each other and their
/// errors can be compared. Outside, the spacing grows by `growth` times the distance from the zone, and the
/// last node falls where the growth puts it, at or beyond the end asked. Between two zones the nodes stand at
/// even steps of the integral of dx / h(x), h being the smaller of the two zones' wishes. Zones are in order
/// and apart.
pub(crate) fn graded_axis(low: f64, high: f64, zones: &[Zone], growth: f64) -> Vec<f64> {
    let (first, last) = (zones[0], zones[zones.len() - 1]);
    let mut nodes: Vec<f64> = outward(first.spacing, first.low - low, growth)
        .iter()
        .rev()
        .map(|d| first.low - d)
        .collect();
    for (index, zone) in zones.iter().enumerate() {
        if index > 0 {
            nodes.extend(between(zones[index - 1], *zone, growth));
        }
        let cells = ((zone.high - zone.low) / zone.spacing).round().max(1.0) as usize;
        nodes.extend(
            (0..=cells).map(|i| zone.low + (zone.high - zone.low) * i as f64 / cells as f64),
        );
    }
    nodes.extend(
        outward(last.spacing, high - last.high, growth)
            .iter()
            .map(|d| last.high + d),
    );
    nodes
}

/// Distances of the nodes beyond a zone's end, up to the first at or beyond `reach`.
fn outward(spacing: f64, reach: f64, growth: f64) -> Vec<f64> {
    let mut distances = Vec::new();
    let mut distance = 0.0;
    while distance < reach * (1.0 - 1e-9) {
        // The cell's middle is where its size is asked.
        distance += (spacing + growth * distance) / (1.0 - 0.5 * growth).max(0.5);
        distances.push(distance);
    }
    distances
}

/// Nodes strictly between two zones.
fn between(left: Zone, right: Zone, growth: f64) -> Vec<f64> {
    let (low, high) = (left.high, right.low);
    let spacing =
        |x: f64| (left.spacing + growth * (x - low)).min(right.spacing + growth * (high - x));
    const STEPS: usize = 2000;
    let step = (high - low) / STEPS as f64;
    let mut counts = vec![0.0];
    for i in 0..STEPS {
        counts.push(counts[i] + step / spacing(low + (i as f64 + 0.5) * step));
    }
    let cells = counts[STEPS].ceil().max(1.0) as usize;
    (1..cells)
        .map(|i| {
            let target = counts[STEPS] * i as f64 / cells as f64;
            let station = counts.partition_point(|c| *c < target).max(1);
            let weight = (target - counts[station - 1]) / (counts[station] - counts[station - 1]);
            low + ((station - 1) as f64 + weight) * step
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_is_even_in_its_zones_and_grows_outside() {
        let zones = [
            Zone {
                low: 0.0,
                high: 1.0,
                spacing: 0.1,
            },
            Zone {
                low: 5.0,
                high: 6.0,
                spacing: 0.2,
            },
        ];
        let nodes = graded_axis(0.0, 100.0, &zones, 0.4);
        assert!(nodes[0] == 0.0 && nodes[nodes.len() - 1] >= 100.0);
        for pair in nodes.windows(2) {
            let (step, middle) = (pair[1] - pair[0], 0.5 * (pair[0] + pair[1]));
            let wish = |zone: &Zone| {
                zone.spacing + 0.4 * (zone.low - middle).max(middle - zone.high).max(0.0)
            };
            let asked = zones.iter().map(wish).fold(f64::INFINITY, f64::min);
            assert!(
                step > 0.0 && step < 1.3 * asked,
                "{step} at {middle}, asked {asked}"
            );
        }
        let inside: Vec<f64> = nodes
            .iter()
            .copied()
            .filter(|x| (0.0..=1.0).contains(x))
            .collect();
        assert_eq!(inside.len(), 11);
    }

    #[test]
    fn finer_axis_of_the_same_zone_has_its_zone_nodes_in_the_same_proportion() {
        let nodes = |cells: f64| {
            graded_axis(
                0.0,
                50.0,
                &[Zone {
                    low: 0.0,
                    high: 1.0,
                    spacing: 1.0 / cells,
                }],
                2.0 / cells,
            )
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
}
