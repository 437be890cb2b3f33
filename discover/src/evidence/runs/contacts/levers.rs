//! Lever, friction and significance of contacts, from the balances that the contacts were not
//! estimated from.

use kufe_sled::WallContact;
use kufe_sled::effects::Active;

use crate::evidence::runs::contacts::run_contacts::{OwnContact, is_in_contact};
use crate::evidence::runs::model::residual_model::ChannelRows;
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::{Interval, symmetric};
use crate::null::random::{below, stream};

/// Standard errors above which a contact is strong: its selection bias is then a thirtieth.
const STRONG: f64 = 10.0;
/// Smallest number of strong contacts that are used alone.
const MIN_STRONG: usize = 4;
/// Number of reference places along the track.
const REFERENCES: usize = 60;
/// Share of the reference places trimmed at either end, where runs may have contacts.
const TRIMMED: f64 = 0.2;

/// Half-wave amplitudes x in the lateral residual and y in another one, minus the median over runs.
type Amplitudes = [f64; 2];

/// Sums of the squares x^2 and products x y of half-wave amplitudes, and their expectation under
/// noise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Excess {
    /// Sums over places, by run.
    runs: Vec<[f64; 2]>,
    /// Sums at reference places, over all runs.
    noise: [f64; 2],
}

fn add(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// The excess of all places. The longitudinal balance is signed by the side of the contact, so that
/// friction always brakes.
pub fn excess(
    frames: &[Frame],
    residual: &[ChannelRows],
    balance: usize,
    places: &[Active],
) -> Excess {
    let mut excess = Excess {
        runs: vec![[0.0; 2]; frames.len()],
        noise: [0.0; 2],
    };
    for (k, place) in places.iter().enumerate() {
        let Some(wave) = mean_wave(frames, k) else {
            continue;
        };
        let sign = match balance {
            0 => -place.values[0].signum(),
            _ => 1.0,
        };
        let end_m = wave.s_m + wave.length_m;
        let is_apart = |[from, to]: &[f64; 2]| wave.s_m >= *to || *from >= end_m;
        let there: Vec<usize> = (0..frames.len())
            .filter(|i| place.acts_on(&frames[*i].track) && frames[*i].pushed.iter().all(is_apart))
            .collect();
        let shifted = |by_m: f64| -> Option<Vec<Amplitudes>> {
            let of_run = |i: &usize| amplitudes(&frames[*i], &residual[*i], balance, &wave, by_m);
            let all: Option<Vec<Amplitudes>> = there.iter().map(of_run).collect();
            let all = all.map(subtract_median)?;
            Some(all.into_iter().map(|[x, y]| [x, sign * y]).collect())
        };
        let Some(here) = shifted(0.0) else { continue };
        let products = |[x, y]: Amplitudes| [x * x, x * y];
        for (i, here) in there.iter().zip(here) {
            excess.runs[*i] = add(excess.runs[*i], products(here));
        }
        let ends = there.iter().filter_map(|i| {
            let s = &frames[*i].s;
            Some((*s.first()?, *s.last()?))
        });
        let (from, to) = ends.fold((f64::NEG_INFINITY, f64::INFINITY), |a, b| {
            (a.0.max(b.0), a.1.min(b.1))
        });
        let step = (to - from - wave.length_m) / REFERENCES as f64;
        let elsewhere = (0..REFERENCES).map(|d| from + step * d as f64 - wave.s_m);
        let elsewhere: Vec<[f64; 2]> = elsewhere
            .filter(|by_m| by_m.abs() > wave.length_m)
            .filter_map(shifted)
            .map(|all| all.into_iter().map(products).fold([0.0; 2], add))
            .collect();
        for (sum, which) in excess.noise.iter_mut().zip([0, 1]) {
            *sum += trimmed(elsewhere.iter().map(|e| e[which]).collect());
        }
    }
    excess
}

/// The mean half wave of the hits of place `k`; `None` without hits.
fn mean_wave(frames: &[Frame], k: usize) -> Option<WallContact> {
    let own = frames.iter().flat_map(|f| &f.contacts);
    let hits: Vec<WallContact> = own
        .filter(|own| own.place == k)
        .map(|own| own.contact)
        .collect();
    let mean =
        |of: &dyn Fn(&WallContact) -> f64| hits.iter().map(of).sum::<f64>() / hits.len() as f64;
    (!hits.is_empty()).then(|| WallContact {
        s_m: mean(&|c| c.s_m),
        length_m: mean(&|c| c.length_m),
        force_n: 1.0,
        x_m: 0.0,
    })
}

/// Amplitudes of a half wave that is shifted by `by_m`; `None` if the run has no sample there.
fn amplitudes(
    frame: &Frame,
    residual: &ChannelRows,
    balance: usize,
    wave: &WallContact,
    by_m: f64,
) -> Option<Amplitudes> {
    let amplitude = |rows: &[f64]| {
        let [wy, ww] = products(frame, rows, wave, by_m);
        (ww > 0.0).then(|| wy / ww.sqrt())
    };
    Some([amplitude(&residual[1])?, amplitude(&residual[balance])?])
}

/// Sums of w y and w^2 over the samples of a half wave w that is shifted by `by_m`, with the
/// residual y.
fn products(frame: &Frame, y: &[f64], wave: &WallContact, by_m: f64) -> [f64; 2] {
    let from = wave.s_m + by_m;
    let first = frame.s.partition_point(|s| *s < from);
    let rows = frame.s.iter().zip(y).skip(first);
    let there = rows.take_while(|(s, _)| **s <= from + wave.length_m);
    there.fold([0.0; 2], |sums, (s, y)| {
        let w = wave.force_at(s - by_m);
        add(sums, [w * y, w * w])
    })
}

fn subtract_median(mut all: Vec<Amplitudes>) -> Vec<Amplitudes> {
    for which in 0..2 {
        let mut sorted: Vec<f64> = all.iter().map(|run| run[which]).collect();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        all.iter_mut().for_each(|run| run[which] -= middle);
    }
    all
}

/// Trimmed mean.
fn trimmed(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let cut = (TRIMMED * values.len() as f64) as usize;
    let middle_values = &values[cut..values.len() - cut];
    middle_values.iter().sum::<f64>() / middle_values.len().max(1) as f64
}

/// Ratio of another residual to the lateral one at contacts.
///
/// With x the half-wave amplitudes in the lateral residual and y those in the other one, the median
/// of all runs and the sums at reference places are subtracted, so that neither noise that both
/// residuals share nor the selection of hits biases the ratio:
///
/// ```text
/// (sum x y - reference) / (sum x^2 - reference)        over the runs of each place's track
/// ```
///
/// The interval is a jackknife interval over runs.
pub fn ratio(excess: &Excess, interval: f64) -> Interval {
    let n = excess.runs.len() as f64;
    let total = excess.runs.iter().copied().fold([0.0; 2], add);
    let ratio = |sums: [f64; 2], share: f64| {
        let [xx, xy] = [0, 1].map(|k| sums[k] - share * excess.noise[k]);
        xy / xx.max(1e-300)
    };
    let value = ratio(total, 1.0);
    let without = excess.runs.iter().map(|run| {
        let residual = [total[0] - run[0], total[1] - run[1]];
        (ratio(residual, (n - 1.0) / n) - value).powi(2)
    });
    let half = interval * ((n - 1.0) / n * without.sum::<f64>()).sqrt();
    symmetric(value, half)
}

/// The ratio by strong contacts alone, each with its own half wave; `None` if they are few.
///
/// ```text
/// sum F w y / sum F^2 w^2        with an interval from the scatter of contacts
/// ```
pub fn ratio_of_strong(
    frames: &[Frame],
    residual: &[ChannelRows],
    balance: usize,
    interval: f64,
) -> Option<Interval> {
    let mut contacts: Vec<Amplitudes> = Vec::new();
    for (frame, residual) in frames.iter().zip(residual) {
        let own = frame.contacts.iter();
        for own in own.filter(|own| own.contact.force_n.abs() > STRONG * own.error_n) {
            let force = match balance {
                0 => -own.contact.force_n.abs(),
                _ => own.contact.force_n,
            };
            let wave = WallContact {
                force_n: 1.0,
                ..own.contact
            };
            let (mut ww, mut wy) = (0.0, 0.0);
            for i in frame.samples() {
                let w = wave.force_at(frame.s[i]);
                (ww, wy) = (ww + w * w, wy + w * residual[balance][i]);
            }
            contacts.push([force * force * ww, force * wy]);
        }
    }
    let [xx, xy] = contacts.iter().copied().fold([0.0; 2], add);
    let n = contacts.len() as f64;
    (contacts.len() >= MIN_STRONG && xx > 0.0).then(|| {
        let value = xy / xx;
        let away = contacts.iter().map(|[xx, xy]| (xy - value * xx).powi(2));
        let half = interval * (away.sum::<f64>() * n / (n - 1.0)).sqrt() / xx;
        symmetric(value, half)
    })
}

/// Regression coefficient of a residual on the lateral one, away from contacts.
///
/// Noise of a slip angle enters both, like a contact with a lever of its own. As this lever depends
/// on frequency, it is evaluated at the length of contacts:
///
/// ```text
/// sum Y X / sum X^2,   X = sum w x,  Y = sum w y  over consecutive half waves w
/// ```
pub fn shared_with_side(frames: &[Frame], residual: &[ChannelRows], balance: usize) -> f64 {
    let own = || frames.iter().flat_map(|f| &f.contacts);
    let length_m = own().map(|own| own.contact.length_m).sum::<f64>() / own().count() as f64;
    if !length_m.is_finite() {
        return 0.0;
    }
    let [mut both, mut squares] = [0.0; 2];
    for (frame, residual) in frames.iter().zip(residual) {
        let mut wave = WallContact {
            s_m: f64::NEG_INFINITY,
            length_m,
            force_n: 1.0,
            x_m: 0.0,
        };
        let [mut x, mut y] = [0.0; 2];
        for i in frame.samples() {
            let s = frame.s[i];
            if s > wave.s_m + length_m {
                (both, squares) = (both + x * y, squares + x * x);
                (wave.s_m, x, y) = (s, 0.0, 0.0);
            }
            if !is_in_contact(frame, s) {
                let w = wave.force_at(s);
                (x, y) = (x + w * residual[1][i], y + w * residual[balance][i]);
            }
        }
    }
    if squares > 0.0 { both / squares } else { 0.0 }
}

/// The yaw residual without the noise that it shares with the lateral one.
pub fn subtract_side_noise(residual: &[ChannelRows], shared_m: f64) -> Vec<Vec<f64>> {
    let without_noise = |l: &ChannelRows| {
        let both = l[2].iter().zip(&l[1]);
        both.map(|(y, x)| y - shared_m * x).collect()
    };
    residual.iter().map(without_noise).collect()
}

/// p-value of the yaw residual ([`subtract_side_noise`]) at the contacts, with one lever for all,
/// against the same half waves moved to other places of the run without contacts. With w the half
/// wave of a contact, F its force and y the residual, the statistic is
///
/// ```text
/// (sum F w y)^2 / sum F^2 w^2
/// ```
pub fn yaw_p_value(frames: &[Frame], yaw: &[Vec<f64>], trials: u64, seed: u64) -> f64 {
    let gain = |[wy, ww]: [f64; 2]| if ww > 0.0 { wy * wy / ww } else { 0.0 };
    let each = || {
        frames
            .iter()
            .zip(yaw)
            .filter(|(f, _)| !f.contacts.is_empty())
    };
    let here = each().flat_map(|(frame, yaw)| {
        let own = frame.contacts.iter();
        own.map(move |own| products(frame, yaw, &own.contact, 0.0))
    });
    let observed = gain(here.fold([0.0; 2], add));
    let mut above = 1;
    for trial in 0..trials {
        let mut rng = stream(seed, 0xC0_17AC, trial);
        let mut sums = [0.0; 2];
        for (frame, yaw) in each() {
            for OwnContact { contact: c, .. } in &frame.contacts {
                // A few draws find a free interval; the last one is used in any case.
                let mut by_m = 0.0;
                for _ in 0..20 {
                    by_m = frame.s[below(&mut rng, frame.len())] - c.s_m;
                    let [from, to] = [c.s_m + by_m, c.s_m + by_m + c.length_m];
                    let free = |own: &OwnContact| {
                        let o = own.contact;
                        to < o.s_m || from > o.s_m + o.length_m
                    };
                    let end = frame.s.last().copied().unwrap_or(0.0);
                    if to <= end && frame.contacts.iter().all(free) {
                        break;
                    }
                }
                sums = add(sums, products(frame, yaw, c, by_m));
            }
        }
        above += u64::from(gain(sums) >= observed);
    }
    above as f64 / (trials + 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::{normal, stream};

    /// Twelve runs; every other one hits with a lever of 0.3 m. The yaw noise has -0.3 m.
    fn drawn(draw: u64) -> Excess {
        let mut rng = stream(4, 0x1E7E, draw);
        let mut of_run = |k: usize| {
            let force = if k.is_multiple_of(2) { 40.0 } else { 0.0 };
            let noise = 10.0 * normal(&mut rng);
            let x = force + noise;
            let y = 0.3 * force - 0.3 * noise + 3.0 * normal(&mut rng);
            [x * x, x * y]
        };
        Excess {
            runs: (0..12).map(&mut of_run).collect(),
            noise: [12.0 * 100.0, 12.0 * -30.0],
        }
    }

    #[test]
    fn noise_does_not_bias_the_lever_of_hits() {
        let each: Vec<Interval> = (0..400).map(|draw| ratio(&drawn(draw), 1.96)).collect();
        let middle = each.iter().map(|i| i.value).sum::<f64>() / 400.0;
        assert!((middle - 0.3).abs() < 0.02, "{middle}");
        let covered = each.iter().filter(|i| i.low < 0.3 && 0.3 < i.high);
        assert!(covered.count() >= 350);
    }
}
