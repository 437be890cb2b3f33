//! Charts of runs over time or distance, with panels one below the other.

use std::ops::Range;

use kufe_sled::{
    Compared, DriverLosses, DrivingForce, LateralForce, Prepared, Replay, RunEvaluation,
    RunValidation,
};

use crate::plot::{Axis, Figure, Layer, PALETTE, Panel, Point, broken, extent};

/// Width of the pictures [pixels].
const WIDTH: f64 = 1500.0;

/// Colours of vertical marks and shaded ranges, which no line uses.
const MARKS: usize = 3;
const RANGES: usize = 4;

/// A line of a panel: its name, the index of its colour, and its value at the k-th sample.
type Line<'a> = (&'static str, usize, &'a dyn Fn(usize) -> f64);

/// Positions of samples along the x axis of panels, with the label of the axis.
struct Along<'a> {
    label: &'static str,
    pieces: &'a [Range<usize>],
    at: &'a dyn Fn(usize) -> f64,
}

impl Along<'_> {
    /// A panel of lines; a single line is not in the legend, since the axis names it.
    fn panel(&self, y: &str, lines: &[Line]) -> Panel {
        let named = lines.iter().map(|(name, colour, value)| {
            let points = broken(self.pieces, |k| (self.at(k), value(k)));
            let name = if lines.len() > 1 { name } else { "" };
            Layer::line(1.0, points, PALETTE[*colour]).named(name)
        });
        let known = self.pieces.iter().cloned().flatten();
        let x = Axis::new(self.label).within(extent(known.map(|k| self.at(k))));
        Panel::new(x, Axis::new(y), named.collect())
    }

    fn at(&self, k: usize) -> f64 {
        (self.at)(k)
    }
}

/// Slip angles, accelerations at the centre of gravity, speed and steering of a run over time.
pub fn run_picture(run: &Prepared) -> Figure {
    let (s, m) = (&run.states, &run.motions);
    let over_time = Along {
        label: "time [s]",
        pieces: &run.pieces,
        at: &|k| s[k].t_s,
    };
    let slip: [Line; 2] = [
        ("front", 1, &|k| s[k].alpha_f_rad.to_degrees()),
        ("rear", 0, &|k| s[k].alpha_r_rad.to_degrees()),
    ];
    let acceleration: [Line; 3] = [
        ("vertical", 0, &|k| m[k].accel_mps2[2]),
        ("lateral", 1, &|k| m[k].accel_mps2[1]),
        ("longitudinal", 2, &|k| m[k].accel_mps2[0]),
    ];
    let angle: [Line; 2] = [
        ("steering", 1, &|k| s[k].delta_rad.to_degrees()),
        ("roll-split", 0, &|k| s[k].gamma_rad.to_degrees()),
    ];
    let panels = [
        over_time.panel("slip [degrees]", &slip),
        over_time.panel("acceleration [m/s²]", &acceleration),
        over_time.panel("speed [m/s]", &[("speed", 0, &|k| s[k].v_mps)]),
        over_time.panel("angle [degrees]", &angle),
    ];
    let title = format!("{} on {}", run.entry.run, run.entry.track);
    Figure::new(WIDTH, title).column(220.0, panels)
}

/// Speed, its difference, time lost, slip angle, yaw rate and roll split of run and model over the
/// distance; shaded where run and model differ.
pub fn replay_picture(replay: &Replay) -> Figure {
    let at: &[Compared] = &replay.compared;
    let over_distance = Along {
        label: "distance [m]",
        pieces: &replay.pieces,
        at: &|k| at[k].s_m,
    };
    let panel = |column: &str, y: &str, lines: &[Line]| {
        let mut panel = over_distance.panel(y, lines);
        let sections = replay.sections.iter();
        let sections = sections.filter(|section| section.column == column);
        let shaded = sections.map(|section| {
            let range = [section.from_m, section.to_m];
            Layer::stretch(range, PALETTE[RANGES].alpha(0.25)).named("where run and model differ")
        });
        panel.layers.splice(0..0, shaded);
        panel
    };
    let degrees = f64::to_degrees(1.0);
    let columns = [
        ("v_mps", "speed [m/s]", 1.0),
        ("alpha_rad", "slip [degrees]", degrees),
        ("yaw_rate_radps", "yaw rate [degrees/s]", degrees),
        ("gamma_rad", "roll split [degrees]", degrees),
    ];
    let is_compared = |column: &str| replay.differences.iter().any(|d| d.column == column);
    let compared = columns.into_iter().enumerate();
    let compared = compared.filter(|(_, (column, ..))| is_compared(column));
    let compared = compared.map(|(n, (column, y, unit))| {
        let lines: [Line; 2] = [
            ("measured", 6, &|k| unit * at[k].values[n][0]),
            ("model", 1, &|k| unit * at[k].values[n][1]),
        ];
        panel(column, y, &lines)
    });
    let mut panels: Vec<Panel> = compared.collect();
    let faster: Line = ("", 0, &|k| at[k].values[0][0] - at[k].values[0][1]);
    let lost: Line = ("", 0, &|k| at[k].t_s[0] - at[k].t_s[1]);
    let differences = [
        panel("v_mps", "run less model [m/s]", &[faster]),
        panel("t_s", "run behind model [s]", &[lost]),
    ];
    let first = panels.len().min(1);
    panels.splice(first..first, differences);
    let title = format!("{} on {}, driven again", replay.run, replay.track);
    Figure::new(WIDTH, title).column(190.0, panels)
}

