//! Where the parts of a figure are on the picture.

use crate::plot::colour::{Colour, INK};
use crate::plot::figure::{
    Axis, ColourBar, Figure, Layer, Mark, Panel, Point, Row, Scales, Symbol, Ticks,
};
use crate::plot::font::width;
use crate::plot::shape::{Place, Shape};
use crate::plot::ticks::{axis_ticks, decades, short, tick_text};

/// Lengths, as multiples of the size of the letters: a line of text, from an axis to its numbers,
/// at the right of a panel, from a colour bar to the right edge.
const LINE: f64 = 1.55;
const TICK: f64 = 0.4;
const RIGHT: f64 = 1.4;
const BAR: f64 = 7.5;

/// Height of a row of a panel with names along y, next to it or above it.
const NAMED: f64 = 1.6;
const NAMED_ABOVE: f64 = 3.0;

/// Names along y that would take more than this share of the width are above their rows.
const MOST_NAMES: f64 = 0.5;

/// Width of bold letters, relative to those of the embedded font.
const BOLD: f64 = 1.15;

const FRAME: Colour = INK.alpha(0.5);
const GRID: Colour = INK.alpha(0.1);

/// The shapes of a figure, and its height.
pub fn laid_out(figure: &Figure) -> (Vec<Shape>, f64) {
    let size = figure.letters;
    let mut page = Page {
        shapes: Vec::new(),
        size,
    };
    let mut top = 0.4 * size;
    if !figure.title.is_empty() {
        top = page.title(&figure.title, 1.25 * size, [0.0, figure.width], top) + 0.3 * size;
    }
    for row in &figure.rows {
        let share = share(figure, row);
        let alike = figure
            .rows
            .iter()
            .filter(|other| other.panels.len() == row.panels.len());
        let margins = alike.flat_map(|row| {
            row.panels
                .iter()
                .map(|panel| page.left(panel, share, row.height))
        });
        let left = margins.fold(0.0, f64::max);
        let sides = |k: usize| {
            let from = k as f64 * share;
            [snapped(from + left), snapped(from + share - RIGHT * size)]
        };
        let heads = row.panels.iter().enumerate().map(|(k, panel)| {
            let [left, right] = sides(k);
            page.head(panel, right - left)
        });
        let head = heads.fold(0.0, f64::max);
        let heights = row
            .panels
            .iter()
            .map(|panel| page.height(panel, share, row.height));
        let height = heights.fold(0.0, f64::max);
        let feet = row.panels.iter().map(|panel| page.foot(&panel.x));
        let foot = feet.fold(0.0, f64::max);
        for (k, panel) in row.panels.iter().enumerate() {
            let [left, right] = sides(k);
            let area = Area {
                left,
                right,
                top: snapped(top + head),
                bottom: snapped(top + head + height),
            };
            page.panel(panel, &area, [k as f64 * share, share]);
        }
        if let Some(bar) = &row.bar {
            page.bar(
                bar,
                figure.width - BAR * size,
                [top + head, top + head + height],
            );
        }
        top += head + height + foot;
    }
    (page.shapes, (top + 0.4 * size).ceil())
}

/// Width of each panel of a row.
fn share(figure: &Figure, row: &Row) -> f64 {
    let bar = if row.bar.is_some() {
        BAR * figure.letters
    } else {
        0.0
    };
    (figure.width - bar) / row.panels.len().max(1) as f64
}

/// The middle of a pixel, where lines are sharp.
fn snapped(at: f64) -> f64 {
    at.floor() + 0.5
}

/// The plotting area of a panel.
struct Area {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

/// From values of an axis to pixels.
#[derive(Clone, Copy)]
struct Scale {
    range: [f64; 2],
    ends: [f64; 2],
    logarithmic: bool,
}

impl Scale {
    fn new(axis: &Axis, values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        Scale {
            range: range(axis, values),
            ends,
            logarithmic: axis.ticks == Ticks::Logarithmic,
        }
    }

