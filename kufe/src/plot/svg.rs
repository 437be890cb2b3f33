//! Shapes as SVG.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::plot::colour::{Colour, INK};
use crate::plot::png::encoded;
use crate::plot::shape::{BASELINE, DASH, Place, Shape};

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
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\" \
         aria-label=\"{}\" font-family=\"system-ui,sans-serif\" font-size=\"{letters}\" fill=\"currentColor\">\n",
        escape(label)
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
        Shape::Polygon { corners, colour } => {
            let places = corners
                .iter()
                .map(|[x, y]| format!("{},{}", tenth(*x), tenth(*y)));
            let places: Vec<String> = places.collect();
            let fill = paint("fill", *colour);
            writeln!(out, "<polygon points=\"{}\" {fill}/>", places.join(" "))
        }
        Shape::Line {
            points,
            colour,
            width,
            dashed,
        } => {
            let mut path = String::new();
            let mut command = 'M';
            for [x, y] in points {
                if x.is_finite() && y.is_finite() {
                    let _ = write!(path, "{command}{} {}", tenth(*x), tenth(*y));
                    command = 'L';
                } else {
                    command = 'M';
                }
            }
            let dashes = match dashed {
                true => format!(" stroke-dasharray=\"{} {}\"", DASH[0], DASH[1]),
                false => String::new(),
            };
            let stroke = paint("stroke", *colour);
            writeln!(
                out,
                "<path d=\"{path}\" fill=\"none\" {stroke} stroke-width=\"{width}\"{dashes}/>"
            )
        }
        Shape::Circle {
            centre: [x, y],
            radius,
            colour,
            ring,
        } => {
            let paint = match ring {
                true => format!(
                    "fill=\"none\" stroke-width=\"2\" {}",
                    paint("stroke", *colour)
                ),
                false => paint("fill", *colour),
            };
            writeln!(
                out,
                "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" {paint}/>",
                tenth(*x),
                tenth(*y)
            )
        }
        Shape::Text {
            at: [x, y],
            text,
            size,
            anchor,
            turned,
            bold,
            colour,
        } => {
            let lower = BASELINE * size;
            let (x, y, turn) = match turned {
                true => {
                    let (x, y) = (tenth(x + lower), tenth(*y));
                    (x, y, format!(" transform=\"rotate(-90 {x} {y})\""))
                }
                false => (tenth(*x), tenth(y + lower), String::new()),
            };
            let anchor = match anchor {
                0.0 => "start",
                1.0 => "end",
                _ => "middle",
            };
            let bold = if *bold { " font-weight=\"bold\"" } else { "" };
            writeln!(
                out,
                "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-size=\"{}\"{bold}{turn} {}>{}</text>",
                tenth(*size),
                paint("fill", *colour),
                escape(text)
            )
        }
        Shape::Image {
            corners: [[x, y], [right, bottom]],
            size,
            pixels,
        } => {
            let colours = pixels.iter();
            let bytes = colours.flat_map(|p| p.map_or([0; 4], |[r, g, b]| [r, g, b, 255]));
            let file = encoded(*size, ::png::ColorType::Rgba, &bytes.collect::<Vec<u8>>());
            writeln!(
                out,
                "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
                 style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>",
                tenth(*x),
                tenth(*y),
                tenth(right - x),
                tenth(bottom - y),
                STANDARD.encode(file)
            )
        }
        Shape::Group { hint, shapes } => {
            let _ = write!(out, "<g><title>{}</title>", escape(hint));
            shapes.iter().for_each(|shape| add(out, shape));
            writeln!(out, "</g>")
        }
    };
}
