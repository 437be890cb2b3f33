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

/// Base parameters with leverage; the others are fixed at their given values.
pub fn free_base(
    residual_model: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
) -> Vec<usize> {
    let whitener = Whitener::estimate(frames, &residuals(residual_model, frames), used);
    let design = Design {
        residual_model,
        whitener: &whitener,
        free_base: &[0, 1, 2, 3, 4],
        form: 0.0,
        candidates: &[],
        local: &[],
        windows: &[],
        noise: None,
    };
    let mut norms = [0.0; BASE];
    // A few runs are enough to determine the leverage.
    for frame in frames.iter().take(6) {
        let columns = design.columns(frame);
        for (b, norm) in norms.iter_mut().enumerate() {
            *norm += columns.column(OWN_LEVELS + b).norm_squared();
        }
    }
    let mut free = Vec::new();
    if used[0] && norms[0] > 0.0 {
        free.push(0);
    }
    for (saturating, stiffness) in [(1, 2), (3, 4)] {
        if norms[saturating] > 1e-4 * norms[stiffness] {
            free.push(saturating);
        }
        if norms[stiffness] > 0.0 {
            free.push(stiffness);
        }
    }
    free
}

/// Runs and the parameters that are fitted to them, apart from those of the model itself.
pub struct Fitting<'a> {
    pub frames: &'a [Frame],
    /// Base parameters.
    pub free: &'a [usize],
    pub used: [bool; CHANNELS],
    /// Stated base multipliers and the standard deviation of their prior.
    pub stated: [f64; BASE],
    pub stated_sd: f64,
}

/// Products of the columns relative to their noise.
pub struct FitProducts {
    /// Products of the fitted columns and the residual, which is last, by run.
    pub by_run: Vec<DMatrix<f64>>,
    pub prior: Prior,
}

impl Fitting<'_> {
    /// Fits all parameters of a model together by Gauss-Newton.
    ///
    /// With S the covariance of the residuals given the discrepancy u, E that expected of noise
    /// ([`row_noise`](crate::evidence::runs::fit::row_noise)), a the installation errors and b the
    /// base multipliers with their stated values b0, it minimises
    ///
    /// ```text
    /// n (ln det S - ln det E) / 2 + |a|^2 / 2 + |u|^2 / 2 + |b - b0|^2 / (2 sd^2)
    /// ```
    ///
    /// A large installation error is not taken up by the base, as it is by a fit of the base
    /// before. Steps are halved until the criterion falls, and lengthened where it falls by more than
    /// its products predict, as they do not contain the change of E; amplitudes are bounded.
    ///
    /// # Errors
    /// [`Error::BaseFit`] if a residual is not finite.
    pub fn fit(&self, model: &ResidualModel) -> Result<Fit, Error> {
        /// Tolerance of the criterion: a parameter is then within a standard error.
        const ENOUGH: f64 = 0.5;
        self.fit_within(model, ENOUGH)
    }

    /// The same with another tolerance of the criterion.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    pub fn fit_within(&self, model: &ResidualModel, enough: f64) -> Result<Fit, Error> {
        const ROUNDS: usize = 12;
        /// Smallest share of a step.
        const LEAST: f64 = 0.05;
        /// Multiples of a step that are tried, from that which is worth another evaluation.
        const LONGER: f64 = 1.5;
        const MOST: f64 = 4.0;
        let mut model = model.clone();
        let mut rows = conditional_residuals(&model, self.frames);
        for _ in 0..ROUNDS {
            model.model_error = model_error(&model, self.frames, &rows);
            let before = self.criterion(&model, &rows);
            if !before.is_finite() {
                return Err(Error::BaseFit {
                    reason: "a residual is not a finite number".to_owned(),
                });
            }
            let FitProducts { by_run, prior } = self.products(&model, &self.whitener(&rows));
            let step = solve(&by_run, &prior);
            let tried = |share: f64| {
                let trial = stepped(&model, self.free, step.by.as_slice(), share);
                let trial_rows = conditional_residuals(&trial, self.frames);
                let gained = before - self.criterion(&trial, &trial_rows);
                (gained, trial, trial_rows)
            };
            let shares = std::iter::successors(Some(1.0), |share| Some(0.5 * share));
            let mut shares = shares.take_while(|share| *share > LEAST).map(tried);
            let Some(mut best) = shares.find(|(gained, ..)| *gained > 0.0) else {
                break;
            };
            let longer = step.multiple(best.0).min(MOST);
            if longer >= LONGER {
                let further = tried(longer);
                if further.0 > best.0 {
                    best = further;
                }
            }
            let gained = best.0;
            (_, model, rows) = best;
            if gained < enough {
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
            residual_model: model,
            whitener,
            free_base: self.free,
            form: 0.0,
            candidates: &[],
            local: &[],
            windows: &[],
            noise: Some(&noise),
        };
        let mut prior = design.prior();
        for (k, b) in self.free.iter().enumerate() {
            prior.precision[k] = self.stated_sd.powi(-2);
            prior.at[k] = model.base[*b] - self.stated[*b];
        }
        let n = design.fitted() + 1;
        let fitted = |run: &Products| {
            let own = run.full.view((OWN_LEVELS, OWN_LEVELS), (n, n));
            own.into_owned()
        };
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
        let off = |b: &usize| ((model.base[*b] - self.stated[*b]) / self.stated_sd).powi(2);
        let base: f64 = self.free.iter().map(off).sum();
        let smooth: f64 = model.discrepancy.sizes.iter().map(|u| u * u).sum();
        count as f64 * (self.whitener(rows).log_scale() - noise)
            + model.installation.distance()
            + 0.5 * (base + smooth)
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
    /// Decrease of the criterion with the whole step if it is quadratic with these products.
    predicted: f64,
}

