//! Bins of the residuals by pressure and by every further column.

use crate::evidence::experiments::fit::{Fit, Setting};
use crate::evidence::experiments::rows::{Row, further_columns};
use crate::finding::{Bin, bin, significant};

/// Number of bins of a column.
const BINS: usize = 3;
/// Smallest number of rows in a bin, for a standard error.
const MIN_ROWS: usize = 3;

/// Significant bins of the residual of mu, strongest first; p-values are Bonferroni-corrected.
pub fn bins(setting: &Setting, rows: &[Row], fit: &Fit) -> Vec<Bin> {
    let residual = |row: &Row| row.mu - fit.predict(setting, row).1;
    let rest: Vec<f64> = rows.iter().map(residual).collect();
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
