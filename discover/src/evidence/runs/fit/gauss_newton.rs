//! Joint fit of base, effects, installation errors and discrepancy.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::Error;
use crate::evidence::runs::fit::row_noise::{log_noise, model_error, noise_gradients};
use crate::evidence::runs::model::design::{Design, OWN_LEVELS, Products};
use crate::evidence::runs::model::residual_model::{
    BASE, BOUNDS, CHANNELS, ChannelRows, ResidualModel,
};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::regression::prior::Prior;

/// Residuals of all runs.
pub fn residuals(residual_model: &ResidualModel, frames: &[Frame]) -> Vec<ChannelRows> {
    frames
        .par_iter()
        .map(|frame| residual_model.residuals(frame))
        .collect()
}

/// Residuals of all runs given the estimated discrepancy.
pub fn conditional_residuals(model: &ResidualModel, frames: &[Frame]) -> Vec<ChannelRows> {
    let mut runs = residuals(model, frames);
    for (frame, rows) in frames.iter().zip(&mut runs) {
        model.discrepancy.subtract(frame, rows);
    }
    runs
}

/// Base parameters with leverage on the residuals; the others are fixed at their given values.
pub fn free_base(
    residual_model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
) -> Vec<usize> {
    let whitener = Whitener::estimate(frames, &residuals(residual_model, frames), used);
    let design = Design::new(residual_model, &whitener, &[0, 1, 2, 3, 4]);
    let mut norms = [0.0; BASE];
    // A few runs are enough to determine the leverage.
    for frame in frames.iter().take(6) {
        let columns = design.columns(frame);
        for (b, norm) in norms.iter_mut().enumerate() {
            *norm += columns.column(OWN_LEVELS + b).norm_squared();
        }
    }
    let has_leverage = [
        used[0] && norms[0] > 0.0,
        norms[1] > 1e-4 * norms[2],
        norms[2] > 0.0,
        norms[3] > 1e-4 * norms[4],
        norms[4] > 0.0,
    ];
    (0..BASE).filter(|b| has_leverage[*b]).collect()
}

/// Tolerance of a fit's criterion: a parameter is then within a standard error.
pub const TOLERANCE: f64 = 0.5;

/// Runs, and the base parameters that are fitted to them together with the model's amplitudes,
/// installation errors and discrepancy.
pub struct Fitting<'a> {
    pub frames: &'a [Frame],
    /// Base parameters.
    pub free: &'a [usize],
    pub used: [bool; CHANNELS],
    /// Stated base multipliers, the mean of their prior.
    pub stated: [f64; BASE],
    /// Standard deviation of the prior of a base multiplier.
    pub stated_sd: f64,
}

/// Products of the columns relative to their noise.
pub struct FitProducts {
    /// Products of the fitted columns and of the residual, which is the last column, by run.
    pub by_run: Vec<DMatrix<f64>>,
    pub prior: Prior,
}

