//! A run and what the model makes of its steering, over the distance.

use std::path::Path;

use super::strip::{Extras, Line, broken, draw_strip};
use crate::plot::Error;
use kufe_sled::Compared;
use kufe_sled::Replay;

/// Speed, its difference, time lost, slip angle, yaw rate and roll split of run and model over the distance; where they part is shaded.
///
/// # Errors
/// [`Error`].
pub fn replay_picture(path: &Path, replay: &Replay) -> Result<(), Error> {
    let line = |name, colour, value: &dyn Fn(&Compared) -> f64| Line {
        name,
        colour,
        points: broken(&replay.pieces, |i| {
            let at = &replay.compared[i];
            (at.s_m, value(at))
        }),
    };
    let mut panels: Vec<(&str, &str, Vec<Line>)> = Vec::new();
    let degrees = f64::to_degrees(1.0);
    for (k, (column, name, unit)) in [
        ("v_mps", "speed [m/s]", 1.0),
        ("alpha_rad", "slip [degrees]", degrees),
        ("yaw_rate_radps", "yaw rate [degrees/s]", degrees),
        ("gamma_rad", "roll split [degrees]", degrees),
    ]
    .into_iter()
    .enumerate()
    {
        if replay.differences.iter().any(|d| d.column == column) {
            let lines = vec![
                line("measured", 6, &|at| unit * at.values[k][0]),
                line("model", 1, &|at| unit * at.values[k][1]),
            ];
            panels.push((column, name, lines));
        }
    }
    let lost = line("run behind model", 0, &|at| at.t_s[0] - at.t_s[1]);
    let faster = line("run less model", 0, &|at| at.values[0][0] - at.values[0][1]);
    panels.insert(1, ("v_mps", "run less model [m/s]", vec![faster]));
    panels.insert(2, ("t_s", "run behind model [s]", vec![lost]));
    let title = format!("{} on {}, driven again", replay.run, replay.track);
    let height = 60 + 270 * panels.len() as u32;
    crate::plot::png(path, 1500, height, &|root| {
        let root = root
            .margin(10, 0, 0, 0)
            .titled(&title, ("sans-serif", 26))?;
        let areas = root.split_evenly((panels.len(), 1));
        for ((column, name, lines), area) in panels.iter().zip(areas) {
            let sections = replay.sections.iter().filter(|s| s.column == *column);
            let extras = Extras {
                bands: sections.map(|s| s.from_m..s.to_m).collect(),
                bands_are: "where run and model part",
                ..Extras::default()
            };
            draw_strip(&area, "", "distance [m]", name, lines, &extras)?;
        }
        Ok(())
    })?;
    Ok(())
}
