//! Bins of the residuals by load and curvature, along and across the runner, and by pressure.

use crate::error::Result;
use crate::evidence::maps::sample::place;
use crate::evidence::maps::simulate::{Simulations, SizedEffects};
use crate::finding::{Bin, bin, significant};

const BINS: usize = 8;
const COLUMNS: [&str; 5] = ["fz_n", "curvature_1pm", "x_m", "y_m", "p_pa"];

/// Significant bins of measured minus simulated pressure, strongest first; p-values are corrected
/// for all bins (Bonferroni).
pub fn bins(simulations: &Simulations, active: &SizedEffects) -> Result<Vec<Bin>> {
    let rules = &simulations.rules;
    let as_one = rules.independent_pixels.powi(2);
    let maps = simulations.registered(active, rules.reporting_cells)?;
    // One value per pixel in contact, in the order of the columns, and its residual.
    let mut values: Vec<([f64; COLUMNS.len()], f64)> = Vec::new();
    for (row, map) in simulations.rows.iter().zip(&maps) {
        let (Some(simulated), Some(measured)) = (map, &row.map) else {
            continue;
        };
        let map = &simulated.map;
        let least = 0.05 * map.pressure.iter().copied().fold(0.0, f64::max);
        for (k, (m, s)) in measured.pressure.iter().zip(&map.pressure).enumerate() {
            if m.max(*s) >= least {
                let [x, y] = place(map, k);
                values.push(([row.fz, row.problem.track_curvature, x, y, *s], m - s));
            }
        }
    }
    let mut found = Vec::new();
    for (c, column) in COLUMNS.iter().enumerate() {
        let mut sorted: Vec<f64> = values.iter().map(|v| v.0[c]).collect();
        sorted.sort_by(f64::total_cmp);
        let Some(last) = sorted.last() else { continue };
        let at = |k: usize| sorted[(k * sorted.len() / BINS).min(sorted.len() - 1)];
        let mut edges: Vec<f64> = (0..=BINS).map(at).collect();
        edges.dedup();
        for ends in edges.windows(2) {
            let [from, to] = [ends[0], ends[1]];
            let is_inside = |x: f64| x >= from && (x < to || to == *last);
            let own = values.iter().filter(|v| is_inside(v.0[c]));
            let own: Vec<f64> = own.map(|v| v.1).collect();
            if own.len() as f64 >= 2.0 * as_one {
                let many = (as_one, f64::INFINITY);
                found.extend(bin(("p", "Pa"), column, [from, to], &own, many));
            }
        }
    }
    Ok(significant(found))
}