impl Fitting<'_> {
    /// Fits all parameters of a model together by Gauss-Newton, until a step decreases the
    /// criterion by less than `tolerance`.
    ///
    /// With S the covariance of the residuals given the discrepancy u, E the covariance expected of
    /// noise ([`row_noise`](crate::evidence::runs::fit::row_noise)), a the installation errors and
    /// b the base multipliers with their stated values b0, it minimises
    ///
    /// ```text
    /// n (ln det S - ln det E) / 2 + |a|^2 / 2 + |u|^2 / 2 + |b - b0|^2 / (2 sd^2)
    /// ```
    ///
    /// In a joint fit the base does not take up a large installation error, as it would if it were
    /// fitted first. Steps are halved until the criterion decreases. They are lengthened if it
    /// decreases by more than the products of the columns predict, which do not contain the change
    /// of E. Amplitudes are bounded.
    ///
    /// # Errors
    /// [`Error::BaseFit`] if a residual is not finite.
    pub fn fit(&self, model: &ResidualModel, tolerance: f64) -> Result<Fit, Error> {
        const MAX_STEPS: usize = 12;
        /// Lower limit of the step length, in Gauss-Newton steps.
        const MIN_LENGTH: f64 = 0.05;
        /// Predicted optimal step length from which a longer step is worth another evaluation.
        const LONGER: f64 = 1.5;
        const MAX_LENGTH: f64 = 4.0;
        let mut model = model.clone();
        let mut rows = conditional_residuals(&model, self.frames);
        for _ in 0..MAX_STEPS {
            model.model_error = model_error(&model, self.frames, &rows);
            let before = self.criterion(&model, &rows);
            if !before.is_finite() {
                return Err(Error::BaseFit {
                    reason: "a residual is not a finite number".to_owned(),
                });
            }
            let FitProducts { by_run, prior } = self.products(&model, &self.whitener(&rows));
            let step = solve(&by_run, &prior);
            let trial = |length: f64| {
                let trial = stepped(&model, self.free, step.by.as_slice(), length);
                let trial_rows = conditional_residuals(&trial, self.frames);
                let decrease = before - self.criterion(&trial, &trial_rows);
                (decrease, trial, trial_rows)
            };
            let lengths = std::iter::successors(Some(1.0), |length| Some(0.5 * length));
            let mut trials = lengths.take_while(|length| *length > MIN_LENGTH).map(trial);
            let Some(mut best) = trials.find(|(decrease, ..)| *decrease > 0.0) else {
                break;
            };
            let longer = step.optimal_length(best.0).min(MAX_LENGTH);
            if longer >= LONGER {
                let lengthened = trial(longer);
                if lengthened.0 > best.0 {
                    best = lengthened;
                }
            }
            let decrease = best.0;
            (_, model, rows) = best;
            if decrease < tolerance {
                break;
            }
        }
        model.model_error = model_error(&model, self.frames, &rows);
        let whitener = self.whitener(&rows);
        Ok(Fit { model, whitener })
    }

    /// Products of the fitted parameters' columns.
    pub fn products(&self, model: &ResidualModel, whitener: &Whitener) -> FitProducts {
        let noise = noise_gradients(model, self.frames, self.free, self.used);
        let design = Design {
            noise: Some(&noise),
            ..Design::new(model, whitener, self.free)
        };
        let mut prior = design.prior();
        for (k, b) in self.free.iter().enumerate() {
            prior.precision[k] = self.stated_sd.powi(-2);
            prior.at[k] = model.base[*b] - self.stated[*b];
        }
        let n = design.fitted_count() + 1;
        let fitted = |run: &Products| run.full.view((OWN_LEVELS, OWN_LEVELS), (n, n)).into_owned();
        FitProducts {
            by_run: design.products(self.frames).iter().map(fitted).collect(),
            prior,
        }
    }

    fn whitener(&self, rows: &[ChannelRows]) -> Whitener {
        Whitener::estimate(self.frames, rows, self.used)
    }

    /// The criterion of a model with these residuals given the discrepancy.
    fn criterion(&self, model: &ResidualModel, rows: &[ChannelRows]) -> f64 {
        let count: usize = self.frames.iter().map(Frame::row_count).sum();
        let noise = log_noise(model, self.frames, self.used);
        let square = |b: &usize| ((model.base[*b] - self.stated[*b]) / self.stated_sd).powi(2);
        let base: f64 = self.free.iter().map(square).sum();
        let discrepancy: f64 = model.discrepancy.sizes.iter().map(|u| u * u).sum();
        count as f64 * (self.whitener(rows).log_scale() - noise)
            + model.installation.penalty()
            + 0.5 * (base + discrepancy)
    }
}

/// A fitted model and the whitening of its residuals.
pub struct Fit {
    pub model: ResidualModel,
    pub whitener: Whitener,
}

