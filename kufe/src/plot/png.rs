//! Shapes as the pixels of a PNG.

use crate::plot::colour::{Colour, Rgb};
use crate::plot::font;
use crate::plot::shape::{BASELINE, DASH, Place, Shape};

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

/// The PNG file of shapes on white.
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
    /// Gives a pixel this share of a colour.
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

    /// The columns (axis 0) or rows (axis 1) that reach from `low` to `high`.
    fn range(&self, axis: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let end = high.ceil().clamp(0.0, self.size[axis] as f64);
        low.floor().clamp(0.0, end) as usize..end as usize
    }

    /// Gives each pixel the share of the colour that `cover` says of its middle.
    fn cover(&mut self, [low, high]: [Place; 2], colour: Colour, cover: impl Fn(Place) -> f64) {
        for row in self.range(1, low[1], high[1]) {
            for column in self.range(0, low[0], high[0]) {
                let share = cover([column, row].map(|k| k as f64 + 0.5));
                if share > 0.0 {
                    self.blend([column, row].map(|k| k as i64), colour, share.min(1.0));
                }
            }
        }
    }

    fn add(&mut self, shape: &Shape) {
        match shape {
            Shape::Polygon { corners, colour } => self.polygon(corners, *colour),
            Shape::Line {
                points,
                colour,
                width,
                dashed,
            } => match dashed {
                true => self.line(&dashes(points), *colour, *width),
                false => self.line(points, *colour, *width),
            },
            Shape::Circle {
                centre,
                radius,
                colour,
                ring,
            } => {
                let around = [-1.0, 1.0].map(|side| centre.map(|at| at + side * (radius + 2.0)));
                self.cover(around, *colour, |[x, y]| {
                    let distance = (x - centre[0]).hypot(y - centre[1]);
                    match ring {
                        true => 1.5 - (distance - radius).abs(),
                        false => radius + 0.5 - distance,
                    }
                });
            }
            Shape::Text {
                at: [x, y],
                text,
                size,
                anchor,
                turned,
                colour,
                ..
            } => {
                let before = anchor * font::width(text, *size);
                let lower = BASELINE * size;
                let start = match turned {
                    true => [x + lower, y + before],
                    false => [x - before, y + lower],
                };
                let [x, y] = start.map(|at| at.round() as i64);
                font::rasterise(text, *size, |right, down, share| {
                    let at = match turned {
                        true => [x + down, y - right],
                        false => [x + right, y + down],
                    };
                    self.blend(at, *colour, share);
                });
            }
            Shape::Image {
                corners: [[left, top], [right, bottom]],
                size,
                pixels,
            } => {
                for row in self.range(1, top.round(), bottom.round()) {
                    for column in self.range(0, left.round(), right.round()) {
                        let share = [
                            (column as f64 + 0.5 - left) / (right - left),
                            (row as f64 + 0.5 - top) / (bottom - top),
                        ];
                        let [i, j] = [0, 1].map(|axis| {
                            let cell = (share[axis] * size[axis] as f64).max(0.0) as usize;
                            cell.min(size[axis] - 1)
                        });
                        if let Some(rgb) = pixels[j * size[0] + i] {
                            self.pixels[row * self.size[0] + column] = rgb;
                        }
                    }
                }
            }
            Shape::Group { shapes, .. } => shapes.iter().for_each(|shape| self.add(shape)),
        }
    }

    /// Fills the pixels whose middles are inside.
    fn polygon(&mut self, corners: &[Place], colour: Colour) {
        let rows = corners.iter().map(|corner| corner[1]);
        let (top, bottom) = rows.fold((f64::INFINITY, 0.0f64), |(a, b), y| (a.min(y), b.max(y)));
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

    /// Gives each pixel the share of the colour that the line covers of it, once where the line
    /// crosses itself.
    fn line(&mut self, points: &[Place], colour: Colour, width: f64) {
        let reach = 0.5 * width + 0.5;
        let finite = || {
            points
                .iter()
                .filter(|p| p[0].is_finite() && p[1].is_finite())
        };
        let ends = |axis: usize| {
            let places = finite().map(|point| point[axis]);
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), at| {
                (a.min(at), b.max(at))
            });
            self.range(axis, low - reach, high + reach)
        };
        let (columns, rows) = (ends(0), ends(1));
        let mut shares = vec![0.0f32; columns.len() * rows.len()];
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let along = [to[0] - from[0], to[1] - from[1]];
            let square = along[0] * along[0] + along[1] * along[1];
            if !square.is_finite() {
                continue;
            }
            let range = |axis: usize| {
                let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
                self.range(axis, low - reach, high + reach)
            };
            for row in range(1) {
                for column in range(0) {
                    let off = [column as f64 + 0.5 - from[0], row as f64 + 0.5 - from[1]];
                    let share = match square > 0.0 {
                        true => ((off[0] * along[0] + off[1] * along[1]) / square).clamp(0.0, 1.0),
                        false => 0.0,
                    };
                    let distance = (off[0] - share * along[0]).hypot(off[1] - share * along[1]);
                    let pixel = (row - rows.start) * columns.len() + column - columns.start;
                    shares[pixel] = shares[pixel].max((reach - distance).min(1.0) as f32);
                }
            }
        }
        for (pixel, share) in shares
            .into_iter()
            .enumerate()
            .filter(|(_, share)| *share > 0.0)
        {
            let at = [
                columns.start + pixel % columns.len(),
                rows.start + pixel / columns.len(),
            ];
            self.blend(at.map(|k| k as i64), colour, f64::from(share));
        }
    }
}

/// A line cut into dashes.
fn dashes(points: &[Place]) -> Vec<Place> {
    let mut dashes = Vec::new();
    let (mut done, period) = (0.0, DASH[0] + DASH[1]);
    for pair in points.windows(2) {
        let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        let at =
            |along: f64| [0, 1].map(|k| pair[0][k] + along / length * (pair[1][k] - pair[0][k]));
        let mut along = 0.0;
        while along < length {
            let phase = (done + along) % period;
            let step = if phase < DASH[0] { DASH[0] } else { period } - phase;
            let end = (along + step.max(1e-6)).min(length);
            if phase < DASH[0] {
                dashes.extend([at(along), at(end), [f64::NAN; 2]]);
            }
            along = end;
        }
        if length.is_finite() {
            done += length;
        }
    }
    dashes
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
        let line = Shape::Line {
            points: vec![
                [10.0, 7.3],
                [60.0, 12.3],
                [f64::NAN, 0.0],
                [80.0, 8.0],
                [90.0, 9.0],
            ],
            colour: INK,
            width: 2.0,
            dashed: false,
        };
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
        let polygon = Shape::Polygon {
            corners: vec![[2.0, 1.0], [4.0, 1.0], [4.0, 3.0], [2.0, 3.0]],
            colour,
        };
        let image = Shape::Image {
            corners: [[4.0, 3.0], [6.0, 5.0]],
            size: [2, 1],
            pixels: vec![Some([1, 2, 3]), None],
        };
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

    /// Of 24 pixels, two dashes of 7.
    #[test]
    fn a_dashed_line_has_its_share_of_ink() {
        let line = |dashed| Shape::Line {
            points: vec![[0.0, 2.5], [24.0, 2.5]],
            colour: INK,
            width: 1.0,
            dashed,
        };
        let dark = |dashed| {
            let row = pixels(&[line(dashed)], [24.0, 5.0])[3 * 48..3 * 72].to_vec();
            row.iter().filter(|value| **value < 128).count() / 3
        };
        assert_eq!(dark(false), 24);
        assert!((14..=16).contains(&dark(true)), "{}", dark(true));
    }
}
