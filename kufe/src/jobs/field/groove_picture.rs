//! `groove.png`: the groove across and along, and pressure and film along the patch.

use std::path::Path;

use crate::jobs::SolvedContact;
use crate::jobs::slide::SolvedSliding;
use crate::plot::{Error, Key, PALETTE, PngRoot, Swatch, curve, legend, png, tick_text};
use kufe_sled::friction::film::FilmStation;
use plotters::prelude::*;

const WIDTH: u32 = 1100;
const HEIGHT: u32 = 1300;
/// Places between two stations at which a line between them is drawn.
const BETWEEN: u32 = 16;

/// Draws the three pictures under each other; dots stand where the mesh has nodes, and stations of the film.
///
/// # Errors
/// [`Error`] where the picture cannot be drawn or written.
pub fn write(path: &Path, pressed: &SolvedContact, slid: &SolvedSliding) -> Result<(), Error> {
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
                title: "the groove that is left (dots: nodes of the mesh)",
                x: "y across [mm]",
                y: "height of the ice [µm]",
                lines: vec![Line::between("", within)],
            },
        )?;
        draw(
            &parts[1],
            &Chart {
                title: "the groove's deepest line under the runner, which slides to the right (dots: nodes)",
                x: "x along the runner [mm]",
                y: "height of the unloaded ice [µm]",
                lines: vec![Line::between("", deepest_line(pressed, slid))],
            },
        )?;
        draw(
            &parts[2],
            &Chart {
                title: "the patch (dots: stations of the film)",
                x: "x along the runner [mm]",
                y: "each in its own unit",
                lines: along(slid),
            },
        )
    })
}

/// Plastic depth along the line on which the groove is deepest, as far as the patch reaches.
fn deepest_line(pressed: &SolvedContact, slid: &SolvedSliding) -> Vec<(f64, f64)> {
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

/// Film, pressure and width over the stations, as the film's strip takes them to be in between: the pressure linear, and the square of the width.
fn along(slid: &SolvedSliding) -> Vec<Line> {
    let stations = &slid.film.film.stations;
    let dots = |value: fn(&FilmStation) -> f64| -> Vec<(f64, f64)> {
        let point = |s: &FilmStation| (1e3 * (slid.film.front - s.xi), value(s));
        stations.iter().map(point).collect()
    };
    let width = dots(|s| 1e4 * s.width);
    let squares = width.windows(2).flat_map(|pair| {
        let [(x, from), (to_x, to)] = [pair[0], pair[1]];
        (0..=BETWEEN).map(move |k| {
            let share = f64::from(k) / f64::from(BETWEEN);
            let square = from * from + share * (to * to - from * from);
            (x + share * (to_x - x), square.sqrt())
        })
    });
    let mut lines = vec![
        Line::between("film [0.1 µm]", dots(|s| 1e7 * s.thickness)),
        Line::between("pressure [MPa]", dots(|s| 1e-6 * s.pressure)),
        Line {
            name: "width [0.1 mm]",
            points: squares.collect(),
            dots: width,
        },
    ];
    if slid.friction.boundary.value > 0.0 {
        let share = dots(|s| 1e2 * s.boundary_share);
        lines.push(Line::between("boundary contact [%]", share));
    }
    lines
}

struct Line {
    name: &'static str,
    /// What is known, and the line through it.
    dots: Vec<(f64, f64)>,
    points: Vec<(f64, f64)>,
}

impl Line {
    /// Linear between its dots.
    fn between(name: &'static str, dots: Vec<(f64, f64)>) -> Line {
        Line {
            name,
            points: dots.clone(),
            dots,
        }
    }
}

struct Chart {
    title: &'static str,
    x: &'static str,
    y: &'static str,
    lines: Vec<Line>,
}

fn draw(area: &PngRoot, chart: &Chart) -> Result<(), Error> {
    let points = || chart.lines.iter().flat_map(|line| &line.points);
    let range = |of: &dyn Fn(&(f64, f64)) -> f64| {
        let low = points().map(of).fold(f64::INFINITY, f64::min);
        let high = points().map(of).fold(f64::NEG_INFINITY, f64::max);
        let margin = 0.05 * (high - low).max(1e-6);
        (low - margin)..(high + margin)
    };
    let (xs, ys) = (range(&|p| p.0), range(&|p| p.1));
    let (wide, high) = (xs.end - xs.start, ys.end - ys.start);
    let named = chart.lines.iter().zip(PALETTE);
    let named = named.filter(|(line, _)| !line.name.is_empty());
    let keys: Vec<Key> = named
        .map(|(line, colour)| Key::new(Swatch::Line, colour, line.name))
        .collect();
    let area = area.margin(12, 0, 0, 0);
    let area = legend(&area.titled(chart.title, ("sans-serif", 24))?, &keys)?;
    let mut builder = ChartBuilder::on(&area);
    builder
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
    for (line, colour) in chart.lines.iter().zip(PALETTE) {
        curve(&drawn, line.points.iter().copied(), colour.stroke_width(2))?;
        let dots = line.dots.iter();
        drawn.draw_series(dots.map(|&at| Circle::new(at, 3, colour.filled())))?;
    }
    Ok(())
}
