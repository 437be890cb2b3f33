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

/// Parts of half the hull, with as many vertices each, in which those on both sides of the middle are counted.
const PARTS: usize = 16;
/// So many times as many on one side are too many for knots at the same distances: those of the finer side would lie between the vertices
/// of the other.
const UNLIKE: f64 = 2.0;
/// Fewest vertices that a part is judged by: of so many that stand at random one in ten thousand parts has twice as many on one side.
const FEWEST: usize = 64;

/// Whether about as many of these places [m], those in a column counted once, lie at every distance below 0 as above it.
pub(crate) fn stand_alike(mut places: Vec<f64>) -> bool {
    places.sort_by(f64::total_cmp);
    let span = places
        .last()
        .zip(places.first())
        .map_or(0.0, |(b, a)| b - a);
    places.dedup_by(|b, a| *b - *a < 1e-6 * span);
    places.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let size = places.len().div_ceil(PARTS).max(FEWEST);
    places
        .chunks(size)
        .filter(|part| part.len() >= FEWEST)
        .all(|part| {
            // The middle is of both sides.
            let middle = part.iter().filter(|&&place| place == 0.0).count() as f64;
            let below = part.iter().filter(|&&place| place < 0.0).count() as f64;
            let [few, many] = [below, part.len() as f64 - middle - below]
                .map(|side| side + middle)
                .into_iter()
                .fold([f64::INFINITY, 0.0], |[few, many], side| {
                    [few.min(side), f64::max(many, side)]
                });
            many <= UNLIKE * few
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_are_fine_on_one_side_alone_do_not_stand_alike() {
        let even = |from: f64, to: f64, count: usize| {
            let step = (to - from) / count as f64;
            (0..=count).map(move |k| from + step * k as f64)
        };
        let side = |count| even(-1.0, -1e-3, count).chain(even(0.0, 1.0, 1000));
        assert!(stand_alike(side(1000).collect()));
        assert!(stand_alike(side(700).collect()));
        assert!(!stand_alike(side(300).collect()));
        // A column counts once.
        let rows = |column: f64| std::iter::repeat_n(column, 80);
        assert!(!stand_alike(side(50).flat_map(rows).collect()));
        assert!(stand_alike(even(-1.0, 1.0, 30).flat_map(rows).collect()));
        // Fine in a fifth of one side, as many in all.
        let somewhere = even(-1.0, -0.2, 100).chain(even(-0.2, 0.0, 900));
        assert!(!stand_alike(
            somewhere.chain(even(0.0, 1.0, 1000)).collect()
        ));
    }

    #[test]
    fn places_at_random_stand_alike() {
        // Marsaglia's xorshift, 2003.
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for count in [200, 2000, 20_000] {
            assert!(stand_alike((0..count).map(|_| next()).collect()), "{count}");
        }
    }
}
