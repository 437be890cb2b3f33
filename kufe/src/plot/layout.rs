//! Layout of a figure: the shapes of its panels, axes, legends and colour bars.

use std::collections::BTreeSet;

use crate::plot::colour::{Colour, INK};
use crate::plot::figure::{
    Axis, ColourBar, Figure, Layer, Mark, Panel, Point, Row, Scales, Symbol, Ticks,
};
use crate::plot::font::width;
use crate::plot::shape::{Cells, Place, Shape, Style};
use crate::plot::ticks::{axis_ticks, decades, extent, short, tick_text};

// Lengths relative to the font size.
/// Height of a line of text.
const LINE: f64 = 1.55;
/// Length of a tick.
const TICK: f64 = 0.4;
/// Margin at the right of a panel.
const RIGHT: f64 = 1.4;
/// Distance from the left edge of a colour bar to the right edge of the picture.
const BAR: f64 = 7.5;
/// Space between two names of the legend.
const KEY_GAP: f64 = 1.5;
/// Width of a layer's symbol in the legend, with the space after it.
const SYMBOL: f64 = 2.2;
/// Height of a row of a panel with names along y, if the names are left of the rows.
const NAMED: f64 = 1.6;
/// Height of a row of a panel with names along y, if the names are above the rows.
const NAMED_ABOVE: f64 = 3.0;

/// Largest number of lines of a title or of a name in the legend.
const MAX_LINES: usize = 8;
/// Largest fraction of a panel's width for names left of the rows; wider names are above them.
const MAX_NAME_WIDTH: f64 = 0.5;

/// Ratio of the width of bold letters to that of the embedded font.
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
        // Rows with the same number of panels are aligned.
        let count = row.panels.len();
        let aligned = figure
            .rows
            .iter()
            .filter(|other| other.panels.len() == count);
        let aligned = aligned.flat_map(|row| row.panels.iter().map(|panel| (panel, row.height)));
        let left = largest(aligned.map(|(panel, height)| page.left(panel, share, height)));
        let wide = (share - left - RIGHT * size).round();
        let panels = || row.panels.iter();
        let head = largest(panels().map(|panel| page.head(panel, wide)));
        let height = largest(panels().map(|panel| page.height(panel, share, row.height)));
        let foot = largest(panels().map(|panel| page.foot(panel)));
        let y = [top + head, top + head + height].map(snapped);
        for (k, panel) in panels().enumerate() {
            let from = k as f64 * share;
            let x = snapped(from + left);
            page.panel(panel, [from, share], [[x, x + wide], y]);
        }
        if let Some(bar) = &row.bar {
            page.bar(bar, figure.width - BAR * size, y);
        }
        top += head + height + foot;
    }
    (page.shapes, (top + 0.4 * size).ceil())
}

