//! Small diagrams for the page, in the page's own text colour.

use std::fmt::Write as _;

use crate::plot::{axis_ticks, unit_of};

use super::data::Data;
use super::parts::for_both;
use crate::report::page::escape;
use crate::report::sign::sign;

/// Colours of what is before and after; told apart by colour-blind readers, on white and on black.
pub const COLOURS: [&str; 2] = ["#d0703c", "#3f8fd0"];

/// Points in up to two series over a column, with bars of their deviations, a curve or the level 0.
pub fn diagram(plot: Data) -> String {
    drawn(plot, WIDTH)
}

/// The same over a page's whole width.
pub fn wide_diagram(plot: Data) -> String {
    for_both([WHOLE, WIDTH], |width| drawn(plot, width))
}

fn drawn(plot: Data, width: f64) -> String {
    let x = plot.numbers("x");
    let series = plot.list("series");
    let mut ends = Vec::new();
    for one in &series {
        let (y, sd) = (one.numbers("y"), one.numbers("sd"));
        match sd.is_empty() {
            true => ends.extend(y),
            false => ends.extend(y.iter().zip(&sd).flat_map(|(y, sd)| [y - sd, y + sd])),
        }
    }
    let frame = Frame::around(&x, &ends, width);
    let mut svg = frame.open(plot.text("label"));
    let column = plot.text("x_name");
    let name = match &*sign(&unit_of(column)) {
        "" => column.to_owned(),
        unit => format!("{column} [{unit}]"),
    };
    frame.axes(&mut svg, &escape(&name), &escape(plot.text("y_name")));
    if plot.has("curve") {
        let curve = plot.part("curve");
        let points: Vec<(f64, f64)> = curve
            .numbers("x")
            .into_iter()
            .zip(curve.numbers("y"))
            .collect();
        frame.line(&mut svg, &points, curve.text("name"), 1);
    } else {
        frame.level(&mut svg, 0.0);
    }
    for (colour, one) in series.iter().enumerate() {
        let y = one.numbers("y");
        frame.bars(&mut svg, &x, &y, &one.numbers("sd"));
        frame.points(&mut svg, &x, &y, one.text("name"), colour);
    }
    let _ = writeln!(svg, "</svg>");
    svg
}

/// A diagram's ranges.
struct Frame {
    /// Range of x.
    x: [f64; 2],
    /// Range of y.
    y: [f64; 2],
    /// Width of the picture.
    width: f64,
}

/// Widths of a diagram beside another, and of one by itself.
const WIDTH: f64 = 480.0;
const WHOLE: f64 = 940.0;
const LEFT: f64 = 58.0;
const TOP: f64 = 26.0;
const BOTTOM: f64 = 250.0;
/// Ticks that leave three numbers on any axis.
const TICKS: usize = 8;

