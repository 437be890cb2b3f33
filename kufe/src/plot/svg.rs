//! Shapes as SVG.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::plot::colour::{Colour, INK};
use crate::plot::png::encoded;
use crate::plot::shape::{BASELINE, Cells, Place, Shape, Style};

/// Escapes text for HTML and SVG, and for the value of a quoted attribute.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            letter => escaped.push(letter),
        }
    }
    escaped
}

/// An SVG element for a page; black becomes the text colour of the page. `label` is the alternative
/// text for screen readers.
pub fn svg(shapes: &[Shape], [width, height]: Place, letters: f64, label: &str) -> String {
    let label = escape(label);
    let shapes: String = shapes.iter().map(element).collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\" \
         aria-label=\"{label}\" font-family=\"system-ui,sans-serif\" font-size=\"{letters}\" fill=\"currentColor\">\n{shapes}</svg>\n"
    )
}

/// The attributes of a colour.
fn paint(attribute: &str, colour: Colour) -> String {
    let [red, green, blue] = colour.rgb;
    let name = if colour.rgb == INK.rgb {
        "currentColor".to_owned()
    } else {
        format!("#{red:02x}{green:02x}{blue:02x}")
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

fn element(shape: &Shape) -> String {
    match shape {
        Shape::Polygon(corners, colour) => {
            format!(
                "<path d=\"{}\" {}/>\n",
                path(corners),
                paint("fill", *colour)
            )
        }
        Shape::Line(points, width, colour) => {
            let (path, stroke) = (path(points), paint("stroke", *colour));
            format!("<path d=\"{path}\" fill=\"none\" {stroke} stroke-width=\"{width}\"/>\n")
        }
        Shape::Disc(at, radius, colour) => circle(*at, *radius, &paint("fill", *colour)),
        Shape::Ring(at, radius, colour) => {
            let stroke = paint("stroke", *colour);
            circle(
                *at,
                *radius,
                &format!("fill=\"none\" stroke-width=\"2\" {stroke}"),
            )
        }
        Shape::Text(at, text, style) => words(*at, text, style),
        Shape::Image(corners, cells) => image(*corners, cells),
        Shape::Group(hint, shapes) => {
            let shapes: String = shapes.iter().map(element).collect();
            format!("<g><title>{}</title>{shapes}</g>\n", escape(hint))
        }
    }
}

/// The commands of a path, broken at NaN points.
fn path(points: &[Place]) -> String {
    let mut command = 'M';
    let commands = points.iter().map(|[x, y]| {
        let is_known = x.is_finite() && y.is_finite();
        let next = if is_known { 'L' } else { 'M' };
        match (is_known, std::mem::replace(&mut command, next)) {
            (true, command) => format!("{command}{} {}", tenth(*x), tenth(*y)),
            (false, _) => String::new(),
        }
    });
    commands.collect()
}

fn circle(at: Place, radius: f64, paint: &str) -> String {
    let [x, y] = at.map(tenth);
    format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {paint}/>\n")
}

fn words([x, y]: Place, text: &str, style: &Style) -> String {
    let lower = BASELINE * style.size;
    let ([x, y], turn) = if style.turned {
        let [x, y] = [x + lower, y].map(tenth);
        ([x, y], format!(" transform=\"rotate(-90 {x} {y})\""))
    } else {
        ([x, y + lower].map(tenth), String::new())
    };
    let bold = if style.bold {
        " font-weight=\"bold\""
    } else {
        ""
    };
    let anchor = ["start", "middle", "end"][(2.0 * style.anchor) as usize];
    let (size, fill, text) = (tenth(style.size), paint("fill", style.colour), escape(text));
    format!(
        "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-size=\"{size}\"{bold}{turn} {fill}>{text}</text>\n"
    )
}

fn image([from, to]: [Place; 2], cells: &Cells) -> String {
    let [x, y] = from.map(tenth);
    let [width, height] = [0, 1].map(|axis| tenth(to[axis] - from[axis]));
    let colours = cells.colours.iter();
    let bytes = colours.flat_map(|cell| cell.map_or([0; 4], |[r, g, b]| [r, g, b, 255]));
    let bytes: Vec<u8> = bytes.collect();
    let file = STANDARD.encode(encoded(cells.size, ::png::ColorType::Rgba, &bytes));
    format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{file}\"/>\n"
    )
}
