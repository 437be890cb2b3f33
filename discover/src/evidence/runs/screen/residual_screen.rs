//! One screen of the residuals: corrected scores of every candidate, tested by sign-flips.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::noise_products::mean_noise_products;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::{Design, Products};
use crate::evidence::runs::model::windows::Window;
use crate::evidence::runs::recordings::frame::Frame;
use crate::null::clusters::session_numbers;
use crate::null::sign_flips::MaxT;
use crate::null::unit_scores::UnitScores;
use crate::procedure::candidate::Candidate;
use crate::regression::prior::Prior;
use crate::regression::scores::{Scores, cross_information};

#[derive(Clone, Copy, Debug)]
pub struct ScreenOptions {
    /// Pairs of simulated runs per run.
    pub pairs: u64,
    pub flips: usize,
    /// Largest p-value of a selected effect.
    pub alpha: f64,
    /// The same for an effect in a window of distance.
    pub alpha_local: f64,
    /// The same for an effect outside the catalogue.
    pub alpha_column: f64,
    /// Smallest shares of a column: remaining after a refit of the base, and not noise.
    pub least: [f64; 2],
    /// Excess over the critical value of a size with a power of 90 %, in standard errors.
    pub nine_in_ten: f64,
    pub seed: u64,
}

/// Scores of a candidate or window.
#[derive(Clone, Debug)]
pub struct CandidateScore {
    /// Share of its column that remains after a refit of the base.
    pub remaining_share: f64,
    pub size: f64,
    pub error: f64,
    /// T: the sum of its scores over their standard deviation.
    pub t: f64,
    /// T of the noise correction.
    pub bias_t: f64,
    /// p-value by sign-flips, max-T over its kind.
    pub p_value: f64,
    /// The same with the runs of a session weighted together; absent with a single session.
    pub p_sessions: Option<f64>,
    /// Explained sum of squares, in units of the noise's variance.
    pub gain: f64,
    pub cross_validated_gain: f64,
    /// Smallest size that would be selected with a probability of 90 %.
    pub detectable: f64,
    /// Whether it can be judged.
    pub usable: bool,
}

pub struct RunScreen {
    /// Regular candidates, then windows.
    pub seen: Vec<CandidateScore>,
    /// Scores of candidates and windows.
    pub sums: UnitScores,
    /// Products of the regular candidates given the base.
    pub cross: DMatrix<f64>,
}

/// Products of all columns, with their candidates.
pub struct CandidateProducts<'a> {
    pub regular: &'a [Candidate<Amplitude>],
    pub local: &'a [Candidate<Amplitude>],
    pub windows: &'a [Window],
    /// Prior of the fitted parameters.
    pub prior: Prior,
    pub products: Vec<Products>,
    /// Noise correction of the products.
    pub noise: Vec<DMatrix<f64>>,
}

impl<'a> CandidateProducts<'a> {
    /// The candidates of a design, with a noise correction from so many pairs of simulated runs.
    pub fn new(
        design: &Design<'a>,
        frames: &[Frame],
        simulator: &RunSimulator,
        pairs: u64,
    ) -> Self {
        Self {
            regular: design.candidates,
            local: design.local,
            windows: design.windows,
            prior: design.prior(),
            products: design.products(frames),
            noise: mean_noise_products(design, frames, simulator, 0..pairs),
        }
    }

    fn typical(&self, c: usize) -> f64 {
        match self.regular.get(c) {
            Some(candidate) => candidate.typical,
            None => self.local[self.windows[c - self.regular.len()].local].typical,
        }
    }
}

