//! Lines over time or distance, one panel below the other.

use std::ops::Range;

use kufe_plot::{Error, PALETTE, PngRoot, tick_text};
use plotters::prelude::*;

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

/// Draws lines in one panel with a legend; `marks` are vertical lines with their labels, `bands` shaded stretches.
pub(super) fn draw_strip(
    root: &PngRoot,
    title: &str,
    x_name: &str,
    y_name: &str,
    lines: &[Line],
    marks: &[(f64, String)],
    bands: &[Range<f64>],
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
    let top = if marks.is_empty() {
        margin
    } else {
        4.0 * margin
    };
    let mut builder = ChartBuilder::on(root);
    if !title.is_empty() {
        builder.caption(title, ("sans-serif", 22));
    }
    let mut chart = builder
        .margin(10)
        .margin_right(24)
        .x_label_area_size(44)
        .y_label_area_size(76)
        .build_cartesian_2d(x_low..x_high, y_low - margin..y_high + top)?;
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
    for band in bands {
        let corners = [(band.start, y_low - margin), (band.end, y_high + top)];
        let shade = PALETTE[1].mix(0.18).filled();
        chart.draw_series([Rectangle::new(corners, shade)])?;
    }
    for line in lines {
        let colour = PALETTE[line.colour];
        for (number, piece) in line.points.split(|point| point.1.is_nan()).enumerate() {
            let drawn = chart.draw_series(LineSeries::new(
                piece.iter().copied(),
                colour.stroke_width(1),
            ))?;
            if number == 0 {
                drawn.label(line.name).legend(move |(x, y)| {
                    PathElement::new(vec![(x, y), (x + 18, y)], colour.stroke_width(3))
                });
            }
        }
    }
    for (x, label) in marks {
        let grey = PALETTE[6];
        chart.draw_series([PathElement::new(
            vec![(*x, y_low - margin), (*x, y_high + margin)],
            grey.stroke_width(1),
        )])?;
        chart.draw_series([Text::new(
            label.clone(),
            (*x, y_high + top - 0.3 * margin),
            ("sans-serif", 15).into_font().color(&grey),
        )])?;
    }
    if lines.len() > 1 {
        chart
            .configure_series_labels()
            .position(least_covered(
                lines,
                [x_low, x_high],
                [y_low - margin, y_high + top],
            ))
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.2))
            .label_font(("sans-serif", 16))
            .draw()?;
    }
    Ok(())
}

/// The corner in which a legend covers the fewest points of these lines.
fn least_covered(lines: &[Line], x: [f64; 2], y: [f64; 2]) -> SeriesLabelPosition {
    // Shares of the panel that a legend of three short names takes.
    const WIDE: f64 = 0.12;
    const HIGH: f64 = 0.35;
    let corners = [
        (SeriesLabelPosition::LowerRight, [true, false]),
        (SeriesLabelPosition::UpperRight, [true, true]),
        (SeriesLabelPosition::UpperLeft, [false, true]),
        (SeriesLabelPosition::LowerLeft, [false, false]),
    ];
    let far = |value: f64, [low, high]: [f64; 2], end: bool| {
        let share = (value - low) / (high - low);
        if end { 1.0 - share } else { share }
    };
    let covered = |[right, top]: [bool; 2]| {
        let points = lines.iter().flat_map(|line| line.points.iter());
        points
            .filter(|point| far(point.0, x, right) < WIDE && far(point.1, y, top) < HIGH)
            .count()
    };
    let fewest = corners
        .into_iter()
        .min_by_key(|(_, corner)| covered(*corner));
    fewest.map_or(SeriesLabelPosition::LowerRight, |(position, _)| position)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_goes_where_no_line_is() {
        let line = |rises: bool| Line {
            name: "a line",
            colour: 0,
            points: (0..100)
                .map(|k| (f64::from(k), f64::from(if rises { k } else { 99 - k })))
                .collect(),
        };
        let at = |rises| least_covered(&[line(rises)], [0.0, 99.0], [0.0, 99.0]);
        assert!(matches!(at(true), SeriesLabelPosition::LowerRight));
        assert!(matches!(at(false), SeriesLabelPosition::UpperRight));
    }
}
