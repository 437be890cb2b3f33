//! Evidence of stated contacts in the lateral residual of a run that was not used to estimate them.

use kufe_sled::effects::Active;
use kufe_sled::{HITS_DIFFER, WallContact, half_waves, hits_of, likelier, scatter, stretch_of};

use crate::evidence::runs::contacts::model::Contacts;
use crate::evidence::runs::model::residual_model::ChannelRows;
use crate::evidence::runs::recordings::frame::Frame;

/// Probability of another push at a place, and the ratio of its standard deviation to a hit's
/// force. Chosen: limits the influence of a single run.
const OTHER_PUSH: (f64, f64) = (0.05, 10.0);

/// Twice the log-likelihood ratio of the lateral residual of a run with and without contacts.
///
/// A place states its half wave w up to a shift, and ([`hits_of`]) a share pi of hits and their
/// force F. With r the rows of the lateral residual in units of their standard deviation sd \[N\],
/// f the fitted force and e its standard error, the likelihood ratio of a force of mean F and
/// standard deviation t is
///
/// ```text
/// f = sd sum w r / sum w^2        e = sd / sqrt(share sum w^2)
/// L(F, t) = mean over w of exp (1/2 (f^2 / e^2 - (f - F)^2 / (e^2 + t^2) - ln(1 + t^2 / e^2)))
/// sum over places of 2 ln ((1 - q) (1 - pi + pi L(F, F / 2)) + q L(0, 10 F)) - 2 ln (1 - q + q L(0, 10 F))
/// ```
///
/// with q the probability of another push; `share` is the fraction of independent rows
/// ([`correlated_rows`]). Source: the predictive density of a normal amplitude in normal noise.
/// Under noise alone the sum exceeds 2 ln(1 / p) with a probability of at most p (Markov's
/// inequality).
pub fn log_likelihood_ratio(
    contacts: &Contacts,
    frame: &Frame,
    side: &[f64],
    sd_n: f64,
    share: f64,
) -> f64 {
    let there = contacts.places.iter().filter(|p| p.acts_on(&frame.track));
    let of_place = |place: &Active| {
        let waves = half_waves(stretch_of(place)).map(|wave| {
            let w: Vec<f64> = frame.s.iter().map(|s| wave.force_at(*s)).collect();
            frame.rows(&w)
        });
        place_log_ratio(waves, side, hits_of(place), sd_n, share)
    };
    there.map(of_place).sum()
}

/// Number of lateral rows per independent one, at least 1: the ratio of the mean square of
/// half-wave amplitudes along the runs to that of white noise. `rows` are the training runs' rows
/// in units of their standard deviation.
///
/// Slow noise persists over a whole half wave. The median of the squares is used: few half waves
/// are at a wall.
pub fn correlated_rows(contacts: &Contacts, frames: &[Frame], rows: &[ChannelRows]) -> f64 {
    let lengths = contacts.places.iter().map(|place| {
        let [from_m, to_m] = stretch_of(place);
        0.5 * (to_m - from_m)
    });
    let length_m = lengths.sum::<f64>() / contacts.places.len().max(1) as f64;
    let of_run = |(frame, rows): (&Frame, &ChannelRows)| -> Vec<f64> {
        let s = frame.rows(&frame.s);
        let (Some(first), Some(last)) = (s.first(), s.last()) else {
            return Vec::new();
        };
        let count = ((last - first) / length_m).floor().max(0.0) as usize;
        let had = |k: usize| {
            let wave = WallContact {
                s_m: first + k as f64 * length_m,
                length_m,
                force_n: 1.0,
                x_m: 0.0,
            };
            let (wr, ww) = products(s.iter().map(|s| wave.force_at(*s)), &rows[1]);
            (ww > 0.0).then(|| wr / ww.sqrt())
        };
        (0..count).filter_map(had).collect()
    };
    let each: Vec<f64> = frames.iter().zip(rows).flat_map(of_run).collect();
    scatter(&each).powi(2).max(1.0)
}