pub fn screen_runs(
    tested: &CandidateProducts,
    frames: &[Frame],
    options: &ScreenOptions,
) -> RunScreen {
    let CandidateProducts {
        prior,
        products,
        noise,
        ..
    } = tested;
    let grams: Vec<_> = products
        .iter()
        .zip(noise)
        .map(|(p, d)| p.corrected(d, 1.0))
        .collect();
    let scores = Scores::new(&grams, prior);
    let plain: Vec<_> = products.iter().map(Products::plain).collect();
    let plain = Scores::new(&plain, prior);
    let (count, runs) = scores.u.shape();
    let regular = tested.regular.len();
    let usable: Vec<bool> = (0..count)
        .map(|c| {
            let information = scores.total_information(c);
            let touched = (0..runs)
                .filter(|i| scores.information[(c, *i)] > 1e-9)
                .count();
            let enough = if c < regular {
                // A direction that is mostly noise is excluded.
                touched >= 4 && information > options.least[1] * plain.total_information(c)
            } else {
                let window = &tested.windows[c - regular];
                let there = frames.iter().filter(|f| f.track == window.track).count();
                touched >= 4 && 2 * touched > there
            };
            scores.remaining_share(c) > options.least[0] && information > 1e-6 && enough
        })
        .collect();
    let norms = window_norms(&scores, &usable, tested);
    let named = tested.regular.iter().filter(|c| !c.is_column()).count();
    assert!(
        tested.regular[named..].iter().all(Candidate::is_column),
        "candidates outside the catalogue come last"
    );
    // Three families of candidates: the catalogue, columns outside it, places.
    let families = [0..named, named..regular, regular..count];
    let sums = UnitScores::of(&scores);
    let of_family = |family: &Range<usize>| {
        let rows: Vec<usize> = family.clone().collect();
        let mut own = sums.only(&rows);
        for (row, _) in rows.iter().enumerate().filter(|(_, c)| !usable[**c]) {
            own.information.row_mut(row).fill(0.0);
        }
        own
    };
    let [known, columns, places] = families.each_ref().map(of_family);
    let nulls = [
        known.by_sign_flips(options.flips, options.seed),
        columns.by_sign_flips(options.flips, options.seed ^ 0xBE40),
        MaxT::with_norms(
            &scattered(&places),
            &norms,
            &places.common,
            options.flips,
            options.seed ^ 0x10CA,
        ),
    ];
    let alphas = [options.alpha, options.alpha_column, options.alpha_local];
    let of_window = |(w, norm): (usize, &f64)| match *norm > 0.0 {
        true => scores.sum(regular + w) / norm,
        false => 0.0,
    };
    let of_windows = norms.iter().enumerate().map(of_window).collect();
    let t_all = [known.t(), columns.t(), of_windows].concat();
    let sessions = session_numbers(frames.iter().map(|frame| frame.session.as_str()));
    let p_sessions: Vec<Option<f64>> = [&known, &columns, &places]
        .into_iter()
        .flat_map(|own| {
            let Some(of_sessions) = own.by_sessions(&sessions) else {
                return vec![None; own.u.nrows()];
            };
            let null = of_sessions.by_wild_bootstrap(options.flips, options.seed);
            let p_value = |t: f64| Some(null.p_value(t));
            of_sessions.t().into_iter().map(p_value).collect()
        })
        .collect();
    let criticals: Vec<f64> = nulls
        .iter()
        .zip(alphas)
        .map(|(null, alpha)| null.critical(alpha))
        .collect();
    let family = |c: usize| usize::from(c >= named) + usize::from(c >= regular);
    let seen = (0..count)
        .map(|c| {
            let information = scores.total_information(c).max(1e-300);
            let scale = tested.typical(c);
            let sum = scores.sum(c);
            let t = t_all[c];
            let size = sum / information;
            let n = runs as f64;
            let spread: f64 = (0..runs)
                .map(|i| (scores.u[(c, i)] - size * scores.information[(c, i)]).powi(2))
                .sum();
            let scatter = spread * n / (n - 1.0).max(1.0);
            let error = (scatter + scores.shared_variance(c)).sqrt() / information;
            let (null, critical) = (&nulls[family(c)], criticals[family(c)]);
            CandidateScore {
                remaining_share: scores.remaining_share(c),
                size: size * scale,
                error: error * scale,
                t,
                bias_t: (plain.sum(c) - sum) / (error * information).max(1e-300),
                p_value: if usable[c] { null.p_value(t) } else { 1.0 },
                p_sessions: p_sessions[c],
                gain: sum * sum / information,
                cross_validated_gain: cross_validated_gain(&scores, c),
                detectable: (critical + options.nine_in_ten) * error * scale,
                usable: usable[c],
            }
        })
        .collect();
    RunScreen {
        seen,
        sums,
        cross: cross_information(&grams, prior),
    }
}

/// Scores of windows less their own sizes, rescaled for the lost degree of freedom.
///
/// The few runs on a track have few sign patterns, and the windows share their norms: an effect in
/// the data would otherwise appear in its own null, with seven ninths of its T if one of nine signs
/// is flipped. The rest scatters as noise does.
fn scattered(windows: &UnitScores) -> DMatrix<f64> {
    let mut u = windows.u.clone();
    for c in 0..u.nrows() {
        let own = windows.information.row(c);
        let touched = own.iter().filter(|i| **i > 1e-9).count() as f64;
        let information = own.sum() + windows.common.row(c).norm_squared();
        if information <= 0.0 || touched < 2.0 {
            continue;
        }
        let size = windows.u.row(c).sum() / information;
        let freed = (touched / (touched - 1.0)).sqrt();
        for i in 0..u.ncols() {
            u[(c, i)] = freed * (u[(c, i)] - size * own[i]);
        }
    }
    u
}

