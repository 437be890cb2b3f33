//! One look at the residuals: every candidate against sign-flips and against twins.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::candidates::Candidate;
use super::data::Frame;
use super::design::{Design, Window};
use super::fit::residuals;
use super::twins::TwinMaker;
use crate::flips::{MaxT, gumbel_tail, statistics};
use crate::score::{Scores, cross_information};

/// How a look is made.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Number of twins.
    pub twins: u64,
    /// Number of sign-flips.
    pub flips: usize,
    /// Largest p-value of a claim.
    pub alpha: f64,
    /// Factors of the twins' bias between which a claim must hold: how far the sensors' noise is trusted.
    pub trust: [f64; 2],
    /// Seed.
    pub seed: u64,
}

/// One candidate, or one window of a local one, after a look.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Share of its direction that a refit of the base leaves.
    pub left: f64,
    /// Size in its own unit, corrected for the twins' bias.
    pub size: f64,
    /// T, corrected.
    pub t: f64,
    /// T of the twins' mean: what noisy inputs alone produce.
    pub bias_t: f64,
    /// Smallest |T| over the trusted range of the noise, 0 where the sign changes.
    pub robust_t: f64,
    /// p-value by sign-flips, max-T.
    pub p_flips: f64,
    /// p-value against the twins' largest statistics.
    pub p_twins: f64,
    /// What it explains, in units of the noise's variance.
    pub gain: f64,
    /// The same by sizes fitted on other runs.
    pub held_gain: f64,
    /// Smallest size that would be claimed nine times in ten.
    pub detectable: f64,
    /// Whether it can be judged at all.
    pub usable: bool,
}

/// A whole look.
pub struct Seeing {
    /// Regular candidates, then windows.
    pub seen: Vec<Seen>,
    /// |T| needed.
    pub critical: f64,
    /// Corrected scores, candidates by runs.
    pub u: DMatrix<f64>,
    /// Products of the regular candidates beyond the base.
    pub cross: DMatrix<f64>,
}

/// Looks once.
pub fn look(
    design: &Design,
    frames: &[Frame],
    maker: &TwinMaker,
    options: &Look,
    progress: &(dyn Fn(&str) + Sync),
) -> Seeing {
    let base = design.fitted();
    let grams = design.grams(frames);
    let scores = Scores::new(&grams, base);
    let rows = residuals(design.chain, frames);
    progress("simulating twins");
    let twins: Vec<Scores> = (0..options.twins)
        .into_par_iter()
        .map(|k| {
            let twin = maker.make(frames, design.chain, &rows, k);
            let grams: Vec<_> = twin.iter().map(|frame| design.gram(frame)).collect();
            Scores::new(&grams, base)
        })
        .collect();
    let (count, runs) = scores.u.shape();
    let regular = design.candidates.len();
    let usable: Vec<bool> = (0..count)
        .map(|c| {
            let touched = (0..runs)
                .filter(|i| scores.information[(c, *i)] > 1e-9)
                .count();
            let needed = if c < regular { 4 } else { 4.max(runs / 8) };
            scores.left(c) > 2e-3 && scores.total_information(c) > 1e-6 && touched >= needed
        })
        .collect();
    let many = twins.len() as f64;
    let mut mean = DMatrix::zeros(count, runs);
    for twin in &twins {
        mean += &twin.u / many;
    }
    let keep = |mut u: DMatrix<f64>| {
        for (c, usable) in usable.iter().enumerate() {
            if !usable {
                u.row_mut(c).fill(0.0);
            }
        }
        u
    };
    let u = keep(&scores.u - &mean);
    // A twin judged by the other twins, as the data are.
    let maxima: Vec<f64> = twins
        .par_iter()
        .map(|twin| {
            let others = (&mean * many - &twin.u) / (many - 1.0);
            statistics(&keep(&twin.u - others))
                .iter()
                .fold(0.0_f64, |m, t| m.max(t.abs()))
        })
        .collect();
    let null = MaxT::by_sign_flips(&u, options.flips, options.seed);
    let critical = null.critical(options.alpha);
    let t = statistics(&u);
    let ends: Vec<Vec<f64>> = options
        .trust
        .iter()
        .map(|f| statistics(&keep(&scores.u - &mean * *f)))
        .collect();
    let bias = statistics(&keep(mean));
    let seen = (0..count)
        .map(|c| {
            let information = scores.total_information(c).max(1e-300);
            let scale = typical(design, c);
            let sum: f64 = u.row(c).sum();
            let size = sum / information;
            let n = runs as f64;
            let error = {
                let spread: f64 = (0..runs)
                    .map(|i| (u[(c, i)] - size * scores.information[(c, i)]).powi(2))
                    .sum();
                (spread * n / (n - 1.0).max(1.0)).sqrt() / information
            };
            let robust_t = if ends.iter().all(|e| e[c].signum() == t[c].signum()) {
                ends.iter().fold(t[c].abs(), |m, e| m.min(e[c].abs()))
            } else {
                0.0
            };
            Seen {
                left: scores.left(c),
                size: size * scale,
                t: t[c],
                bias_t: bias[c],
                robust_t,
                p_flips: if usable[c] { null.p_value(t[c]) } else { 1.0 },
                p_twins: if usable[c] {
                    gumbel_tail(&maxima, t[c].abs())
                } else {
                    1.0
                },
                gain: sum * sum / information,
                held_gain: held_gain(&u, &scores.information, c),
                detectable: (critical + 1.28) * error * scale,
                usable: usable[c],
            }
        })
        .collect();
    Seeing {
        seen,
        critical,
        u,
        cross: cross_information(&grams, base),
    }
}

