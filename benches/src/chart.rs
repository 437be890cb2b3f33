//! Lines on logarithmic axes.

use std::path::Path;

use kufe::plot::PALETTE;
use plotters::prelude::*;

/// One line: x and y by point.
#[derive(Clone, Debug)]
pub struct Line {
    /// What the legend calls it.
    pub name: String,
    /// Positive x and y.
    pub points: Vec<[f64; 2]>,
}

/// Lines that share their axes.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Title.
    pub title: &'static str,
    /// What y is, with its unit.
    pub unit: &'static str,
    /// Its lines.
    pub lines: Vec<Line>,
}

/// Draws charts side by side over the size of what was measured, both axes logarithmic.
///
/// # Errors
/// Those of the drawing and of the file.
pub fn draw(path: &Path, charts: &[Chart]) -> Result<(), kufe::plot::Error> {
    let width = 560 * charts.len() as u32;
    kufe::plot::svg(path, width, 440, &|root| {
        for (area, chart) in root.split_evenly((1, charts.len())).iter().zip(charts) {
            let decades = |axis: usize| {
                let values = chart.lines.iter().flat_map(|l| &l.points).map(|p| p[axis]);
                let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), v| {
                    (low.min(v), high.max(v))
                });
                // The legend has the lowest decade to itself.
                let room = axis as f64;
                10f64.powf((0.9 * low).log10().floor() - room)
                    ..10f64.powf((1.1 * high).log10().ceil())
            };
            let mut axes = ChartBuilder::on(area)
                .caption(chart.title, ("sans-serif", 17))
                .margin(10)
                .x_label_area_size(42)
                .y_label_area_size(64)
                .build_cartesian_2d(decades(0).log_scale(), decades(1).log_scale())?;
            axes.configure_mesh()
                .light_line_style(WHITE)
                .x_desc("size: unknowns, points, nodes, runs, candidates [1]")
                .y_desc(chart.unit)
                .x_label_formatter(&|v| power(*v))
                .y_label_formatter(&|v| power(*v))
                .draw()?;
            for (line, colour) in chart.lines.iter().zip(PALETTE) {
                let points: Vec<(f64, f64)> = line.points.iter().map(|p| (p[0], p[1])).collect();
                axes.draw_series(LineSeries::new(points.clone(), colour.stroke_width(2)))?
                    .label(line.name.clone())
                    .legend(move |(x, y)| {
                        PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2))
                    });
                axes.draw_series(points.iter().map(|&p| Circle::new(p, 3, colour.filled())))?;
            }
            axes.configure_series_labels()
                .position(SeriesLabelPosition::LowerRight)
                .background_style(WHITE.mix(0.85))
                .border_style(BLACK.mix(0.3))
                .label_font(("sans-serif", 12))
                .draw()?;
        }
        Ok(())
    })
}

/// Powers of ten as such, small ones as numbers.
fn power(value: f64) -> String {
    let exponent = value.log10().round();
    if (-3.0..4.0).contains(&exponent) {
        format!("{value}")
    } else {
        format!("1e{exponent}")
    }
}
