//! The track channel: errors of the slope and of the accelerometer, with the surveyed profile as a
//! random effect.
//!
//! The residual `dv/dt - g sin(slope) - a_x cos(beta) - a_y sin(beta)` contains no friction.
//! Residuals are averaged over runs in bins of distance. A bin's mean has the variance of its runs'
//! scatter plus that of the survey, (g sd)^2, which does not decrease with the number of runs.
//! Neighbouring bins are correlated; their lag-1 correlation is estimated.

use kufe_sled::GRAVITY;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::model::installation::{Information, Installation};
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::track::bins::{between_drivers, by_bin, mean};
use crate::evidence::runs::screen::track::chance::{
    angle, inflation, minimise, p_value_of_maximum, two_sided,
};
use crate::procedure::candidate::Candidate;
use crate::procedure::rules::RunRules;

/// Number of bins on either side over which the scatter between drivers is averaged.
const NEIGHBOURS: usize = 3;

/// Scores of a candidate of the track channel, for one survey deviation.
#[derive(Clone, Debug)]
pub struct TrackScore {
    pub size: f64,
    pub error: f64,
    /// Two-sided p-value times the number of candidates.
    pub p_value: f64,
}

/// Bin means of the track channel and the candidates that are tested in it.
#[derive(Clone)]
pub struct TrackChannel {
    /// Bin means, by bin: track, from [m], mean [m/s2], variance of the mean.
    bins: Vec<(String, f64, f64, f64)>,
    /// Rows of each run.
    rows: Vec<Vec<f64>>,
    /// Change of each bin by each candidate per unit, at the candidate's fitted size.
    directions: Vec<Vec<f64>>,
    /// Angle through which the direction of each candidate turns over its sizes [rad].
    turns: Vec<f64>,
    /// Standard deviation of each candidate due to installation errors, in its unit.
    tolerances: Vec<f64>,
    /// Inflation of the variance of means over bins by their correlation.
    inflation: f64,
    /// Root mean square scatter of single runs about the bins' means [m/s2].
    scatter: f64,
    /// Width of a bin [m].
    width: f64,
}

fn rows_of(residual_model: &ResidualModel, frames: &[Frame]) -> Vec<Vec<f64>> {
    let of_run = |frame: &Frame| frame.rows(&residual_model.track_residual(frame));
    frames.par_iter().map(of_run).collect()
}

impl TrackChannel {
    /// Averages residuals over bins; `None` without a survey and with fewer than eight bins.
    pub fn new(residual_model: &ResidualModel, frames: &[Frame], rules: &RunRules) -> Option<Self> {
        let (width, reach) = (rules.track_bin_m, NEIGHBOURS);
        if frames.iter().any(|f| f.slope.len() != f.len()) {
            return None;
        }
        let rows = rows_of(residual_model, frames);
        let mut bins = Vec::new();
        let (mut scatter, mut by_driver) = (Vec::new(), Vec::new());
        for ((track, bin), runs) in &by_bin(frames, &rows, width) {
            let (m, n) = (mean(runs), runs.len() as f64);
            let variance = runs.iter().map(|(_, r)| (r - m).powi(2)).sum::<f64>() / (n - 1.0);
            scatter.push(variance);
            by_driver.push(between_drivers(runs));
            bins.push(((*track).to_owned(), *bin as f64 * width, m, n));
        }
        if bins.len() < 8 {
            return None;
        }
        let common = scatter.iter().sum::<f64>() / scatter.len() as f64;
        // A driver repeats his line: each driver counts as one run, by the scatter near the bin.
        for k in 0..bins.len() {
            let near = k.saturating_sub(reach)..(k + reach + 1).min(bins.len());
            let there: Vec<f64> = near
                .filter(|j| bins[*j].0 == bins[k].0)
                .filter_map(|j| by_driver[j])
                .collect();
            let of_drivers = there.iter().sum::<f64>() / there.len().max(1) as f64;
            bins[k].3 = of_drivers.max(common / bins[k].3);
        }
        let means: Vec<f64> = bins.iter().map(|b| b.2).collect();
        Some(Self {
            inflation: inflation(&bins, &means),
            bins,
            rows,
            directions: Vec::new(),
            turns: Vec::new(),
            tolerances: Vec::new(),
            scatter: common.sqrt(),
            width,
        })
    }

