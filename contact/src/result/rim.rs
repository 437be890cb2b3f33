//! Stretches of a line in contact, with ends of sub-cell resolution.

/// Estimator of the end of a stretch between two nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RimEstimator {
    /// Extrapolation of the pressures inside, exact for Hertz' contact: [`rim_by_shape`].
    Shape,
    /// From the force on the outermost node, which hardly depends on the shape of the pressure:
    /// [`rim_by_load`].
    Load,
    /// [`RimEstimator::Load`] where the pressure falls to zero, half-way to the next node where it
    /// jumps: these ends stay the same on meshes that are graded to them, those of sub-cell
    /// resolution would not.
    Cells,
}

/// Zero of p^2 outside the outermost node in contact; `None` if it is no parabola there, or a
/// rising one.
///
/// p^2 of a Hertz contact is a parabola along every line. The mean of the outermost node is biased
/// (its hat reaches out of the contact), so the parabola goes through the next three nodes inside;
/// they must be in contact and below the bound of pressures.
fn rim_by_shape(inside: &[(f64, f64)], outside: f64, bound: f64) -> Option<f64> {
    let outermost = inside[0].0;
    let [_, a, b, c, ..] = inside else {
        return None;
    };
    if [a, b, c].iter().any(|node| node.1 >= bound) {
        return None;
    }
    let [pa, pb, pc] = [a, b, c].map(|n| n.1 * n.1);
    // Newton's form from a outwards: p^2(t) = pa + d1 t + d2 t (t - (b - a)), t = x - a.
    let d1 = (pb - pa) / (b.0 - a.0);
    let d2 = ((pc - pb) / (c.0 - b.0) - d1) / (c.0 - a.0);
    let slope = d1 - d2 * (b.0 - a.0);
    let outwards = (outside - outermost).signum();
    if slope * outwards >= 0.0 || !slope.is_finite() {
        return None;
    }
    let discriminant = slope * slope - 4.0 * d2 * pa;
    let t = if discriminant > 0.0 {
        2.0 * pa / (-slope + -slope.signum() * discriminant.sqrt())
    } else {
        -pa / slope
    };
    let (low, high) = (0.5 * (a.0 + outermost), outside);
    Some((a.0 + t).clamp(low.min(high), low.max(high)))
}

/// End of the pressure outside the outermost node in contact, from the last three nodes (outermost
/// first); `None` if it does not end before the next node, `outside`.
///
/// Along a line from X' to X a contact's pressure is p = sqrt(u) (c0 + c1 u + ...) with u = (X - x)
/// (x - X'): c0 alone in Hertz' contact, while c1 grows on layers (`tests/data/layered.py`). c0 and
/// c1 follow from the two inner nodes, X from the outermost node: its `value` is the mean of p over
/// its hat function, which reaches out of the contact. `other` returns X' for X.
fn rim_by_load(
    inside: &[(f64, f64)],
    outside: f64,
    other: impl Fn(f64) -> f64,
    bound: f64,
) -> Option<f64> {
    let &[(outermost, value), a, b, ..] = inside else {
        return None;
    };
    if [value, a.1, b.1].iter().any(|&p| p >= bound) {
        return None;
    }
    let hat = |x: f64| {
        if (x - outermost) * (outside - outermost) > 0.0 {
            (outside - x) / (outside - outermost)
        } else {
            (x - a.0) / (outermost - a.0)
        }
    };
    // Mean pressure of the outermost node if the pressure ended at `end`, less its actual one.
    let excess = |end: f64| {
        let u = |x: f64| (end - x) * (x - other(end));
        let [ua, ub] = [u(a.0), u(b.0)];
        let [qa, qb] = [a.1 / ua.sqrt(), b.1 / ub.sqrt()];
        // Past the middle the second node gives no information on c1.
        let past_middle = (b.0 - 0.5 * (end + other(end))) * (outside - outermost) < 0.0;
        let c1 = if past_middle {
            0.0
        } else {
            (qb - qa) / (ub - ua)
        };
        let pressure = |x: f64| u(x).max(0.0).sqrt() * (qa + c1 * (u(x) - ua));
        let piece = |from: f64, to: f64| -> f64 {
            // In w = sqrt(|end - x|) the integrand is smooth.
            let [low, high] = [(end - to).abs().sqrt(), (end - from).abs().sqrt()];
            GAUSS
                .iter()
                .map(|(weight, t)| {
                    let w = 0.5 * (low + high) + 0.5 * (high - low) * t;
                    let x = end - (end - from).signum() * w * w;
                    weight * (high - low) * w * pressure(x) * hat(x)
                })
                .sum()
        };
        let ends_beyond = (end - outermost) * (outside - outermost) > 0.0;
        let borne = if ends_beyond {
            piece(a.0, outermost) + piece(outermost, end)
        } else {
            piece(a.0, end)
        };
        borne / (0.5 * (outside - a.0).abs()) - value
    };
    // Illinois variant of regula falsi (M. Dowell and P. Jarratt, BIT 11, 1971).
    let [mut low, mut high] = [0.5 * (a.0 + outermost), outside].map(|end| (end, excess(end)));
    if low.1 >= 0.0 {
        return Some(low.0);
    }
    if high.1.is_nan() || high.1 <= 0.0 {
        return None;
    }
    for _ in 0..MAX_STEPS {
        let end = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let found = excess(end);
        if found.abs() <= TOLERANCE * value {
            return Some(end);
        }
        if found * high.1 < 0.0 {
            low = high;
        } else {
            low.1 *= 0.5;
        }
        high = (end, found);
    }
    Some(high.0)
}

