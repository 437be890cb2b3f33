//! Model against measurement: errors by run and track, and the force over time.

use std::path::Path;

use super::boxes::{Spread, draw_boxes};
use super::strip::{Line, broken, draw_strip};
use crate::error::Error;
use crate::evaluate::validate::{RunValidation, by_track};

/// Root mean square error by run, a box a track and law.
///
/// # Errors
/// [`Error::Plot`].
pub fn rmse_picture(path: &Path, runs: &[RunValidation]) -> Result<(), Error> {
    let tracks = by_track(runs);
    let mut boxes = Vec::new();
    for track in &tracks {
        let of = |pick: fn(&RunValidation) -> f64| {
            Spread::of(runs.iter().filter(|run| run.track == track.track).map(pick))
        };
        boxes.push((format!("{}: model", track.track), of(|run| run.rmse_n)));
        boxes.push((
            format!("{}: Braghin", track.track),
            of(|run| run.rmse_braghin_n),
        ));
    }
    let width = 220 * boxes.len().max(3) as u32;
    kufe_plot::png(path, width, 560, &|root| {
        draw_boxes(
            &root,
            "Lateral force at the centre of gravity",
            "RMSE by run [N]",
            &boxes,
        )
    })?;
    Ok(())
}

/// One run's lateral force over time, with the largest disagreements marked.
///
/// # Errors
/// [`Error::Plot`].
pub fn lateral_force_picture(path: &Path, run: &RunValidation) -> Result<(), Error> {
    let line = |name, colour, pick: fn(&crate::evaluate::validate::LateralForce) -> f64| Line {
        name,
        colour,
        points: broken(&run.pieces, |i| (run.series[i].t_s, pick(&run.series[i]))),
    };
    let lines = [
        line("measured", 6, |f| f.measured_n),
        line("friction model", 1, |f| f.model_n),
    ];
    let difference = [line("measured - model", 0, |f| f.measured_n - f.model_n)];
    let marks: Vec<(f64, String)> = run
        .largest
        .iter()
        .map(|d| (d.t_s, format!("{:.0} m", d.s_m)))
        .collect();
    let title = format!(
        "{} on {}: RMSE {:.0} N (Braghin {:.0} N)",
        run.run, run.track, run.rmse_n, run.rmse_braghin_n
    );
    kufe_plot::png(path, 1500, 820, &|root| {
        let (above, below) = root.split_vertically(500);
        draw_strip(
            &above,
            &title,
            "time [s]",
            "lateral force [N]",
            &lines,
            &marks,
            &[],
        )?;
        draw_strip(
            &below,
            "",
            "time [s]",
            "difference [N]",
            &difference,
            &[],
            &[],
        )
    })?;
    Ok(())
}
