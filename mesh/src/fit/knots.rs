//! Knots of a fitted surface: candidates from the vertices, refined by residuals.

use crate::fit::downward::Downward;
use crate::fit::spline::{Bicubic, Sample, fit};

/// Candidate breaks along each axis: the vertices' columns if they form columns, otherwise
/// quantiles as dense as the vertices.
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
    let sorted_places = |axis: usize, place: fn(f64) -> f64| {
        let mut values: Vec<f64> = samples.iter().map(|s| place(s.at[axis])).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let sorted = [0, 1].map(|axis| sorted_places(axis, |place| place));
    let columns = [0, 1].map(|axis| {
        let mut values = sorted[axis].clone();
        values.dedup_by(|b, a| *b - *a < 1e-6 * spans[axis]);
        values
    });
    let in_columns = columns[0].len() * columns[1].len() <= 4 * samples.len();
    let ratio = (edge[0] / edge[1]).clamp(1e-3, 1e6);
    // Two vertices per unknown.
    let cell = 2.0 * spans[0] * spans[1] / samples.len() as f64;
    let sizes = [(cell * ratio).sqrt(), (cell / ratio).sqrt()];
    [0, 1].map(|axis| {
        let mut values = if in_columns {
            columns[axis].clone()
        } else if mirrored[axis] {
            let half = sorted_places(axis, f64::abs);
            let count = ((0.5 * spans[axis] / sizes[axis]) as usize).clamp(2, samples.len());
            let places = (1..=count).map(|i| half[i * (samples.len() - 1) / count]);
            let below = places.clone().rev().map(|place| -place);
            below.chain([0.0]).chain(places).collect()
        } else {
            let count = ((spans[axis] / sizes[axis]) as usize).clamp(4, samples.len());
            let place = |i: usize| sorted[axis][i * (samples.len() - 1) / count];
            (0..=count).map(place).collect()
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

/// Number of parts of half the hull, with equally many vertices, in which the vertices on both
/// sides of the middle are counted.
const PARTS: usize = 16;
/// Largest ratio of the vertices of one side of a part to those of the other for symmetric knots:
/// above it, knots of the finer side would lie between the vertices of the other.
const MAX_RATIO: f64 = 2.0;
/// Smallest number of vertices of a part that is judged: with so many random places, one in ten
/// thousand parts has twice as many on one side.
const MIN_VERTICES: usize = 64;

/// Whether about as many of these places [m], each column counted once, lie below 0 as above it, at
/// every distance from 0.
pub(crate) fn balanced_sides(mut places: Vec<f64>) -> bool {
    places.sort_by(f64::total_cmp);
    let span = places.last().unwrap_or(&0.0) - places.first().unwrap_or(&0.0);
    places.dedup_by(|b, a| *b - *a < 1e-6 * span);
    places.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let size = places.len().div_ceil(PARTS).max(MIN_VERTICES);
    let balanced = |part: &[f64]| {
        // Places at the middle count on both sides.
        let below = part.iter().filter(|&&place| place <= 0.0).count() as f64;
        let above = part.iter().filter(|&&place| place >= 0.0).count() as f64;
        below.max(above) <= MAX_RATIO * below.min(above)
    };
    places
        .chunks(size)
        .all(|part| part.len() < MIN_VERTICES || balanced(part))
}

/// Largest product of unknowns and squared band width: bounds the work of one factorisation to a
/// second or two. With a third of it a luge steel of 300,000 vertices is not resolved.
const MAX_WORK: f64 = 1e10;
/// Largest number of rounds of refinement.
const MAX_ROUNDS: usize = 24;
/// Intervals whose misfit is below this fraction of the largest are not yet split. Where the
/// curvature jumps, the spline oscillates in the intervals nearby and along the other axis until
/// the jump is resolved. Misfits are squares: in residuals the fraction is a thirtieth, about three
/// intervals away.
const RINGING: f64 = 1e-3;

/// Fit with breaks from `candidates` (sorted, ends included). Intervals are split at their middle
/// candidate, the worst first, until the residuals are consistent with noise of standard deviation
/// `noise`.
///
/// The test of an interval uses the means of the residuals over its quarters (and over thirds along
/// the other axis): with noise alone, the sum of their squares divided by `noise^2/n` is about
/// their number. If `mirrored`, an interval is split together with its mirror image.
pub(crate) fn refined_fit(
    samples: &[Sample],
    candidates: &[Vec<f64>; 2],
    noise: f64,
    mirrored: [bool; 2],
) -> Option<Bicubic> {
    let mut breaks = [0, 1].map(|axis| thinned(&candidates[axis], [9, 5][axis], mirrored[axis]));
    let mut surface = fit(samples, &breaks)?;
    for _ in 0..MAX_ROUNDS {
        let residual = |s: &Sample| s.weight * (surface.value(s.at) - s.height);
        let residuals: Vec<f64> = samples.iter().map(residual).collect();
        let misfits = [0, 1].map(|axis| misfits(samples, &residuals, &breaks, axis, noise));
        let splits_over = |least: f64| {
            [0, 1].map(|axis| {
                let split: Vec<bool> = misfits[axis].iter().map(|&m| m > least).collect();
                with_splits(&breaks[axis], &split, &candidates[axis], mirrored[axis])
            })
        };
        let next = affordable(&misfits, splits_over);
        if next == breaks {
            break;
        }
        surface = fit(samples, &next)?;
        breaks = next;
    }
    Some(surface)
}

/// The breaks that `splits_over` gives for all misfits above 1 and above [`RINGING`] times the
/// largest, or for as many of the largest as [`MAX_WORK`] allows.
fn affordable(
    misfits: &[Vec<f64>; 2],
    splits_over: impl Fn(f64) -> [Vec<f64>; 2],
) -> [Vec<f64>; 2] {
    let work = |breaks: &[Vec<f64>; 2]| {
        let [along, across] = breaks.each_ref().map(|b| (b.len() + 2) as f64);
        along * across.powi(3) * 9.0
    };
    let largest = misfits.iter().flatten().copied().fold(0.0, f64::max);
    let least = (RINGING * largest).max(1.0);
    let mut levels: Vec<f64> = misfits.iter().flatten().copied().collect();
    levels.retain(|&m| m > least);
    levels.push(least);
    levels.sort_by(f64::total_cmp);
    let dear = levels.partition_point(|&least| work(&splits_over(least)) > MAX_WORK);
    splits_over(levels.get(dear).copied().unwrap_or(f64::INFINITY))
}

/// About `count` of the sorted `values`, the ends among them.
pub(crate) fn thinned(values: &[f64], count: usize, mirrored: bool) -> Vec<f64> {
    let last = values.len() - 1;
    let mut retained: Vec<f64> = (0..count).map(|i| values[i * last / (count - 1)]).collect();
    retained.dedup();
    if mirrored {
        symmetric(retained)
    } else {
        retained
    }
}

/// `values` and their mirror images, with nearly coincident values merged.
fn symmetric(values: Vec<f64>) -> Vec<f64> {
    let last = values[values.len() - 1];
    let mut half: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    half.sort_by(f64::total_cmp);
    half.dedup_by(|b, a| *b - *a < 1e-6 * last);
    let centred = half[0] < 1e-6 * last;
    let positive = &half[usize::from(centred)..];
    let mut all: Vec<f64> = positive.iter().rev().map(|v| -v).collect();
    if centred {
        all.push(0.0);
    }
    all.extend(positive);
    all
}

/// Misfit of each interval along `axis`: ratio of the test statistic of its residuals to the
/// largest value that noise explains.
fn misfits(
    samples: &[Sample],
    residuals: &[f64],
    breaks: &[Vec<f64>; 2],
    axis: usize,
    noise: f64,
) -> Vec<f64> {
    const QUARTERS: usize = 4;
    const THIRDS: usize = 3;
    let (own, other) = (&breaks[axis], &breaks[1 - axis]);
    let (low, span) = (other[0], other[other.len() - 1] - other[0]);
    let intervals = own.len() - 1;
    let mut bins = vec![(0.0, 0.0); intervals * QUARTERS * THIRDS];
    for (sample, residual) in samples.iter().zip(residuals) {
        let place = sample.at[axis];
        let i = own.partition_point(|&b| b <= place).clamp(1, intervals) - 1;
        let quarter = ((place - own[i]) / (own[i + 1] - own[i]) * QUARTERS as f64) as usize;
        let third = ((sample.at[1 - axis] - low) / span * THIRDS as f64) as usize;
        let part = quarter.min(QUARTERS - 1) * THIRDS + third.min(THIRDS - 1);
        let bin = &mut bins[i * QUARTERS * THIRDS + part];
        bin.0 += 1.0;
        bin.1 += residual;
    }
    let misfit = |bins: &[(f64, f64)]| {
        let filled = || bins.iter().filter(|(n, _)| *n > 0.0);
        let sum = filled().fold(0.0, |sum, (n, r)| sum + r * r / n);
        let count = filled().count() as f64;
        // 0 without vertices.
        sum / (noise * noise) / (count + 4.0 * f64::sqrt(2.0 * count)).max(1.0)
    };
    bins.chunks(QUARTERS * THIRDS).map(misfit).collect()
}

fn with_splits(breaks: &[f64], split: &[bool], candidates: &[f64], mirrored: bool) -> Vec<f64> {
    let mut next = vec![breaks[0]];
    let (first, last) = (breaks[0], breaks[breaks.len() - 1]);
    for (i, pair) in breaks.windows(2).enumerate() {
        let gap = 1e-6 * (last - first);
        let from = candidates.partition_point(|&c| c <= pair[0] + gap);
        let to = candidates.partition_point(|&c| c < pair[1] - gap);
        if split[i] && from < to {
            // The candidate nearest to the middle, so that wide gaps are halved.
            let middle = 0.5 * (pair[0] + pair[1]);
            let off = |place: &&f64| (**place - middle).abs();
            let inside = candidates[from..to].iter();
            next.extend(inside.min_by(|a, b| off(a).total_cmp(&off(b))));
        }
        next.push(pair[1]);
    }
    if mirrored { symmetric(next) } else { next }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_are_fine_on_one_side_alone_do_not_balanced_sides() {
        let even = |from: f64, to: f64, count: usize| {
            let step = (to - from) / count as f64;
            (0..=count).map(move |k| from + step * k as f64)
        };
        let side = |count| even(-1.0, -1e-3, count).chain(even(0.0, 1.0, 1000));
        assert!(balanced_sides(side(1000).collect()));
        assert!(balanced_sides(side(700).collect()));
        assert!(!balanced_sides(side(300).collect()));
        // A column counts once.
        let rows = |column: f64| std::iter::repeat_n(column, 80);
        assert!(!balanced_sides(side(50).flat_map(rows).collect()));
        assert!(balanced_sides(even(-1.0, 1.0, 30).flat_map(rows).collect()));
        // Fine in a fifth of one side, as many in all.
        let somewhere = even(-1.0, -0.2, 100).chain(even(-0.2, 0.0, 900));
        assert!(!balanced_sides(
            somewhere.chain(even(0.0, 1.0, 1000)).collect()
        ));
    }

    #[test]
    fn places_at_random_balanced_sides() {
        // Marsaglia's xorshift, 2003.
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for count in [200, 2000, 20_000] {
            assert!(
                balanced_sides((0..count).map(|_| next()).collect()),
                "{count}"
            );
        }
    }

    fn grid(n: [usize; 2], f: impl Fn(f64, f64) -> f64) -> Vec<Sample> {
        let at = |i: usize, n: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
        (0..n[0] * n[1])
            .map(|k| [at(k / n[1], n[0]), at(k % n[1], n[1])])
            .map(|at| Sample {
                at,
                height: f(at[0], at[1]),
                weight: 1.0,
            })
            .collect()
    }

    fn candidates(n: usize) -> Vec<f64> {
        (0..n)
            .map(|i| 2.0 * i as f64 / (n - 1) as f64 - 1.0)
            .collect()
    }

    #[test]
    fn a_plane_is_reproduced() {
        let surface = fit(
            &grid([20, 20], |x, y| 1.0 + 2.0 * x - y),
            &[candidates(6), candidates(9)],
        )
        .unwrap();
        assert!((surface.value([0.33, -0.71]) - (1.0 + 0.66 + 0.71)).abs() < 1e-11);
    }

    #[test]
    fn breaks_gather_where_the_surface_bends() {
        let samples = grid([200, 40], |x, _| (x - 0.5).max(0.0).powi(3));
        let surface = refined_fit(
            &samples,
            &[candidates(200), candidates(40)],
            1e-7,
            [false; 2],
        )
        .unwrap();
        let breaks = surface.axes[0].breaks();
        let right = breaks.iter().filter(|&&b| b > 0.3 && b < 0.7).count();
        let left = breaks.iter().filter(|&&b| b < -0.1).count();
        assert!(right > left, "{breaks:?}");
        assert!(
            samples
                .iter()
                .all(|s| (surface.value(s.at) - s.height).abs() < 1e-6)
        );
    }

    #[test]
    fn noise_is_smoothed_not_followed() {
        // A fixed scramble in place of a random number generator; standard deviation 1 / sqrt(12).
        let scramble =
            |x: f64, y: f64| (x * 12.9898 + y * 78.233).sin().abs() * 43758.5453 % 1.0 - 0.5;
        let noise = 1e-3;
        let smooth = |x: f64, y: f64| 0.1 * x * x + 0.3 * y * y;
        let samples = grid([150, 80], |x, y| {
            smooth(x, y) + noise * 12f64.sqrt() * scramble(x, y)
        });
        let surface = refined_fit(
            &samples,
            &[candidates(150), candidates(80)],
            noise,
            [false; 2],
        )
        .unwrap();
        let mut worst = 0.0f64;
        for s in grid([31, 31], smooth) {
            worst = worst.max(
                (surface.value(s.at.map(|v| 0.9 * v)) - smooth(0.9 * s.at[0], 0.9 * s.at[1])).abs(),
            );
        }
        assert!(worst < 0.4 * noise, "{worst:e}");
    }
}
