//! A delay to a fraction of a sample, with its standard error.

use crate::clock::pair::Sides;

/// Most steps of Gauss and Newton; they double their digits near the end.
const STEPS: usize = 30;

/// Over which time residuals are taken to remember [s].
const MEMORY_S: f64 = 2.0;

/// A delay by one relation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Refined {
    pub delay_s: f64,
    pub sd_s: f64,
    pub correlation: f64,
}

/// Fits `left(t) = a + b right(t - ahead)` over a, b and the delay from a first guess.
///
/// Standard error by the residuals' own covariance (Newey and West 1987, Bartlett's weights over 2 s), since they are no
/// white noise. `None` where the fit leaves the neighbourhood of the guess (`reach_s`) or too few samples overlap.
pub(crate) fn refine(sides: &Sides, guess_s: f64, rate_hz: f64, reach_s: f64) -> Option<Refined> {
    let mut delay = guess_s;
    let mut last = None;
    for _ in 0..STEPS {
        let fit = linear(sides, delay, rate_hz)?;
        delay += fit.change;
        if (delay - guess_s).abs() > reach_s {
            return None;
        }
        last = Some(fit);
        if fit.change.abs() < 1e-9 {
            break;
        }
    }
    let fit = last?;
    Some(Refined {
        delay_s: delay,
        sd_s: fit.sd,
        correlation: fit.correlation,
    })
}

#[derive(Clone, Copy)]
struct Linear {
    change: f64,
    sd: f64,
    correlation: f64,
}

/// One step of Newton's: with `e = left - a - b right` and the right side's derivative freed of the side itself, the delay is
/// where their product sums to zero. Its change with the delay is, by parts, the product of both sides' derivatives: noise of
/// either side, which the other does not have, adds nothing to that.
fn linear(sides: &Sides, delay: f64, rate_hz: f64) -> Option<Linear> {
    let ahead = sides.ahead(delay);
    let [left, right] = sides.spans();
    let from = left[0].max(right[0] + ahead);
    let to = left[1].min(right[1] + ahead);
    let count = ((to - from) * rate_hz).floor();
    if !(20.0..1e7).contains(&count) {
        return None;
    }
    let mut rows: Vec<[f64; 4]> = Vec::new();
    for i in 0..=count as usize {
        let t = from + i as f64 / rate_hz;
        if let (Some([a, da]), Some([b, db])) = (sides.left(t), sides.right(t - ahead, ahead)) {
            rows.push([a, da, b, db]);
        }
    }
    let n = rows.len() as f64;
    if n < 20.0 {
        return None;
    }
    for k in 0..4 {
        let mean = rows.iter().map(|row| row[k]).sum::<f64>() / n;
        rows.iter_mut().for_each(|row| row[k] -= mean);
    }
    let dot = |j: usize, k: usize| rows.iter().map(|row| row[j] * row[k]).sum::<f64>();
    let (aa, ab, bb) = (dot(0, 0), dot(0, 2), dot(2, 2));
    let (b, slope) = (ab / bb, dot(2, 3) / bb);
    let scores: Vec<f64> = rows
        .iter()
        .map(|[a, _, right, d]| (a - b * right) * (d - slope * right))
        .collect();
    let change = dot(1, 3);
    if !(b > 0.0 && change > 0.0) {
        return None;
    }
    let memory = (MEMORY_S * rate_hz) as usize;
    let mut variance = 0.0;
    for lag in 0..=memory.min(scores.len() - 1) {
        let product: f64 = scores.iter().zip(&scores[lag..]).map(|(x, y)| x * y).sum();
        let bartlett = 1.0 - lag as f64 / (memory + 1) as f64;
        variance += if lag == 0 {
            product
        } else {
            2.0 * bartlett * product
        };
    }
    let shift = -scores.iter().sum::<f64>() / change;
    Some(Linear {
        // The shift moves the right side, which is early where the left side's clock is late.
        change: if sides.ahead(1.0) > 0.0 {
            shift
        } else {
            -shift
        },
        sd: variance.max(0.0).sqrt() / change,
        correlation: ab / (aa * bb).sqrt(),
    })
}