impl Frame {
    /// Ranges that hold all values with a margin.
    fn around(x: &[f64], y: &[f64], width: f64) -> Self {
        let range = |values: &[f64]| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let margin = (0.06 * (high - low)).max(1e-9 * high.abs()).max(1e-12);
            [low - margin, high + margin]
        };
        Self {
            x: range(x),
            y: range(y),
            width,
        }
    }

    /// The opening tag.
    fn open(&self, label: &str) -> String {
        format!(
            "<svg viewBox=\"0 0 {0} 300\" width=\"{0}\" role=\"img\" aria-label=\"{1}\" font-family=\"system-ui,sans-serif\" font-size=\"13\" fill=\"currentColor\">\n",
            self.width,
            escape(label)
        )
    }

    fn right(&self) -> f64 {
        self.width - 8.0
    }

    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let share = |v: f64, [low, high]: [f64; 2]| (v - low) / (high - low);
        (
            LEFT + (self.right() - LEFT) * share(x, self.x),
            BOTTOM - (BOTTOM - TOP) * share(y, self.y),
        )
    }

    /// Frame, ticks and names of the axes.
    fn axes(&self, svg: &mut String, x: &str, y: &str) {
        let _ = writeln!(
            svg,
            "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"currentColor\" opacity=\"0.5\"/>\
<text x=\"{}\" y=\"290\" text-anchor=\"middle\">{x}</text><text x=\"8\" y=\"16\">{y}</text>",
            self.right() - LEFT,
            BOTTOM - TOP,
            0.5 * (LEFT + self.right()),
        );
        for tick in axis_ticks(self.x[0], self.x[1], TICKS) {
            let (at, _) = self.at(tick, self.y[0]);
            let _ = writeln!(
                svg,
                "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{BOTTOM}\" y2=\"{}\" stroke=\"currentColor\"/><text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                BOTTOM + 5.0,
                BOTTOM + 20.0,
                plain(tick)
            );
        }
        for tick in axis_ticks(self.y[0], self.y[1], TICKS) {
            let (_, at) = self.at(self.x[0], tick);
            let _ = writeln!(
                svg,
                "<line x1=\"{}\" x2=\"{LEFT}\" y1=\"{at:.1}\" y2=\"{at:.1}\" stroke=\"currentColor\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                LEFT - 5.0,
                LEFT - 8.0,
                at + 4.0,
                plain(tick)
            );
        }
    }

    /// A horizontal line.
    fn level(&self, svg: &mut String, y: f64) {
        let (_, at) = self.at(self.x[0], y);
        let _ = writeln!(
            svg,
            "<line x1=\"{LEFT}\" x2=\"{}\" y1=\"{at:.1}\" y2=\"{at:.1}\" stroke=\"currentColor\" opacity=\"0.4\"/>",
            self.right()
        );
    }

    /// Points, with an entry in the key.
    fn points(&self, svg: &mut String, x: &[f64], y: &[f64], name: &str, colour: usize) {
        for (x, y) in x.iter().zip(y) {
            let (x, y) = self.at(*x, *y);
            let _ = write!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{}\"/>",
                COLOURS[colour]
            );
        }
        self.key(svg, name, colour);
    }

    /// Vertical bars of one standard deviation.
    fn bars(&self, svg: &mut String, x: &[f64], y: &[f64], sd: &[f64]) {
        for ((x, y), sd) in x.iter().zip(y).zip(sd) {
            let ((at, low), (_, high)) = (self.at(*x, y - sd), self.at(*x, y + sd));
            let _ = write!(
                svg,
                "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{low:.1}\" y2=\"{high:.1}\" stroke=\"{}\" opacity=\"0.7\"/>",
                COLOURS[0]
            );
        }
    }

    /// A line, clipped to the frame, with an entry in the key.
    fn line(&self, svg: &mut String, points: &[(f64, f64)], name: &str, colour: usize) {
        let inside = |y: f64| (self.y[0]..=self.y[1]).contains(&y);
        let path: Vec<String> = points
            .iter()
            .filter(|p| inside(p.1))
            .map(|p| {
                let (x, y) = self.at(p.0, p.1);
                format!("{x:.1},{y:.1}")
            })
            .collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>",
            path.join(" "),
            COLOURS[colour]
        );
        self.key(svg, name, colour);
    }

    fn key(&self, svg: &mut String, name: &str, colour: usize) {
        let x = self.right() - 285.0 + 140.0 * colour as f64;
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"6\" width=\"12\" height=\"12\" fill=\"{}\"/><text x=\"{}\" y=\"16\">{}</text>",
            COLOURS[colour],
            x + 17.0,
            escape(name)
        );
    }
}

/// A tick as it is usually written.
fn plain(tick: f64) -> String {
    let rounded = (tick * 1e9).round() / 1e9;
    if rounded != 0.0 && rounded.abs() < 1e-3 {
        format!("{tick:.1e}")
    } else {
        format!("{rounded}")
    }
}
