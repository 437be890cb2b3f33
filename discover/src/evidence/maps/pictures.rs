//! Measured and simulated maps side by side, for the report.

use crate::error::Error;
use crate::evidence::maps::simulate::{Active, Bench, REPORTING};
use crate::finding::picture::{Picture, Plot};

/// For the learned map with the largest difference, and the first locked-away one: measured pressure, and what is simulated
/// before and after.
///
/// # Errors
/// Those of the contact solver.
pub fn pictures(bench: &Bench, locked: &Bench, active: &Active) -> Result<Vec<Picture>, Error> {
    let mut pictures = Vec::new();
    for (bench, kind) in [
        (bench, "a map used for learning"),
        (locked, "a locked-away map"),
    ] {
        let before = bench.maps(&Active::new(), REPORTING)?;
        let after = bench.maps(active, REPORTING)?;
        let chi2 = bench.misfit(&Active::new(), REPORTING)?.by_row;
        let shown = (0..bench.rows.len())
            .filter(|k| bench.rows[*k].map.is_some())
            .max_by(|a, b| chi2[*a].total_cmp(&chi2[*b]));
        let Some(k) = shown else { continue };
        if let (Some(measured), Some(before), Some(after)) =
            (&bench.rows[k].map, &before[k], &after[k])
        {
            pictures.push(Picture {
                title: format!("{}, {kind}", bench.rows[k].name),
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