/// A Gauss-Newton step.
pub struct GaussNewtonStep {
    pub by: DVector<f64>,
    /// Inverse of the sum of the products and the prior.
    pub inverse: DMatrix<f64>,
    /// Decrease of the criterion by the whole step if it is quadratic with these products.
    predicted: f64,
}

impl GaussNewtonStep {
    /// Step length that minimises the criterion, in units of the step, given its decrease d by the
    /// whole step. With p the predicted decrease, the decrease `2 p s - (2 p - d) s^2` at length s
    /// has its maximum at `s = p / (2 p - d)`; infinity if it has no maximum.
    fn optimal_length(&self, decrease: f64) -> f64 {
        let curvature = 2.0 * self.predicted - decrease;
        if curvature > 0.0 {
            self.predicted / curvature
        } else {
            f64::INFINITY
        }
    }
}

/// A Gauss-Newton step from products by run.
pub fn solve(by_run: &[DMatrix<f64>], prior: &Prior) -> GaussNewtonStep {
    let p = prior.count();
    let mut total = DMatrix::zeros(p + 1, p + 1);
    by_run.iter().for_each(|products| total += products);
    let inverse = prior.inverse(total.view((0, 0), (p, p)).into_owned());
    let scores = total.view((0, p), (p, 1)).column(0) + prior.scores(&prior.at);
    let by = &inverse * &scores;
    let predicted = 0.5 * by.dot(&scores);
    GaussNewtonStep {
        by,
        inverse,
        predicted,
    }
}

/// Largest factor by which a step changes a base multiplier: a long step along a poorly determined
/// direction leads to values at which the data do not determine it at all. Chosen.
const MAX_FACTOR: f64 = 2.0;

