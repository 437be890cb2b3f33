//! `pressure.png`: the map with its axes, outline and colour bar, and two cuts through the peak.

use std::path::Path;

use crate::plot::{Error, PALETTE, PngRoot, colour_bar, curve, png, tick_text, viridis};
use kufe_contact::PressureMap;
use plotters::prelude::*;

use crate::jobs::field::outline::outline;

const WIDTH: u32 = 1500;
const HEIGHT: u32 = 1040;
const BACKGROUND: RGBColor = RGBColor(244, 244, 246);
/// Below this part of the peak a point counts as outside, for the outline and the colouring.
const EDGE: f64 = 0.01;

/// Draws the maps of a contact's parts side by side, and cuts through the highest of them.
///
/// # Errors
/// [`Error`] where the picture cannot be drawn or written.
pub fn write(path: &Path, maps: &[PressureMap], title: &str) -> Result<(), Error> {
    png(path, WIDTH, HEIGHT, &|root| draw(&root, maps, title))
}

fn draw(root: &PngRoot, maps: &[PressureMap], title: &str) -> Result<(), Error> {
    let (header, body) = root.split_vertically(54);
    header.draw(&Text::new(
        title.to_string(),
        (24, 18),
        ("sans-serif", 26).into_font(),
    ))?;
    let (upper, lower) = body.split_vertically(580);
    let (map_area, bar_area) = upper.split_horizontally(1350);
    let highest = |map: &PressureMap| map.pressure.iter().copied().fold(0.0, f64::max) / 1e6;
    let Some(main) = maps.iter().max_by(|a, b| highest(a).total_cmp(&highest(b))) else {
        return Ok(());
    };
    let scale = if highest(main) > 0.0 {
        highest(main)
    } else {
        1.0
    };
    for (map, area) in maps.iter().zip(map_area.split_evenly((1, maps.len()))) {
        draw_map(&area, map, scale)?;
    }
    colour_bar(
        &bar_area.margin(12, 68, 2, 0),
        [0.0, scale],
        |p| viridis(p / scale),
        "contact pressure [MPa]",
    )?;
    draw_cuts(&lower, main, scale)
}

/// The window in millimetres: x from, x to, y from, y to.
fn window(map: &PressureMap) -> [f64; 4] {
    let span = |first: f64, step: f64, count: usize| {
        [
            1e3 * (first - 0.5 * step),
            1e3 * (first + (count as f64 - 0.5) * step),
        ]
    };
    let [x_from, x_to] = span(map.x0, map.dx, map.nx);
    let [y_from, y_to] = span(map.y0, map.dy, map.ny);
    [x_from, x_to, y_from, y_to]
}

fn draw_map(area: &PngRoot, map: &PressureMap, scale: f64) -> Result<(), Error> {
    let [x_from, x_to, y_from, y_to] = window(map);
    let mut builder = ChartBuilder::on(area);
    builder
        .margin(12)
        .margin_right(24)
        .x_label_area_size(56)
        .y_label_area_size(96);
    let mut chart = builder.build_cartesian_2d(x_from..x_to, y_from..y_to)?;
    let (columns, rows) = chart.plotting_area().get_pixel_range();
    let (width, height) = (columns.end - columns.start, rows.end - rows.start);
    let at = |column: i32, row: i32| {
        (
            columns.start + column - area_left(area),
            rows.start + row - area_top(area),
        )
    };
    area.draw(&Rectangle::new(
        [at(0, 0), at(width, height)],
        BACKGROUND.filled(),
    ))?;
    let stretch = ((x_to - x_from) / f64::from(width)) / ((y_to - y_from) / f64::from(height));
    for row in 0..height {
        let y = y_to - (f64::from(row) + 0.5) / f64::from(height) * (y_to - y_from);
        for column in 0..width {
            let x = x_from + (f64::from(column) + 0.5) / f64::from(width) * (x_to - x_from);
            let p = map.pressure_at(1e-3 * x, 1e-3 * y) / 1e6;
            if p > EDGE * scale {
                area.draw_pixel(at(column, row), &viridis(p / scale))?;
            }
        }
    }
    // All pieces as one line, with a break after each.
    let pieces = outline(map, EDGE * scale * 1e6).into_iter();
    let points = pieces.flat_map(|piece| piece.into_iter().chain([(f64::NAN, f64::NAN)]));
    curve(&chart, points.map(|(x, y)| (1e3 * x, 1e3 * y)), BLACK)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("x along the runner [mm]")
        .y_desc(format!("y across [mm], {}", stretch_text(stretch)))
        .x_label_formatter(&|x| tick_text(*x, x_to - x_from))
        .y_label_formatter(&|y| tick_text(*y, y_to - y_from))
        .label_style(("sans-serif", 18))
        .axis_desc_style(("sans-serif", 20))
        .draw()?;
    Ok(())
}