/// Evidence of one place: half waves row by row, the share of hits and their force \[N\].
fn place_log_ratio(
    waves: impl Iterator<Item = Vec<f64>>,
    side: &[f64],
    (hits, hit_n): (f64, f64),
    sd_n: f64,
    share: f64,
) -> f64 {
    let (other, harder) = OTHER_PUSH;
    // Logarithms: the likelihood of a hard push overflows.
    let [mut by_hit, mut by_other] = [Vec::new(), Vec::new()];
    for wave in waves {
        let (wr, ww) = products(wave.into_iter(), side);
        if ww <= 0.0 {
            continue;
        }
        let (force, variance) = (sd_n * wr / ww, sd_n * sd_n / (share * ww));
        by_hit.push(likelier(force, variance, hit_n, HITS_DIFFER * hit_n));
        by_other.push(likelier(force, variance, 0.0, harder * hit_n));
    }
    if hits == 0.0 || by_hit.is_empty() {
        return 0.0;
    }
    let [by_hit, by_other] = [mean_of(&by_hit), mean_of(&by_other)];
    let with = log_sum((1.0 - hits).ln(), hits.ln() + by_hit);
    let by_other = other.ln() + by_other;
    let none = (1.0 - other).ln();
    2.0 * (log_sum(none + with, by_other) - log_sum(none, by_other))
}

fn products(wave: impl Iterator<Item = f64>, rows: &[f64]) -> (f64, f64) {
    let pairs = wave.zip(rows);
    pairs.fold((0.0, 0.0), |(wr, ww), (w, r)| (wr + w * r, ww + w * w))
}

/// `ln(e^a + e^b)`.
fn log_sum(a: f64, b: f64) -> f64 {
    a.max(b) + (-(a - b).abs()).exp().ln_1p()
}

/// The logarithm of the mean of `exp(logs)`.
fn mean_of(logs: &[f64]) -> f64 {
    let sum = logs.iter().copied().fold(f64::NEG_INFINITY, log_sum);
    sum - (logs.len() as f64).ln()
}

#[cfg(test)]
mod tests {
    use kufe_sled::WallContact;

    use super::*;
    use crate::null::random::{normal, stream};

    /// Evidence of 400 runs for a place that half of all hit with five standard errors of a force,
    /// each with a push of this size \[N\].
    fn log_ratios(push_n: f64) -> Vec<f64> {
        let s: Vec<f64> = (0..40).map(f64::from).collect();
        let wave = |w: WallContact| s.iter().map(|s| w.force_at(*s)).collect::<Vec<f64>>();
        let true_one = WallContact {
            s_m: 11.0,
            length_m: 10.0,
            force_n: push_n,
            x_m: 0.0,
        };
        let pushed = wave(true_one);
        // The squares of a half wave of 10 m sum to 3.75: 26 N are five standard errors.
        let of_run = |draw: u64| {
            let mut rng = stream(8, 0x9121, draw);
            let side: Vec<f64> = pushed.iter().map(|p| p / 10.0 + normal(&mut rng)).collect();
            let waves = half_waves([5.0, 27.0]).map(wave);
            place_log_ratio(waves, &side, (0.5, 26.0), 10.0, 1.0)
        };
        (0..400).map(of_run).collect()
    }

    #[test]
    fn the_likelihood_ratio_is_bounded_under_noise_large_for_hits_and_robust() {
        let noise = log_ratios(0.0);
        let mean = noise.iter().sum::<f64>() / 400.0;
        let by_chance = noise
            .iter()
            .filter(|log_ratios| **log_ratios > 2.0 * f64::ln(20.0));
        assert!(mean < 0.0 && by_chance.count() <= 20, "{mean}");
        let hits = log_ratios(26.0);
        let mean = hits.iter().sum::<f64>() / 400.0;
        assert!(mean > 6.0, "{mean}");
        for push_n in [1000.0, -300.0] {
            let most = log_ratios(push_n)
                .into_iter()
                .map(f64::abs)
                .fold(0.0, f64::max);
            assert!(most < 3.0, "{push_n} N: {most}");
        }
    }

    #[test]
    fn log_sums_do_not_overflow() {
        let logs = [1000.0, 999.0];
        let truth = 1000.0 + ((1.0 + f64::exp(-1.0)) / 2.0).ln();
        assert!((mean_of(&logs) - truth).abs() < 1e-12);
        assert!((log_sum(0.2_f64.ln(), 0.3_f64.ln()).exp() - 0.5).abs() < 1e-15);
    }
}