    /// Adds a candidate, whose standard deviation due to installation errors is `tolerance`. Its
    /// change per unit is evaluated at its best nonlinear size: a delay of the speed of a tenth of
    /// a second is poorly approximated to first order.
    pub fn add_candidate(
        &mut self,
        residual_model: &ResidualModel,
        frames: &[Frame],
        candidate: &Candidate<Amplitude>,
        [tolerance, slope_sd]: [f64; 2],
    ) {
        /// Ratio of successive trial sizes: a wave of the slope that is ten times as long as its
        /// shift remains resolved.
        const RATIO: f64 = 1.4;
        /// Relative accuracy of the best size, far below its error.
        const ACCURACY: f64 = 0.01;
        let small = 0.01 * candidate.typical;
        let change = |size: f64| self.change(residual_model, frames, candidate, size);
        let per_unit = |size: f64| -> Vec<f64> { change(size).iter().map(|x| x / size).collect() };
        let w = self.weights(slope_sd);
        let misfit = |change: &[f64]| -> f64 {
            let both = self.bins.iter().zip(change).zip(&w);
            both.map(|((bin, change), w)| w * (bin.2 - change).powi(2))
                .sum()
        };
        let direct = per_unit(small);
        let both = self.bins.iter().zip(&direct).zip(&w);
        let [score, information] = both.fold([0.0; 2], |[s, i], ((bin, d), w)| {
            [s + w * d * bin.2, i + w * d * d]
        });
        let mut sizes = vec![score / information.max(1e-300)];
        let [low, high] = [candidate.low, candidate.high].map(|bound| 0.5 * bound);
        let largest = if high > -low { high } else { low };
        // The change per unit of a linear candidate is the same at any size.
        let at_largest = per_unit(largest);
        let both = at_largest.iter().zip(&direct).zip(&w);
        let nonlinearity: f64 = both.map(|((far, d), w)| w * (far - d).powi(2)).sum();
        let mut trial = 0.1 * candidate.typical;
        while trial <= largest.abs() && nonlinearity > ACCURACY * ACCURACY * information {
            sizes.extend([trial, -trial]);
            trial *= RATIO;
        }
        sizes.retain(|size| (low..=high).contains(size) && size.abs() > small);
        sizes.sort_by(f64::total_cmp);
        let changes: Vec<Vec<f64>> = sizes.par_iter().map(|size| change(*size)).collect();
        let best =
            (0..sizes.len()).min_by(|a, b| misfit(&changes[*a]).total_cmp(&misfit(&changes[*b])));
        let exact = best.map(|k| {
            let interval = [sizes[k] / RATIO, sizes[k] * RATIO];
            per_unit(minimise(
                |size| misfit(&change(size)),
                interval,
                ACCURACY * sizes[k].abs(),
            ))
        });
        let steps = changes.windows(2);
        self.turns
            .push(steps.map(|pair| angle(&pair[0], &pair[1], &w)).sum());
        self.tolerances.push(tolerance);
        self.directions.push(exact.unwrap_or(direct));
    }

    /// Change of each bin's mean by a candidate of this size.
    fn change(
        &self,
        residual_model: &ResidualModel,
        frames: &[Frame],
        candidate: &Candidate<Amplitude>,
        size: f64,
    ) -> Vec<f64> {
        self.change_to(&residual_model.with(candidate.active(size)), frames)
    }

    /// Change of each bin's mean by another model.
    fn change_to(&self, moved: &ResidualModel, frames: &[Frame]) -> Vec<f64> {
        let moved = rows_of(moved, frames);
        let of_run = |(rest, moved): (&Vec<f64>, &Vec<f64>)| {
            rest.iter().zip(moved).map(|(r, m)| r - m).collect()
        };
        let change: Vec<Vec<f64>> = self.rows.iter().zip(&moved).map(of_run).collect();
        let means = by_bin(frames, &change, self.width);
        means.values().map(|runs| mean(runs)).collect()
    }

    /// Closure error: root mean square of the bins' means as a slope [rad], less their scatter.
    pub fn closure(&self) -> f64 {
        let n = self.bins.len() as f64;
        let square = self.bins.iter().map(|b| b.2 * b.2 - b.3).sum::<f64>() / n;
        square.max(0.0).sqrt() / GRAVITY
    }