/// Width of each panel of a row.
fn share(figure: &Figure, row: &Row) -> f64 {
    let bar = BAR * figure.letters * f64::from(row.bar.is_some());
    (figure.width - bar) / row.panels.len().max(1) as f64
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// The middle of a pixel, where lines are sharp.
fn snapped(at: f64) -> f64 {
    at.floor() + 0.5
}

/// The plotting area of a panel: its left and right side, and its upper and lower side.
type Area = [[f64; 2]; 2];

/// Mapping of values of an axis to pixels.
#[derive(Clone, Copy)]
struct Scale {
    range: [f64; 2],
    ends: [f64; 2],
    logarithmic: bool,
}

impl Scale {
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

    /// Extends the range on both sides until a pixel spans at least `per_pixel`.
    fn extend(&mut self, per_pixel: f64) {
        let more = (per_pixel / self.per_pixel()).max(1.0);
        let [low, high] = self.range;
        let (middle, half) = (0.5 * (low + high), 0.5 * more * (high - low));
        self.range = [middle - half, middle + half];
    }
}

/// The range of a panel's axis: the stated range, or the extent of lines, points and areas with a
/// margin.
fn range(panel: &Panel, axis: usize) -> [f64; 2] {
    if let Some(range) = panel.axes[axis].range {
        return range;
    }
    let points = panel.layers.iter().flat_map(|layer| match &layer.mark {
        Mark::Line(points, _) | Mark::Dots(points, ..) | Mark::Area(points) => &points[..],
        _ => &[],
    });
    let [low, high] = extent(points.map(|(x, y)| [*x, *y][axis]));
    if low > high {
        return [0.0, 1.0];
    }
    if panel.axes[axis].ticks == Ticks::Logarithmic {
        return [low / 1.1, high * 1.1];
    }
    let margin = (0.05 * (high - low)).max(1e-6 * high.abs()).max(1e-12);
    [low - margin, high + margin]
}

fn scales(panel: &Panel, [x, [top, bottom]]: Area) -> [Scale; 2] {
    let scale = |axis: usize, ends: [f64; 2]| Scale {
        range: range(panel, axis),
        ends,
        logarithmic: panel.axes[axis].ticks == Ticks::Logarithmic,
    };
    let (mut x, mut y) = (scale(0, x), scale(1, [bottom, top]));
    if panel.scales == Scales::Equal {
        x.extend(y.per_pixel());
        y.extend(x.per_pixel());
    }
    [x, y]
}

/// About `count` ticks of an axis with their texts.
fn ticks(axis: &Axis, [low, high]: [f64; 2], count: f64) -> Vec<(f64, String)> {
    match &axis.ticks {
        Ticks::Names(names) => names.clone(),
        Ticks::Logarithmic => {
            let values = decades([low, high]).into_iter();
            values.map(|at| (at, short(at))).collect()
        }
        Ticks::Linear => {
            let values = axis_ticks(low, high, count.clamp(5.0, 12.0) as usize).into_iter();
            values.map(|at| (at, tick_text(at, high - low))).collect()
        }
    }
}

/// Number of names along y, and whether they are above their rows; `None` for an axis of numbers.
fn names(panel: &Panel, share: f64, size: f64) -> Option<(usize, bool)> {
    match &panel.axes[1].ticks {
        Ticks::Names(names) if !names.is_empty() => {
            let widest = largest(names.iter().map(|(_, name)| width(name, size)));
            Some((names.len(), widest > MAX_NAME_WIDTH * share))
        }
        _ => None,
    }
}

/// An entry of the legend: a layer's symbol and name. A continuation line of a long name has no
/// symbol.
struct Key<'a> {
    layer: Option<&'a Layer>,
    text: String,
}

/// The shapes of a picture, and the font size.
struct Page {
    shapes: Vec<Shape>,
    size: f64,
}

impl Page {
    fn text(&mut self, at: Place, text: &str, anchor: f64) {
        if !text.is_empty() {
            let style = Style::new(self.size, anchor, INK);
            self.shapes.push(Shape::Text(at, text.to_owned(), style));
        }
    }

    fn line<const N: usize>(&mut self, points: [Place; N], colour: Colour) {
        self.shapes.push(Shape::Line(points.to_vec(), 1.0, colour));
    }

    /// Writes a title between two horizontal positions; returns its lower end.
    fn title(&mut self, text: &str, size: f64, [from, to]: [f64; 2], top: f64) -> f64 {
        let mut style = Style::new(size, 0.5, INK);
        style.bold = true;
        let mut middle = top + 0.5 * LINE * size;
        for line in wrapped(text, BOLD * size, to - from) {
            let at = [0.5 * (from + to), middle];
            self.shapes.push(Shape::Text(at, line, style));
            middle += LINE * size;
        }
        middle - 0.5 * LINE * size
    }

    /// Writes a label that reads upwards, with its middle at a place.
    fn upwards(&mut self, at: Place, label: String) {
        let mut style = Style::new(self.size, 0.5, INK);
        style.turned = true;
        self.shapes.push(Shape::Text(at, label, style));
    }

    /// Width of the labels at the left of a panel.
    fn left(&self, panel: &Panel, share: f64, height: f64) -> f64 {
        if let Some((_, true)) = names(panel, share, self.size) {
            return 0.6 * self.size;
        }
        let texts = ticks(&panel.axes[1], range(panel, 1), height / (2.6 * self.size));
        let widest = largest(texts.iter().map(|(_, text)| width(text, self.size)));
        let has_label = !panel.axes[1].label.is_empty();
        let label = if has_label { LINE } else { 0.3 };
        widest + (label + 2.0 * TICK) * self.size
    }

