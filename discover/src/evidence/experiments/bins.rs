//! Where rows and law part: thirds of the rows by pressure and by every further column.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::evidence::experiments::fit::{Fit, Setting};
use crate::evidence::experiments::rows::Row;
use crate::finding::Bin;
use crate::procedure::rules::ExperimentRules;

/// Bins of measured less fitted mu that stand out, strongest first; p-values hold over all bins (Bonferroni).
pub fn bins(
    setting: &Setting,
    rows: &[Row],
    fit: &Fit,
    chosen: &[usize],
    rules: &ExperimentRules,
) -> Vec<Bin> {
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
        for k in 0..rules.bins {
            let own = &order[k * order.len() / rules.bins..(k + 1) * order.len() / rules.bins];
            let n = own.len();
            if n < rules.bin_rows {
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
    let count = found.len() as f64;
    for bin in &mut found {
        bin.p_value = (bin.p_value * count).min(1.0);
    }
    found.retain(|bin| bin.p_value <= rules.bin_shown);
    found.sort_by(|a, b| {
        let t = |bin: &Bin| (bin.mean / bin.error.max(1e-300)).abs();
        t(b).total_cmp(&t(a))
    });
    found
}
