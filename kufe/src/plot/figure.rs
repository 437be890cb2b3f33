//! A picture as data: figure, rows, panels, axes and layers.

use std::ops::Range;

use crate::plot::colour::{Colour, INK, Rgb, viridis};
use crate::plot::layout::laid_out;
use crate::plot::png::png;
use crate::plot::shape::Cells;
use crate::plot::svg::svg;

/// A point in the units of a panel's axes.
pub type Point = (f64, f64);

/// A picture: rows of panels under a title.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Width \[pixels\]; the height follows from the rows.
    pub width: f64,
    /// Size of the letters \[pixels\].
    pub letters: f64,
    /// Title; may be empty.
    pub title: String,
    /// Alternative text for screen readers; the title where it is empty.
    pub label: String,
    /// The rows from top to bottom.
    pub rows: Vec<Row>,
}

/// Panels next to each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Height of the plotting areas \[pixels\]; for panels with names along y it follows from their
    /// number.
    pub height: f64,
    /// The panels, of equal width.
    pub panels: Vec<Panel>,
    /// Colour bar of maps.
    pub bar: Option<ColourBar>,
}

/// Axes with layers; the legend lists each named layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Title; may be empty.
    pub title: String,
    /// The x axis and the y axis.
    pub axes: [Axis; 2],
    /// The layers from back to front.
    pub layers: Vec<Layer>,
    /// Relation of the scales of two axes with the same unit.
    pub scales: Scales,
}

/// Relation of the scales of a panel's axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scales {
    /// Independent scales.
    Independent,
    /// Independent scales; the label of y states the ratio of the scales.
    Stretched,
    /// Equal scales: the shorter range is extended.
    Equal,
}

/// An axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// First and last value, in either order; the extent of the layers where it is absent.
    pub range: Option<[f64; 2]>,
    /// Ticks.
    pub ticks: Ticks,
}

/// Ticks of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Ticks {
    /// At round numbers.
    #[default]
    Linear,
    /// Ticks of a logarithmic axis.
    Logarithmic,
    /// Texts at positions; of two that overlap the first is written. Empty for no ticks.
    Names(Vec<(f64, String)>),
}

impl Axis {
    /// A linear axis.
    pub fn new(label: impl Into<String>) -> Self {
        Axis::with(label, Ticks::Linear)
    }

    /// An axis with any ticks.
    pub fn with(label: impl Into<String>, ticks: Ticks) -> Self {
        Axis {
            label: label.into(),
            range: None,
            ticks,
        }
    }

    /// Names at 0.5, 1.5 and so on; see [`reversed`](Self::reversed).
    pub fn names(label: &str, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let names = names.into_iter().enumerate();
        let names = names.map(|(k, name)| (k as f64 + 0.5, name.into()));
        let names: Vec<(f64, String)> = names.collect();
        let range = [0.0, names.len() as f64];
        Axis::with(label, Ticks::Names(names)).within(range)
    }

    /// An axis without ticks and label.
    pub fn blank(range: [f64; 2]) -> Self {
        Axis::with("", Ticks::Names(Vec::new())).within(range)
    }

    /// The axis with this range.
    pub fn within(mut self, range: [f64; 2]) -> Self {
        self.range = Some(range);
        self
    }

    /// Reverses the axis, so that names are listed from the top.
    pub fn reversed(mut self) -> Self {
        self.range = self.range.map(|[from, to]| [to, from]);
        self
    }
}

impl Panel {
    /// A panel without title.
    pub fn new(x: Axis, y: Axis, layers: Vec<Layer>) -> Self {
        Panel {
            title: String::new(),
            axes: [x, y],
            layers,
            scales: Scales::Independent,
        }
    }

    /// The panel with a title.
    pub fn titled(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// The panel with these scales.
    pub fn scaled(mut self, scales: Scales) -> Self {
        self.scales = scales;
        self
    }
}

/// One layer of a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Name in the legend, which lists equal names once; an empty name is not listed.
    pub name: String,
    /// Tooltip on a page; may be empty.
    pub hint: String,
    /// Colour.
    pub colour: Colour,
    /// Shape.
    pub mark: Mark,
}

