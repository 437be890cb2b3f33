//! A bicubic spline through scattered heights, its knots refined where the heights ask for it.

use crate::{BSpline, band_cholesky::Band};

/// Weight of the bending energy, as a length in units of a cell's.
const STIFFNESS: f64 = 0.03;
/// Most work in one factorisation: unknowns times band width squared.
const MOST_WORK: f64 = 3e9;
/// Most rounds of refinement.
const ROUNDS: usize = 12;

/// One height: place, value and weight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Place along both axes [m].
    pub at: [f64; 2],
    /// Height [m].
    pub height: f64,
    /// Residuals count in proportion to this.
    pub weight: f64,
}

/// A bicubic spline over two axes.
#[derive(Clone, Debug)]
pub(crate) struct Bicubic {
    /// The splines along both axes.
    pub axes: [BSpline; 2],
    /// Coefficients, the second axis running fastest.
    pub coefficients: Vec<f64>,
}

impl Bicubic {
    /// Height at `at`.
    pub fn value(&self, at: [f64; 2]) -> f64 {
        let (i, along) = self.axes[0].values(at[0]);
        let (j, across) = self.axes[1].values(at[1]);
        let count = self.axes[1].count();
        let mut sum = 0.0;
        for (k, a) in along.iter().enumerate() {
            let row = &self.coefficients[(i + k) * count + j..][..4];
            sum += a
                * (row[0] * across[0]
                    + row[1] * across[1]
                    + row[2] * across[2]
                    + row[3] * across[3]);
        }
        sum
    }

    /// The mean of the surface and its mirror image along `axis`; the breaks must be symmetric.
    pub fn symmetrise(&mut self, axis: usize) {
        let [rows, columns] = [self.axes[0].count(), self.axes[1].count()];
        let old = self.coefficients.clone();
        for i in 0..rows {
            for j in 0..columns {
                let mirror = if axis == 0 {
                    (rows - 1 - i) * columns + j
                } else {
                    i * columns + columns - 1 - j
                };
                self.coefficients[i * columns + j] = 0.5 * (old[i * columns + j] + old[mirror]);
            }
        }
    }
}

/// Least squares with a trace of bending energy on fixed breaks:
/// `sum_i (w_i (s(x_i) - z_i))^2 + density * int (c hx)^4 s_xx^2 + 2 (c^2 hx hy)^2 s_xy^2 + (c hy)^4 s_yy^2`,
/// c = 0.03, hx and hy the cell's sides. The energy settles what no height decides.
pub(crate) fn fit(samples: &[Sample], breaks: &[Vec<f64>; 2]) -> Option<Bicubic> {
    let axes = [BSpline::new(&breaks[0]), BSpline::new(&breaks[1])];
    let columns = axes[1].count();
    let (size, width) = (axes[0].count() * columns, 3 * columns + 3);
    let mut band = Band::new(size, width);
    let mut right = vec![0.0; size];
    let mut add = |i: usize, a: &[f64; 4], j: usize, b: &[f64; 4], weight: f64, height: f64| {
        let mut product = [0.0; 16];
        for k in 0..16 {
            product[k] = a[k / 4] * b[k % 4];
        }
        let place = |k: usize| (i + k / 4) * columns + j + k % 4;
        for k in 0..16 {
            right[place(k)] += weight * product[k] * height;
            (0..=k).for_each(|l| band.add(place(k), place(l), weight * product[k] * product[l]));
        }
    };
    for sample in samples {
        let (i, a) = axes[0].values(sample.at[0]);
        let (j, b) = axes[1].values(sample.at[1]);
        add(i, &a, j, &b, sample.weight * sample.weight, sample.height);
    }
    let lengths = [0, 1].map(|k| breaks[k][breaks[k].len() - 1] - breaks[k][0]);
    let density = samples.len() as f64 / (lengths[0] * lengths[1]);
    let gauss = 0.5 / 3f64.sqrt();
    for x in breaks[0].windows(2) {
        for y in breaks[1].windows(2) {
            let (hx, hy) = (x[1] - x[0], y[1] - y[0]);
            let weight = density * 0.25 * hx * hy;
            let (cx, cy) = ((STIFFNESS * hx).powi(2), (STIFFNESS * hy).powi(2));
            for (sx, sy) in [
                (-gauss, -gauss),
                (-gauss, gauss),
                (gauss, -gauss),
                (gauss, gauss),
            ] {
                let (px, py) = (0.5 * (x[0] + x[1]) + sx * hx, 0.5 * (y[0] + y[1]) + sy * hy);
                let ((i, a0), (j, b0)) = (axes[0].values(px), axes[1].values(py));
                let ((_, a1), (_, b1)) =
                    (axes[0].first_derivatives(px), axes[1].first_derivatives(py));
                let ((_, a2), (_, b2)) = (
                    axes[0].second_derivatives(px),
                    axes[1].second_derivatives(py),
                );
                add(i, &a2, j, &b0, weight * cx * cx, 0.0);
                add(i, &a1, j, &b1, weight * 2.0 * cx * cy, 0.0);
                add(i, &a0, j, &b2, weight * cy * cy, 0.0);
            }
        }
    }
    Some(Bicubic {
        coefficients: band.solve(right)?,
        axes,
    })
}

