//! What the balances that did not set a contact say of it: where it pushes, how it brakes, and whether it is there at all.

use crate::evidence::runs::contacts::of_run::OwnContact;
use crate::evidence::runs::model::residual_model::ChannelRows;
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::report::Interval;
use crate::null::random::{below, stream};

/// Lever and friction of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// Yaw moment over force \[m\].
    pub lever_m: f64,
    /// Braking over the size of the force.
    pub friction: f64,
    /// Weight of both: what the half wave takes of the side balance \[N2\].
    pub weight: f64,
}

/// Levers of all contacts of all runs: `sum w y / (F sum w^2)` with the contact's own half wave.
pub fn levers(frames: &[Frame], left: &[ChannelRows]) -> Vec<Reaction> {
    let mut levers = Vec::new();
    for (frame, left) in frames.iter().zip(left) {
        for own in &frame.contacts {
            let c = own.contact;
            let [mut ww, mut yaw, mut along] = [0.0; 3];
            for i in frame.samples() {
                let w = c.force_at(frame.s[i]) / c.force_n;
                ww += w * w;
                yaw += w * left[2][i];
                along += w * left[0][i];
            }
            if ww > 0.0 {
                levers.push(Reaction {
                    lever_m: yaw / (c.force_n * ww),
                    friction: -along / (c.force_n.abs() * ww),
                    weight: c.force_n.powi(2) * ww,
                });
            }
        }
    }
    levers
}

/// The weighted mean with an interval from the scatter of the contacts.
pub fn mean(levers: &[Reaction], of: fn(&Reaction) -> f64, interval: f64) -> Interval {
    let total: f64 = levers.iter().map(|l| l.weight).sum();
    let value = levers.iter().map(|l| l.weight * of(l)).sum::<f64>() / total.max(1e-300);
    let scatter = |l: &Reaction| (l.weight * (of(l) - value)).powi(2);
    let n = levers.len() as f64;
    let variance = levers.iter().map(scatter).sum::<f64>() * n / (n - 1.0).max(1.0);
    let half = interval * variance.sqrt() / total.max(1e-300);
    Interval {
        value,
        low: value - half,
        high: value + half,
    }
}

/// p-value of what the yaw balance shows beneath the contacts: each with a lever of its own, against the same half waves of the same run put
/// elsewhere on its way, where it has no contact.
pub fn seen_by_yaw(frames: &[Frame], left: &[ChannelRows], trials: u64, seed: u64) -> f64 {
    let gain = |frame: &Frame, yaw: &[f64], by_m: f64, k: usize| {
        let c = frame.contacts[k].contact;
        let from = c.s_m + by_m;
        let first = frame.s.partition_point(|s| *s < from);
        let [mut ww, mut wy] = [0.0; 2];
        for (s, y) in frame.s[first..].iter().zip(&yaw[first..]) {
            if *s > from + c.length_m {
                break;
            }
            let w = c.force_at(s - by_m) / c.force_n;
            (ww, wy) = (ww + w * w, wy + w * y);
        }
        if ww > 0.0 { wy * wy / ww } else { 0.0 }
    };
    let each = || {
        frames
            .iter()
            .zip(left)
            .filter(|(f, _)| !f.contacts.is_empty())
    };
    let observed: f64 = each()
        .map(|(f, l)| {
            (0..f.contacts.len())
                .map(|k| gain(f, &l[2], 0.0, k))
                .sum::<f64>()
        })
        .sum();
    let mut above = 1;
    for trial in 0..trials {
        let mut rng = stream(seed, 0xC0_17AC, trial);
        let mut sum = 0.0;
        for (frame, left) in each() {
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
                sum += gain(frame, &left[2], by_m, k);
            }
        }
        above += u64::from(sum >= observed);
    }
    above as f64 / (trials + 1) as f64
}
