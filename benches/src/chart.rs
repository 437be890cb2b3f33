//! Lines on logarithmic axes.

use kufe::plot::{Axis, Figure, Layer, PALETTE, Panel, Ticks};

/// One line: x and y by point.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Positive x and y.
    pub points: Vec<[f64; 2]>,
}

/// Lines as functions of the size, on logarithmic axes; `label` is the label of the y axis with its
/// unit.
pub fn growth_panel(title: &str, label: &str, lines: Vec<Line>) -> Panel {
    let layers = lines.into_iter().zip(PALETTE).flat_map(|(line, colour)| {
        let points = || line.points.iter().map(|point| (point[0], point[1]));
        [
            Layer::line(2.0, points(), colour).named(&*line.name),
            Layer::dots(3.0, points(), colour),
        ]
    });
    let size = "size: unknowns, points, nodes, runs, candidates [1]";
    let axis = |label: &str| Axis::with(label, Ticks::Logarithmic);
    Panel::new(axis(size), axis(label), layers.collect()).titled(title)
}

/// Panels side by side.
pub fn growth_figure(panels: [Panel; 2]) -> Figure {
    Figure::new(1120.0, "").row(320.0, panels)
}
