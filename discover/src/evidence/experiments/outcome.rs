//! Results of a search over experiments: sizes, explained share and the next model.

use kufe_sled::Model;

use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::evidence::{Experiments, TableFit};
use crate::evidence::experiments::fit::{Fit, fit};
use crate::evidence::experiments::rows::Row;
use crate::finding::{Fitted, Interval};
use crate::procedure::closed::ClosedGap;
use crate::procedure::evidence::Account;

impl Experiments<'_> {
    /// Size of the `k`-th selected candidate with its interval.
    pub fn size(&self, last: &TableFit, k: usize, quantile: f64) -> Fitted {
        let candidate = &self.setting.candidates[last.chosen[k]];
        let at = self.setting.base.len() + k;
        let value = last.fit.step[at] * candidate.typical;
        let error = last.fit.errors[at] * candidate.typical;
        Fitted {
            name: candidate.key.clone(),
            value,
            low: value - quantile * error,
            high: value + quantile * error,
            unit: candidate.unit.clone(),
        }
    }

    /// Base coefficients with their intervals.
    pub fn base_parameters(&self, last: &TableFit, quantile: f64) -> Vec<Fitted> {
        let base = self.setting.base;
        let fitted = |(k, (name, unit)): (usize, &(&str, &str))| {
            let (value, error) = last.fit.base_value(k, base);
            Fitted {
                name: (*name).to_owned(),
                value,
                low: value - quantile * error,
                high: value + quantile * error,
                unit: (*unit).to_owned(),
            }
        };
        base.names().iter().enumerate().map(fitted).collect()
    }

    /// The model with the refitted base and the selected effects. Effects on columns that
    /// simulations do not have are reported in the account instead.
    pub fn next_model(
        &self,
        last: &TableFit,
        parameters: &[Vec<Fitted>],
        account: &mut Account,
    ) -> Model {
        let base = self.setting.base;
        let value = |k: usize| Some(last.fit.base_value(k, base).0);
        let mut next = self.model.clone();
        let keys = &mut next.friction.longitudinal;
        match base {
            Base::Fixed => keys.mu = value(0),
            Base::Pressure => (keys.b, keys.c, keys.d) = (value(0), value(1), value(2)),
            Base::Film => keys.zeta = value(0),
        }
        for (c, sizes) in last.chosen.iter().zip(parameters) {
            let candidate = &self.setting.candidates[*c];
            if let Some(mut table) = candidate.act.table.clone() {
                table.insert(candidate.key.clone(), sizes[0].value.into());
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
    pub fn closed(&self, before: &TableFit, after: &TableFit) -> Interval {
        let setting = &self.setting;
        let all: Vec<usize> = after.chosen.iter().copied().chain(self.next_best).collect();
        let least = fit(setting, &self.training, &all);
        let last = &after.fit;
        let rest = |rows: &[Row], fit: &Fit, chosen: &[usize]| -> Vec<f64> {
            let residual = |row: &Row| row.mu - fit.predict(setting, row, chosen).1;
            let rows = rows.iter();
            rows.map(|row| residual(row) / last.deviation(setting, row))
                .collect()
        };
        let change = |rows: &[Row]| -> Vec<f64> {
            let first = rest(rows, &before.fit, &before.chosen);
            let least = rest(rows, &least, &all);
            first.iter().zip(least).map(|(a, b)| a - b).collect()
        };
        let judged = match self.held_out.is_empty() {
            true => &self.training,
            false => &self.held_out,
        };
        let freedom = (self.training.len() as f64 - last.step.len() as f64).max(1.0);
        ClosedGap {
            direction: &change(judged),
            before: &rest(judged, &before.fit, &before.chosen),
            after: &rest(judged, last, &after.chosen),
            fitted: &change(&self.training),
            spread: (last.chi2 / freedom).max(1.0).sqrt(),
        }
        .closed()
    }
}