fn typical(design: &Design, c: usize) -> f64 {
    match design.candidates.get(c) {
        Some(candidate) => candidate.typical,
        None => design.local[design.windows[c - design.candidates.len()].local].typical,
    }
}

/// What sizes fitted on four fifths of the runs explain on the rest.
fn held_gain(u: &DMatrix<f64>, information: &DMatrix<f64>, c: usize) -> f64 {
    let runs = u.ncols();
    let folds = 5.min(runs);
    let (all_u, all_i): (f64, f64) = (u.row(c).sum(), information.row(c).sum());
    (0..folds)
        .map(|fold| {
            let (mut u_out, mut i_out) = (0.0, 0.0);
            for i in (fold..runs).step_by(folds) {
                u_out += u[(c, i)];
                i_out += information[(c, i)];
            }
            let size = (all_u - u_out) / (all_i - i_out).max(1e-300);
            2.0 * size * u_out - size * size * i_out
        })
        .sum()
}

impl Seeing {
    /// T of regular candidate `a` once `b` has taken its part.
    pub fn beyond(&self, a: usize, b: usize) -> f64 {
        let share = self.cross[(a, b)] / self.cross[(b, b)].max(1e-300);
        let left = self.u.row(a) - self.u.row(b) * share;
        crate::score::studentised(left.iter().copied())
    }

    /// Correlation of two regular candidates beyond the base.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        let norm = (self.cross[(a, a)] * self.cross[(b, b)]).sqrt();
        if norm > 0.0 {
            self.cross[(a, b)] / norm
        } else {
            0.0
        }
    }

    /// Whether a candidate may be claimed.
    pub fn claimable(&self, c: usize, candidate: &Candidate, alpha: f64) -> bool {
        let s = &self.seen[c];
        s.usable
            && s.p_flips <= alpha
            && s.p_twins <= alpha
            && s.robust_t >= 0.85 * self.critical
            && s.held_gain > 0.0
            && (candidate.low..=candidate.high).contains(&s.size)
    }
}

/// The best window of each local candidate, as a candidate of its own with its place in the look.
pub fn best_windows(
    seeing: &Seeing,
    locals: &[Candidate],
    windows: &[Window],
    regular: usize,
) -> Vec<(Candidate, usize)> {
    (0..locals.len())
        .filter_map(|l| {
            let best = windows
                .iter()
                .enumerate()
                .filter(|(w, window)| window.local == l && seeing.seen[regular + w].usable)
                .max_by(|a, b| {
                    seeing.seen[regular + a.0]
                        .gain
                        .total_cmp(&seeing.seen[regular + b.0].gain)
                })?;
            let candidate = locals[l].within(&best.1.track, best.1.from, best.1.to);
            Some((candidate, regular + best.0))
        })
        .collect()
}