    fn at(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        let share = if value.is_infinite() {
            f64::from(value > 0.0)
        } else if self.logarithmic {
            (value / low).ln() / (high / low).ln()
        } else {
            (value - low) / (high - low)
        };
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    fn per_pixel(&self) -> f64 {
        ((self.range[1] - self.range[0]) / (self.ends[1] - self.ends[0])).abs()
    }

    /// Extends the range to both sides until a pixel is at least this long.
    fn extend(&mut self, per_pixel: f64) {
        let more = per_pixel / self.per_pixel();
        if more > 1.0 {
            let [low, high] = self.range;
            let (middle, half) = (0.5 * (low + high), 0.5 * more * (high - low));
            self.range = [middle - half, middle + half];
        }
    }
}

/// The range of an axis: the stated one, or that of the values with a margin.
fn range(axis: &Axis, values: impl Iterator<Item = f64>) -> [f64; 2] {
    if let Some(range) = axis.range {
        return range;
    }
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low > high {
        return [0.0, 1.0];
    }
    if axis.ticks == Ticks::Logarithmic {
        return [low / 1.1, high * 1.1];
    }
    let margin = (0.05 * (high - low)).max(1e-6 * high.abs()).max(1e-12);
    [low - margin, high + margin]
}

/// The points that decide on the ranges of a panel's axes.
fn points(panel: &Panel) -> impl Iterator<Item = &Point> {
    panel.layers.iter().flat_map(|layer| match &layer.mark {
        Mark::Line { points, .. } | Mark::Dots { points, .. } | Mark::Area(points) => &points[..],
        _ => &[],
    })
}

fn scales(panel: &Panel, area: &Area) -> [Scale; 2] {
    let mut x = Scale::new(
        &panel.x,
        points(panel).map(|p| p.0),
        [area.left, area.right],
    );
    let mut y = Scale::new(
        &panel.y,
        points(panel).map(|p| p.1),
        [area.bottom, area.top],
    );
    if panel.scales == Scales::Equal {
        x.extend(y.per_pixel());
        y.extend(x.per_pixel());
    }
    [x, y]
}

/// Ticks of an axis of this length and their texts.
fn ticks(axis: &Axis, [low, high]: [f64; 2], count: f64) -> Vec<(f64, String)> {
    match &axis.ticks {
        Ticks::Names(names) => names.clone(),
        Ticks::Logarithmic => decades([low, high])
            .into_iter()
            .map(|at| (at, short(at)))
            .collect(),
        Ticks::Linear => axis_ticks(low, high, count.clamp(5.0, 12.0) as usize)
            .into_iter()
            .map(|at| (at, tick_text(at, high - low)))
            .collect(),
    }
}

/// A named layer in the legend, from left to right.
struct Entry<'a> {
    left: f64,
    row: usize,
    layer: &'a Layer,
}

/// Shapes, and the size of the letters.
struct Page {
    shapes: Vec<Shape>,
    size: f64,
}

impl Page {
    fn text(&mut self, at: Place, text: &str, anchor: f64, colour: Colour) {
        self.shapes.push(Shape::Text {
            at,
            text: text.to_owned(),
            size: self.size,
            anchor,
            turned: false,
            bold: false,
            colour,
        });
    }

    fn line(&mut self, points: impl Into<Vec<Place>>, colour: Colour, width: f64) {
        self.shapes.push(Shape::Line {
            points: points.into(),
            colour,
            width,
            dashed: false,
        });
    }

    /// Writes a title between two places; returns where it ends.
    fn title(&mut self, text: &str, size: f64, [from, to]: [f64; 2], top: f64) -> f64 {
        let lines = wrapped(text, BOLD * size, to - from);
        for (k, line) in lines.iter().enumerate() {
            self.shapes.push(Shape::Text {
                at: [0.5 * (from + to), top + LINE * size * (k as f64 + 0.5)],
                text: line.clone(),
                size,
                anchor: 0.5,
                turned: false,
                bold: true,
                colour: INK,
            });
        }
        top + LINE * size * lines.len() as f64
    }