    /// Root mean square scatter of single runs about the bins' means [m/s2].
    pub fn scatter(&self) -> f64 {
        self.scatter
    }

    /// Information on tilt-like installation errors, for a model with none of them.
    ///
    /// With y the means of the bins, d their change by one standard deviation of an installation
    /// error and W the inverse covariance of the means, the information is `d' W d` and the score
    /// `d' W y`, both divided by the excess scatter of the means. The covariance contains the
    /// scatter of the means, an independent survey error of each place, and an equal one common to
    /// all places.
    pub fn information(
        &self,
        bare: &ResidualModel,
        frames: &[Frame],
        stated: &Installation,
        slope_sd: f64,
    ) -> Information {
        let count = stated.errors.len();
        let mut directions = DMatrix::zeros(self.bins.len(), count);
        for error in (0..count).filter(|error| stated.errors[*error].is_tilt()) {
            let moved = ResidualModel {
                installation: stated.moved(error, 1.0),
                ..bare.clone()
            };
            let change = DVector::from_vec(self.change_to(&moved, frames));
            directions.set_column(error, &change);
        }
        let w = DVector::from_vec(self.weights(slope_sd));
        let means = DVector::from_iterator(self.bins.len(), self.bins.iter().map(|bin| bin.2));
        let common_variance = 1.0 / (1.0 / (GRAVITY * slope_sd).powi(2) + w.sum());
        // W x, by the Sherman-Morrison formula.
        let weighted = |x: DVector<f64>| {
            let common = common_variance * w.dot(&x);
            w.component_mul(&x.add_scalar(-common))
        };
        let offset = w.dot(&means) / w.sum();
        let squares = w.dot(&means.map(|m| (m - offset).powi(2)));
        let scatter = (squares / (self.bins.len() as f64 - 1.0)).max(1.0) * self.inflation;
        let columns: Vec<DVector<f64>> = (0..count)
            .map(|error| weighted(directions.column(error).into_owned()))
            .collect();
        let weighed_directions = DMatrix::from_columns(&columns);
        Information {
            precision: directions.tr_mul(&weighed_directions) / scatter,
            scores: weighed_directions.tr_mul(&means) / scatter,
        }
    }

    /// Inverse variance of each bin's mean, including the survey's.
    fn weights(&self, slope_sd: f64) -> Vec<f64> {
        let survey = (GRAVITY * slope_sd).powi(2);
        self.bins
            .iter()
            .map(|b| 1.0 / (b.3 + survey).max(1e-30))
            .collect()
    }

    /// Scores candidate `c` for a survey deviation [rad].
    pub fn score(&self, c: usize, slope_sd: f64) -> TrackScore {
        let w = self.weights(slope_sd);
        let d = &self.directions[c];
        let information: f64 = d.iter().zip(&w).map(|(d, w)| d * d * w).sum();
        let score: f64 = d
            .iter()
            .zip(&w)
            .zip(&self.bins)
            .map(|((d, w), b)| d * w * b.2)
            .sum();
        let size = score / information.max(1e-300);
        let [scatter, null_scatter] = self.excess_scatter(d, size, &w);
        let error = |scatter: f64| {
            let statistical = (scatter / information.max(1e-300)).sqrt();
            statistical.hypot(self.tolerances[c])
        };
        let p = p_value_of_maximum(size / error(null_scatter), self.turns[c]);
        TrackScore {
            size,
            error: error(scatter),
            p_value: (p * self.directions.len() as f64).min(1.0),
        }
    }

    /// Excess variance about a candidate of this size, and under the null hypothesis: Birge's ratio
    /// squared, at least 1, times the inflation by correlation, as a profile error along the track
    /// correlates with any candidate by chance.
    ///
    /// The fit of the best of many sizes lowers the correlation of neighbours: under the null
    /// hypothesis the inflation is at least the one before the fit.
    fn excess_scatter(&self, direction: &[f64], size: f64, w: &[f64]) -> [f64; 2] {
        let both = self.bins.iter().zip(direction);
        let residual: Vec<f64> = both.map(|(b, d)| b.2 - d * size).collect();
        let squares: f64 = residual
            .iter()
            .zip(w)
            .map(|(residual, w)| w * residual * residual)
            .sum();
        let birge = (squares / (self.bins.len() as f64 - 1.0)).max(1.0);
        let inflation = inflation(&self.bins, &residual);
        [birge * inflation, birge * inflation.max(self.inflation)]
    }

