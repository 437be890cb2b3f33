//! What the balances that did not set a contact say of it: where it pushes, how it brakes, and whether it is there at all.

use kufe_sled::{FOLLOWED, scatter};

use crate::evidence::runs::contacts::of_run::OwnContact;
use crate::evidence::runs::contacts::own::beneath;
use crate::evidence::runs::model::residual_model::ChannelRows;
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::report::Interval;
use crate::null::random::{below, stream};

/// What one contact says of a balance: the lever that it turns at, or the friction that it brakes with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// What the balance has of the half wave over the contact's force.
    pub ratio: f64,
    /// What the half wave takes of the side balance's squares \[N2\].
    pub weight: f64,
    /// What it takes of them where it follows noise.
    pub noise: f64,
    /// Variance of `weight ratio` by the balance's own noise.
    pub variance: f64,
}

/// What all contacts of all runs say of a balance: `sum w y / (F sum w^2)` with the contact's own half wave; over `|F|` where it brakes.
pub fn reactions(frames: &[Frame], left: &[ChannelRows], balance: usize) -> Vec<Reaction> {
    let mut reactions = Vec::new();
    for (frame, left) in frames.iter().zip(left) {
        let of_run = |c: usize| scatter(&frame.samples().map(|i| left[c][i]).collect::<Vec<_>>());
        for own in &frame.contacts {
            let c = own.contact;
            let [mut ww, mut wy] = [0.0; 2];
            for i in frame.samples() {
                let w = c.force_at(frame.s[i]) / c.force_n;
                ww += w * w;
                wy += w * left[balance][i];
            }
            if ww <= 0.0 {
                continue;
            }
            let force = match balance {
                0 => -c.force_n.abs(),
                _ => c.force_n,
            };
            let weight = c.force_n.powi(2) * ww;
            let noise = own.error_n.powi(2) * ww;
            let louder = of_run(balance) / of_run(1).max(1e-300);
            reactions.push(Reaction {
                ratio: wy / (force * ww),
                weight,
                noise: FOLLOWED * noise,
                variance: weight * noise * louder.powi(2),
            });
        }
    }
    reactions
}

/// The ratio of all contacts, freed of the noise that their forces have followed, of which the balance has `shared` times as much; its
/// interval from the scatter of contacts or from the balance's noise, whichever is wider.
///
/// ```text
/// (sum weight ratio - shared sum noise) / (sum weight - sum noise)
/// ```
pub fn mean(reactions: &[Reaction], shared: f64, interval: f64) -> Interval {
    let sum = |of: &dyn Fn(&Reaction) -> f64| reactions.iter().map(of).sum::<f64>();
    let total = sum(&|r| r.weight - r.noise).max(1e-300);
    let value = sum(&|r| r.weight * r.ratio - r.noise * shared) / total;
    let away = |r: &Reaction| r.weight * (r.ratio - value) - r.noise * (shared - value);
    let n = reactions.len() as f64;
    let scatter = sum(&|r| away(r).powi(2)) * n / (n - 1.0).max(1.0);
    let half = interval * scatter.max(sum(&|r| r.variance)).sqrt() / total;
    Interval {
        value,
        low: value - half,
        high: value + half,
    }
}

/// How much of the side balance's noise a balance shares, along the runs and apart from contacts: `sum y x / sum x^2`. Noise of a slip angle
/// is in both, pushes and turns like a wall at a lever of its own.
pub fn shared_with_side(frames: &[Frame], left: &[ChannelRows], balance: usize) -> f64 {
    let [mut both, mut squares] = [0.0; 2];
    for (frame, left) in frames.iter().zip(left) {
        for i in frame.samples().filter(|i| !beneath(frame, frame.s[*i])) {
            both += left[1][i] * left[balance][i];
            squares += left[1][i] * left[1][i];
        }
    }
    if squares > 0.0 { both / squares } else { 0.0 }
}

/// The yaw balance without what noise of the side balance has in it.
pub fn apart_from_side(left: &[ChannelRows], shared_m: f64) -> Vec<Vec<f64>> {
    let apart = |l: &ChannelRows| {
        let both = l[2].iter().zip(&l[1]);
        both.map(|(y, x)| y - shared_m * x).collect()
    };
    left.iter().map(apart).collect()
}

/// p-value of what the yaw balance ([`apart_from_side`]) shows beneath the contacts, all with one lever, against the same half waves of the same run put elsewhere
/// on its way, where it has no contact: with the half wave w of a contact, F its force and y the balance, of
///
/// ```text
/// (sum F w y)^2 / sum F^2 w^2
/// ```
pub fn seen_by_yaw(frames: &[Frame], yaw: &[Vec<f64>], trials: u64, seed: u64) -> f64 {
    let products = |frame: &Frame, yaw: &[f64], by_m: f64, k: usize| {
        let c = frame.contacts[k].contact;
        let from = c.s_m + by_m;
        let first = frame.s.partition_point(|s| *s < from);
        let [mut ww, mut wy] = [0.0; 2];
        for (s, y) in frame.s[first..].iter().zip(&yaw[first..]) {
            if *s > from + c.length_m {
                break;
            }
            let w = c.force_at(s - by_m);
            (ww, wy) = (ww + w * w, wy + w * y);
        }
        [wy, ww]
    };
    let gain = |sums: [f64; 2]| {
        if sums[1] > 0.0 {
            sums[0] * sums[0] / sums[1]
        } else {
            0.0
        }
    };
    let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
    let each = || {
        frames
            .iter()
            .zip(yaw)
            .filter(|(f, _)| !f.contacts.is_empty())
    };
    let observed = each()
        .flat_map(|(f, l)| (0..f.contacts.len()).map(move |k| products(f, l, 0.0, k)))
        .fold([0.0; 2], add);
    let observed = gain(observed);
    let mut above = 1;
    for trial in 0..trials {
        let mut rng = stream(seed, 0xC0_17AC, trial);
        let mut sums = [0.0; 2];
        for (frame, yaw) in each() {
            for k in 0..frame.contacts.len() {
                let c = frame.contacts[k].contact;
                // A few draws find a stretch that is free; the last one is taken as it is.
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
                sums = add(sums, products(frame, yaw, by_m, k));
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

    /// Contacts of 40 N with an error of 10 N and a lever of 0.3 m, beside noise of which the yaw balance shares a lever of -0.3 m.
    fn contacts(draw: u64) -> Vec<Reaction> {
        let mut rng = stream(4, 0x1E7E, draw);
        let mut of_run = |_| {
            let noise = 10.0 * normal(&mut rng);
            let force = 40.0 + noise;
            let yaw = 0.3 * 40.0 - 0.3 * noise + 5.0 * normal(&mut rng);
            Reaction {
                ratio: yaw / force,
                weight: force * force,
                noise: 100.0,
                variance: force * force * 34.0,
            }
        };
        (0..12).map(&mut of_run).collect()
    }

    #[test]
    fn a_lever_is_that_of_the_force_and_not_of_the_noise_that_it_followed() {
        let each: Vec<Interval> = (0..400)
            .map(|draw| mean(&contacts(draw), -0.3, 1.96))
            .collect();
        let middle = each.iter().map(|i| i.value).sum::<f64>() / 400.0;
        assert!((middle - 0.3).abs() < 0.02, "{middle}");
        let plain = (0..400).map(|draw| mean(&contacts(draw), 0.3, 1.96).value);
        assert!(
            plain.sum::<f64>() / 400.0 - 0.3 < 0.0,
            "as if it were no noise"
        );
        let holds = each.iter().filter(|i| i.low < 0.3 && 0.3 < i.high);
        assert!(holds.count() >= 370);
    }
}