impl GaussNewtonStep {
    /// The multiple of the step at which the criterion is least, from its decrease d with the whole
    /// step: with p the predicted decrease, `2 p s - (2 p - d) s^2` has its maximum at
    /// `s = p / (2 p - d)`.
    fn multiple(&self, decrease: f64) -> f64 {
        let curvature = 2.0 * self.predicted - decrease;
        match curvature > 0.0 {
            true => self.predicted / curvature,
            false => f64::INFINITY,
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

/// Largest factor by which a step moves a base multiplier: a long step along a poorly determined
/// direction leads to where the data do not determine it at all. Chosen.
const FARTHEST: f64 = 2.0;

/// The model moved by a share of a step: base multipliers, amplitudes in their units, then
/// installation errors; all remain within bounds.
pub fn stepped(
    residual_model: &ResidualModel,
    free_base: &[usize],
    step: &[f64],
    share: f64,
) -> ResidualModel {
    let mut trial = residual_model.clone();
    for (k, b) in free_base.iter().enumerate() {
        let from = residual_model.base[*b];
        let next = (from + share * step[k]).clamp(from / FARTHEST, from * FARTHEST);
        trial.base[*b] = next.clamp(BOUNDS[0], BOUNDS[1]);
    }
    for (k, (e, q)) in residual_model.free().into_iter().enumerate() {
        let scale = residual_model.scale(e, q);
        let [low, high] = residual_model.bounds(e, q);
        let active = &mut trial.effects.active[e];
        let value = active.values[q] + share * scale * step[free_base.len() + k];
        // An amplitude of exactly 0 would count as switched off.
        active.values[q] = if value == 0.0 {
            1e-12 * scale
        } else {
            value.clamp(low, high)
        };
    }
    let smooth = step.len() - trial.discrepancy.fitted();
    let first = smooth - trial.installation.fitted();
    let installed: Vec<f64> = step[first..smooth]
        .iter()
        .map(|step| share * step)
        .collect();
    trial.installation.step(&installed);
    for (size, step) in trial.discrepancy.sizes.iter_mut().zip(&step[smooth..]) {
        *size += share * step;
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
        let by: Vec<f64> = (0..model.installation.fitted())
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
        let fit = fitting.fit(&model).expect("finite residuals");
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
