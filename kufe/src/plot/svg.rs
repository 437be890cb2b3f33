//! Shapes as SVG.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::plot::colour::{Colour, INK};
use crate::plot::png::encoded;
use crate::plot::shape::{BASELINE, Cells, Place, Shape, Style};

/// Text as text in HTML and SVG, and as the value of a quoted attribute.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            letter => escaped.push(letter),
        }
    }
    escaped
}

/// An SVG element for a page; black is the colour of the page's text. `label` is read to those who
/// do not see it.
pub fn svg(shapes: &[Shape], [width, height]: Place, letters: f64, label: &str) -> String {
    let label = escape(label);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\" \
         aria-label=\"{label}\" font-family=\"system-ui,sans-serif\" font-size=\"{letters}\" fill=\"currentColor\">\n"
    );
    shapes.iter().for_each(|shape| add(&mut out, shape));
    out + "</svg>\n"
}

/// The attributes of a colour.
fn paint(attribute: &str, colour: Colour) -> String {
    let [red, green, blue] = colour.rgb;
    let name = match colour.rgb == INK.rgb {
        true => "currentColor".to_owned(),
        false => format!("#{red:02x}{green:02x}{blue:02x}"),
    };
    match colour.alpha {
        1.0 => format!("{attribute}=\"{name}\""),
        alpha => format!("{attribute}=\"{name}\" {attribute}-opacity=\"{alpha}\""),
    }
}

/// A coordinate to a tenth of a pixel.
fn tenth(value: f64) -> f64 {
    (10.0 * value).round() / 10.0
}

fn add(out: &mut String, shape: &Shape) {
    let _ = match shape {
        Shape::Polygon(corners, colour) => {
            let fill = paint("fill", *colour);
            writeln!(out, "<path d=\"{}\" {fill}/>", path(corners))
        }
        Shape::Line(points, width, colour) => {
            let (path, stroke) = (path(points), paint("stroke", *colour));
            writeln!(
                out,
                "<path d=\"{path}\" fill=\"none\" {stroke} stroke-width=\"{width}\"/>"
            )
        }
        Shape::Disc(at, radius, colour) => circle(out, *at, *radius, &paint("fill", *colour)),
        Shape::Ring(at, radius, colour) => {
            let stroke = paint("stroke", *colour);
            circle(
                out,
                *at,
                *radius,
                &format!("fill=\"none\" stroke-width=\"2\" {stroke}"),
            )
        }
        Shape::Text(at, text, style) => words(out, *at, text, style),
        Shape::Image(corners, cells) => image(out, *corners, cells),
        Shape::Group(hint, shapes) => {
            let _ = write!(out, "<g><title>{}</title>", escape(hint));
            shapes.iter().for_each(|shape| add(out, shape));
            writeln!(out, "</g>")
        }
    };
}

/// The commands of a path, broken at points that are no numbers.
fn path(points: &[Place]) -> String {
    let mut path = String::new();
    let mut command = 'M';
    for [x, y] in points {
        let is_known = x.is_finite() && y.is_finite();
        if is_known {
            let _ = write!(path, "{command}{} {}", tenth(*x), tenth(*y));
        }
        command = if is_known { 'L' } else { 'M' };
    }
    path
}

fn circle(out: &mut String, at: Place, radius: f64, paint: &str) -> std::fmt::Result {
    let [x, y] = at.map(tenth);
    writeln!(
        out,
        "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {paint}/>"
    )
}

fn words(out: &mut String, [x, y]: Place, text: &str, style: &Style) -> std::fmt::Result {
    let lower = BASELINE * style.size;
    let [x, y] = match style.turned {
        true => [x + lower, y].map(tenth),
        false => [x, y + lower].map(tenth),
    };
    let turn = match style.turned {
        true => format!(" transform=\"rotate(-90 {x} {y})\""),
        false => String::new(),
    };
    let bold = if style.bold {
        " font-weight=\"bold\""
    } else {
        ""
    };
    let anchor = ["start", "middle", "end"][(2.0 * style.anchor) as usize];
    let (size, fill, text) = (tenth(style.size), paint("fill", style.colour), escape(text));
    writeln!(
        out,
        "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-size=\"{size}\"{bold}{turn} {fill}>{text}</text>"
    )
}

fn image(out: &mut String, [from, to]: [Place; 2], cells: &Cells) -> std::fmt::Result {
    let [x, y] = from.map(tenth);
    let [width, height] = [0, 1].map(|axis| tenth(to[axis] - from[axis]));
    let colours = cells.colours.iter();
    let bytes = colours.flat_map(|cell| cell.map_or([0; 4], |[r, g, b]| [r, g, b, 255]));
    let file = encoded(
        cells.size,
        ::png::ColorType::Rgba,
        &bytes.collect::<Vec<u8>>(),
    );
    let file = STANDARD.encode(file);
    writeln!(
        out,
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{file}\"/>"
    )
}