/// Largest number of steps of the search for an end, and its tolerance relative to the outermost
/// pressure.
const MAX_STEPS: usize = 30;
const TOLERANCE: f64 = 1e-7;

/// Weights and nodes of Gauss' rule with five points on [-1, 1].
const GAUSS: [(f64, f64); 5] = [
    (0.236_926_885_056_189, -0.906_179_845_938_664),
    (0.478_628_670_499_366, -0.538_469_310_105_683),
    (0.568_888_888_888_889, 0.0),
    (0.478_628_670_499_366, 0.538_469_310_105_683),
    (0.236_926_885_056_189, 0.906_179_845_938_664),
];

/// Position at which the gap closes, from the outermost two nodes in contact, `inside` (place,
/// pressure), and the two open nodes (place, gap) outside them.
///
/// Next to a smooth contact the gap grows with the distance to the power 3/2 (K. L. Johnson,
/// Contact Mechanics, 1985, section 5.1), so that its power 2/3 is a line. The force on the
/// outermost node needs a contact of at least its ratio to the `bound`. [`Line::rim_of_yielding`]
/// treats a pressure that jumps next to the node.
fn rim_by_gap(
    inside: [(f64, f64); 2],
    open: [Option<(f64, f64)>; 2],
    bound: Option<f64>,
) -> Option<f64> {
    let [near, far] = [open[0]?, open[1]?];
    let [outermost, next] = inside;
    if !(near.1 > 0.0 && far.1 > near.1 && far.1.is_finite()) {
        return None;
    }
    let [a, b] = [near.1, far.1].map(|gap| gap.powf(2.0 / 3.0));
    let rim = near.0 - (far.0 - near.0) * a / (b - a);
    let (start, end) = (0.5 * (next.0 + outermost.0), 0.5 * (outermost.0 + near.0));
    let least = bound.map_or(start, |bound| start + (end - start) * outermost.1 / bound);
    Some(rim.clamp(least.min(near.0), least.max(near.0)))
}

/// Nodes of a line with their pressures and, if rims are also estimated from them, gaps.
pub(crate) struct Line<'a> {
    pub nodes: &'a [f64],
    pub pressure: Vec<f64>,
    pub gap: Vec<f64>,
    /// Largest possible pressure, less rounding [Pa].
    pub bound: f64,
    /// Whether the first node lies on a mirror plane.
    pub symmetric: bool,
}