    /// Height of title, legend and texts above the plotting area.
    fn head(&self, panel: &Panel, wide: f64) -> f64 {
        let title = wrapped(&panel.title, BOLD * 1.1 * self.size, wide).len();
        let title = if panel.title.is_empty() { 0 } else { title };
        let rows = self.legend(panel, wide).len();
        let is_above = |layer: &Layer| matches!(layer.mark, Mark::Text((_, f64::INFINITY), ..));
        let above = panel.layers.iter().any(is_above);
        let lines = 1.1 * title as f64 + rows as f64 + f64::from(above);
        (LINE * lines + 0.5) * self.size
    }

    /// Height of the plotting area.
    fn height(&self, panel: &Panel, share: f64, stated: f64) -> f64 {
        names(panel, share, self.size).map_or(stated, |(count, above)| {
            let row = if above { NAMED_ABOVE } else { NAMED };
            row * self.size * count as f64
        })
    }

    /// Height of numbers and axis label below the plotting area.
    fn foot(&self, panel: &Panel) -> f64 {
        let blank = panel.axes[0].ticks == Ticks::Names(Vec::new());
        let numbers = if blank { 0.4 } else { LINE + TICK };
        let has_label = !panel.axes[0].label.is_empty();
        let label = if has_label { LINE } else { 0.0 };
        (numbers + label) * self.size
    }

    /// Width of an entry of the legend.
    fn key(&self, text: &str) -> f64 {
        SYMBOL * self.size + width(text, self.size)
    }

