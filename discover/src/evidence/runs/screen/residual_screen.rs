//! One screen of the residuals: score tests of every candidate, with scores corrected for noisy
//! inputs and p-values by sign-flips.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::noise_products::mean_noise_products;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::{Design, Products};
use crate::evidence::runs::model::windows::Window;
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::Detectable;
use crate::null::clusters::session_numbers;
use crate::null::sign_flips::MaxT;
use crate::procedure::candidate::Candidate;
use crate::regression::prior::Prior;
use crate::regression::scores::{Scores, cross_information};

/// Options of a screen.
#[derive(Clone, Copy, Debug)]
pub struct ScreenOptions {
    /// Pairs of simulated runs per run.
    pub pairs: u64,
    /// Number of sign-flips.
    pub flips: usize,
    /// Largest p-value of a selected effect of the catalogue, also in a window of distance.
    pub alpha: f64,
    /// Largest p-value of a selected effect outside the catalogue.
    pub alpha_column: f64,
    /// Smallest share of a column's information that remains after a refit of the base, and
    /// smallest share that is not noise.
    pub min_shares: [f64; 2],
    /// Excess over the critical value of a size with a power of 90 %, in standard errors.
    pub nine_in_ten: f64,
    pub seed: u64,
}

impl ScreenOptions {
    /// Largest p-value of a candidate that is selected.
    pub fn alpha_of(&self, candidate: &Candidate<Amplitude>) -> f64 {
        if candidate.is_column() {
            self.alpha_column
        } else {
            self.alpha
        }
    }
}

/// Scores of a candidate or window.
#[derive(Clone, Debug)]
pub struct CandidateScore {
    /// Share of its column that remains after a refit of the base.
    pub remaining_share: f64,
    pub size: f64,
    pub error: f64,
    /// T: the ratio of the sum of its scores to their standard deviation.
    pub t: f64,
    /// Ratio of the noise correction of the sum to the standard error of the sum.
    pub bias_t: f64,
    /// p-value by sign-flips, max-T over its kind.
    pub p_value: f64,
    /// p-value by a wild bootstrap over sessions; `None` with a single session.
    pub p_sessions: Option<f64>,
    /// Explained sum of squares, in units of the noise's variance.
    pub gain: f64,
    pub cross_validated_gain: f64,
    /// Smallest size that would be selected with a probability of 90 %.
    pub detectable: f64,
    /// Whether the data determine it well enough to be tested.
    pub usable: bool,
}

/// Results of a screen.
pub struct RunScreen {
    /// Scores of the regular candidates, then of the windows.
    pub scores: Vec<CandidateScore>,
    /// Scores by run of candidates and windows.
    pub by_run: Scores,
    /// Information matrix of the regular candidates given the base.
    pub cross: DMatrix<f64>,
}

/// Candidates and windows, and the products of all columns.
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
    /// The candidates of a design, with a noise correction from `pairs` pairs of simulations of
    /// each run.
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
            noise: mean_noise_products(design, frames, simulator, pairs),
        }
    }

    fn typical(&self, c: usize) -> f64 {
        match self.regular.get(c) {
            Some(candidate) => candidate.typical,
            None => self.local[self.windows[c - self.regular.len()].local].typical,
        }
    }
}