impl Line<'_> {
    /// Stretches of positive pressure with sub-cell resolution.
    ///
    /// If the estimator `by` finds no end, the end is the outer one of [`rim_by_gap`] and
    /// [`Line::rim_of_yielding`]; if neither exists, it is half-way to the next node. A mirror
    /// plane at the first node is the start of a stretch that touches it.
    pub fn chords(&self, by: RimEstimator) -> Vec<[f64; 2]> {
        let touching = |k: &usize| self.pressure[*k] > 0.0;
        let touching: Vec<usize> = (0..self.nodes.len()).filter(touching).collect();
        let stretches = touching.chunk_by(|k, next| next - k == 1);
        stretches
            .map(|of| [0, 1].map(|side| self.end([of[0], of[of.len() - 1]], side, by)))
            .collect()
    }

    /// Place and pressure of a node.
    fn at(&self, node: usize) -> (f64, f64) {
        (self.nodes[node], self.pressure[node])
    }

    /// The lower (`side` 0) or upper end of the stretch of the nodes `first` to `last`.
    fn end(&self, [first, last]: [usize; 2], side: usize, by: RimEstimator) -> f64 {
        let nodes = self.nodes;
        let cut = first == 0 && self.symmetric;
        if cut && side == 0 {
            return nodes[0];
        }
        let outside = [first.saturating_sub(1), (last + 1).min(nodes.len() - 1)].map(|k| nodes[k]);
        let half_way = [0, 1].map(|side| 0.5 * (nodes[[first, last][side]] + outside[side]));
        // From the outermost node inwards.
        let mut inside: Vec<usize> = (first..=last).collect();
        if side == 1 {
            inside.reverse();
        }
        let shape: Vec<(f64, f64)> = inside.iter().take(4).map(|&k| self.at(k)).collect();
        let opposite = |x: f64| {
            if cut {
                2.0 * nodes[0] - x
            } else {
                half_way[1 - side]
            }
        };
        let found = match by {
            RimEstimator::Shape => rim_by_shape(&shape, outside[side], self.bound),
            RimEstimator::Load | RimEstimator::Cells if cut || last > first + 2 => {
                rim_by_load(&shape, outside[side], opposite, self.bound)
            }
            RimEstimator::Load | RimEstimator::Cells => None,
        };
        let outermost = [inside[0], inside[inside.len().min(2) - 1]];
        found
            .or_else(|| self.end_by_gap(outermost, [-1, 1][side], by))
            .unwrap_or(half_way[side])
    }

    /// The end outside the outermost two nodes of a stretch, `inside`: the outer one of the ends by
    /// the gap and by the end of yielding.
    fn end_by_gap(&self, inside: [usize; 2], outwards: isize, by: RimEstimator) -> Option<f64> {
        let [outermost_full, next_full] = inside.map(|k| self.pressure[k] >= self.bound);
        let open = [1, 2].map(|k| {
            let k = inside[0].checked_add_signed(k * outwards)?;
            Some((*self.nodes.get(k)?, *self.gap.get(k)?))
        });
        let by_gap = |bound| rim_by_gap(inside.map(|k| self.at(k)), open, bound);
        if by == RimEstimator::Cells {
            return by_gap(Some(self.bound)).filter(|_| !outermost_full);
        }
        let by_gap = by_gap((!next_full).then_some(self.bound));
        let farther = |a: f64, b: f64| if outwards < 0 { a.min(b) } else { a.max(b) };
        let yields = self.rim_of_yielding(inside[0], outwards);
        by_gap.into_iter().chain(yields).reduce(farther)
    }

    /// End of yielding outside `end`, the outermost node in contact; `None` if neither that node
    /// nor the next one inside is at the hardness.
    ///
    /// The pressure is the hardness wherever the runner overlaps with the elastic surface of the
    /// ice. The overlap crosses zero steeply at a rim; the pressure shows only between which nodes.
    fn rim_of_yielding(&self, end: usize, outwards: isize) -> Option<f64> {
        let end = end as isize;
        // Nodes beyond a mirror plane are images.
        let node = |k: isize| (k >= 0 || self.symmetric).then(|| k.unsigned_abs());
        let full = |k: isize| {
            let pressure = node(k).and_then(|k| self.pressure.get(k));
            pressure.is_some_and(|p| *p >= self.bound)
        };
        let overlap = |k: isize| {
            let (x, gap) = (*self.nodes.get(node(k)?)?, *self.gap.get(node(k)?)?);
            Some((if k < 0 { 2.0 * self.nodes[0] - x } else { x }, -gap))
        };
        let last = if full(end) || (full(end - outwards) && overlap(end)?.1 > 0.0) {
            end
        } else {
            full(end - outwards).then(|| end - outwards)?
        };
        rim_by_overlap(
            overlap(last - outwards),
            overlap(last)?,
            overlap(last + outwards)?,
        )
    }
}

