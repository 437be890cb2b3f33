//! Drivers and tracks compared: energies, angles, and the forces of one run.

use std::path::Path;

use super::boxes::{Category, MEANING, Spread, draw_boxes, reach};
use super::strip::{Extras, Line, broken, draw_strip};
use crate::plot::Error;
use kufe_sled::distinct;
use kufe_sled::{DrivingForce, RunEvaluation};

/// Relative loss increases as box plots (front, rear, air, total), a box a driver or a track.
///
/// `by` picks the name that runs are grouped by; the title says what is compared.
///
/// # Errors
/// [`Error`].
pub fn energy_picture(
    path: &Path,
    title: &str,
    runs: &[RunEvaluation],
    by: fn(&RunEvaluation) -> &String,
) -> Result<(), Error> {
    type Pick = fn(&RunEvaluation) -> f64;
    let panels: [(&str, Pick); 4] = [
        ("front runner", |run| run.increase_front),
        ("rear runner", |run| run.increase_rear),
        ("air", |run| run.increase_aero),
        ("total", |run| run.increase_total),
    ];
    crate::plot::png(path, 1500, 560, &|root| {
        let title = format!("{title} ({MEANING})");
        let root = root
            .margin(10, 0, 0, 0)
            .titled(&title, ("sans-serif", 26))?;
        for ((name, pick), area) in panels.iter().zip(root.split_evenly((1, 4))) {
            let boxes = grouped(runs, by, &|run| vec![100.0 * pick(run)]);
            draw_boxes(&area, name, "loss increase [%]", &boxes)?;
        }
        Ok(())
    })?;
    Ok(())
}

/// Steering and slip angles by driver: their distributions, and the shares above 2 and 4 degrees by run.
///
/// # Errors
/// [`Error`].
pub fn angle_picture(path: &Path, runs: &[RunEvaluation]) -> Result<(), Error> {
    type Angle = fn(&DrivingForce) -> f64;
    type Share = fn(&RunEvaluation) -> [f64; 2];
    let angles: [(&str, Angle, Share); 4] = [
        (
            "steering",
            |f| f.delta_rad,
            |run| [run.steering.share_above_2deg, run.steering.share_above_4deg],
        ),
        (
            "front slip",
            |f| f.alpha_f_rad,
            |run| {
                [
                    run.slip_front.share_above_2deg,
                    run.slip_front.share_above_4deg,
                ]
            },
        ),
        (
            "rear slip",
            |f| f.alpha_r_rad,
            |run| {
                [
                    run.slip_rear.share_above_2deg,
                    run.slip_rear.share_above_4deg,
                ]
            },
        ),
        (
            "chassis slip",
            |f| f.beta_rad,
            |run| {
                [
                    run.chassis_slip.share_above_2deg,
                    run.chassis_slip.share_above_4deg,
                ]
            },
        ),
    ];
    let by: fn(&RunEvaluation) -> &String = |run| &run.driver;
    let mut rows = vec![angles.map(|(name, angle, _)| {
        let degrees = grouped(runs, by, &|run| {
            run.series.iter().map(|f| angle(f).to_degrees()).collect()
        });
        (name.to_owned(), "angle [degrees]", degrees)
    })];
    for (k, degrees) in [2, 4].into_iter().enumerate() {
        rows.push(angles.map(|(name, _, share)| {
            let shares = grouped(runs, by, &|run| vec![100.0 * share(run)[k]]);
            (
                format!("{name} above {degrees}°"),
                "share of time [%]",
                shares,
            )
        }));
    }
    rows.retain(|row| row.iter().any(|(_, _, boxes)| reach(boxes).is_some()));
    let height = 50 + 440 * rows.len() as u32;
    crate::plot::png(path, 1600, height, &|root| {
        let title = format!("Angles by driver ({MEANING})");
        let root = root
            .margin(10, 0, 0, 0)
            .titled(&title, ("sans-serif", 26))?;
        let areas = root.split_evenly((rows.len(), 4));
        for ((title, unit, boxes), area) in rows.iter().flatten().zip(areas) {
            draw_boxes(&area, title, unit, boxes)?;
        }
        Ok(())
    })?;
    Ok(())
}

/// A box a group of runs, from what each of its runs gives.
fn grouped(
    runs: &[RunEvaluation],
    by: fn(&RunEvaluation) -> &String,
    values: &dyn Fn(&RunEvaluation) -> Vec<f64>,
) -> Vec<Category> {
    let groups = distinct(runs, by).into_iter().enumerate();
    groups
        .map(|(place, group)| {
            let of = runs.iter().filter(|run| by(run) == group);
            Category {
                name: group.to_string(),
                colour: place % 6,
                spread: Spread::of(of.flat_map(values)),
            }
        })
        .collect()
}

/// Actual and ideal force against the motion over the distance of one run, with the slip angles below.
///
/// # Errors
/// [`Error`].
pub fn force_picture(path: &Path, run: &RunEvaluation) -> Result<(), Error> {
    let line = |name, colour, pick: fn(&DrivingForce) -> f64| Line {
        name,
        colour,
        points: broken(&run.pieces, |i| (run.series[i].s_m, pick(&run.series[i]))),
    };
    let forces = [
        line("as driven", 1, |f| f.actual_n),
        line("ideal", 0, |f| f.ideal_n),
    ];
    let slips = [
        line("front slip", 1, |f| f.alpha_f_rad.to_degrees()),
        line("rear slip", 0, |f| f.alpha_r_rad.to_degrees()),
        line("steering", 6, |f| f.delta_rad.to_degrees()),
    ];
    let title = format!(
        "{} on {}: {:.2} % more loss than a straight glide",
        run.run,
        run.track,
        100.0 * run.increase_total
    );
    crate::plot::png(path, 1500, 860, &|root| {
        let (above, below) = root.split_vertically(460);
        draw_strip(
            &above,
            &title,
            "distance [m]",
            "force along the motion [N]",
            &forces,
            &Extras::default(),
        )?;
        draw_strip(
            &below,
            "",
            "distance [m]",
            "angle [degrees]",
            &slips,
            &Extras::default(),
        )
    })?;
    Ok(())
}