    /// A text that reads upwards, with its middle at a place.
    fn upwards(&mut self, at: Place, text: &str) {
        self.shapes.push(Shape::Text {
            at,
            text: text.to_owned(),
            size: self.size,
            anchor: 0.5,
            turned: true,
            bold: false,
            colour: INK,
        });
    }

    /// Width of the labels at the left of a panel of this width.
    fn left(&self, panel: &Panel, wide: f64, height: f64) -> f64 {
        if is_above(panel, wide, self.size) {
            return 0.6 * self.size;
        }
        let range = range(&panel.y, points(panel).map(|p| p.1));
        let texts = ticks(&panel.y, range, height / (2.6 * self.size));
        let widest = texts
            .iter()
            .map(|(_, text)| width(text, self.size))
            .fold(0.0, f64::max);
        let label = if panel.y.label.is_empty() { 0.3 } else { LINE };
        widest + (label + 2.0 * TICK) * self.size
    }

    /// Height of what is above the plotting area: title, legend, texts.
    fn head(&self, panel: &Panel, wide: f64) -> f64 {
        let title = match panel.title.is_empty() {
            true => 0,
            false => wrapped(&panel.title, BOLD * 1.1 * self.size, wide).len(),
        };
        let rows = self
            .entries(panel, wide)
            .last()
            .map_or(0, |entry| entry.row + 1);
        let above = panel
            .layers
            .iter()
            .any(|layer| matches!(layer.mark, Mark::Above(_)));
        LINE * self.size * (1.1 * title as f64 + rows as f64 + f64::from(above)) + 0.5 * self.size
    }

    /// Height of the plotting area.
    fn height(&self, panel: &Panel, wide: f64, stated: f64) -> f64 {
        match &panel.y.ticks {
            Ticks::Names(names) if !names.is_empty() => {
                let row = if is_above(panel, wide, self.size) {
                    NAMED_ABOVE
                } else {
                    NAMED
                };
                row * self.size * names.len() as f64
            }
            _ => stated,
        }
    }

    /// Height of what is below the plotting area: numbers and the axis's name.
    fn foot(&self, x: &Axis) -> f64 {
        let numbers = if x.ticks == Ticks::Names(Vec::new()) {
            0.4
        } else {
            LINE + TICK
        };
        let label = if x.label.is_empty() { 0.0 } else { LINE };
        (numbers + label) * self.size
    }

