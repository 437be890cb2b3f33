//! `groove.png`: the groove across and along, and pressure and film along the patch.

use std::path::Path;

use crate::Pressed;
use crate::slide::Slid;
use kufe_plot::{Error, PALETTE, PngRoot, png, tick_text};
use plotters::prelude::*;

const WIDTH: u32 = 1100;
const HEIGHT: u32 = 1240;

/// Draws the three pictures under each other.
///
/// # Errors
/// [`Error`] where the picture cannot be drawn or written.
pub fn write(path: &Path, pressed: &Pressed, slid: &Slid) -> Result<(), Error> {
    png(path, WIDTH, HEIGHT, &|root| {
        let parts = root.split_evenly((3, 1));
        let across = slid
            .groove
            .profile
            .y()
            .iter()
            .zip(slid.groove.profile.depth());
        let across: Vec<(f64, f64)> = across.map(|(y, d)| (1e3 * y, -1e6 * d)).collect();
        let widest = 0.75e3
            * slid
                .groove
                .sections
                .iter()
                .map(|s| s.width)
                .fold(0.0, f64::max);
        let within = across
            .into_iter()
            .filter(|(y, _)| y.abs() <= widest)
            .collect();
        draw(
            &parts[0],
            &Chart {
                title: "the groove that is left",
                x: "y across [mm]",
                y: "height of the ice [µm]",
                lines: vec![("", within)],
            },
        )?;
        draw(
            &parts[1],
            &Chart {
                title: "the groove's deepest line under the runner, which slides to the right",
                x: "x along the runner [mm]",
                y: "height of the unloaded ice [µm]",
                lines: vec![("", deepest_line(pressed, slid))],
            },
        )?;
        draw(
            &parts[2],
            &Chart {
                title: "the patch",
                x: "x along the runner [mm]",
                y: "film [0.1 µm], pressure [MPa], width [0.1 mm]",
                lines: along(slid),
            },
        )
    })
}

/// Plastic depth along the line on which the groove is deepest, as far as the patch reaches.
fn deepest_line(pressed: &Pressed, slid: &Slid) -> Vec<(f64, f64)> {
    let field = &pressed.solution.surface;
    let nx = field.x.len();
    let deepest = (0..field.y.len())
        .max_by(|&i, &j| slid.groove.depth[i * nx].total_cmp(&slid.groove.depth[j * nx]))
        .unwrap_or(0);
    let length = slid.groove.front.value - slid.groove.back.value;
    let from = slid.groove.lowest + slid.groove.back.value - 0.2 * length;
    let to = slid.groove.lowest + slid.groove.front.value + 0.2 * length;
    (0..nx)
        .filter(|&i| (from..=to).contains(&field.x[i]))
        .map(|i| (1e3 * field.x[i], -1e6 * slid.groove.depth[deepest * nx + i]))
        .collect()
}

fn along(slid: &Slid) -> Vec<(&'static str, Vec<(f64, f64)>)> {
    let stations = &slid.film.film.stations;
    let line = |value: &dyn Fn(&kufe_friction::film::FilmStation) -> f64| {
        let point =
            |s: &kufe_friction::film::FilmStation| (1e3 * (slid.film.front - s.xi), value(s));
        stations.iter().map(point).collect()
    };
    vec![
        ("film", line(&|s| 1e7 * s.thickness)),
        ("pressure", line(&|s| 1e-6 * s.pressure)),
        ("width", line(&|s| 1e4 * s.width)),
    ]
}

struct Chart {
    title: &'static str,
    x: &'static str,
    y: &'static str,
    lines: Vec<(&'static str, Vec<(f64, f64)>)>,
}

fn draw(area: &PngRoot, chart: &Chart) -> Result<(), Error> {
    let points = || chart.lines.iter().flat_map(|(_, points)| points);
    let range = |of: &dyn Fn(&(f64, f64)) -> f64| {
        let low = points().map(of).fold(f64::INFINITY, f64::min);
        let high = points().map(of).fold(f64::NEG_INFINITY, f64::max);
        let margin = 0.05 * (high - low).max(1e-6);
        (low - margin)..(high + margin)
    };
    let (xs, ys) = (range(&|p| p.0), range(&|p| p.1));
    let (wide, high) = (xs.end - xs.start, ys.end - ys.start);
    let mut builder = ChartBuilder::on(area);
    builder
        .caption(chart.title, ("sans-serif", 24))
        .margin(14)
        .margin_right(28)
        .x_label_area_size(54)
        .y_label_area_size(92);
    let mut drawn = builder.build_cartesian_2d(xs, ys)?;
    drawn
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 230))
        .x_desc(chart.x)
        .y_desc(chart.y)
        .x_label_formatter(&|x| tick_text(*x, wide))
        .y_label_formatter(&|y| tick_text(*y, high))
        .label_style(("sans-serif", 18))
        .axis_desc_style(("sans-serif", 20))
        .draw()?;
    for ((name, points), colour) in chart.lines.iter().zip(PALETTE) {
        let line = LineSeries::new(points.iter().copied(), colour.stroke_width(2));
        let line = drawn.draw_series(line)?;
        if !name.is_empty() {
            line.label(*name).legend(move |(x, y)| {
                PathElement::new(vec![(x, y), (x + 24, y)], colour.stroke_width(3))
            });
        }
    }
    if chart.lines.len() > 1 {
        drawn
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.8))
            .label_font(("sans-serif", 18))
            .draw()?;
    }
    Ok(())
}
