//! Rasterisation of shapes into a PNG.

use crate::plot::colour::{Colour, Rgb};
use crate::plot::font;
use crate::plot::shape::{BASELINE, Cells, Place, Shape, Style};
use crate::plot::ticks::extent;

/// The bytes of a PNG file.
///
/// # Panics
/// Where there are not as many bytes as `size` and `kind` need.
pub fn encoded([width, height]: [usize; 2], kind: ::png::ColorType, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(kind);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_adaptive_filter(::png::AdaptiveFilterType::Adaptive);
    encoder.set_compression(::png::Compression::Fast);
    let software = concat!("kufe ", env!("CARGO_PKG_VERSION"));
    encoder
        .add_text_chunk("Software".into(), software.into())
        .and_then(|()| encoder.write_header())
        .and_then(|mut image| image.write_image_data(bytes).and_then(|()| image.finish()))
        .expect("pixels of the stated size are written to memory");
    file
}

/// The PNG file of shapes on a white background.
pub fn png(shapes: &[Shape], [width, height]: Place) -> Vec<u8> {
    let size = [width.ceil() as usize, height.ceil() as usize];
    let mut bitmap = Bitmap {
        size,
        pixels: vec![[255; 3]; size[0] * size[1]],
    };
    shapes.iter().for_each(|shape| bitmap.add(shape));
    encoded(size, ::png::ColorType::Rgb, bitmap.pixels.as_flattened())
}

struct Bitmap {
    size: [usize; 2],
    pixels: Vec<Rgb>,
}

impl Bitmap {
    /// Blends a colour into a pixel; `share` is the covered fraction of the pixel.
    fn blend(&mut self, [column, row]: [i64; 2], colour: Colour, share: f64) {
        let [Ok(column), Ok(row)] = [column, row].map(usize::try_from) else {
            return;
        };
        if column < self.size[0] && row < self.size[1] {
            let pixel = &mut self.pixels[row * self.size[0] + column];
            let share = share * colour.alpha;
            for (below, above) in pixel.iter_mut().zip(colour.rgb) {
                *below =
                    (f64::from(*below) * (1.0 - share) + f64::from(above) * share).round() as u8;
            }
        }
    }

    /// The columns (axis 0) or rows (axis 1) between `low` and `high`.
    fn range(&self, axis: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let end = high.ceil().clamp(0.0, self.size[axis] as f64);
        low.floor().clamp(0.0, end) as usize..end as usize
    }

    fn add(&mut self, shape: &Shape) {
        match shape {
            Shape::Polygon(corners, colour) => self.polygon(corners, *colour),
            Shape::Line(points, width, colour) => self.line(points, *width, *colour),
            // A disc is a line of zero length with a width.
            Shape::Disc(at, radius, colour) => self.line(&[*at; 2], 2.0 * radius, *colour),
            Shape::Ring([x, y], radius, colour) => {
                let angles = (0..=32).map(|k| std::f64::consts::TAU * f64::from(k) / 32.0);
                let points = angles.map(|a| [x + radius * a.cos(), y + radius * a.sin()]);
                self.line(&points.collect::<Vec<Place>>(), 2.0, *colour);
            }
            Shape::Text(at, text, style) => self.text(*at, text, style),
            Shape::Image(corners, cells) => self.image(*corners, cells),
            Shape::Group(_, shapes) => shapes.iter().for_each(|shape| self.add(shape)),
        }
    }

    fn text(&mut self, [x, y]: Place, text: &str, style: &Style) {
        let before = style.anchor * font::width(text, style.size);
        let lower = BASELINE * style.size;
        let start = if style.turned {
            [x + lower, y + before]
        } else {
            [x - before, y + lower]
        };
        let [x, y] = start.map(|at| at.round() as i64);
        font::rasterise(text, style.size, |right, down, share| {
            let at = if style.turned {
                [x + down, y - right]
            } else {
                [x + right, y + down]
            };
            self.blend(at, style.colour, share);
        });
    }

    fn image(&mut self, [from, to]: [Place; 2], cells: &Cells) {
        let cell = |axis: usize, pixel: usize| {
            let share = (pixel as f64 + 0.5 - from[axis]) / (to[axis] - from[axis]);
            let cell = (share * cells.size[axis] as f64).max(0.0) as usize;
            cell.min(cells.size[axis] - 1)
        };
        for row in self.range(1, from[1].round(), to[1].round()) {
            for column in self.range(0, from[0].round(), to[0].round()) {
                if let Some(rgb) = cells.colours[cell(1, row) * cells.size[0] + cell(0, column)] {
                    self.pixels[row * self.size[0] + column] = rgb;
                }
            }
        }
    }