    /// The legend: each name once, in rows.
    fn entries<'a>(&self, panel: &'a Panel, wide: f64) -> Vec<Entry<'a>> {
        let mut entries: Vec<Entry> = Vec::new();
        let mut left = 0.0;
        let mut row = 0;
        for layer in panel.layers.iter().filter(|layer| !layer.name.is_empty()) {
            if entries.iter().any(|entry| entry.layer.name == layer.name) {
                continue;
            }
            let own = 2.2 * self.size + width(&layer.name, self.size);
            if left > 0.0 && left + own > wide {
                (left, row) = (0.0, row + 1);
            }
            entries.push(Entry { left, row, layer });
            left += own + 1.5 * self.size;
        }
        entries
    }

    fn legend(&mut self, panel: &Panel, [from, to]: [f64; 2], top: f64) {
        let entries = self.entries(panel, to - from);
        for entry in &entries {
            let end = |e: &Entry| e.left + 2.2 * self.size + width(&e.layer.name, self.size);
            let ends = entries.iter().filter(|e| e.row == entry.row).map(end);
            let long = ends.fold(0.0, f64::max);
            let left = from + 0.5 * (to - from - long).max(0.0) + entry.left;
            let y = snapped(top + LINE * self.size * (entry.row as f64 + 0.5));
            let (right, middle) = (left + 1.7 * self.size, [left + 0.85 * self.size, y]);
            let Layer { colour, mark, .. } = entry.layer;
            match mark {
                Mark::Line { width, dashed, .. } => self.shapes.push(Shape::Line {
                    points: vec![[left, y], [right, y]],
                    colour: *colour,
                    width: width.max(2.0),
                    dashed: *dashed,
                }),
                Mark::Dots { radius, symbol, .. } => {
                    self.symbol(*symbol, middle, radius.max(3.0), *colour)
                }
                _ => {
                    let half = 0.45 * self.size;
                    let corners = vec![
                        [left, y - half],
                        [right, y - half],
                        [right, y + half],
                        [left, y + half],
                    ];
                    self.shapes.push(Shape::Polygon {
                        corners,
                        colour: *colour,
                    });
                }
            }
            self.text([left + 2.2 * self.size, y], &entry.layer.name, 0.0, INK);
        }
    }

    fn symbol(&mut self, symbol: Symbol, [x, y]: Place, radius: f64, colour: Colour) {
        let r = radius;
        match symbol {
            Symbol::Disc | Symbol::Ring => self.shapes.push(Shape::Circle {
                centre: [x, y],
                radius,
                colour,
                ring: symbol == Symbol::Ring,
            }),
            Symbol::Cross => {
                let gap = [f64::NAN; 2];
                let points = [
                    [x - r, y - r],
                    [x + r, y + r],
                    gap,
                    [x - r, y + r],
                    [x + r, y - r],
                ];
                self.line(points, colour, 1.0);
            }
            Symbol::Stroke => self.line([[x, y - r], [x, y + r]], colour, 2.0),
        }
    }

    /// Draws a panel whose part of the picture begins at `from` and is `wide`.
    fn panel(&mut self, panel: &Panel, area: &Area, [from, wide]: [f64; 2]) {
        let Area {
            left,
            right,
            top,
            bottom,
        } = *area;
        let size = self.size;
        let mut head = top - self.head(panel, right - left);
        if !panel.title.is_empty() {
            head = self.title(&panel.title, 1.1 * size, [left, right], head);
        }
        self.legend(panel, [left, right], head);
        let [x, y] = scales(panel, area);
        let columns = ticks(&panel.x, x.range, (right - left) / (6.0 * size));
        let is_named = matches!(&panel.y.ticks, Ticks::Names(names) if !names.is_empty());
        let rows = ticks(&panel.y, y.range, (bottom - top) / (2.6 * size));
        if !matches!(panel.x.ticks, Ticks::Names(_)) {
            for (value, _) in &columns {
                let at = snapped(x.at(*value));
                self.line([[at, top], [at, bottom]], GRID, 1.0);
            }
        }
        if !is_named {
            for (value, _) in &rows {
                let at = snapped(y.at(*value));
                self.line([[left, at], [right, at]], GRID, 1.0);
            }
        }
        for layer in &panel.layers {
            self.layer(layer, [x, y], area);
        }
        let corners = [
            [left, top],
            [right, top],
            [right, bottom],
            [left, bottom],
            [left, top],
        ];
        self.line(corners, FRAME, 1.0);
        let mut end = f64::NEG_INFINITY;
        for (value, text) in &columns {
            let (at, half) = (snapped(x.at(*value)), 0.5 * width(text, size));
            if at - half > end + 0.5 * size {
                self.line([[at, bottom], [at, bottom + TICK * size]], FRAME, 1.0);
                self.text([at, bottom + (TICK + 0.7) * size], text, 0.5, INK);
                end = at + half;
            }
        }
        let above = is_above(panel, wide, size);
        for (value, text) in &rows {
            let at = snapped(y.at(*value));
            if is_named && above {
                let text = shortened(text, size, right - left - TICK * size);
                self.text([left + TICK * size, at - 0.95 * size], &text, 0.0, INK);
            } else {
                self.line([[left - TICK * size, at], [left, at]], FRAME, 1.0);
                self.text([left - 1.7 * TICK * size, at], text, 1.0, INK);
            }
        }
        if !panel.x.label.is_empty() {
            let below = self.foot(&panel.x) - 0.6 * size;
            self.text(
                [0.5 * (left + right), bottom + below],
                &panel.x.label,
                0.5,
                INK,
            );
        }
        if !panel.y.label.is_empty() {
            let label = match panel.scales {
                Scales::Independent => panel.y.label.clone(),
                _ => format!(
                    "{}, {}",
                    panel.y.label,
                    stretch_text(x.per_pixel() / y.per_pixel())
                ),
            };
            self.upwards([from + 0.8 * size, 0.5 * (top + bottom)], &label);
        }
    }

    fn layer(&mut self, layer: &Layer, [x, y]: [Scale; 2], area: &Area) {
        let outer = std::mem::take(&mut self.shapes);
        let place = |(a, b): &Point| [x.at(*a), y.at(*b)];
        let Area {
            left,
            right,
            top,
            bottom,
        } = *area;
        let colour = layer.colour;
        match &layer.mark {
            Mark::Line {
                points,
                width,
                dashed,
            } => {
                let points: Vec<Place> = points.iter().map(place).collect();
                self.shapes.push(Shape::Line {
                    points: clipped(&points, area),
                    colour,
                    width: *width,
                    dashed: *dashed,
                });
            }
            Mark::Dots {
                points,
                radius,
                symbol,
            } => {
                let inside =
                    |[a, b]: &Place| (left..=right).contains(a) && (top..=bottom).contains(b);
                for at in points.iter().map(place).filter(inside) {
                    self.symbol(*symbol, at, *radius, colour);
                }
            }
            Mark::Area(corners) => {
                let corners = corners.iter().map(place);
                let corners = corners.map(|[a, b]| [a.clamp(left, right), b.clamp(top, bottom)]);
                let corners = corners.collect();
                self.shapes.push(Shape::Polygon { corners, colour });
            }
            Mark::Map {
                window: [across, up],
                size,
                cells,
            } => self.shapes.push(Shape::Image {
                corners: [place(&(across[0], up[1])), place(&(across[1], up[0]))],
                size: *size,
                pixels: cells.clone(),
            }),
            Mark::Text { at, text, shift } => {
                let [a, b] = place(at);
                let at = [a + shift[0] * self.size, b - shift[1] * self.size];
                let anchor = match shift[0] {
                    0.0 => 0.5,
                    right => f64::from(right < 0.0),
                };
                self.text(at, text, anchor, colour);
            }
            Mark::Above(texts) => {
                let mut end = f64::NEG_INFINITY;
                for (value, text) in texts {
                    let half = 0.5 * width(text, self.size);
                    let at = x.at(*value).min(right - half).max(left + half);
                    if at - half > end {
                        self.text([at, top - 0.75 * self.size], text, 0.5, colour);
                        end = at + half + 0.5 * self.size;
                    }
                }
            }
        }
        let shapes = std::mem::replace(&mut self.shapes, outer);
        if layer.hint.is_empty() {
            self.shapes.extend(shapes);
        } else {
            let hint = layer.hint.clone();
            self.shapes.push(Shape::Group { hint, shapes });
        }
    }

    /// Draws a colour bar, its numbers and its label between two heights.
    fn bar(&mut self, bar: &ColourBar, left: f64, [top, bottom]: [f64; 2]) {
        let size = self.size;
        let (right, top, bottom) = (left + 1.8 * size, snapped(top), snapped(bottom));
        self.shapes.push(Shape::Image {
            corners: [[left, top], [right, bottom]],
            size: [1, bar.colours.len()],
            pixels: bar
                .colours
                .iter()
                .rev()
                .map(|colour| Some(*colour))
                .collect(),
        });
        let scale = Scale {
            range: bar.range,
            ends: [bottom, top],
            logarithmic: false,
        };
        let mut widest = 0.0f64;
        for (value, text) in ticks(&Axis::default(), bar.range, (bottom - top) / (2.6 * size)) {
            let at = snapped(scale.at(value));
            self.line([[right, at], [right + TICK * size, at]], FRAME, 1.0);
            self.text([right + 1.7 * TICK * size, at], &text, 0.0, INK);
            widest = widest.max(width(&text, size));
        }
        let at = right + widest + (1.7 * TICK + 0.9) * size;
        self.upwards([at, 0.5 * (top + bottom)], &bar.label);
    }
}

