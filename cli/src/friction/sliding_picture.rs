//! `friction.png`: mu of each runner over speed, over temperature, or runner by runner.

use kufe::jobs::slide::FrictionPoint;
use kufe::plot::{Error, Key, PALETTE, PngRoot, Swatch, curve, legend, tick_text};
use plotters::prelude::*;

use crate::friction::asked::Runner;

/// What the points of a line differ by.
#[derive(Clone, Copy, PartialEq)]
enum Over {
    Speed,
    Temperature,
    Runner,
}

/// A line: its name, and place, mu and error of its points [1e-3].
type Line = (String, Vec<[f64; 3]>);

/// Draws mu over speed where there are several, else over temperature, else runner by runner.
///
/// # Errors
/// [`Error`] where the picture cannot be drawn.
pub fn draw(root: &PngRoot, runners: &[Runner]) -> Result<(), Error> {
    let points = || runners.iter().flat_map(|runner| &runner.points);
    let differ =
        |of: fn(&FrictionPoint) -> f64| points().any(|p| Some(of(p)) != points().next().map(of));
    let over = match (differ(|p| p.v_mps), differ(|p| p.ice_c)) {
        (true, _) => Over::Speed,
        (_, true) => Over::Temperature,
        _ => Over::Runner,
    };
    let lines = lines(runners, over);
    let places = || lines.iter().flat_map(|(_, line)| line);
    let most = places().map(|at| at[1] + at[2]).fold(0.0, f64::max);
    let (low, high) = match over {
        Over::Speed => (0.0, 1.05 * places().map(|at| at[0]).fold(0.0, f64::max)),
        Over::Temperature => (1.05 * places().map(|at| at[0]).fold(0.0, f64::min), 0.0),
        Over::Runner => (0.0, runners.len() as f64 + 1.0),
    };
    let least = places()
        .map(|at| at[1] - at[2])
        .fold(f64::INFINITY, f64::min);
    // Runner by runner the differences count, else the size.
    let (lowest, highest) = match over {
        Over::Runner => (least - 0.2 * (most - least), most + 0.2 * (most - least)),
        _ => (0.0, 1.1 * most),
    };
    let named = lines
        .iter()
        .zip(PALETTE.iter().cycle())
        .filter(|_| over != Over::Runner);
    let keys: Vec<Key> = named
        .map(|((name, _), colour)| Key::new(Swatch::Line, *colour, name))
        .collect();
    let area = root.margin(12, 0, 0, 0);
    let area = area.titled("friction of groove and melt film", ("sans-serif", 22))?;
    let area = legend(&area, &keys)?;
    let mut builder = ChartBuilder::on(&area);
    builder
        .margin(14)
        .margin_right(26)
        .x_label_area_size(50)
        .y_label_area_size(66);
    let mut chart = builder.build_cartesian_2d(low..high, lowest..highest)?;
    let title = match over {
        Over::Speed => "speed [m/s]",
        Over::Temperature => "temperature of the ice [C]",
        Over::Runner => "runner",
    };
    let runner = |x: f64| {
        let whole = x >= 0.5 && (x - x.round()).abs() < 0.01;
        let named = runners.get((x.round() as usize).wrapping_sub(1));
        named
            .filter(|_| whole)
            .map_or_else(String::new, |r| r.name.clone())
    };
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 230))
        .x_labels(match over {
            Over::Runner => runners.len() + 2,
            _ => 10,
        })
        .x_desc(title)
        .y_desc("coefficient of friction mu [1e-3]")
        .x_label_formatter(&|x| match over {
            Over::Runner => runner(*x),
            _ => tick_text(*x, high - low),
        })
        .y_label_formatter(&|y| tick_text(*y, highest - lowest))
        .label_style(("sans-serif", 16))
        .axis_desc_style(("sans-serif", 18))
        .draw()?;
    for ((_, line), colour) in lines.iter().zip(PALETTE.iter().cycle()) {
        chart.draw_series(
            line.iter()
                .map(|at| Circle::new((at[0], at[1]), 4, colour.filled())),
        )?;
        let bars = line.iter().map(|[x, mu, error]| {
            ErrorBar::new_vertical(*x, mu - error, *mu, mu + error, colour.filled(), 10)
        });
        chart.draw_series(bars)?;
        if over != Over::Runner {
            let ends = line.iter().map(|at| (at[0], at[1]));
            curve(&chart, ends, colour.stroke_width(2))?;
        }
    }
    Ok(())
}

/// A line a runner, and over speed one a temperature too.
fn lines(runners: &[Runner], over: Over) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for (k, runner) in runners.iter().enumerate() {
        for point in &runner.points {
            let name = match (over, runners.len()) {
                (Over::Speed, 1) => format!("ice of {} C", point.ice_c),
                (Over::Speed, _) => format!("{}, {} C", runner.name, point.ice_c),
                _ => runner.name.clone(),
            };
            let place = match over {
                Over::Speed => point.v_mps,
                Over::Temperature => point.ice_c,
                Over::Runner => 1.0 + k as f64,
            };
            let mu = point.friction.mu;
            let at = [place, 1e3 * mu.value, 1e3 * mu.error];
            match lines.iter_mut().find(|line| line.0 == name) {
                Some((_, line)) => line.push(at),
                None => lines.push((name, vec![at])),
            }
        }
    }
    for (_, line) in &mut lines {
        line.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    lines
}