    /// Fills the pixels whose centres are inside.
    fn polygon(&mut self, corners: &[Place], colour: Colour) {
        let [top, bottom] = extent(corners.iter().map(|corner| corner[1]));
        for row in self.range(1, top, bottom) {
            let y = row as f64 + 0.5;
            let next = corners.iter().cycle().skip(1);
            let sides = corners.iter().zip(next);
            let crossed = sides.filter(|(a, b)| (a[1] <= y) != (b[1] <= y));
            let mut ends: Vec<f64> = crossed
                .map(|(a, b)| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
                .collect();
            ends.sort_by(f64::total_cmp);
            for pair in ends.chunks_exact(2) {
                for column in self.range(0, pair[0].round(), pair[1].round()) {
                    self.blend([column as i64, row as i64], colour, 1.0);
                }
            }
        }
    }

    /// Blends a line: each pixel by the fraction that the line covers, only once where the line
    /// crosses itself.
    fn line(&mut self, points: &[Place], width: f64, colour: Colour) {
        let reach = 0.5 * width + 0.5;
        let around = |bitmap: &Self, points: &[Place], axis: usize| {
            let [low, high] = extent(points.iter().map(|point| point[axis]));
            bitmap.range(axis, low - reach, high + reach)
        };
        let (columns, rows) = (around(self, points, 0), around(self, points, 1));
        let mut shares = vec![0.0f32; columns.len() * rows.len()];
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let along = [to[0] - from[0], to[1] - from[1]];
            let square = along[0] * along[0] + along[1] * along[1];
            if !square.is_finite() {
                continue;
            }
            for row in around(self, pair, 1) {
                for column in around(self, pair, 0) {
                    let off = [column as f64 + 0.5 - from[0], row as f64 + 0.5 - from[1]];
                    let share = (off[0] * along[0] + off[1] * along[1]) / square.max(1e-12);
                    let share = share.clamp(0.0, 1.0);
                    let distance = (off[0] - share * along[0]).hypot(off[1] - share * along[1]);
                    let pixel = (row - rows.start) * columns.len() + column - columns.start;
                    shares[pixel] = shares[pixel].max((reach - distance).min(1.0) as f32);
                }
            }
        }
        for (pixel, share) in shares.into_iter().enumerate() {
            let column = columns.start + pixel % columns.len();
            let row = rows.start + pixel / columns.len();
            if share > 0.0 {
                self.blend([column, row].map(|k| k as i64), colour, f64::from(share));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::colour::INK;

    fn pixels(shapes: &[Shape], size: Place) -> Vec<u8> {
        let file = png(shapes, size);
        let mut reader = ::png::Decoder::new(&file[..]).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!([info.width, info.height].map(f64::from), size);
        pixels
    }

    /// A line that climbs a pixel in ten is as dark in every column; points rounded to pixels would
    /// give stairs.
    #[test]
    fn a_flat_slope_is_drawn_without_stairs_and_not_across_a_gap() {
        let gap = [f64::NAN, 0.0];
        let points = vec![[10.0, 7.3], [60.0, 12.3], gap, [80.0, 8.0], [90.0, 9.0]];
        let line = Shape::Line(points, 2.0, INK);
        let pixels = pixels(&[line], [101.0, 21.0]);
        let ink = |column: usize| {
            let rows = (0..21).map(|row| 255 - i32::from(pixels[3 * (101 * row + column)]));
            f64::from(rows.sum::<i32>()) / 255.0
        };
        for column in 13..57 {
            assert!(
                (ink(column) - 2.0).abs() < 0.08,
                "{column}: {}",
                ink(column)
            );
        }
        assert!((64..76).all(|column| ink(column) == 0.0));
        assert!(ink(85) > 1.9);
    }

    #[test]
    fn a_polygon_covers_its_pixels_and_an_image_is_stretched_over_its_rectangle() {
        let colour = Colour::new(10, 20, 30);
        let corners = vec![[2.0, 1.0], [4.0, 1.0], [4.0, 3.0], [2.0, 3.0]];
        let polygon = Shape::Polygon(corners, colour);
        let cells = Cells::new([2, 1], |column, _| (column == 0).then_some([1, 2, 3]));
        let image = Shape::Image([[4.0, 3.0], [6.0, 5.0]], cells);
        let found = pixels(&[polygon, image], [7.0, 5.0]);
        for (place, pixel) in found.chunks(3).enumerate() {
            let drawn = match (place % 7, place / 7) {
                (2 | 3, 1 | 2) => colour.rgb,
                (4, 3 | 4) => [1, 2, 3],
                _ => [255; 3],
            };
            assert_eq!(pixel, drawn, "{place}");
        }
    }

    #[test]
    fn a_disc_and_a_ring_have_the_ink_of_their_areas() {
        let ink = |shape: Shape| {
            let pixels = pixels(&[shape], [31.0, 31.0]);
            pixels
                .iter()
                .map(|value| f64::from(255 - value) / 765.0)
                .sum::<f64>()
        };
        let disc = ink(Shape::Disc([15.0, 16.0], 10.0, INK)) / (100.0 * std::f64::consts::PI);
        let ring = ink(Shape::Ring([15.0, 16.0], 10.0, INK)) / (40.0 * std::f64::consts::PI);
        assert!(
            (disc - 1.0).abs() < 0.02 && (ring - 1.0).abs() < 0.03,
            "{disc} {ring}"
        );
    }
}
