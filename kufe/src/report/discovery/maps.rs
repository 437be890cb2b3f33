//! Measured and simulated maps side by side.

use std::fmt::Write as _;

use crate::plot::{number4, viridis};
use base64::Engine as _;

use super::data::Data;

/// Where a map's pixels are.
struct Grid {
    pixels: [usize; 2],
    from: [f64; 2],
    step: [f64; 2],
}

impl Grid {
    fn of(plot: Data) -> Self {
        Self {
            pixels: [plot.count("nx"), plot.count("ny")],
            from: [plot.number("x0"), plot.number("y0")],
            step: [plot.number("dx"), plot.number("dy")],
        }
    }
}

/// Panels of a picture: side and place of each [px].
const PANEL: (f64, f64) = (190.0, 150.0);

/// Measured pressure, and measured less simulated before and after (where that is another one).
///
/// `nx`, `ny`, `x0`, `y0`, `dx`, `dy` [m] place the pixels; `measured`, `before` and `after` [Pa] hold them row by row.
pub fn comparison(plot: Data) -> String {
    let grid = Grid::of(plot);
    let measured = plot.numbers("measured");
    let less = |key: &str| -> Vec<f64> {
        let pairs = measured.iter().zip(plot.numbers(key));
        pairs.map(|(m, s)| m - s).collect()
    };
    let (first, second) = (less("before"), less("after"));
    let largest = |values: &[f64]| values.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
    let (top, off) = (largest(&measured), largest(&first));
    let mut out = String::from("<div class=\"panels\">\n");
    let mut panels = vec![
        (
            "measured",
            colours(&measured, |p| viridis(p / top)),
            Scale::Upwards(top),
        ),
        (
            "measured less simulated, before",
            colours(&first, |d| diverging(d / off)),
            Scale::Both(off),
        ),
    ];
    if !second.is_empty() {
        panels.push((
            "measured less simulated, after",
            colours(&second, |d| diverging(d / off)),
            Scale::Both(off),
        ));
    }
    for (title, pixels, scale) in panels {
        panel(&mut out, title, &grid, &pixels, &scale);
    }
    out.push_str("</div>\n");
    out
}

/// Range of a colour bar [Pa].
enum Scale {
    Upwards(f64),
    Both(f64),
}

fn panel(svg: &mut String, title: &str, grid: &Grid, pixels: &[[u8; 3]], scale: &Scale) {
    let (width, height) = PANEL;
    let x = 56.0;
    let _ = writeln!(
        svg,
        "<svg viewBox=\"0 0 252 240\" width=\"252\" role=\"img\" aria-label=\"{title}\" font-family=\"system-ui,sans-serif\" font-size=\"12\" fill=\"currentColor\">"
    );
    let y = 28.0;
    let image = base64::engine::general_purpose::STANDARD.encode(bitmap(grid.pixels, pixels));
    let [along, across] = [0, 1].map(|axis| {
        let (from, step, count) = (grid.from[axis], grid.step[axis], grid.pixels[axis] as f64);
        [
            1e3 * (from - 0.5 * step),
            1e3 * (from + (count - 0.5) * step),
        ]
    });
    let _ = writeln!(
        svg,
        "<text x=\"{x}\" y=\"18\">{title}</text>\
<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" href=\"data:image/bmp;base64,{image}\"/>\
<text x=\"{x}\" y=\"{low}\">{}</text><text x=\"{middle}\" y=\"{low}\" text-anchor=\"middle\">x [mm]</text><text x=\"{right}\" y=\"{low}\" text-anchor=\"end\">{}</text>\
<text x=\"{left}\" y=\"{bottom}\" text-anchor=\"end\">{}</text><text x=\"{left}\" y=\"{top}\" text-anchor=\"end\">{}</text><text x=\"{left}\" y=\"{centre}\" text-anchor=\"end\">y [mm]</text>",
        number3(along[0]),
        number3(along[1]),
        number3(across[0]),
        number3(across[1]),
        low = y + height + 15.0,
        middle = x + 0.5 * width,
        right = x + width,
        left = x - 3.0,
        bottom = y + height,
        top = y + 10.0,
        centre = y + 0.5 * height,
    );
    let (from, to) = match scale {
        Scale::Upwards(most) => (0.0, 1e-6 * most),
        Scale::Both(most) => (-1e-6 * most, 1e-6 * most),
    };
    for k in 0..41 {
        let t = k as f64 / 40.0;
        let [r, g, b] = match scale {
            Scale::Upwards(_) => viridis(t),
            Scale::Both(_) => diverging(2.0 * t - 1.0),
        };
        let _ = write!(
            svg,
            "<rect x=\"{:.1}\" y=\"{}\" width=\"{:.1}\" height=\"10\" fill=\"rgb({r},{g},{b})\"/>",
            x + t * width * 40.0 / 41.0,
            y + height + 24.0,
            width / 41.0 + 0.5
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{x}\" y=\"{below}\">{}</text><text x=\"{middle}\" y=\"{below}\" text-anchor=\"middle\">p [MPa]</text><text x=\"{right}\" y=\"{below}\" text-anchor=\"end\">{}</text></svg>",
        number3(from),
        number3(to),
        below = y + height + 48.0,
        middle = x + 0.5 * width,
        right = x + width,
    );
}

fn number3(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let digits = (2 - x.abs().log10().floor() as i32).clamp(0, 6);
    if digits > 5 {
        number4(x)
    } else {
        format!("{x:.*}", digits as usize)
    }
}

fn colours(values: &[f64], of: impl Fn(f64) -> [u8; 3]) -> Vec<[u8; 3]> {
    values.iter().map(|v| of(*v)).collect()
}

/// Blue below, white at 0, red above.
fn diverging(t: f64) -> [u8; 3] {
    let t = t.clamp(-1.0, 1.0);
    let end = if t < 0.0 {
        [33.0, 102.0, 172.0]
    } else {
        [178.0, 24.0, 43.0]
    };
    end.map(|c: f64| (255.0 + (c - 255.0) * t.abs()).round() as u8)
}

/// An uncompressed 24-bit bitmap: rows from the bottom, as maps have them, blue first, padded to four bytes.
fn bitmap([nx, ny]: [usize; 2], pixels: &[[u8; 3]]) -> Vec<u8> {
    let stride = (3 * nx).div_ceil(4) * 4;
    let size = 54 + stride * ny;
    let mut out = Vec::with_capacity(size);
    out.extend(b"BM");
    for word in [size, 0, 54, 40, nx, ny] {
        out.extend((word as u32).to_le_bytes());
    }
    for half in [1u16, 24] {
        out.extend(half.to_le_bytes());
    }
    out.extend([0; 24]);
    for row in pixels.chunks(nx) {
        for [r, g, b] in row {
            out.extend([*b, *g, *r]);
        }
        out.resize(out.len() + stride - 3 * nx, 0);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bitmap_states_its_size_and_pads_its_rows() {
        let data = bitmap([3, 2], &[[1, 2, 3]; 6]);
        assert_eq!(data.len(), 54 + 2 * 12);
        assert_eq!(data[2..6], 78u32.to_le_bytes());
        assert_eq!(data[54..60], [3, 2, 1, 3, 2, 1]);
        assert_eq!(data[63..66], [0, 0, 0]);
    }
}