    /// z of candidate `a` given `b`.
    pub fn t_given(&self, a: usize, b: usize, slope_sd: f64) -> f64 {
        let w = self.weights(slope_sd);
        let dot = |x: &[f64], y: &[f64]| -> f64 {
            x.iter().zip(y).zip(&w).map(|((x, y), w)| x * y * w).sum()
        };
        let y: Vec<f64> = self.bins.iter().map(|bin| bin.2).collect();
        let (x, z) = (&self.directions[a], &self.directions[b]);
        let zz = dot(z, z).max(1e-300);
        let information = dot(x, x) - dot(x, z).powi(2) / zz;
        if information < 1e-6 * dot(x, x) {
            return 0.0;
        }
        let size = dot(x, &y) / dot(x, x);
        let [scatter, _] = self.excess_scatter(x, size, &w);
        (dot(x, &y) - dot(x, z) * dot(z, &y) / zz) / (information * scatter).sqrt()
    }

    /// Correlation of two candidates over the bins.
    pub fn correlation(&self, a: usize, b: usize, slope_sd: f64) -> f64 {
        let w = self.weights(slope_sd);
        let dot = |x: &[f64], y: &[f64]| -> f64 {
            x.iter().zip(y).zip(&w).map(|((x, y), w)| x * y * w).sum()
        };
        let (x, z) = (&self.directions[a], &self.directions[b]);
        dot(x, z) / (dot(x, x) * dot(z, z)).sqrt().max(1e-300)
    }

    /// Tests the profile against the survey, given a common slope, as a whole and in every interval
    /// (Bonferroni).
    ///
    /// Returns the p-value, the interval of largest mean departure (track, from, to [m], slope
    /// error [rad]) and the survey deviation that would explain it [rad].
    pub fn profile(&self, slope_sd: f64) -> (f64, String, f64, f64, f64, f64) {
        let w = self.weights(slope_sd);
        let total: f64 = w.iter().sum();
        let mean = self.bins.iter().zip(&w).map(|(b, w)| b.2 * w).sum::<f64>() / total;
        let chi2: f64 = self
            .bins
            .iter()
            .zip(&w)
            .map(|(b, w)| (b.2 - mean).powi(2) * w)
            .sum();
        // The effective number of correlated bins is smaller: statistic and degrees of freedom are
        // divided by the inflation.
        let n = self.bins.len() as f64;
        let freedom = ((n - 1.0) / self.inflation).max(2.0);
        let p =
            ChiSquared::new(freedom).map_or(1.0, |law| 1.0 - law.cdf(chi2 * freedom / (n - 1.0)));
        let mut best = (String::new(), 0.0, 0.0, 0.0, 0.0_f64);
        let survey = (GRAVITY * slope_sd).powi(2);
        let (mut largest, mut count) = (0.0_f64, 0.0);
        for width in [1, 2, 4, 8] {
            for window in self.bins.windows(width) {
                if window[0].0 != window[width - 1].0 {
                    continue;
                }
                let m = window.iter().map(|b| b.2 - mean).sum::<f64>() / width as f64;
                // A survey error may be common to an interval; errors of runs are correlated in
                // neighbouring bins only.
                let own = window.iter().map(|b| b.3).sum::<f64>() / (width * width) as f64;
                let reach = (width as f64).min(self.inflation);
                largest = largest.max(m.abs() / (survey + own * reach).sqrt());
                count += 1.0;
                let strength = m.abs() * (width as f64).sqrt();
                if strength > best.4 {
                    best = (
                        window[0].0.clone(),
                        window[0].1,
                        window[width - 1].1 + self.width,
                        m / -GRAVITY,
                        strength,
                    );
                }
            }
        }
        let excess = self
            .bins
            .iter()
            .map(|b| (b.2 - mean).powi(2) - b.3)
            .sum::<f64>()
            / n;
        // A single interval hardly changes the sum: the largest departure is tested separately.
        let p = p.min(two_sided(largest) * count);
        // The residual is dv/dt - g slope: a residual of +1 is a slope stated too small.
        (
            p,
            best.0,
            best.1,
            best.2,
            -best.3,
            excess.max(0.0).sqrt() / GRAVITY,
        )
    }
}