/// Shape of a layer. Infinite coordinates are at the ends of an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A line of a width \[pixels\], broken at NaN points.
    Line(Vec<Point>, f64),
    /// Points of a radius \[pixels\].
    Dots(Vec<Point>, f64, Symbol),
    /// A filled polygon.
    Area(Vec<Point>),
    /// Coloured cells between two values of x and two of y, equally spaced on the axes.
    Map([[f64; 2]; 2], Cells),
    /// A text at a point, shifted to the right and up by multiples of the font size. A text with
    /// infinite y is above the panel.
    Text(Point, String, [f64; 2]),
}

/// Shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// A disc.
    Disc,
    /// A ring.
    Ring,
    /// Two crossed lines.
    Cross,
    /// An upright line.
    Stroke,
}

impl Layer {
    /// A layer without a name.
    pub fn new(mark: Mark, colour: Colour) -> Self {
        Layer {
            name: String::new(),
            hint: String::new(),
            colour,
            mark,
        }
    }

    /// A line of this width.
    pub fn line(width: f64, points: impl IntoIterator<Item = Point>, colour: Colour) -> Self {
        Layer::new(Mark::Line(points.into_iter().collect(), width), colour)
    }

    /// Separate straight lines of this width.
    pub fn segments(
        width: f64,
        ends: impl IntoIterator<Item = [Point; 2]>,
        colour: Colour,
    ) -> Self {
        let gap = (f64::NAN, f64::NAN);
        let points = ends.into_iter().flat_map(|[from, to]| [from, to, gap]);
        Layer::line(width, points, colour)
    }

    /// Discs of this radius.
    pub fn dots(radius: f64, points: impl IntoIterator<Item = Point>, colour: Colour) -> Self {
        Layer::symbols(Symbol::Disc, radius, points, colour)
    }

    /// Points of any shape.
    pub fn symbols(
        symbol: Symbol,
        radius: f64,
        points: impl IntoIterator<Item = Point>,
        colour: Colour,
    ) -> Self {
        let points = points.into_iter().collect();
        Layer::new(Mark::Dots(points, radius, symbol), colour)
    }

    /// A filled polygon.
    pub fn area(corners: impl IntoIterator<Item = Point>, colour: Colour) -> Self {
        Layer::new(Mark::Area(corners.into_iter().collect()), colour)
    }

    /// A filled rectangle between two values of x and two of y.
    pub fn rectangle([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], colour: Colour) -> Self {
        Layer::area([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], colour)
    }

    /// A shaded range of x over the whole height.
    pub fn stretch(range: [f64; 2], colour: Colour) -> Self {
        Layer::rectangle(range, [f64::NEG_INFINITY, f64::INFINITY], colour)
    }

    /// Coloured cells between two values of x and two of y.
    pub fn map(window: [[f64; 2]; 2], cells: Cells) -> Self {
        Layer::new(Mark::Map(window, cells), INK)
    }

    /// A text next to a place, or at it; see [`Mark::Text`].
    pub fn text(at: Point, text: impl Into<String>, shift: [f64; 2], colour: Colour) -> Self {
        Layer::new(Mark::Text(at, text.into(), shift), colour)
    }

    /// A text above the panel.
    pub fn above(x: f64, text: impl Into<String>) -> Self {
        Layer::text((x, f64::INFINITY), text, [0.0, 0.75], INK)
    }

    /// A horizontal line over the whole width.
    pub fn level(y: f64) -> Self {
        let ends = [(f64::NEG_INFINITY, y), (f64::INFINITY, y)];
        Layer::line(1.0, ends, INK.alpha(0.4))
    }

    /// A vertical line over the whole height.
    pub fn upright(x: f64, colour: Colour) -> Self {
        Layer::line(1.0, [(x, f64::NEG_INFINITY), (x, f64::INFINITY)], colour)
    }

