//! Measured and simulated maps side by side, for the report.

use crate::error::Error;
use crate::evidence::maps::simulate::Simulations;
use crate::evidence::maps::sized::SizedEffects;
use crate::finding::picture::{Picture, Plot};

/// For the learned map with the largest difference, and the first locked-away one: measured pressure, and what is simulated
/// before and after.
///
/// # Errors
/// Those of the contact solver.
pub fn pictures(
    simulations: &Simulations,
    locked: &Simulations,
    active: &SizedEffects,
) -> Result<Vec<Picture>, Error> {
    let mut pictures = Vec::new();
    for (simulations, kind) in [
        (simulations, "a map that it learned from"),
        (locked, "a map that the search had not seen"),
    ] {
        let before = simulations.maps(&SizedEffects::new(), simulations.rules.reporting_cells)?;
        let after = simulations.maps(active, simulations.rules.reporting_cells)?;
        let chi2 = simulations.reporting(&SizedEffects::new())?.by_row;
        let shown = (0..simulations.rows.len())
            .filter(|k| simulations.rows[*k].map.is_some())
            .max_by(|a, b| chi2[*a].total_cmp(&chi2[*b]));
        let Some(k) = shown else { continue };
        if let (Some(measured), Some(before), Some(after)) =
            (&simulations.rows[k].map, &before[k], &after[k])
        {
            pictures.push(Picture {
                title: format!("{}, {kind}", simulations.rows[k].name),
                caption: String::new(),
                plot: Plot::Maps {
                    nx: measured.nx,
                    ny: measured.ny,
                    x0: measured.x0,
                    y0: measured.y0,
                    dx: measured.dx,
                    dy: measured.dy,
                    measured: measured.pressure.clone(),
                    before: before.pressure.clone(),
                    after: match active.is_empty() {
                        true => Vec::new(),
                        false => after.pressure.clone(),
                    },
                },
            });
        }
    }
    Ok(pictures)
}