/// The model after a step of length `length`; multipliers and amplitudes remain within bounds.
///
/// `step` contains base multipliers, amplitudes in their units, installation errors and
/// coefficients of the discrepancy.
pub fn stepped(
    residual_model: &ResidualModel,
    free_base: &[usize],
    step: &[f64],
    length: f64,
) -> ResidualModel {
    let mut trial = residual_model.clone();
    for (k, b) in free_base.iter().enumerate() {
        let from = residual_model.base[*b];
        let next = (from + length * step[k]).clamp(from / MAX_FACTOR, from * MAX_FACTOR);
        trial.base[*b] = next.clamp(BOUNDS[0], BOUNDS[1]);
    }
    for (k, (e, q)) in residual_model.free().into_iter().enumerate() {
        let scale = residual_model.scale(e, q);
        let [low, high] = residual_model.bounds(e, q);
        let active = &mut trial.effects.active[e];
        let value = active.values[q] + length * scale * step[free_base.len() + k];
        // An amplitude of exactly 0 would count as switched off.
        active.values[q] = if value == 0.0 {
            1e-12 * scale
        } else {
            value.clamp(low, high)
        };
    }
    let discrepancy = step.len() - trial.discrepancy.fitted_count();
    let installation = discrepancy - trial.installation.fitted_count();
    let of_installation = step[installation..discrepancy].iter();
    let of_installation: Vec<f64> = of_installation.map(|step| length * step).collect();
    trial.installation.step(&of_installation);
    for (size, step) in trial.discrepancy.sizes.iter_mut().zip(&step[discrepancy..]) {
        *size += length * step;
    }
    trial
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use kufe_sled::effects::Effects;
    use kufe_sled::sample_data::{drive_sample, sample_plan};
    use kufe_sled::{Model, Tolerances, Vehicle};

    use super::*;
    use crate::evidence::runs::fit::simulated_runs::RunSimulator;
    use crate::evidence::runs::model::installation::Installation;
    use crate::evidence::runs::recordings::prepare::prepare;
    use crate::procedure::rules::Rules;

    /// Six runs, and a model with an effect and installation errors away from their optimum.
    fn example() -> (Vec<Frame>, ResidualModel) {
        let published = Model::published();
        let mut plan = sample_plan(4);
        plan.truncate(6);
        for planned in &mut plan {
            planned.options.rate_hz = 100.0;
            planned.options.step_s = 2.5e-3;
            planned.options.contacts.clear();
        }
        let recorded = drive_sample(&plan, &published).expect("runs");
        let rules = Rules::default();
        let data = prepare(&recorded, &published, &BTreeMap::new(), &rules).expect("frames");
        let sensors = RunSimulator::of_sensors(data.noise, (1, &rules.runs));
        let effect = "[effects.speed-grip]\nslope_s_per_m = 0.002\n";
        let with = Model::from_toml(&(published.to_toml() + effect), "model").expect("a model");
        let effects = Effects::from_tables(&with.effects).expect("an effect");
        let vehicle = Vehicle::new(&published).expect("the published model");
        let mut model = ResidualModel::new(vehicle, [1.1, 0.98, 1.03, 1.0, 0.98], effects);
        let tolerances = Tolerances::default();
        let sessions = data.frames.iter().map(|frame| frame.session.as_str());
        model.installation = Installation::new(&tolerances, sessions);
        let by: Vec<f64> = (0..model.installation.fitted_count())
            .map(|k| 0.3 * (1.7 * k as f64).sin())
            .collect();
        model.installation.step(&by);
        (sensors.with_row_noise(&data.frames), model)
    }

    fn fitting(frames: &[Frame]) -> Fitting<'_> {
        Fitting {
            frames,
            free: &[0, 1, 2, 3, 4],
            used: [true, true, true, false],
            stated: [1.0; BASE],
            stated_sd: 0.5,
        }
    }

    fn criterion(fitting: &Fitting, model: &ResidualModel) -> f64 {
        fitting.criterion(model, &conditional_residuals(model, fitting.frames))
    }

    #[test]
    fn scores_are_the_derivatives_of_the_criterion() {
        let (frames, mut model) = example();
        let fitting = fitting(&frames);
        let rows = conditional_residuals(&model, &frames);
        model.model_error = model_error(&model, &frames, &rows);
        let FitProducts { by_run, prior } = fitting.products(&model, &fitting.whitener(&rows));
        let p = prior.count();
        let zero = DMatrix::zeros(p + 1, p + 1);
        let total = by_run.iter().fold(zero, |sum, run| sum + run);
        let scores = total.view((0, p), (p, 1)).column(0) + prior.scores(&prior.at);
        for k in 0..p {
            let h = 1e-3;
            let at = |by: f64| {
                let mut step = vec![0.0; p];
                step[k] = by;
                criterion(&fitting, &stepped(&model, fitting.free, &step, 1.0))
            };
            let slope = (at(-h) - at(h)) / (2.0 * h);
            // The whitening keeps a hundredth of each variance apart, and delays and rotations are
            // linear to first order only.
            let within = 0.1 * slope.abs() + 0.2 * total[(k, k)].sqrt();
            let score = scores[k];
            assert!((score - slope).abs() < within, "{k}: {score} {slope}");
        }
    }

    #[test]
    fn a_fit_lowers_the_criterion_to_a_minimum() {
        let (frames, model) = example();
        let fitting = fitting(&frames);
        let fit = fitting.fit(&model, TOLERANCE).expect("finite residuals");
        let FitProducts { by_run, prior } = fitting.products(&fit.model, &fit.whitener);
        let step = solve(&by_run, &prior);
        let beyond = stepped(&fit.model, fitting.free, step.by.as_slice(), 1.0);
        let more = criterion(&fitting, &fit.model) - criterion(&fitting, &beyond);
        assert!(more < 0.5, "{more}");
        // The runs are those of the published model.
        for b in [1, 2, 3, 4] {
            assert!(
                (fit.model.base[b] - 1.0).abs() < 0.1,
                "{:?}",
                fit.model.base
            );
        }
    }
}
