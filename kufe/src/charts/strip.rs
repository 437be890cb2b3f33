//! Lines over time or distance, one panel below the other.

use std::ops::Range;

use crate::plot::{Error, Key, PALETTE, PngRoot, Swatch, curve, legend, tick_text};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// One line of a panel; broken at points that are no numbers.
pub(super) struct Line<'a> {
    pub name: &'a str,
    pub points: Vec<(f64, f64)>,
    pub colour: usize,
}

/// Points of a series with a break between its pieces.
pub(super) fn broken(
    pieces: &[Range<usize>],
    point: impl Fn(usize) -> (f64, f64),
) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for piece in pieces {
        if !points.is_empty() {
            points.push((f64::NAN, f64::NAN));
        }
        points.extend(piece.clone().map(&point));
    }
    points
}

/// What stands beside the lines of a panel, and what it is called in the legend.
#[derive(Default)]
pub(super) struct Extras<'a> {
    /// Vertical lines with their labels.
    pub marks: Vec<(f64, String)>,
    pub marks_are: &'a str,
    /// Shaded stretches.
    pub bands: Vec<Range<f64>>,
    pub bands_are: &'a str,
}

/// Colours of marks and bands: those of no line beside them.
const MARKS: RGBColor = PALETTE[3];
const BANDS: RGBColor = PALETTE[4];

/// Draws lines in one panel, with a legend above it.
pub(super) fn draw_strip(
    root: &PngRoot,
    title: &str,
    x_name: &str,
    y_name: &str,
    lines: &[Line],
    extras: &Extras,
) -> Result<(), Error> {
    let all = || lines.iter().flat_map(|line| line.points.iter());
    let range = |pick: fn(&(f64, f64)) -> f64| {
        let (low, high) = all()
            .map(pick)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        (low, high.max(low + 1e-9))
    };
    let (x_low, x_high) = range(|point| point.0);
    let (y_low, y_high) = range(|point| point.1);
    let margin = 0.06 * (y_high - y_low);
    let (bottom, top) = (y_low - margin, y_high + margin);
    let mut area = root.margin(10, 0, 0, 0);
    if !title.is_empty() {
        area = area.titled(title, ("sans-serif", 22))?;
    }
    let area = legend(&area, &keys(lines, extras))?;
    // Labels of marks stand above the panel.
    let above = if extras.marks.is_empty() { 4 } else { 22 };
    let mut chart = ChartBuilder::on(&area)
        .margin(10)
        .margin_top(above)
        .margin_right(24)
        .x_label_area_size(44)
        .y_label_area_size(76)
        .build_cartesian_2d(x_low..x_high, bottom..top)?;
    chart
        .configure_mesh()
        .x_desc(x_name)
        .y_desc(y_name)
        .x_label_formatter(&|x| tick_text(*x, x_high - x_low))
        .y_label_formatter(&|y| tick_text(*y, y_high - y_low))
        .x_labels(12)
        .y_labels(6)
        .label_style(("sans-serif", 16))
        .light_line_style(WHITE)
        .draw()?;
    for band in &extras.bands {
        let corners = [(band.start, bottom), (band.end, top)];
        chart.draw_series([Rectangle::new(corners, BANDS.mix(0.25).filled())])?;
    }
    for (x, label) in &extras.marks {
        chart.draw_series([PathElement::new([(*x, bottom), (*x, top)], MARKS)])?;
        let (column, row) = chart.backend_coord(&(*x, top));
        let (left, upper) = area.get_base_pixel();
        let style = ("sans-serif", 15).into_font().color(&MARKS);
        let style = style.pos(Pos::new(HPos::Center, VPos::Bottom));
        area.draw(&Text::new(
            label.as_str(),
            (column - left, row - upper - 2),
            style,
        ))?;
    }
    for line in lines {
        let points = line.points.iter().copied();
        curve(&chart, points, PALETTE[line.colour])?;
    }
    Ok(())
}

/// Keys of several lines, of marks and of bands; a line alone is what its axis says.
fn keys(lines: &[Line], extras: &Extras) -> Vec<Key> {
    let named = lines.iter().filter(|_| lines.len() > 1);
    let mut keys: Vec<Key> = named
        .map(|line| Key::new(Swatch::Line, PALETTE[line.colour], line.name))
        .collect();
    if !extras.marks.is_empty() {
        keys.push(Key::new(Swatch::Line, MARKS, extras.marks_are));
    }
    if !extras.bands.is_empty() {
        keys.push(Key::new(Swatch::Fill, BANDS.mix(0.25), extras.bands_are));
    }
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_colour_of_a_panel_is_explained_and_no_two_things_share_one() {
        let line = |name, colour| Line {
            name,
            colour,
            points: vec![(0.0, 0.0), (1.0, 1.0)],
        };
        let extras = Extras {
            marks: vec![(0.5, "651 m".into())],
            marks_are: "largest difference",
            bands: vec![0.1..0.2],
            bands_are: "where they part",
        };
        // The colours of every panel's lines.
        let lines = [0, 1, 2, 6].map(|colour| line("a line", colour));
        let keys = keys(&lines, &extras);
        let rgb = |k: usize| (keys[k].colour.0, keys[k].colour.1, keys[k].colour.2);
        assert_eq!(keys.len(), 6);
        assert!((0..6).all(|k| (0..k).all(|other| rgb(k) != rgb(other))));
    }
}