/// Fits with breaks taken from `candidates` (sorted, ends included), each interval split at its middle
/// candidate until its residuals are what noise of standard deviation `noise` leaves.
///
/// Of each interval the means over quarters (and thirds along the other axis) are tested; noise makes
/// the sum of their squares over `noise^2/n` about their number. Where `mirrored` an interval is
/// split together with its mirror image.
pub(crate) fn refined_fit(
    samples: &[Sample],
    candidates: &[Vec<f64>; 2],
    noise: f64,
    mirrored: [bool; 2],
) -> Option<Bicubic> {
    let mut breaks = [0, 1].map(|axis| thinned(&candidates[axis], [9, 5][axis], mirrored[axis]));
    let mut surface = fit(samples, &breaks)?;
    for _ in 0..ROUNDS {
        let residuals: Vec<f64> = samples
            .iter()
            .map(|s| s.weight * (surface.value(s.at) - s.height))
            .collect();
        let mut next = breaks.clone();
        for axis in 0..2 {
            let split = badly_fitted(samples, &residuals, &breaks, axis, noise);
            next[axis] = with_splits(&breaks[axis], &split, &candidates[axis], mirrored[axis]);
        }
        let work = (next[0].len() + 2) as f64 * ((next[1].len() + 2) as f64).powi(3) * 9.0;
        if next == breaks || work > MOST_WORK {
            break;
        }
        surface = fit(samples, &next)?;
        breaks = next;
    }
    Some(surface)
}

/// About `count` of the sorted `values`, the ends among them.
pub(crate) fn thinned(values: &[f64], count: usize, mirrored: bool) -> Vec<f64> {
    let last = values.len() - 1;
    let mut kept: Vec<f64> = (0..count).map(|i| values[i * last / (count - 1)]).collect();
    kept.dedup();
    if mirrored { symmetric(kept) } else { kept }
}

/// `values` and their mirror images, with those that nearly coincide made one.
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

fn badly_fitted(
    samples: &[Sample],
    residuals: &[f64],
    breaks: &[Vec<f64>; 2],
    axis: usize,
    noise: f64,
) -> Vec<bool> {
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
        let bin =
            &mut bins[(i * QUARTERS + quarter.min(QUARTERS - 1)) * THIRDS + third.min(THIRDS - 1)];
        bin.0 += 1.0;
        bin.1 += residual;
    }
    bins.chunks(QUARTERS * THIRDS)
        .map(|bins| {
            let filled = bins.iter().filter(|(n, _)| *n > 0.0);
            let (count, sum) = filled.fold((0.0, 0.0), |(count, sum), (n, r)| {
                (count + 1.0, sum + r * r / n)
            });
            sum / (noise * noise) > count + 4.0 * f64::sqrt(2.0 * count)
        })
        .collect()
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
            let inside = &candidates[from..to];
            next.extend(
                inside
                    .iter()
                    .copied()
                    .min_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs())),
            );
        }
        next.push(pair[1]);
    }
    if mirrored { symmetric(next) } else { next }
}

#[cfg(test)]
mod tests {
    use super::*;

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