/// Lateral force of a run over time, measured and by the model, with the largest differences
/// marked.
pub fn lateral_force_picture(run: &RunValidation) -> Figure {
    let f: &[LateralForce] = &run.series;
    let over_time = Along {
        label: "time [s]",
        pieces: &run.pieces,
        at: &|k| f[k].t_s,
    };
    let forces: [Line; 2] = [
        ("measured", 6, &|k| f[k].measured_n),
        ("friction model", 1, &|k| f[k].model_n),
    ];
    let difference: Line = ("", 0, &|k| f[k].measured_n - f[k].model_n);
    let mut above = over_time.panel("lateral force [N]", &forces);
    let marks = run.largest.iter().flat_map(|d| {
        let line = Layer::upright(d.t_s, PALETTE[MARKS]);
        let line = line.named("largest differences, with their place on the track");
        [line, Layer::above(d.t_s, format!("{:.0} m", d.s_m))]
    });
    above.layers.splice(0..0, marks);
    let title = format!(
        "{} on {}: RMSE {:.0} N (Braghin's law {:.0} N)",
        run.run, run.track, run.rmse_n, run.rmse_braghin_n
    );
    let below = over_time.panel("difference [N]", &[difference]);
    Figure::new(WIDTH, title)
        .row(340.0, [above])
        .row(220.0, [below])
}

/// Actual and ideal force against the motion over the distance of a run, with the slip angles
/// below.
pub fn force_picture(run: &RunEvaluation) -> Figure {
    let f: &[DrivingForce] = &run.series;
    let over_distance = Along {
        label: "distance [m]",
        pieces: &run.pieces,
        at: &|k| f[k].s_m,
    };
    let forces: [Line; 2] = [
        ("as driven", 1, &|k| f[k].actual_n),
        ("ideal", 0, &|k| f[k].ideal_n),
    ];
    let angles: [Line; 3] = [
        ("front slip", 1, &|k| f[k].alpha_f_rad.to_degrees()),
        ("rear slip", 0, &|k| f[k].alpha_r_rad.to_degrees()),
        ("steering", 6, &|k| f[k].delta_rad.to_degrees()),
    ];
    let increase = 100.0 * run.increase_total;
    let (name, track) = (&run.run, &run.track);
    let title = format!("{name} on {track}: {increase:.2} % more loss than a straight glide");
    let forces = over_distance.panel("force along the motion [N]", &forces);
    let angles = over_distance.panel("angle [degrees]", &angles);
    Figure::new(WIDTH, title)
        .row(330.0, [forces])
        .row(270.0, [angles])
}

/// Time that drivers lose on a track: by stretch, and accumulated along the track.
pub fn losses_picture(track: &str, drivers: &[&DriverLosses]) -> Figure {
    let panel = |y: &str, points: &dyn Fn(&DriverLosses) -> Vec<Point>| {
        let layers = drivers.iter().zip(PALETTE.iter().cycle());
        let layers = layers.map(|(driver, colour)| {
            let name = format!("{} ({} runs)", driver.driver, driver.runs);
            Layer::line(1.6, points(driver), *colour).named(name)
        });
        Panel::new(Axis::new("distance [m]"), Axis::new(y), layers.collect())
    };
    let by_stretch = panel("lost on 25 m [s]", &|driver| {
        let ends = driver.stretches.iter();
        let ends = ends.flat_map(|one| [(one.from_m, one.lost_s), (one.to_m, one.lost_s)]);
        ends.collect()
    });
    let summed = panel("lost so far [s]", &|driver| {
        let mut sum = 0.0;
        let stretches = driver.stretches.iter();
        let sums = stretches.map(|one| {
            sum += one.lost_s;
            (one.to_m, sum)
        });
        sums.collect()
    });
    let title = format!("Time lost over a straight glide on {track}, mean of runs");
    Figure::new(WIDTH, title).column(280.0, [by_stretch, summed])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_alone_is_not_in_the_legend_and_marks_have_colours_of_no_line() {
        let along = Along {
            label: "time [s]",
            pieces: std::slice::from_ref(&(0..2)),
            at: &|k| k as f64,
        };
        let line: Line = ("a line", 0, &|_| 1.0);
        let named = |lines: &[Line]| {
            let layers = along.panel("y", lines).layers;
            layers.iter().filter(|layer| !layer.name.is_empty()).count()
        };
        assert_eq!([named(&[line]), named(&[line, line])], [0, 2]);
        // The colours of every panel's lines.
        let colours = [0, 1, 2, 6, MARKS, RANGES].map(|k| PALETTE[k].rgb);
        assert!((0..6).all(|k| (0..k).all(|other| colours[k] != colours[other])));
    }
}
