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
use crate::evidence::runs::screen::track::bins::{Bin, DriverMean, between_drivers, by_bin, mean};
use crate::evidence::runs::screen::track::significance::{
    angle, inflation, minimise, p_value_of_maximum, two_sided, weighted_dot,
};
use crate::procedure::candidate::Candidate;
use crate::procedure::rules::RunRules;

/// Number of bins on either side over which the scatter between drivers is averaged.
const NEIGHBOURS: usize = 3;

/// A candidate that is tested in the track channel.
#[derive(Clone)]
struct TrackCandidate {
    /// Change of each bin's mean per unit, at the candidate's fitted size.
    direction: Vec<f64>,
    /// Angle through which the direction turns over the candidate's sizes [rad].
    turn_rad: f64,
    /// Standard deviation due to installation errors, in the candidate's unit.
    tolerance: f64,
}

/// Departure of the profile of a track from its survey.
pub struct ProfileDeparture {
    pub p_value: f64,
    /// Track and interval of the largest mean departure [m].
    pub track: String,
    pub from_m: f64,
    pub to_m: f64,
    /// Slope error there [rad].
    pub slope: f64,
    /// Survey deviation that would explain the departures [rad].
    pub needed_sd: f64,
}

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
    bins: Vec<Bin>,
    /// Rows of each run.
    rows: Vec<Vec<f64>>,
    candidates: Vec<TrackCandidate>,
    /// Inflation of the variance of means over bins by their correlation.
    inflation: f64,
    /// Root mean square scatter of single runs about the bins' means [m/s2].
    pub scatter: f64,
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
        let width = rules.track_bin_m;
        if frames.iter().any(|f| f.slope.len() != f.len()) {
            return None;
        }
        let rows = rows_of(residual_model, frames);
        let by_bin = by_bin(frames, &rows, width);
        if by_bin.len() < 8 {
            return None;
        }
        let scatter = |runs: &Vec<DriverMean>| {
            let (m, n) = (mean(runs), runs.len() as f64);
            runs.iter().map(|(_, r)| (r - m).powi(2)).sum::<f64>() / (n - 1.0)
        };
        let common = by_bin.values().map(scatter).sum::<f64>() / by_bin.len() as f64;
        let tracks: Vec<&str> = by_bin.keys().map(|(track, _)| *track).collect();
        let by_driver: Vec<_> = by_bin.values().map(|runs| between_drivers(runs)).collect();
        // A driver repeats his line: each driver counts as one run, by the scatter near the bin.
        let variance_near = |k: usize, runs: f64| {
            let near = k.saturating_sub(NEIGHBOURS)..(k + NEIGHBOURS + 1).min(tracks.len());
            let near = near.filter(|j| tracks[*j] == tracks[k]);
            let of_drivers: Vec<f64> = near.filter_map(|j| by_driver[j]).collect();
            let of_drivers = of_drivers.iter().sum::<f64>() / of_drivers.len().max(1) as f64;
            of_drivers.max(common / runs)
        };
        let bins = by_bin
            .iter()
            .enumerate()
            .map(|(k, ((track, bin), runs))| Bin {
                track: (*track).to_owned(),
                from_m: *bin as f64 * width,
                mean: mean(runs),
                variance: variance_near(k, runs.len() as f64),
            });
        let bins: Vec<Bin> = bins.collect();
        let means: Vec<f64> = bins.iter().map(|bin| bin.mean).collect();
        Some(Self {
            inflation: inflation(&bins, &means),
            bins,
            rows,
            candidates: Vec::new(),
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
        let change = |size: f64| {
            let moved = residual_model.with(candidate.active(size));
            self.change_to(&moved, frames)
        };
        let per_unit = |size: f64| -> Vec<f64> { change(size).iter().map(|x| x / size).collect() };
        let w = self.weights(slope_sd);
        let misfit = |change: &[f64]| -> f64 {
            let both = self.bins.iter().zip(change).zip(&w);
            both.map(|((bin, change), w)| w * (bin.mean - change).powi(2))
                .sum()
        };
        let direct = per_unit(small);
        let both = self.bins.iter().zip(&direct).zip(&w);
        let [score, information] = both.fold([0.0; 2], |[s, i], ((bin, d), w)| {
            [s + w * d * bin.mean, i + w * d * d]
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
            let tolerance = ACCURACY * sizes[k].abs();
            per_unit(minimise(|size| misfit(&change(size)), interval, tolerance))
        });
        let steps = changes.windows(2).map(|pair| angle(&pair[0], &pair[1], &w));
        self.candidates.push(TrackCandidate {
            turn_rad: steps.sum(),
            tolerance,
            direction: exact.unwrap_or(direct),
        });
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
        let excess = self.bins.iter().map(|b| b.mean * b.mean - b.variance);
        let square = excess.sum::<f64>() / self.bins.len() as f64;
        square.max(0.0).sqrt() / GRAVITY
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
                installation: stated.with_error_changed(error, 1.0),
                ..bare.clone()
            };
            let change = DVector::from_vec(self.change_to(&moved, frames));
            directions.set_column(error, &change);
        }
        let w = DVector::from_vec(self.weights(slope_sd));
        let means = DVector::from_iterator(self.bins.len(), self.bins.iter().map(|bin| bin.mean));
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
        let weight = |bin: &Bin| 1.0 / (bin.variance + survey).max(1e-30);
        self.bins.iter().map(weight).collect()
    }

    /// Scores candidate `c` for a survey deviation [rad].
    pub fn score(&self, c: usize, slope_sd: f64) -> TrackScore {
        let w = self.weights(slope_sd);
        let candidate = &self.candidates[c];
        let d = &candidate.direction;
        let information = weighted_dot(d, d, &w);
        let weighted = d.iter().zip(&w).zip(&self.bins);
        let score: f64 = weighted.map(|((d, w), bin)| d * w * bin.mean).sum();
        let size = score / information.max(1e-300);
        let [scatter, null_scatter] = self.excess_scatter(d, size, &w);
        let error = |scatter: f64| {
            let statistical = (scatter / information.max(1e-300)).sqrt();
            statistical.hypot(candidate.tolerance)
        };
        let p = p_value_of_maximum(size / error(null_scatter), candidate.turn_rad);
        TrackScore {
            size,
            error: error(scatter),
            p_value: (p * self.candidates.len() as f64).min(1.0),
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
        let residual: Vec<f64> = both.map(|(bin, d)| bin.mean - d * size).collect();
        let weighted = residual.iter().zip(w);
        let squares: f64 = weighted.map(|(r, w)| w * r * r).sum();
        let birge = (squares / (self.bins.len() as f64 - 1.0)).max(1.0);
        let inflation = inflation(&self.bins, &residual);
        [birge * inflation, birge * inflation.max(self.inflation)]
    }

    /// z of candidate `a` given `b`.
    pub fn t_given(&self, a: usize, b: usize, slope_sd: f64) -> f64 {
        let w = self.weights(slope_sd);
        let dot = |x: &[f64], y: &[f64]| weighted_dot(x, y, &w);
        let y: Vec<f64> = self.bins.iter().map(|bin| bin.mean).collect();
        let [x, z] = [a, b].map(|c| &self.candidates[c].direction);
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
        let dot = |x: &[f64], y: &[f64]| weighted_dot(x, y, &w);
        let [x, z] = [a, b].map(|c| &self.candidates[c].direction);
        dot(x, z) / (dot(x, x) * dot(z, z)).sqrt().max(1e-300)
    }

    /// Tests the profile against the survey, given a common slope, as a whole and in every interval
    /// (Bonferroni).
    pub fn profile(&self, slope_sd: f64) -> ProfileDeparture {
        let w = self.weights(slope_sd);
        let total: f64 = w.iter().sum();
        let weighted = || self.bins.iter().zip(&w);
        let mean = weighted().map(|(b, w)| b.mean * w).sum::<f64>() / total;
        let departure = |bin: &Bin| bin.mean - mean;
        let mean_departure =
            |bins: &[Bin]| bins.iter().map(departure).sum::<f64>() / bins.len() as f64;
        let squares = weighted().map(|(b, w)| departure(b).powi(2) * w);
        let chi2: f64 = squares.sum();
        // The effective number of correlated bins is smaller: statistic and degrees of freedom are
        // divided by the inflation.
        let n = self.bins.len() as f64;
        let freedom = ((n - 1.0) / self.inflation).max(2.0);
        let chi2 = chi2 * freedom / (n - 1.0);
        let p_of_whole = ChiSquared::new(freedom).map_or(1.0, |law| 1.0 - law.cdf(chi2));
        let survey = (GRAVITY * slope_sd).powi(2);
        let (mut largest, mut count) = (0.0_f64, 0.0);
        let (mut strongest, mut strength) = (&self.bins[..1], 0.0);
        for width in [1, 2, 4, 8] {
            for window in self.bins.windows(width) {
                if window[0].track != window[width - 1].track {
                    continue;
                }
                let m = mean_departure(window);
                // A survey error may be common to an interval; errors of runs are correlated in
                // neighbouring bins only.
                let variances = window.iter().map(|bin| bin.variance);
                let own = variances.sum::<f64>() / (width * width) as f64;
                let reach = (width as f64).min(self.inflation);
                largest = largest.max(m.abs() / (survey + own * reach).sqrt());
                count += 1.0;
                let of_window = m.abs() * (width as f64).sqrt();
                if of_window > strength {
                    (strongest, strength) = (window, of_window);
                }
            }
        }
        let excess = self.bins.iter().map(|b| departure(b).powi(2) - b.variance);
        let excess = excess.sum::<f64>() / n;
        // A single interval hardly changes the sum: the largest departure is tested separately.
        let p_value = p_of_whole.min(two_sided(largest) * count);
        ProfileDeparture {
            p_value,
            track: strongest[0].track.clone(),
            from_m: strongest[0].from_m,
            to_m: strongest[strongest.len() - 1].from_m + self.width,
            // The residual is dv/dt - g slope: a residual of +1 is a slope stated too small.
            slope: mean_departure(strongest) / GRAVITY,
            needed_sd: excess.max(0.0).sqrt() / GRAVITY,
        }
    }
}