    /// The layer with a name in the legend.
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// The layer with a text that a page shows when the pointer is over it.
    pub fn hinted(mut self, hint: impl Into<String>) -> Self {
        self.hint = hint.into();
        self
    }
}

/// The points of a series with a NaN point after each piece, at which a line is broken.
pub fn broken(pieces: &[Range<usize>], point: impl Fn(usize) -> Point) -> Vec<Point> {
    let mut points = Vec::new();
    for piece in pieces {
        points.extend(piece.clone().map(&point));
        points.push((f64::NAN, f64::NAN));
    }
    points
}

/// Colour bar of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct ColourBar {
    /// Quantity and unit.
    pub label: String,
    /// Lowest and highest value.
    pub range: [f64; 2],
    /// Colours from the lowest to the highest value.
    pub colours: Vec<Rgb>,
}

impl ColourBar {
    /// A bar of a colour map, which is a function of the position in the range from 0 to 1.
    pub fn new(label: impl Into<String>, range: [f64; 2], map: impl Fn(f64) -> Rgb) -> Self {
        ColourBar {
            label: label.into(),
            range,
            colours: (0..256).map(|k| map(f64::from(k) / 255.0)).collect(),
        }
    }

    /// A bar of [`viridis`].
    pub fn viridis(label: impl Into<String>, range: [f64; 2]) -> Self {
        ColourBar::new(label, range, viridis)
    }

    /// The colour of a value. Values outside the range have the colour of the nearer end, NaN is
    /// mid-grey.
    pub fn colour(&self, value: f64) -> Rgb {
        let share = (value - self.range[0]) / (self.range[1] - self.range[0]);
        if share.is_nan() {
            [128; 3]
        } else {
            self.colours[(share.clamp(0.0, 1.0) * 255.0).round() as usize]
        }
    }
}

impl Figure {
    /// A picture without panels.
    pub fn new(width: f64, title: impl Into<String>) -> Self {
        Figure {
            width,
            letters: 14.0,
            title: title.into(),
            label: String::new(),
            rows: Vec::new(),
        }
    }

    /// The picture with a further row, whose plotting areas have this height \[pixels\].
    pub fn row(mut self, height: f64, panels: impl IntoIterator<Item = Panel>) -> Self {
        self.rows.push(Row {
            height,
            panels: panels.into_iter().collect(),
            bar: None,
        });
        self
    }

    /// The picture with a further row for each panel.
    pub fn column(self, height: f64, panels: impl IntoIterator<Item = Panel>) -> Self {
        let panels = panels.into_iter();
        panels.fold(self, |figure, panel| figure.row(height, [panel]))
    }

    /// The picture with a colour bar at the right of its last row.
    pub fn bar(mut self, bar: ColourBar) -> Self {
        if let Some(row) = self.rows.last_mut() {
            row.bar = Some(bar);
        }
        self
    }

    /// An SVG element for a page, in the colour of the page's text.
    pub fn svg(&self) -> String {
        let (shapes, height) = laid_out(self);
        let label = match &*self.label {
            "" => &self.title,
            label => label,
        };
        svg(&shapes, [self.width, height], self.letters, label)
    }

    /// The bytes of a PNG file.
    pub fn png(&self) -> Vec<u8> {
        let (shapes, height) = laid_out(self);
        png(&shapes, [self.width, height])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_broken_between_its_pieces() {
        let points = broken(&[0..2, 5..6], |i| (i as f64, 0.0));
        let known = |p: &Point| p.0.is_finite().then_some(p.0);
        let known: Vec<Option<f64>> = points.iter().map(known).collect();
        assert_eq!(known, [Some(0.0), Some(1.0), None, Some(5.0), None]);
    }

    #[test]
    fn a_bar_has_the_colours_of_its_map_at_its_ends_and_grey_for_no_number() {
        let bar = ColourBar::viridis("p [Pa]", [2.0, 4.0]);
        let found = [2.0, 4.0, 9.0, f64::NAN].map(|value| bar.colour(value));
        assert_eq!(found, [viridis(0.0), viridis(1.0), viridis(1.0), [128; 3]]);
    }
}
