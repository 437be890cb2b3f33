//! Interpolation along a line with gaps.

/// A piecewise cubic through values on increasing nodes; NaN marks nodes without a value.
///
/// Slopes come from the parabola through a node and its neighbours (one-sided beside a gap), so parabolas are
/// reproduced exactly. Cells that lack an end are gaps. Between two values that are not positive nothing is; between two
/// positive ones nothing is lower than both, and from a positive one to the other kind it falls all the way, however steep
/// the cells beside are.
pub struct Hermite<'a> {
    nodes: &'a [f64],
    values: &'a [f64],
    slopes: Vec<f64>,
}

impl<'a> Hermite<'a> {
    /// Prepares the slopes of `values` at `nodes`.
    pub fn new(nodes: &'a [f64], values: &'a [f64]) -> Hermite<'a> {
        let slopes = (0..nodes.len()).map(|k| slope(nodes, values, k)).collect();
        Hermite {
            nodes,
            values,
            slopes,
        }
    }

    /// The value at `x`; NaN in a gap and beyond the ends.
    pub fn at(&self, x: f64) -> f64 {
        let above = self.nodes.partition_point(|&node| node <= x);
        if above == 0 || above == self.nodes.len() {
            return f64::NAN;
        }
        let (left, right) = (above - 1, above);
        let width = self.nodes[right] - self.nodes[left];
        let t = (x - self.nodes[left]) / width;
        let rise = self.values[right] - self.values[left];
        let (mut from, mut to) = (self.slopes[left] * width, self.slopes[right] * width);
        let [low, high] = [self.values[left], self.values[right]];
        if low.is_nan() || high.is_nan() {
            return f64::NAN;
        }
        if (low > 0.0) != (high > 0.0) {
            [from, to] =
                [from, to].map(|slope| slope.clamp(rise.min(0.0) * 3.0, rise.max(0.0) * 3.0));
        }
        // h(t) = v + t (m0 + t (3 d - 2 m0 - m1 + t (m0 + m1 - 2 d))), d the rise, m the slopes over the cell
        let value = self.values[left]
            + t * (from + t * (3.0 * rise - 2.0 * from - to + t * (from + to - 2.0 * rise)));
        // A cubic may swing over zero between two values that are not positive: no contact is there.
        match (low > 0.0, high > 0.0) {
            (false, false) => value.min(0.0),
            (true, true) => value.max(low.min(high)),
            _ => value,
        }
    }
}

fn slope(nodes: &[f64], values: &[f64], k: usize) -> f64 {
    let known = |k: usize| values.get(k).is_some_and(|v| !v.is_nan());
    let difference = |a: usize, b: usize| (values[b] - values[a]) / (nodes[b] - nodes[a]);
    if !known(k) {
        return f64::NAN;
    }
    match (k > 0 && known(k - 1), known(k + 1)) {
        (true, true) => {
            let (before, after) = (nodes[k] - nodes[k - 1], nodes[k + 1] - nodes[k]);
            (difference(k - 1, k) * after + difference(k, k + 1) * before) / (before + after)
        }
        (false, true) if known(k + 2) => {
            let bend = difference(k + 1, k + 2) - difference(k, k + 1);
            let share = (nodes[k + 1] - nodes[k]) / (nodes[k + 2] - nodes[k]);
            difference(k, k + 1) - bend * share
        }
        (true, false) if k > 1 && known(k - 2) => {
            let bend = difference(k - 1, k) - difference(k - 2, k - 1);
            let share = (nodes[k] - nodes[k - 1]) / (nodes[k] - nodes[k - 2]);
            difference(k - 1, k) + bend * share
        }
        (false, true) => difference(k, k + 1),
        (true, false) => difference(k - 1, k),
        (false, false) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_values_that_are_not_positive_nothing_is() {
        let (nodes, values) = ([0.0, 1.0, 2.0, 3.0], [-9.0, -0.1, -0.1, -9.0]);
        let line = Hermite::new(&nodes, &values);
        assert!((0..=300).all(|k| line.at(0.01 * f64::from(k)).max(0.0) == 0.0));
    }

    #[test]
    fn beside_steep_cells_nothing_is_lower_than_its_neighbours_and_rims_are_crossed_once() {
        let nodes = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let values = [1.0, 1.0, 1.0, 40.0, 3.0, -90.0];
        let line = Hermite::new(&nodes, &values);
        let at: Vec<f64> = (0..500).map(|k| line.at(0.01 * f64::from(k))).collect();
        assert!(at[..400].iter().all(|v| *v >= 1.0));
        assert!(at[400..].is_sorted_by(|a, b| a >= b));
    }

    #[test]
    fn parabolas_are_reproduced_up_to_the_gap_and_not_beyond() {
        let nodes = [-1.0, -0.4, 0.1, 0.3, 1.0, 1.7, 2.0];
        let parabola = |x: f64| 2.0 - 3.0 * x + 0.7 * x * x;
        let mut values: Vec<f64> = nodes.iter().map(|&x| parabola(x)).collect();
        values[6] = f64::NAN;
        let line = Hermite::new(&nodes, &values);
        for k in 0..100 {
            let x = -1.0 + 2.7 * f64::from(k) / 100.0;
            assert!((line.at(x) - parabola(x)).abs() < 1e-12, "{x}");
        }
        assert!(line.at(1.8).is_nan() && line.at(-1.1).is_nan() && line.at(2.5).is_nan());
    }
}