    /// The rows of the legend: each name once; a name that is too long is broken into several rows.
    fn legend<'a>(&self, panel: &'a Panel, wide: f64) -> Vec<Vec<Key<'a>>> {
        let mut rows: Vec<Vec<Key>> = Vec::new();
        let mut names = BTreeSet::new();
        for layer in &panel.layers {
            if layer.name.is_empty() || !names.insert(&layer.name) {
                continue;
            }
            let lines = wrapped(&layer.name, self.size, wide - SYMBOL * self.size);
            let whole = lines.len() == 1;
            for (k, text) in lines.into_iter().enumerate() {
                let room = wide - KEY_GAP * self.size - self.key(&text);
                let layer = (k == 0).then_some(layer);
                let key = Key { layer, text };
                match rows.last_mut() {
                    Some(row) if whole && row[0].layer.is_some() && self.length(row) <= room => {
                        row.push(key);
                    }
                    _ => rows.push(vec![key]),
                }
            }
        }
        rows
    }

    /// Width of a row of the legend.
    fn length(&self, row: &[Key]) -> f64 {
        let keys: f64 = row.iter().map(|key| self.key(&key.text)).sum();
        keys + KEY_GAP * self.size * (row.len() as f64 - 1.0)
    }

    fn draw_legend(&mut self, panel: &Panel, [from, to]: [f64; 2], top: f64) {
        let size = self.size;
        for (k, row) in self.legend(panel, to - from).iter().enumerate() {
            let y = snapped(top + LINE * size * (k as f64 + 0.5));
            let mut left = from + 0.5 * (to - from - self.length(row)).max(0.0);
            for Key { layer, text } in row {
                let right = left + 1.7 * size;
                self.shapes.extend(layer.map(|layer| match &layer.mark {
                    Mark::Line(_, width) => {
                        let ends = vec![[left, y], [right, y]];
                        Shape::Line(ends, width.max(2.0), layer.colour)
                    }
                    Mark::Dots(_, radius, symbol) => {
                        let middle = [0.5 * (left + right), y];
                        symbol_shape(*symbol, middle, radius.max(3.0), layer.colour)
                    }
                    _ => {
                        let sides = [y - 0.45 * size, y + 0.45 * size];
                        Shape::Polygon(rectangle([[left, right], sides]), layer.colour)
                    }
                }));
                self.text([left + SYMBOL * size, y], text, 0.0);
                left += self.key(text) + KEY_GAP * size;
            }
        }
    }

    /// Draws a panel into its area; it occupies the width `share` of the picture, starting at
    /// `from`.
    fn panel(&mut self, panel: &Panel, [from, share]: [f64; 2], area: Area) {
        let size = self.size;
        let [[left, right], [top, bottom]] = area;
        let mut head = top - self.head(panel, right - left);
        if !panel.title.is_empty() {
            head = self.title(&panel.title, 1.1 * size, area[0], head);
        }
        self.draw_legend(panel, area[0], head);
        let [x, y] = scales(panel, area);
        let [across, up] = &panel.axes;
        let columns = ticks(across, x.range, (right - left) / (6.0 * size));
        let rows = ticks(up, y.range, (bottom - top) / (2.6 * size));
        let has_grid = |axis: &Axis| !matches!(axis.ticks, Ticks::Names(_));
        for (value, _) in columns.iter().filter(|_| has_grid(across)) {
            let at = snapped(x.at(*value));
            self.line([[at, top], [at, bottom]], GRID);
        }
        for (value, _) in rows.iter().filter(|_| has_grid(up)) {
            let at = snapped(y.at(*value));
            self.line([[left, at], [right, at]], GRID);
        }
        for layer in &panel.layers {
            let shapes = self.layer(layer, [x, y], area);
            if layer.hint.is_empty() {
                self.shapes.extend(shapes)
            } else {
                self.shapes.push(Shape::Group(layer.hint.clone(), shapes))
            }
        }
        let mut frame = rectangle(area);
        frame.push(frame[0]);
        self.shapes.push(Shape::Line(frame, 1.0, FRAME));
        let mut end = f64::NEG_INFINITY;
        for (value, text) in &columns {
            let (at, half) = (snapped(x.at(*value)), 0.5 * width(text, size));
            if at - half > end + 0.5 * size {
                self.line([[at, bottom], [at, bottom + TICK * size]], FRAME);
                self.text([at, bottom + (TICK + 0.7) * size], text, 0.5);
                end = at + half;
            }
        }
        let above = names(panel, share, size).is_some_and(|(_, above)| above);
        for (value, text) in &rows {
            let at = snapped(y.at(*value));
            if above {
                self.text([left + TICK * size, at - 0.95 * size], text, 0.0);
            } else {
                self.line([[left - TICK * size, at], [left, at]], FRAME);
                self.text([left - 1.7 * TICK * size, at], text, 1.0);
            }
        }
        let below = bottom + self.foot(panel) - 0.6 * size;
        self.text([0.5 * (left + right), below], &across.label, 0.5);
        let stretch = match panel.scales {
            Scales::Independent => String::new(),
            _ => stretch_text(x.per_pixel() / y.per_pixel()),
        };
        let label = format!("{}{stretch}", up.label);
        self.upwards([from + 0.8 * size, 0.5 * (top + bottom)], label);
    }

    /// The shapes of a layer.
    fn layer(&self, layer: &Layer, [x, y]: [Scale; 2], area: Area) -> Vec<Shape> {
        let place = |(a, b): &Point| [x.at(*a), y.at(*b)];
        let [[left, right], [top, bottom]] = area;
        let inside = |[a, b]: Place| [a.max(left).min(right), b.max(top).min(bottom)];
        let colour = layer.colour;
        vec![match &layer.mark {
            Mark::Line(points, width) => {
                let points: Vec<Place> = points.iter().map(place).collect();
                Shape::Line(clipped(&points, area), *width, colour)
            }
            Mark::Dots(points, radius, symbol) => {
                let places = points.iter().map(place).filter(|at| inside(*at) == *at);
                let dot = |at| symbol_shape(*symbol, at, *radius, colour);
                return places.map(dot).collect();
            }
            Mark::Area(corners) => {
                let corners = corners.iter().map(place).map(inside);
                Shape::Polygon(corners.collect(), colour)
            }
            Mark::Map([across, up], cells) => {
                let corners = [(across[0], up[1]), (across[1], up[0])];
                Shape::Image(corners.map(|corner| place(&corner)), cells.clone())
            }
            Mark::Text(at, text, shift) => {
                let [a, b] = place(at);
                let anchor = match shift[0] {
                    0.0 => 0.5,
                    right => f64::from(right < 0.0),
                };
                // Within the panel, as far as there is room.
                let before = anchor * width(text, self.size);
                let a = a + shift[0] * self.size;
                let a = a.min(right - before).max(left + before);
                let style = Style::new(self.size, anchor, colour);
                Shape::Text([a, b - shift[1] * self.size], text.clone(), style)
            }
        }]
    }

    /// Draws a colour bar, its numbers and its label between two heights.
    fn bar(&mut self, bar: &ColourBar, left: f64, [top, bottom]: [f64; 2]) {
        let size = self.size;
        let right = left + 1.8 * size;
        let cells = Cells::new([1, bar.colours.len()], |_, row| Some(bar.colours[row]));
        self.shapes
            .push(Shape::Image([[left, top], [right, bottom]], cells));
        let range = bar.range;
        let scale = Scale {
            range,
            ends: [bottom, top],
            logarithmic: false,
        };
        let numbers = ticks(&Axis::default(), range, (bottom - top) / (2.6 * size));
        for (value, text) in &numbers {
            let at = snapped(scale.at(*value));
            self.line([[right, at], [right + TICK * size, at]], FRAME);
            self.text([right + 1.7 * TICK * size, at], text, 0.0);
        }
        let widest = largest(numbers.iter().map(|(_, text)| width(text, size)));
        let at = right + widest + (1.7 * TICK + 0.9) * size;
        self.upwards([at, 0.5 * (top + bottom)], bar.label.clone());
    }
}

