//! Runs over time or distance: one panel below the other.

use kufe_sled::{
    Compared, DriverLosses, DrivingForce, LateralForce, Prepared, Replay, RunEvaluation,
    RunValidation,
};

use crate::plot::{Axis, Figure, Layer, PALETTE, Panel, Point, broken, extent};

/// Width of the pictures [pixels].
const WIDTH: f64 = 1500.0;

/// Colours of vertical marks and shaded ranges: those of no line.
const MARKS: usize = 3;
const RANGES: usize = 4;

/// A line of a panel: its name, its place in the palette, and its points.
type Line = (&'static str, usize, Vec<Point>);

/// Lines over time or distance; a line that is alone is named by its axis.
fn panel(x: &str, y: &str, lines: Vec<Line>) -> Panel {
    let range = extent(lines.iter().flat_map(|line| &line.2).map(|point| point.0));
    let is_named = lines.len() > 1;
    let layers = lines.into_iter().map(|(name, colour, points)| {
        Layer::line(1.0, points, PALETTE[colour]).named(if is_named { name } else { "" })
    });
    Panel::new(Axis::new(x).within(range), Axis::new(y), layers.collect())
}

/// Slip angles, accelerations at the centre of gravity, speed and steering of a run over time.
pub fn run_picture(run: &Prepared) -> Figure {
    let (s, m) = (&run.states, &run.motions);
    let series = |name, colour, value: &dyn Fn(usize) -> f64| {
        (name, colour, broken(&run.pieces, |i| (s[i].t_s, value(i))))
    };
    let panels = [
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
    let panels = panels
        .into_iter()
        .map(|(name, lines)| panel("time [s]", name, lines));
    let title = format!("{} on {}", run.entry.run, run.entry.track);
    Figure::new(WIDTH, title).column(220.0, panels)
}

/// Speed, its difference, time lost, slip angle, yaw rate and roll split of run and model over the
/// distance; shaded where run and model differ.
pub fn replay_picture(replay: &Replay) -> Figure {
    let over_distance = |name, colour, value: &dyn Fn(&Compared) -> f64| {
        let point = |at: &Compared| (at.s_m, value(at));
        (
            name,
            colour,
            broken(&replay.pieces, |i| point(&replay.compared[i])),
        )
    };
    let degrees = f64::to_degrees(1.0);
    let columns = [
        ("v_mps", "speed [m/s]", 1.0),
        ("alpha_rad", "slip [degrees]", degrees),
        ("yaw_rate_radps", "yaw rate [degrees/s]", degrees),
        ("gamma_rad", "roll split [degrees]", degrees),
    ];
    let compared = columns.into_iter().enumerate();
    let compared =
        compared.filter(|(_, (column, ..))| replay.differences.iter().any(|d| d.column == *column));
    let mut panels: Vec<(&str, &str, Vec<Line>)> = compared
        .map(|(k, (column, name, unit))| {
            let lines = vec![
                over_distance("measured", 6, &|at| unit * at.values[k][0]),
                over_distance("model", 1, &|at| unit * at.values[k][1]),
            ];
            (column, name, lines)
        })
        .collect();
    let faster = over_distance("run less model", 0, &|at| at.values[0][0] - at.values[0][1]);
    let lost = over_distance("run behind model", 0, &|at| at.t_s[0] - at.t_s[1]);
    panels.insert(1, ("v_mps", "run less model [m/s]", vec![faster]));
    panels.insert(2, ("t_s", "run behind model [s]", vec![lost]));
    let title = format!("{} on {}, driven again", replay.run, replay.track);
    let panels = panels.into_iter().map(|(column, name, lines)| {
        let mut panel = panel("distance [m]", name, lines);
        let sections = replay
            .sections
            .iter()
            .filter(|section| section.column == column);
        let shaded = sections.map(|section| {
            let range = [section.from_m, section.to_m];
            Layer::stretch(range, PALETTE[RANGES].alpha(0.25)).named("where run and model differ")
        });
        panel.layers.splice(0..0, shaded);
        panel
    });
    Figure::new(WIDTH, title).column(190.0, panels)
}

/// Lateral force of a run over time, measured and by the model, with the largest differences
/// marked.
pub fn lateral_force_picture(run: &RunValidation) -> Figure {
    let over_time = |name, colour, value: fn(&LateralForce) -> f64| {
        let point = |f: &LateralForce| (f.t_s, value(f));
        (name, colour, broken(&run.pieces, |i| point(&run.series[i])))
    };
    let forces = vec![
        over_time("measured", 6, |f| f.measured_n),
        over_time("friction model", 1, |f| f.model_n),
    ];
    let difference = vec![over_time("measured - model", 0, |f| {
        f.measured_n - f.model_n
    })];
    let mut above = panel("time [s]", "lateral force [N]", forces);
    let marks = run.largest.iter().flat_map(|d| {
        let line = Layer::upright(d.t_s, PALETTE[MARKS]);
        let name = "largest differences, with their place on the track";
        [
            line.named(name),
            Layer::above(d.t_s, format!("{:.0} m", d.s_m)),
        ]
    });
    above.layers.splice(0..0, marks);
    let title = format!(
        "{} on {}: RMSE {:.0} N (Braghin's law {:.0} N)",
        run.run, run.track, run.rmse_n, run.rmse_braghin_n
    );
    Figure::new(WIDTH, title)
        .row(340.0, [above])
        .row(220.0, [panel("time [s]", "difference [N]", difference)])
}

/// Actual and ideal force against the motion over the distance of a run, with the slip angles
/// below.
pub fn force_picture(run: &RunEvaluation) -> Figure {
    let over_distance = |name, colour, value: fn(&DrivingForce) -> f64| {
        let point = |f: &DrivingForce| (f.s_m, value(f));
        (name, colour, broken(&run.pieces, |i| point(&run.series[i])))
    };
    let forces = vec![
        over_distance("as driven", 1, |f| f.actual_n),
        over_distance("ideal", 0, |f| f.ideal_n),
    ];
    let angles = vec![
        over_distance("front slip", 1, |f| f.alpha_f_rad.to_degrees()),
        over_distance("rear slip", 0, |f| f.alpha_r_rad.to_degrees()),
        over_distance("steering", 6, |f| f.delta_rad.to_degrees()),
    ];
    let title = format!(
        "{} on {}: {:.2} % more loss than a straight glide",
        run.run,
        run.track,
        100.0 * run.increase_total
    );
    Figure::new(WIDTH, title)
        .row(
            330.0,
            [panel("distance [m]", "force along the motion [N]", forces)],
        )
        .row(270.0, [panel("distance [m]", "angle [degrees]", angles)])
}

/// The time that drivers lose on a track: by stretch, and summed up to a place.
pub fn losses_picture(track: &str, drivers: &[&DriverLosses]) -> Figure {
    let lines = |point: &dyn Fn(&DriverLosses) -> Vec<Point>| {
        let drivers = drivers.iter().enumerate();
        let layers = drivers.map(|(k, driver)| {
            let colour = PALETTE[k % PALETTE.len()];
            let name = format!("{} ({} runs)", driver.driver, driver.runs);
            Layer::line(1.6, point(driver), colour).named(name)
        });
        layers.collect::<Vec<_>>()
    };
    let by_stretch = lines(&|driver| {
        let ends = driver.stretches.iter();
        let ends = ends.flat_map(|one| [(one.from_m, one.lost_s), (one.to_m, one.lost_s)]);
        ends.collect()
    });
    let summed = lines(&|driver| {
        let mut sum = 0.0;
        let add = |one: &kufe_sled::TrackLoss| {
            sum += one.lost_s;
            (one.to_m, sum)
        };
        driver.stretches.iter().map(add).collect()
    });
    let panel = |y: &str, layers| Panel::new(Axis::new("distance [m]"), Axis::new(y), layers);
    let title = format!("Time lost over a straight glide on {track}, mean of runs");
    Figure::new(WIDTH, title)
        .row(280.0, [panel("lost on 25 m [s]", by_stretch)])
        .row(280.0, [panel("lost so far [s]", summed)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_alone_is_not_in_the_legend_and_marks_have_colours_of_no_line() {
        let line = |colour| ("a line", colour, vec![(0.0, 0.0), (1.0, 1.0)]);
        let named = |lines: Vec<Line>| {
            let panel = panel("time [s]", "y", lines);
            panel
                .layers
                .iter()
                .filter(|layer| !layer.name.is_empty())
                .count()
        };
        assert_eq!(
            [named(vec![line(0)]), named(vec![line(0), line(1)])],
            [0, 2]
        );
        // The colours of every panel's lines.
        let colours = [0, 1, 2, 6, MARKS, RANGES].map(|k| PALETTE[k].rgb);
        assert!((0..6).all(|k| (0..k).all(|other| colours[k] != colours[other])));
    }
}
