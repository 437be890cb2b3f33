//! Results of a search over experiments: sizes, explained share and the next model.

use kufe_sled::Model;

use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::evidence::Experiments;
use crate::evidence::experiments::fit::Fit;
use crate::evidence::experiments::rows::Row;
use crate::finding::{Fitted, Interval, fitted};
use crate::procedure::closed::{ClosedGap, change};
use crate::procedure::evidence::Account;

impl Experiments<'_> {
    /// Base coefficients with their intervals.
    pub fn base_parameters(&self, last: &Fit, quantile: f64) -> Vec<Fitted> {
        let estimates = last.step.iter().zip(&last.errors);
        let coefficients = self.setting.base.coefficients().iter().zip(estimates);
        coefficients
            .map(|((name, unit, scale), (value, error))| {
                fitted(name, unit, scale * value, quantile * (scale * error).abs())
            })
            .collect()
    }

    /// The model with the refitted base and the selected effects. Effects on columns that
    /// simulations do not have are reported in the account instead.
    pub fn next_model(&self, last: &Fit, account: &mut Account) -> Model {
        let base = self.setting.base;
        let value = |k: usize| Some(base.coefficients()[k].2 * last.step[k]);
        let mut next = self.model.clone();
        let keys = &mut next.friction.longitudinal;
        match base {
            Base::Fixed => keys.mu = value(0),
            Base::Pressure => (keys.b, keys.c, keys.d) = (value(0), value(1), value(2)),
            Base::Film => keys.zeta = value(0),
        }
        for (k, c) in last.chosen.iter().enumerate() {
            let candidate = &self.setting.candidates[*c];
            if let Some(mut table) = candidate.act.table.clone() {
                let size = last.amount(&self.setting, k).value;
                table.insert(candidate.key.clone(), size.into());
                next.effects.insert(candidate.effect.clone(), table);
            } else {
                account.remarks.push(format!(
                    "{} is not in model.next.toml: simulations have no such column",
                    candidate.effect
                ));
            }
        }
        next
    }

    /// Closed share of the explainable misfit, on the held-out rows if there are any. The direction
    /// is that of all selected effects and the next best candidate, fitted to the other rows.
    pub fn closed(&self, before: &Fit, after: &Fit) -> Interval {
        let all: Vec<usize> = after.chosen.iter().copied().chain(self.next_best).collect();
        let least = self.fitted(&all);
        let rest = |rows: &[Row], fit: &Fit| -> Vec<f64> {
            let residual = |row: &Row| row.mu - fit.predict(&self.setting, row).1;
            let rows = rows.iter();
            rows.map(|row| residual(row) / after.deviation(&self.setting, row))
                .collect()
        };
        let judged = if self.held_out.is_empty() {
            &self.training
        } else {
            &self.held_out
        };
        let first = rest(judged, before);
        ClosedGap {
            direction: &change(&first, &rest(judged, &least)),
            before: &first,
            after: &rest(judged, after),
            fitted: &change(&rest(&self.training, before), &rest(&self.training, &least)),
            spread: (after.chi2 / after.freedom()).max(1.0).sqrt(),
        }
        .closed()
    }
}
