//! Pictures of measured and simulated maps, and of the peaks of rows without a map.

use crate::error::Error;
use crate::evidence::maps::simulate::Simulations;
use crate::evidence::maps::sized::SizedEffects;
use crate::finding::{Maps, Peak, Picture, Plot};

/// Most rows of a picture of peaks.
const MOST_PEAKS: usize = 60;

/// Measured and simulated pressure before and after: the training map of largest difference, the
/// first held-out map, and the peaks of rows without a map.
pub fn pictures(
    simulations: &Simulations,
    locked: &Simulations,
    active: &SizedEffects,
) -> Result<Vec<Picture>, Error> {
    let mut pictures: Vec<Picture> = peaks(simulations, locked, active)?.into_iter().collect();
    for (simulations, kind) in [(simulations, "a training map"), (locked, "a held-out map")] {
        let before =
            simulations.registered(&SizedEffects::new(), simulations.rules.reporting_cells)?;
        let after = simulations.registered(active, simulations.rules.reporting_cells)?;
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
                plot: Plot::Maps(Maps {
                    measured: measured.clone(),
                    before: before.map.pressure.clone(),
                    after: match active.is_empty() {
                        true => Vec::new(),
                        false => after.map.pressure.clone(),
                    },
                }),
            });
        }
    }
    Ok(pictures)
}

/// Peaks of the rows without a map; `None` if all rows have one.
fn peaks(
    simulations: &Simulations,
    locked: &Simulations,
    active: &SizedEffects,
) -> Result<Option<Picture>, Error> {
    let mut rows = Vec::new();
    for (simulations, not_seen) in [(simulations, false), (locked, true)] {
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
    rows.truncate(MOST_PEAKS);
    let shown = match count > rows.len() {
        true => format!(" The first {} of {count} rows.", rows.len()),
        false => String::new(),
    };
    Ok((count > 0).then(|| Picture {
        title: "Peak pressure, measured and simulated".to_owned(),
        caption: format!("Bars: two standard deviations of what was measured.{shown}"),
        plot: Plot::Peaks(rows),
    }))
}
