//! Negative log-likelihood of the training runs.

use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::fit::row_noise::log_noise_of;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::model::whiten::Whitener;

impl Campaign<'_> {
    /// The negative log-likelihood of the training runs with a model, up to a constant and without
    /// the prior of installation errors; the discrepancy is integrated out.
    pub fn misfit(&self, model: &ResidualModel, whitener: &Whitener) -> f64 {
        let all = residuals(model, &self.training);
        let white: Vec<Vec<f64>> = (self.training.iter().zip(&all))
            .map(|(frame, rows)| whitener.apply(frame, rows))
            .collect();
        let runs = self.training.iter().zip(&white).map(|(frame, rows)| {
            let squares: f64 = rows.iter().map(|x| x * x).sum();
            let noise = log_noise_of(model, frame, self.used);
            0.5 * squares + frame.row_count() as f64 * (whitener.log_scale() - noise)
        });
        let explained = (model.discrepancy).explained(&self.training, &white, whitener);
        runs.sum::<f64>() - explained
    }

    /// Decrease of the negative log posterior from the first fit to the second.
    pub fn posterior_gain(&self, from: &RunFit, to: &RunFit) -> f64 {
        let [a, b] = [&from.residual_model, &to.residual_model];
        // With a large effect, the noise of the better model applies to both.
        let model_error = std::array::from_fn(|c| a.model_error[c].min(b.model_error[c]));
        let discrepancy = a.discrepancy.with_min_sd(&b.discrepancy);
        let [before, after] = [from, to].map(|fit| {
            let model = ResidualModel {
                model_error,
                discrepancy: discrepancy.clone(),
                ..fit.residual_model.clone()
            };
            self.penalised_misfit(&model, &fit.whitener)
        });
        before - after
    }

    /// The negative log posterior of a model: the misfit and the prior of the installation errors.
    pub fn penalised_misfit(&self, model: &ResidualModel, whitener: &Whitener) -> f64 {
        self.misfit(model, whitener) + model.installation.penalty_relative_to_zero()
    }
}
