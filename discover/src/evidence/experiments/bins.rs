//! Bins of the residuals by pressure and by every further column.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::evidence::experiments::fit::{Fit, Setting};
use crate::evidence::experiments::rows::Row;
use crate::finding::{Bin, significant};

/// Bins of a column.
const BINS: usize = 3;
/// Fewest rows in a bin: three give a standard error of their own.
const BIN_ROWS: usize = 3;

/// Significant bins of the residual of mu, strongest first; p-values are Bonferroni-corrected.
pub fn bins(setting: &Setting, rows: &[Row], fit: &Fit, chosen: &[usize]) -> Vec<Bin> {
    let rest: Vec<f64> = rows
        .iter()
        .map(|row| row.mu - fit.predict(setting, row, chosen).1)
        .collect();
    let mut columns: Vec<(&str, Vec<f64>)> =
        vec![("p_max_pa", rows.iter().map(|r| r.pressure).collect())];
    if let Some(first) = rows.first() {
        for name in first.columns.keys() {
            columns.push((name, rows.iter().map(|r| r.columns[name]).collect()));
        }
    }
    let mut found = Vec::new();
    for (name, values) in &columns {
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        for k in 0..BINS {
            let own = &order[k * order.len() / BINS..(k + 1) * order.len() / BINS];
            let n = own.len();
            if n < BIN_ROWS {
                continue;
            }
            let mean = own.iter().map(|i| rest[*i]).sum::<f64>() / n as f64;
            let squares = own.iter().map(|i| (rest[*i] - mean).powi(2)).sum::<f64>();
            let error = (squares / (n as f64 - 1.0) / n as f64).sqrt();
            let Ok(law) = StudentsT::new(0.0, 1.0, n as f64 - 1.0) else {
                continue;
            };
            found.push(Bin {
                channel: "mu".to_owned(),
                column: (*name).to_owned(),
                from: values[own[0]],
                to: values[own[n - 1]],
                mean,
                error,
                unit: String::new(),
                p_value: 2.0 * law.sf((mean / error.max(1e-300)).abs()),
            });
        }
    }
    significant(found)
}