/// Standard deviations of the sums of scores of windows: from their information and the median
/// scatter of their kind, because the few runs on one track do not determine their own. 0 if a
/// window cannot be judged.
fn window_norms(scores: &Scores, usable: &[bool], tested: &CandidateProducts) -> Vec<f64> {
    let regular = tested.regular.len();
    let mut norms = vec![0.0; scores.u.nrows() - regular];
    for l in 0..tested.local.len() {
        let mine: Vec<usize> = (0..norms.len())
            .filter(|w| usable[regular + w] && tested.windows[*w].local == l)
            .collect();
        let information = |w: usize| scores.total_information(regular + w);
        let inflation = |w: &usize| scores.u.row(regular + w).norm_squared() / information(*w);
        let mut inflation: Vec<f64> = mine.iter().map(inflation).collect();
        inflation.sort_by(f64::total_cmp);
        let Some(middle) = inflation.get(inflation.len() / 2) else {
            continue;
        };
        // The contribution of random effects is common to all runs.
        for w in &mine {
            let common = scores.shared_variance(regular + w);
            norms[*w] = (middle * information(*w) + common).sqrt();
        }
    }
    norms
}

/// Cross-validated gain with sizes fitted on four fifths of the runs; the installation's
/// contribution is divided among the runs.
fn cross_validated_gain(scores: &Scores, c: usize) -> f64 {
    let (u, information) = (&scores.u, &scores.information);
    let runs = u.ncols();
    let folds = 5.min(runs);
    let (all_u, all_i) = (scores.sum(c), scores.total_information(c));
    let [shared, variance] =
        [scores.shared[c], scores.shared_variance(c)].map(|sum| sum / runs as f64);
    (0..folds)
        .map(|fold| {
            let (mut u_out, mut i_out) = (0.0, 0.0);
            for i in (fold..runs).step_by(folds) {
                u_out += u[(c, i)] + shared;
                i_out += information[(c, i)] + variance;
            }
            let size = (all_u - u_out) / (all_i - i_out).max(1e-300);
            2.0 * size * u_out - size * size * i_out
        })
        .sum()
}

impl RunScreen {
    /// Some of the regular candidates.
    pub fn only(&self, selected: &[usize]) -> Self {
        let pairs = |i: usize, j: usize| self.cross[(selected[i], selected[j])];
        Self {
            seen: selected.iter().map(|c| self.seen[*c].clone()).collect(),
            sums: self.sums.only(selected),
            cross: DMatrix::from_fn(selected.len(), selected.len(), pairs),
        }
    }

    /// T of regular candidate `a` given `b`.
    pub fn t_given(&self, a: usize, b: usize) -> f64 {
        let share = self.cross[(a, b)] / self.cross[(b, b)].max(1e-300);
        self.sums.t_less(a, b, share)
    }

    /// Correlation of two regular candidates given the base, corrected for noise.
    ///
    /// Corrected products are estimates: for two almost collinear columns the corrected squares may
    /// be smaller than their product. The nearest matrix of products of two columns then has a
    /// correlation of 1.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        correlation([self.cross[(a, a)], self.cross[(a, b)], self.cross[(b, b)]])
    }

    /// Whether a candidate may be selected.
    pub fn is_selectable(&self, c: usize, candidate: &Candidate<Amplitude>, alpha: f64) -> bool {
        let s = &self.seen[c];
        s.usable && s.p_value <= alpha && s.cross_validated_gain > 0.0 && candidate.admits(s.size)
    }
}

/// The window of largest gain of each local candidate, with its index in the screen.
pub fn best_windows<'w>(
    screen: &RunScreen,
    windows: &'w [Window],
    regular: usize,
) -> Vec<(&'w Window, usize)> {
    let gain = |c: usize| screen.seen[c].gain;
    windows
        .chunk_by(|a, b| a.local == b.local)
        .scan(regular, |first, of_one| {
            let places = of_one.iter().zip(*first..);
            *first += of_one.len();
            let usable = places.filter(|(_, c)| screen.seen[*c].usable);
            Some(usable.max_by(|a, b| gain(a.1).total_cmp(&gain(b.1))))
        })
        .flatten()
        .collect()
}

/// Correlation of two columns by their products, at most 1 in magnitude.
fn correlation([aa, ab, bb]: [f64; 3]) -> f64 {
    match aa > 0.0 && bb > 0.0 {
        true => (ab / (aa * bb).sqrt()).clamp(-1.0, 1.0),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_correlation_exceeds_one_however_much_noise_is_taken_off() {
        // From products [1, -1, 1] and [4, 2, 4] noises of 0.05 and 0 are subtracted.
        assert_eq!(correlation([0.95, -1.0, 0.95]), -1.0);
        assert_eq!(correlation([4.0, 2.0, 4.0]), 0.5);
        assert_eq!(correlation([-0.1, 0.2, 1.0]), 0.0);
    }
}