/// Scores and tests all candidates and windows.
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
    let grams = products.iter().zip(noise).map(|(p, d)| p.corrected(d));
    let grams: Vec<_> = grams.collect();
    let scores = Scores::new(&grams, prior);
    let plain: Vec<_> = products.iter().map(Products::plain).collect();
    let plain = Scores::new(&plain, prior);
    let (count, runs) = scores.u.shape();
    let regular = tested.regular.len();
    let usable = usable(tested, [&scores, &plain], frames, options);
    let norms = window_norms(&scores, &usable, tested);
    let named = tested.regular.iter().filter(|c| !c.is_column()).count();
    assert!(
        tested.regular[named..].iter().all(Candidate::is_column),
        "candidates outside the catalogue come last"
    );
    // Three families of candidates: the catalogue, columns outside it, places.
    let of_family = |rows: Range<usize>| {
        let rows: Vec<usize> = rows.collect();
        let mut family = scores.only(&rows);
        for (row, _) in rows.iter().enumerate().filter(|(_, c)| !usable[**c]) {
            family.information.row_mut(row).fill(0.0);
        }
        family
    };
    let [known, columns, places] = [0..named, named..regular, regular..count].map(of_family);
    let (flips, seed) = (options.flips, options.seed);
    let of_windows = (regular..).zip(&norms).map(|(c, norm)| {
        if *norm > 0.0 {
            scores.sum(c) / norm
        } else {
            0.0
        }
    });
    let null_of_windows = MaxT::with_norms(
        &without_estimated_effect(&places),
        &norms,
        &places.common,
        flips,
        seed ^ 0x10CA,
    );
    let sessions = session_numbers(frames.iter().map(|frame| frame.session.as_str()));
    let by_sessions = |family: &Scores| by_sessions(family, &sessions, options);
    let families = [
        Family {
            alpha: options.alpha,
            null: known.by_sign_flips(flips, seed),
            t: known.t(),
            p_sessions: by_sessions(&known),
        },
        Family {
            alpha: options.alpha_column,
            null: columns.by_sign_flips(flips, seed ^ 0xBE40),
            t: columns.t(),
            p_sessions: by_sessions(&columns),
        },
        Family {
            alpha: options.alpha,
            null: null_of_windows,
            t: of_windows.collect(),
            p_sessions: by_sessions(&places),
        },
    ];
    let members = families.iter().flat_map(|family| {
        let critical = family.null.critical(family.alpha);
        let members = family.t.iter().zip(&family.p_sessions);
        members.map(move |(t, p_sessions)| (&family.null, critical, *t, *p_sessions))
    });
    let candidate_scores = members
        .enumerate()
        .map(|(c, (null, critical, t, p_sessions))| {
            let information = scores.total_information(c).max(1e-300);
            let scale = tested.typical(c);
            let sum = scores.sum(c);
            let size = sum / information;
            let n = runs as f64;
            let squares: f64 = (0..runs)
                .map(|i| (scores.u[(c, i)] - size * scores.information[(c, i)]).powi(2))
                .sum();
            let scatter = squares * n / (n - 1.0).max(1.0);
            let error = (scatter + scores.shared_variance(c)).sqrt() / information;
            CandidateScore {
                remaining_share: scores.remaining_share(c),
                size: size * scale,
                error: error * scale,
                t,
                bias_t: (plain.sum(c) - sum) / (error * information).max(1e-300),
                p_value: if usable[c] { null.p_value(t) } else { 1.0 },
                p_sessions,
                gain: sum * sum / information,
                cross_validated_gain: cross_validated_gain(&scores, c),
                detectable: (critical + options.nine_in_ten) * error * scale,
                usable: usable[c],
            }
        })
        .collect();
    RunScreen {
        scores: candidate_scores,
        by_run: scores,
        cross: cross_information(&grams, prior),
    }
}

/// Candidates whose largest statistic is tested.
struct Family {
    /// Largest p-value of a selected one.
    alpha: f64,
    /// Null distribution of the largest statistic.
    null: MaxT,
    /// Statistic of each candidate.
    t: Vec<f64>,
    /// p-value of each candidate by a wild bootstrap over sessions; `None` with a single session.
    p_sessions: Vec<Option<f64>>,
}

/// p-value of each candidate of a family with only sessions independent.
fn by_sessions(family: &Scores, sessions: &[usize], options: &ScreenOptions) -> Vec<Option<f64>> {
    let Some(of_sessions) = family.by_sessions(sessions) else {
        return vec![None; family.u.nrows()];
    };
    let null = of_sessions.by_wild_bootstrap(options.flips, options.seed);
    let t = of_sessions.t().into_iter();
    t.map(|t| Some(null.p_value(t))).collect()
}

/// Whether the data determine each candidate and window well enough to be tested, from the scores
/// with and without correction for noise.
fn usable(
    tested: &CandidateProducts,
    [scores, plain]: [&Scores; 2],
    frames: &[Frame],
    options: &ScreenOptions,
) -> Vec<bool> {
    let [min_remaining, min_signal] = options.min_shares;
    let is_usable = |c: usize| {
        let information = scores.total_information(c);
        let of_runs = scores.information.row(c);
        let runs = of_runs.iter().filter(|i| **i > 1e-9).count();
        let enough = match c.checked_sub(tested.regular.len()) {
            // A direction that is mostly noise is excluded.
            None => information > min_signal * plain.total_information(c),
            Some(w) => {
                let track = &tested.windows[w].track;
                2 * runs > frames.iter().filter(|f| f.track == *track).count()
            }
        };
        scores.remaining_share(c) > min_remaining && information > 1e-6 && runs >= 4 && enough
    };
    (0..scores.u.nrows()).map(is_usable).collect()
}

/// Scores of windows minus the contribution of the window's estimated size, rescaled for the lost
/// degree of freedom.
///
/// The few runs on a track have few sign patterns, and the windows share their norms. An effect in
/// the data would otherwise appear in its own null distribution, with seven ninths of its T if one
/// of nine signs is flipped. The remaining scores scatter as noise does.
fn without_estimated_effect(windows: &Scores) -> DMatrix<f64> {
    let mut u = windows.u.clone();
    for c in 0..u.nrows() {
        let of_runs = windows.information.row(c);
        let runs = of_runs.iter().filter(|i| **i > 1e-9).count() as f64;
        let information = windows.total_information(c);
        if information <= 0.0 || runs < 2.0 {
            continue;
        }
        let size = windows.u.row(c).sum() / information;
        let rescaling = (runs / (runs - 1.0)).sqrt();
        for i in 0..u.ncols() {
            u[(c, i)] = rescaling * (u[(c, i)] - size * of_runs[i]);
        }
    }
    u
}

