//! One recorded run at a glance.

use std::path::Path;

use super::strip::{Extras, Line, broken, draw_strip};
use crate::plot::Error;
use kufe_sled::Prepared;

/// Slip angles, accelerations at the centre of gravity, speed and steering over time.
///
/// # Errors
/// [`Error`].
pub fn run_picture(path: &Path, run: &Prepared) -> Result<(), Error> {
    let series = |name: &'static str, colour, value: &dyn Fn(usize) -> f64| Line {
        name,
        colour,
        points: broken(&run.pieces, |i| (run.states[i].t_s, value(i))),
    };
    let (s, m) = (&run.states, &run.motions);
    let panels: [(&str, Vec<Line>); 4] = [
        (
            "slip [degrees]",
            vec![
                series("front", 1, &|i| s[i].alpha_f_rad.to_degrees()),
                series("rear", 0, &|i| s[i].alpha_r_rad.to_degrees()),
            ],
        ),
        (
            "acceleration [m/s²]",
            vec![
                series("vertical", 0, &|i| m[i].accel_mps2[2]),
                series("lateral", 1, &|i| m[i].accel_mps2[1]),
                series("longitudinal", 2, &|i| m[i].accel_mps2[0]),
            ],
        ),
        ("speed [m/s]", vec![series("speed", 0, &|i| s[i].v_mps)]),
        (
            "angle [degrees]",
            vec![
                series("steering", 1, &|i| s[i].delta_rad.to_degrees()),
                series("roll-split", 0, &|i| s[i].gamma_rad.to_degrees()),
            ],
        ),
    ];
    let title = format!("{} on {}", run.entry.run, run.entry.track);
    crate::plot::png(path, 1500, 1300, &|root| {
        let root = root
            .margin(10, 0, 0, 0)
            .titled(&title, ("sans-serif", 26))?;
        for ((name, lines), area) in panels.iter().zip(root.split_evenly((4, 1))) {
            draw_strip(&area, "", "time [s]", name, lines, &Extras::default())?;
        }
        Ok(())
    })?;
    Ok(())
}
