//! Pictures of measured and simulated maps, and of the peaks of rows without a map.

use crate::error::Result;
use crate::evidence::maps::simulate::{Simulations, SizedEffects};
use crate::finding::{Maps, Peak, Picture, Plot};

/// Largest number of rows of a picture of peaks.
const MAX_PEAKS: usize = 60;

/// Measured and simulated pressure before and after, of training and held-out rows: the map of
/// largest difference of each, and the peaks of rows without a map.
pub fn pictures(simulations: [&Simulations; 2], active: &SizedEffects) -> Result<Vec<Picture>> {
    let none = SizedEffects::new();
    let mut pictures: Vec<Picture> = peaks(simulations, active)?.into_iter().collect();
    for (simulations, kind) in simulations
        .into_iter()
        .zip(["a training map", "a held-out map"])
    {
        let (rows, cells) = (&simulations.rows, simulations.rules.reporting_cells);
        let before = simulations.registered(&none, cells)?;
        let after = simulations.registered(active, cells)?;
        let chi2 = simulations.reporting(&none)?.by_row;
        let shown = (0..rows.len())
            .filter(|k| rows[*k].map.is_some())
            .max_by(|a, b| chi2[*a].total_cmp(&chi2[*b]));
        let Some(k) = shown else { continue };
        if let (Some(measured), Some(before), Some(after)) = (&rows[k].map, &before[k], &after[k]) {
            let mut after = after.map.pressure.clone();
            if active.is_empty() {
                after.clear();
            }
            pictures.push(Picture {
                title: format!("{}, {kind}", rows[k].name),
                caption: String::new(),
                plot: Plot::Maps(Maps {
                    measured: measured.clone(),
                    before: before.map.pressure.clone(),
                    after,
                }),
            });
        }
    }
    Ok(pictures)
}

/// Peaks of the rows without a map; `None` if all rows have one.
fn peaks(simulations: [&Simulations; 2], active: &SizedEffects) -> Result<Option<Picture>> {
    let mut rows = Vec::new();
    for (simulations, not_seen) in simulations.into_iter().zip([false, true]) {
        let cells = simulations.rules.reporting_cells;
        let before = simulations.peaks(&SizedEffects::new(), cells)?;
        let after = simulations.peaks(active, cells)?;
        let pairs = simulations.rows.iter().zip(before.into_iter().zip(after));
        rows.extend(pairs.filter_map(|(row, (before, after))| {
            Some(Peak {
                name: row.name.clone(),
                not_seen,
                measured: row.p_max,
                sd: row.p_max_sd,
                before: before?,
                after: after.filter(|_| !active.is_empty()),
            })
        }));
    }
    let count = rows.len();
    rows.truncate(MAX_PEAKS);
    let shown = if count > rows.len() {
        format!(" The first {} of {count} rows.", rows.len())
    } else {
        String::new()
    };
    Ok((count > 0).then(|| Picture {
        title: "Peak pressure, measured and simulated".to_owned(),
        caption: format!("Bars: two standard deviations of what was measured.{shown}"),
        plot: Plot::Peaks(rows),
    }))
}