fn rectangle([[left, right], [top, bottom]]: Area) -> Vec<Place> {
    vec![[left, top], [right, top], [right, bottom], [left, bottom]]
}

fn symbol_shape(symbol: Symbol, at: Place, radius: f64, colour: Colour) -> Shape {
    let by = |x: f64, y: f64| [at[0] + x * radius, at[1] + y * radius];
    match symbol {
        Symbol::Disc => Shape::Disc(at, radius, colour),
        Symbol::Ring => Shape::Ring(at, radius, colour),
        Symbol::Stroke => Shape::Line(vec![by(0.0, -1.0), by(0.0, 1.0)], 2.0, colour),
        Symbol::Cross => {
            let gap = [f64::NAN; 2];
            let [a, b, c, d] = [by(-1.0, -1.0), by(1.0, 1.0), by(-1.0, 1.0), by(1.0, -1.0)];
            Shape::Line(vec![a, b, gap, c, d], 1.0, colour)
        }
    }
}

/// How many times the upright axis is stretched.
fn stretch_text(stretch: f64) -> String {
    match stretch {
        0.9..=1.1 => ", to scale".to_owned(),
        10.0.. => format!(", stretched {stretch:.0}x"),
        _ => format!(", stretched {stretch:.1}x"),
    }
}

/// The words of a text in lines of at most this width, up to [`MAX_LINES`]; a word that is wider
/// is broken.
fn wrapped(text: &str, size: f64, wide: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut used = 0.0;
    for word in text.split(' ') {
        let space = width(" ", size);
        match lines.last_mut() {
            Some(line) if used + space + width(word, size) <= wide => {
                line.push(' ');
                used += space;
            }
            _ => {
                lines.push(String::new());
                used = 0.0;
            }
        }
        for letter in word.chars() {
            let more = width(letter.encode_utf8(&mut [0; 4]), size);
            match lines.last_mut() {
                Some(line) if used + more <= wide || line.is_empty() => line.push(letter),
                _ => {
                    lines.push(letter.to_string());
                    used = 0.0;
                }
            }
            used += more;
        }
    }
    if lines.len() > MAX_LINES {
        lines.truncate(MAX_LINES);
        let last = &mut lines[MAX_LINES - 1];
        last.pop();
        last.push('…');
    }
    lines
}

