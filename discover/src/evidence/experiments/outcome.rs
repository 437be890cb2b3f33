//! Results of a search over experiments: sizes, explained share, bins and the next model.

use kufe_sled::Model;

use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::evidence::Experiments;
use crate::evidence::experiments::fit::{Fit, Setting};
use crate::evidence::experiments::rows::{Row, further_columns};
use crate::finding::{Bin, Fitted, Interval, bin, fitted, significant};
use crate::procedure::closed::{ClosedMisfit, change};
use crate::procedure::evidence::Account;

/// Number of bins of a column.
const BINS: usize = 3;
/// Smallest number of rows in a bin, for a standard error.
const MIN_ROWS: usize = 3;

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
        let setting = &self.setting;
        let rest = |rows: &[Row], fit: &Fit| -> Vec<f64> {
            let of_row = |row| fit.residual(setting, row) / after.deviation(setting, row);
            rows.iter().map(of_row).collect()
        };
        let judged = if self.held_out.is_empty() {
            &self.training
        } else {
            &self.held_out
        };
        let first = rest(judged, before);
        ClosedMisfit {
            direction: &change(&first, &rest(judged, &least)),
            before: &first,
            after: &rest(judged, after),
            fitted: &change(&rest(&self.training, before), &rest(&self.training, &least)),
            spread: (after.chi2 / after.freedom()).max(1.0).sqrt(),
        }
        .closed()
    }
}

/// Significant bins of the residual of mu, strongest first; p-values are Bonferroni-corrected.
pub fn bins(setting: &Setting, rows: &[Row], fit: &Fit) -> Vec<Bin> {
    let rest: Vec<f64> = rows.iter().map(|row| fit.residual(setting, row)).collect();
    let pressure = rows.iter().map(|r| r.pressure).collect();
    let mut columns = vec![("p_max_pa", pressure)];
    columns.extend(further_columns(rows));
    let mut found = Vec::new();
    for (name, values) in &columns {
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        for k in 0..BINS {
            let own = &order[k * order.len() / BINS..(k + 1) * order.len() / BINS];
            let n = own.len();
            if n < MIN_ROWS {
                continue;
            }
            let residuals: Vec<f64> = own.iter().map(|i| rest[*i]).collect();
            let ends = [values[own[0]], values[own[n - 1]]];
            let freedom = n as f64 - 1.0;
            found.extend(bin(("mu", ""), name, ends, &residuals, (1.0, freedom)));
        }
    }
    significant(found)
}
