//! Where a fitted surface may have breaks.

use crate::fit::bicubic::Sample;
use crate::fit::downward::Downward;

/// Places along each axis at which there may be a break: the vertices' columns where they stand in
/// columns, else quantiles as dense as the vertices.
pub(crate) fn break_places(
    part: &Downward,
    samples: &[Sample],
    ends: [[f64; 2]; 2],
    mirrored: [bool; 2],
    at: impl Fn(&[f64; 3]) -> [f64; 2],
) -> [Vec<f64>; 2] {
    let spans = ends.map(|[from, to]| to - from);
    let mut edge = [0.0; 2];
    for [a, b, c] in part.facets.iter().map(|f| f.map(|i| at(&part.points[i]))) {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            (0..2).for_each(|k| edge[k] += (p[k] - q[k]).abs());
        }
    }
    let sorted = [0, 1].map(|axis| {
        let mut values: Vec<f64> = samples.iter().map(|s| s.at[axis]).collect();
        values.sort_by(f64::total_cmp);
        values
    });
    let columns = [0, 1].map(|axis| {
        let mut values = sorted[axis].clone();
        values.dedup_by(|b, a| *b - *a < 1e-6 * spans[axis]);
        values
    });
    let in_columns = columns[0].len() * columns[1].len() <= 4 * samples.len();
    let ratio = (edge[0] / edge[1]).clamp(1e-3, 1e6);
    // Two vertices an unknown.
    let cell = 2.0 * spans[0] * spans[1] / samples.len() as f64;
    let sizes = [(cell * ratio).sqrt(), (cell / ratio).sqrt()];
    [0, 1].map(|axis| {
        let mut values = if in_columns {
            columns[axis].clone()
        } else if mirrored[axis] {
            let mut half: Vec<f64> = samples.iter().map(|s| s.at[axis].abs()).collect();
            half.sort_by(f64::total_cmp);
            let count = ((0.5 * spans[axis] / sizes[axis]) as usize).clamp(2, samples.len());
            let place = |i: usize| {
                if i == 0 {
                    0.0
                } else {
                    half[i * (samples.len() - 1) / count]
                }
            };
            (1..=count)
                .rev()
                .map(|i| -place(i))
                .chain((0..=count).map(place))
                .collect()
        } else {
            let count = ((spans[axis] / sizes[axis]) as usize).clamp(4, samples.len());
            (0..=count)
                .map(|i| sorted[axis][i * (samples.len() - 1) / count])
                .collect()
        };
        let [from, to] = ends[axis];
        let gap = 1e-6 * spans[axis];
        values.dedup_by(|b, a| *b - *a < gap);
        values.retain(|&v| v > from + gap && v < to - gap);
        values.insert(0, from);
        values.push(to);
        values
    })
}