/// Standard deviations of the sums of scores of windows; 0 for an unusable window. They follow from
/// the window's information and the median scatter of the windows of its candidate, because the few
/// runs on one track do not determine a scatter for each window.
fn window_norms(scores: &Scores, usable: &[bool], tested: &CandidateProducts) -> Vec<f64> {
    let regular = tested.regular.len();
    let mut norms = vec![0.0; scores.u.nrows() - regular];
    for l in 0..tested.local.len() {
        let of_candidate: Vec<usize> = (0..norms.len())
            .filter(|w| usable[regular + w] && tested.windows[*w].local == l)
            .collect();
        let information = |w: usize| scores.total_information(regular + w);
        let inflation = |w: &usize| scores.u.row(regular + w).norm_squared() / information(*w);
        let mut inflation: Vec<f64> = of_candidate.iter().map(inflation).collect();
        inflation.sort_by(f64::total_cmp);
        let Some(median) = inflation.get(inflation.len() / 2) else {
            continue;
        };
        // The contribution of random effects is common to all runs.
        for w in &of_candidate {
            let common = scores.shared_variance(regular + w);
            norms[*w] = (median * information(*w) + common).sqrt();
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
    /// The screen of the selected regular candidates alone.
    pub fn only(&self, selected: &[usize]) -> Self {
        let pairs = |i: usize, j: usize| self.cross[(selected[i], selected[j])];
        Self {
            scores: selected.iter().map(|c| self.scores[*c].clone()).collect(),
            by_run: self.by_run.only(selected),
            cross: DMatrix::from_fn(selected.len(), selected.len(), pairs),
        }
    }

    /// T of regular candidate `a` given `b`.
    pub fn t_given(&self, a: usize, b: usize) -> f64 {
        let share = self.cross[(a, b)] / self.cross[(b, b)].max(1e-300);
        self.by_run.t_of_difference(a, b, share)
    }

    /// Correlation of two regular candidates given the base, corrected for noise.
    ///
    /// Corrected products are estimates: for two almost collinear columns they may violate the
    /// Cauchy-Schwarz inequality. The nearest valid matrix of products has a correlation of 1 in
    /// magnitude.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        correlation([self.cross[(a, a)], self.cross[(a, b)], self.cross[(b, b)]])
    }

    /// Detectable size of each usable candidate of a list, and its most similar rival.
    pub fn detectable(&self, list: &[Candidate<Amplitude>]) -> Vec<Detectable> {
        let usable = |c: &usize| self.scores[*c].usable;
        let detectable = |c: usize| {
            let others = (0..list.len()).filter(usable);
            let others = others.filter(|j| list[*j].effect != list[c].effect);
            let others = others.map(|j| (&list[j], self.correlation(c, j)));
            let seen = &self.scores[c];
            list[c].detectable(seen.detectable, seen.remaining_share, others)
        };
        (0..list.len()).filter(usable).map(detectable).collect()
    }

    /// Whether a candidate may be selected.
    pub fn is_selectable(&self, c: usize, candidate: &Candidate<Amplitude>, alpha: f64) -> bool {
        let s = &self.scores[c];
        s.usable && s.p_value <= alpha && s.cross_validated_gain > 0.0 && candidate.admits(s.size)
    }
}

/// The usable window of largest gain of each local candidate, with its index in the screen.
pub fn best_windows<'w>(
    screen: &RunScreen,
    windows: &'w [Window],
    regular: usize,
) -> Vec<(&'w Window, usize)> {
    let gain = |c: usize| screen.scores[c].gain;
    windows
        .chunk_by(|a, b| a.local == b.local)
        .scan(regular, |first, of_one| {
            let places = of_one.iter().zip(*first..);
            *first += of_one.len();
            let usable = places.filter(|(_, c)| screen.scores[*c].usable);
            Some(usable.max_by(|a, b| gain(a.1).total_cmp(&gain(b.1))))
        })
        .flatten()
        .collect()
}

/// Correlation of two columns by their products, at most 1 in magnitude.
fn correlation([aa, ab, bb]: [f64; 3]) -> f64 {
    if aa > 0.0 && bb > 0.0 {
        (ab / (aa * bb).sqrt()).clamp(-1.0, 1.0)
    } else {
        0.0
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