fn area_left(area: &PngRoot) -> i32 {
    area.get_pixel_range().0.start
}

fn area_top(area: &PngRoot) -> i32 {
    area.get_pixel_range().1.start
}

fn draw_cuts(area: &PngRoot, map: &PressureMap, scale: f64) -> Result<(), Error> {
    let [x_from, x_to, y_from, y_to] = window(map);
    let (left, right) = area.split_horizontally(750);
    let (x_peak, y_peak) = map.peak();
    let along = (0..map.nx).map(|i| {
        let x = map.x0 + i as f64 * map.dx;
        (1e3 * x, map.pressure_at(x, y_peak) / 1e6)
    });
    let across = (0..map.ny).map(|j| {
        let y = map.y0 + j as f64 * map.dy;
        (1e3 * y, map.pressure_at(x_peak, y) / 1e6)
    });
    let (x_mm, y_mm) = (1e3 * x_peak, 1e3 * y_peak);
    let (x_at, y_at) = (
        tick_text(x_mm, x_to - x_from),
        tick_text(y_mm, y_to - y_from),
    );
    draw_cut(
        &left,
        along.collect(),
        scale,
        &format!("along, at y = {y_at} mm"),
        "x [mm]",
    )?;
    draw_cut(
        &right,
        across.collect(),
        scale,
        &format!("across, at x = {x_at} mm"),
        "y [mm]",
    )
}

fn draw_cut(
    area: &PngRoot,
    points: Vec<(f64, f64)>,
    scale: f64,
    caption: &str,
    x_desc: &str,
) -> Result<(), Error> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Ok(());
    };
    let (from, to) = (first.0, last.0);
    let mut builder = ChartBuilder::on(area);
    builder
        .caption(caption, ("sans-serif", 20))
        .margin(12)
        .margin_right(24)
        .x_label_area_size(52)
        .y_label_area_size(96);
    let mut chart = builder.build_cartesian_2d(from..to, 0.0..1.05 * scale)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 230))
        .y_labels(8)
        .x_desc(x_desc)
        .y_desc("p [MPa]")
        .x_label_formatter(&|x| tick_text(*x, to - from))
        .y_label_formatter(&|p| tick_text(*p, scale))
        .label_style(("sans-serif", 18))
        .axis_desc_style(("sans-serif", 20))
        .draw()?;
    chart.draw_series(AreaSeries::new(
        points.iter().copied(),
        0.0,
        PALETTE[0].mix(0.15),
    ))?;
    curve(&chart, points, PALETTE[0].stroke_width(2))
}

/// How many times the upright axis is stretched.
pub(crate) fn stretch_text(stretch: f64) -> String {
    if (0.9..=1.1).contains(&stretch) {
        "to scale".to_string()
    } else if stretch >= 10.0 {
        format!("stretched {stretch:.0}x")
    } else {
        format!("stretched {stretch:.1}x")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::field::hertz_map::hertz_map;

    #[test]
    fn a_needle_is_drawn_stretched_and_to_the_last_row() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("pressure.png");
        let map = hertz_map();
        write(&path, &[map], "test")?;
        let bytes = std::fs::read(&path)?;
        assert_eq!(&bytes[1..4], b"PNG");
        assert_eq!(
            bytes[16..24],
            [WIDTH.to_be_bytes(), HEIGHT.to_be_bytes()].concat()
        );
        if let Some(keep) = std::env::var_os("KUFE_KEEP_PICTURES") {
            std::fs::copy(&path, Path::new(&keep).join("pressure-test.png"))?;
        }
        Ok(())
    }
}
