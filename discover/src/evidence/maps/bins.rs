//! Bins of the residuals by load and curvature, along and across the runner, and by pressure.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::error::Error;
use crate::evidence::maps::registration::Registered;
use crate::evidence::maps::simulate::Simulations;
use crate::evidence::maps::sized::SizedEffects;
use crate::finding::{Bin, significant};

const BINS: usize = 8;

/// Significant bins of measured minus simulated pressure, strongest first; p-values are corrected
/// for all bins (Bonferroni).
pub fn bins(simulations: &Simulations, active: &SizedEffects) -> Result<Vec<Bin>, Error> {
    let rules = &simulations.rules;
    let as_one = rules.independent_pixels.powi(2);
    let maps = simulations.registered(active, rules.reporting_cells)?;
    // One value per pixel in contact: load, curvature, place, simulated pressure, residual.
    let mut values: Vec<([f64; 5], f64)> = Vec::new();
    for (row, map) in simulations.rows.iter().zip(&maps) {
        let (Some(Registered { map, .. }), Some(measured)) = (map, &row.map) else {
            continue;
        };
        let largest = map.pressure.iter().copied().fold(0.0, f64::max);
        for (k, (m, s)) in measured.pressure.iter().zip(&map.pressure).enumerate() {
            if m.max(*s) < 0.05 * largest {
                continue;
            }
            let x = map.x0 + (k % map.nx) as f64 * map.dx;
            let y = map.y0 + (k / map.nx) as f64 * map.dy;
            values.push(([row.fz, row.problem.track_curvature, x, y, *s], m - s));
        }
    }
    let columns = ["fz_n", "curvature_1pm", "x_m", "y_m", "p_pa"];
    let mut found = Vec::new();
    for (c, column) in columns.iter().enumerate() {
        let mut sorted: Vec<f64> = values.iter().map(|v| v.0[c]).collect();
        sorted.sort_by(f64::total_cmp);
        let mut edges: Vec<f64> = (0..=BINS)
            .filter_map(|k| sorted.get((k * sorted.len() / BINS).min(sorted.len().max(1) - 1)))
            .copied()
            .collect();
        edges.dedup();
        if edges.len() < 2 {
            continue;
        }
        let last = edges[edges.len() - 1];
        for pair in edges.windows(2) {
            let own: Vec<f64> = values
                .iter()
                .filter(|v| v.0[c] >= pair[0] && (v.0[c] < pair[1] || pair[1] == last))
                .filter(|v| v.0[c] <= pair[1])
                .map(|v| v.1)
                .collect();
            let n = own.len() as f64;
            if n < 2.0 * as_one {
                continue;
            }
            let mean = own.iter().sum::<f64>() / n;
            let variance = own.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let error = (variance * as_one / n).sqrt();
            found.push(Bin {
                channel: "p".to_owned(),
                column: (*column).to_owned(),
                from: pair[0],
                to: pair[1],
                mean,
                error,
                unit: "Pa".to_owned(),
                p_value: two_sided(mean / error.max(1e-300)),
            });
        }
    }
    Ok(significant(found))
}

fn two_sided(t: f64) -> f64 {
    2.0 * Normal::standard().sf(t.abs())
}