/// Whether the names along y are above their rows.
fn is_above(panel: &Panel, wide: f64, size: f64) -> bool {
    let Ticks::Names(names) = &panel.y.ticks else {
        return false;
    };
    let widest = names
        .iter()
        .map(|(_, name)| width(name, size))
        .fold(0.0, f64::max);
    widest > MOST_NAMES * wide
}

/// How many times the upright axis is stretched.
fn stretch_text(stretch: f64) -> String {
    if (0.9..=1.1).contains(&stretch) {
        "to scale".to_owned()
    } else if stretch >= 10.0 {
        format!("stretched {stretch:.0}x")
    } else {
        format!("stretched {stretch:.1}x")
    }
}

/// The first letters of a text that is too long.
fn shortened(text: &str, size: f64, wide: f64) -> String {
    let mut letters: Vec<char> = text.chars().collect();
    let cut = |letters: &[char]| letters.iter().chain(&['…']).collect::<String>();
    if width(text, size) <= wide {
        return text.to_owned();
    }
    while !letters.is_empty() && width(&cut(&letters), size) > wide {
        letters.pop();
    }
    cut(&letters)
}

/// The words of a text in lines of at most this width.
fn wrapped(text: &str, size: f64, wide: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size) <= wide => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The parts of a line within a panel, with a break between them (Liang and Barsky, 1984).
fn clipped(points: &[Place], area: &Area) -> Vec<Place> {
    let bounds = [[area.left, area.right], [area.top, area.bottom]];
    let mut parts: Vec<Place> = Vec::new();
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let along = [to[0] - from[0], to[1] - from[1]];
        if !(along[0] + along[1]).is_finite() {
            continue;
        }
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for axis in 0..2 {
            for (step, room) in [
                (-along[axis], from[axis] - bounds[axis][0]),
                (along[axis], bounds[axis][1] - from[axis]),
            ] {
                if step < 0.0 {
                    first = first.max(room / step);
                } else if step > 0.0 {
                    last = last.min(room / step);
                } else if room < 0.0 {
                    last = -1.0;
                }
            }
        }
        if first <= last {
            let at = |share: f64| [from[0] + share * along[0], from[1] + share * along[1]];
            if parts.last() != Some(&at(first)) {
                if !parts.is_empty() {
                    parts.push([f64::NAN; 2]);
                }
                parts.push(at(first));
            }
            parts.push(at(last));
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(shapes: &[Shape]) -> Vec<(String, Place, f64)> {
        let text = |shape: &Shape| match shape {
            Shape::Text {
                text, at, anchor, ..
            } => Some((text.clone(), *at, *anchor)),
            _ => None,
        };
        shapes.iter().filter_map(text).collect()
    }

    fn panel(layers: Vec<Layer>) -> Panel {
        Panel {
            x: Axis::new("x [m]").within([0.0, 10.0]),
            y: Axis::new("y [m]").within([0.0, 10.0]),
            layers,
            ..Panel::default()
        }
    }

    #[test]
    fn a_legend_has_each_name_once_and_as_many_rows_as_it_needs() {
        let line = |k: usize| {
            Layer::line(1.0, [(0.0, 0.0), (1.0, 1.0)], INK).named(format!("layer {}", k % 9))
        };
        let height = |wide: f64, count: usize| {
            let figure = Figure::new(wide, "").row(100.0, [panel((0..count).map(line).collect())]);
            let (shapes, height) = laid_out(&figure);
            let named = texts(&shapes)
                .iter()
                .filter(|text| text.0.starts_with("layer"))
                .count();
            assert_eq!(named, count.min(9));
            height
        };
        let [none, one, several] = [height(900.0, 0), height(900.0, 18), height(300.0, 18)];
        assert!(none < one && one < several, "{none} {one} {several}");
    }

    #[test]
    fn no_text_runs_out_of_a_narrow_picture() {
        let rows = [
            "a name that is so much longer than a phone is wide that it is cut",
            "short",
        ];
        let named = Panel {
            title: "a title that is too long for one line of a telephone's narrow screen"
                .to_owned(),
            x: Axis::new("peak pressure [MPa]").within([0.0, 1e3]),
            y: Axis::names(rows).reversed(),
            layers: vec![Layer::dots(4.0, [(10.0, 0.5), (1e3, 1.5)], INK)],
            ..Panel::default()
        };
        let (shapes, _) = laid_out(&Figure::new(400.0, "").row(0.0, [named]));
        for (text, at, anchor) in texts(&shapes) {
            let wide = width(&text, 14.0);
            let from = at[0] - anchor * wide;
            assert!(
                from >= 0.0 && from + wide <= 400.0,
                "{text}: {from} to {}",
                from + wide
            );
        }
    }

    #[test]
    fn a_line_is_cut_where_it_leaves_the_panel_and_comes_back() {
        let area = Area {
            left: 0.0,
            right: 10.0,
            top: 0.0,
            bottom: 10.0,
        };
        let parts = clipped(&[[5.0, 5.0], [15.0, 5.0], [15.0, 9.0], [5.0, 9.0]], &area);
        let known: Vec<Place> = parts.iter().filter(|p| p[0].is_finite()).copied().collect();
        assert_eq!(known, [[5.0, 5.0], [10.0, 5.0], [10.0, 9.0], [5.0, 9.0]]);
        assert_eq!(parts.len(), 5);
        assert!(clipped(&[[-5.0, 11.0], [15.0, 12.0]], &area).is_empty());
    }

    #[test]
    fn points_are_where_their_values_are_and_infinite_ends_are_edges() {
        let layers = vec![
            Layer::dots(3.0, [(0.0, 0.0), (10.0, 10.0), (5.0, 11.0)], INK),
            Layer::stretch([2.0, 4.0], INK),
        ];
        let (shapes, _) = laid_out(&Figure::new(600.0, "").row(200.0, [panel(layers)]));
        let dots: Vec<Place> = shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Circle { centre, .. } => Some(*centre),
                _ => None,
            })
            .collect();
        let [low, high] = dots[..] else {
            panic!("{dots:?}")
        };
        assert!((low[1] - high[1] - 200.0).abs() < 1.0 && high[0] > low[0]);
        let corners = shapes
            .iter()
            .find_map(|shape| match shape {
                Shape::Polygon { corners, .. } => Some(corners.clone()),
                _ => None,
            })
            .unwrap();
        let x = |share: f64| low[0] + share * (high[0] - low[0]);
        assert_eq!([corners[0][1], corners[2][1]], [low[1], high[1]]);
        assert!((corners[0][0] - x(0.2)).abs() < 1e-9 && (corners[1][0] - x(0.4)).abs() < 1e-9);
    }

    #[test]
    fn equal_scales_have_square_pixels() {
        let square = Panel {
            scales: Scales::Equal,
            ..panel(Vec::new())
        };
        let area = Area {
            left: 0.0,
            right: 300.0,
            top: 0.0,
            bottom: 100.0,
        };
        let [x, y] = scales(&square, &area);
        assert!((x.per_pixel() / y.per_pixel() - 1.0).abs() < 1e-12);
        assert_eq!((x.range, y.range), ([-10.0, 20.0], [0.0, 10.0]));
    }
}