/// The parts of a line within a panel, with a break between them (Liang and Barsky, 1984).
fn clipped(points: &[Place], area: Area) -> Vec<Place> {
    let mut parts: Vec<Place> = Vec::new();
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let along = [to[0] - from[0], to[1] - from[1]];
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for axis in 0..2 {
            let [low, high] = area[axis];
            let ends = [low, high].map(|bound| (bound - from[axis]) / along[axis]);
            if along[axis] != 0.0 {
                first = first.max(ends[0].min(ends[1]));
                last = last.min(ends[0].max(ends[1]));
            } else if !(low..=high).contains(&from[axis]) {
                last = -1.0;
            }
        }
        if first <= last && (along[0] + along[1]).is_finite() {
            let at = |share: f64| [from[0] + share * along[0], from[1] + share * along[1]];
            if parts.last().is_some_and(|end| *end != at(first)) {
                parts.push([f64::NAN; 2]);
            }
            if parts.last() != Some(&at(first)) {
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
            Shape::Text(at, text, style) => Some((text.clone(), *at, style.anchor)),
            _ => None,
        };
        shapes.iter().filter_map(text).collect()
    }

    fn panel(layers: Vec<Layer>) -> Panel {
        let axis = |label: &str| Axis::new(label).within([0.0, 10.0]);
        Panel::new(axis("x [m]"), axis("y [m]"), layers)
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
        let rows = ["a name that is nearly as long as a phone is wide", "short"];
        let names = Axis::names("", rows).reversed();
        let formula =
            "mu = 0.003 + 1e-4*(temperature_c+5)*sqrt(humidity_pct/50)*exp(-p_max_pa/1e7)";
        let dots = Layer::dots(4.0, [(10.0, 0.5), (1e3, 1.5)], INK).named(formula);
        let session =
            Layer::level(1.0).named("a session whose name is a whole sentence about the day");
        let x = Axis::new("peak pressure [MPa]").within([0.0, 1e3]);
        let title = "a title that is too long for one line of a telephone's narrow screen";
        let named = Panel::new(
            x,
            names,
            vec![dots, session, Layer::above(999.0, "the end")],
        )
        .titled(title);
        let (shapes, _) = laid_out(&Figure::new(400.0, "").row(0.0, [named]));
        let drawn: String = texts(&shapes).into_iter().map(|text| text.0).collect();
        let drawn = drawn.replace(' ', "");
        for part in ["exp(-p_max_pa/1e7)", "abouttheday"] {
            assert!(drawn.contains(part), "{part}: {drawn}");
        }
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
        let area = [[0.0, 10.0]; 2];
        let parts = clipped(&[[5.0, 5.0], [15.0, 5.0], [15.0, 9.0], [5.0, 9.0]], area);
        let known: Vec<Place> = parts.iter().filter(|p| p[0].is_finite()).copied().collect();
        assert_eq!(known, [[5.0, 5.0], [10.0, 5.0], [10.0, 9.0], [5.0, 9.0]]);
        assert_eq!(parts.len(), 5);
        assert!(clipped(&[[-5.0, 11.0], [15.0, 12.0]], area).is_empty());
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
                Shape::Disc(centre, ..) => Some(*centre),
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
                Shape::Polygon(corners, _) => Some(corners.clone()),
                _ => None,
            })
            .unwrap();
        let x = |share: f64| low[0] + share * (high[0] - low[0]);
        assert_eq!([corners[0][1], corners[2][1]], [low[1], high[1]]);
        assert!((corners[0][0] - x(0.2)).abs() < 1e-9 && (corners[1][0] - x(0.4)).abs() < 1e-9);
    }

    #[test]
    fn equal_scales_have_square_pixels() {
        let square = panel(Vec::new()).scaled(Scales::Equal);
        let [x, y] = scales(&square, [[0.0, 300.0], [0.0, 100.0]]);
        assert!((x.per_pixel() / y.per_pixel() - 1.0).abs() < 1e-12);
        assert_eq!((x.range, y.range), ([-10.0, 20.0], [0.0, 10.0]));
    }
}