/// Zero of the overlap with the elastic surface of the ice between the outermost node, which
/// yields, and the `open` one (place, overlap): that of the parabola through both and the next node
/// `within`, or of the line if that node's overlap is unknown. `None` if the open node has no gap
/// or, outside the hull, an infinite one.
pub(crate) fn rim_by_overlap(
    within: Option<(f64, f64)>,
    outermost: (f64, f64),
    open: (f64, f64),
) -> Option<f64> {
    let (inside, outside) = (outermost.1.max(0.0), -open.1);
    if !(outside > 0.0 && outside.is_finite()) {
        return None;
    }
    let step = open.0 - outermost.0;
    let within = within.filter(|w| w.1.is_finite());
    let bend = within.map_or(0.0, |(at, value)| {
        let (before, after) = (
            (inside - value) / (outermost.0 - at),
            (-outside - inside) / step,
        );
        (after - before) / (open.0 - at)
    });
    Some(outermost.0 + step * crossing(inside, outside, bend * step * step))
}

/// Zero in [0, 1] of the parabola with the values `inside` >= 0 at 0 and `-outside` < 0 at 1 and
/// the quadratic coefficient `bend`.
fn crossing(inside: f64, outside: f64, bend: f64) -> f64 {
    if inside <= 0.0 {
        return 0.0;
    }
    // inside + t (slope + bend t) with slope = -outside - inside - bend; the root with the sign
    // that falls.
    let slope = -outside - inside - bend;
    let root = (slope * slope - 4.0 * bend * inside).max(0.0).sqrt();
    (2.0 * inside / (root - slope)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pressures (1 - x^2)^m at even nodes of spacing 1 / `cells`, the outermost one's as the mean
    /// over its hat function.
    fn sampled(m: f64, cells: f64) -> (Vec<f64>, Vec<f64>) {
        let h = 1.0 / cells;
        let pressure = |x: f64| (1.0 - x * x).max(0.0).powf(m);
        let last = cells.floor() as i32;
        let nodes: Vec<f64> = (-last - 2..=last + 2).map(|i| h * f64::from(i)).collect();
        let mean = |x: f64| {
            let steps = 20_000;
            let part = |k: i32| {
                let t = (f64::from(k) + 0.5) / f64::from(steps) * 2.0 - 1.0;
                pressure(x + t * h) * (1.0 - t.abs())
            };
            (0..steps).map(part).sum::<f64>() * 2.0 / f64::from(steps)
        };
        let value = |x: &f64| match 1.0 - x.abs() {
            remaining if remaining <= 0.0 => 0.0,
            remaining if remaining < h => mean(*x),
            _ => pressure(*x),
        };
        let values = nodes.iter().map(value).collect();
        (nodes, values)
    }

    #[test]
    fn ends_of_hertz_pressures_by_load_are_exact_and_those_on_layers_within_a_quarter_of_a_cell() {
        for cells in [3.3, 3.5, 4.7, 6.5, 10.5] {
            for (m, mirrored, whole) in [(0.5, 1e-4, 0.02), (0.75, 0.15, 0.15), (1.0, 0.25, 0.25)] {
                let (nodes, values) = sampled(m, cells);
                let of = |from: usize, symmetric: bool| {
                    let line = Line {
                        nodes: &nodes[from..],
                        pressure: values[from..].to_vec(),
                        gap: Vec::new(),
                        bound: f64::INFINITY,
                        symmetric,
                    };
                    line.chords(RimEstimator::Load)[0]
                };
                let ([low, high], [_, half]) = (of(0, false), of(nodes.len() / 2, true));
                for (found, end, part) in [
                    (low, -1.0, whole),
                    (high, 1.0, whole),
                    (half, 1.0, mirrored),
                ] {
                    let off = (found - end).abs() * cells;
                    assert!(off < part, "{m} {cells}: {found} is off by {off} cells");
                }
            }
        }
    }
}
