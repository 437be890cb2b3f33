//! Model against measurement: errors by run and track, and the force over time.

use std::path::Path;

use crate::plot::{Key, PALETTE, Swatch, legend};
use plotters::style::IntoFont;

use super::boxes::{Category, MEANING, Spread, draw_boxes};
use super::strip::{Extras, Line, broken, draw_strip};
use crate::plot::Error;
use kufe_sled::{Disagreement, RunValidation, by_track};

/// Root mean square error by run, a box a track and law.
///
/// # Errors
/// [`Error`].
pub fn rmse_picture(path: &Path, runs: &[RunValidation]) -> Result<(), Error> {
    type Pick = fn(&RunValidation) -> f64;
    let laws: [(&str, usize, Pick); 2] = [
        ("friction model", 1, |run| run.rmse_n),
        ("Braghin's law, for comparison", 0, |run| run.rmse_braghin_n),
    ];
    let mut boxes = Vec::new();
    for track in by_track(runs) {
        for (_, colour, pick) in laws {
            let here = runs.iter().filter(|run| run.track == track.track);
            boxes.push(Category {
                name: track.track.clone(),
                colour,
                spread: Spread::of(here.map(pick)),
            });
        }
    }
    let width = 220 * boxes.len().max(4) as u32;
    let title = format!("Lateral force: what is left ({MEANING})");
    let keys = laws.map(|(name, colour, _)| Key::new(Swatch::Fill, PALETTE[colour], name));
    crate::plot::png(path, width, 600, &|root| {
        let area = root.margin(10, 0, 0, 0);
        let area = area.titled(&title, ("sans-serif", 22).into_font())?;
        draw_boxes(&legend(&area, &keys)?, "", "RMSE by run [N]", &boxes)
    })?;
    Ok(())
}

/// One run's lateral force over time, with the largest disagreements marked.
///
/// # Errors
/// [`Error`].
pub fn lateral_force_picture(path: &Path, run: &RunValidation) -> Result<(), Error> {
    let line = |name, colour, pick: fn(&kufe_sled::LateralForce) -> f64| Line {
        name,
        colour,
        points: broken(&run.pieces, |i| (run.series[i].t_s, pick(&run.series[i]))),
    };
    let lines = [
        line("measured", 6, |f| f.measured_n),
        line("friction model", 1, |f| f.model_n),
    ];
    let difference = [line("measured - model", 0, |f| f.measured_n - f.model_n)];
    let mark = |d: &Disagreement| (d.t_s, format!("{:.0} m", d.s_m));
    let extras = Extras {
        marks: run.largest.iter().map(mark).collect(),
        marks_are: "largest differences, with their place on the track",
        ..Extras::default()
    };
    let title = format!(
        "{} on {}: RMSE {:.0} N (Braghin's law {:.0} N)",
        run.run, run.track, run.rmse_n, run.rmse_braghin_n
    );
    crate::plot::png(path, 1500, 820, &|root| {
        let (above, below) = root.split_vertically(500);
        draw_strip(
            &above,
            &title,
            "time [s]",
            "lateral force [N]",
            &lines,
            &extras,
        )?;
        draw_strip(
            &below,
            "",
            "time [s]",
            "difference [N]",
            &difference,
            &Extras::default(),
        )
    })?;
    Ok(())
}
