//! Lines that are drawn to a fraction of a pixel.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::plot::file::Error;

/// A chart in a PNG whose axes are linear.
pub type PngChart<'a, 'b> =
    ChartContext<'a, BitMapBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Draws the line through points, broken where one is no number.
///
/// The drawing library rounds points to whole pixels, which makes stairs of a smooth curve. Here each pixel takes the share of the colour that
/// the line covers of it.
///
/// # Errors
/// [`Error::Draw`] from the drawing library.
pub fn curve(
    chart: &PngChart,
    points: impl IntoIterator<Item = (f64, f64)>,
    style: impl Into<ShapeStyle>,
) -> Result<(), Error> {
    let style = style.into();
    let area = chart.plotting_area().strip_coord_spec();
    let (width, height) = area.dim_in_pixel();
    let place = places(chart);
    let mut cover = Cover {
        size: [width as usize, height as usize],
        shares: vec![0.0; width as usize * height as usize],
        touched: Vec::new(),
        half: 0.5 * f64::from(style.stroke_width),
    };
    let mut before = None;
    for point in points {
        let [x, y] = place(point);
        let at = (x.is_finite() && y.is_finite()).then_some([x, y]);
        if let (Some(from), Some(to)) = (before, at) {
            cover.add(from, to);
        }
        before = at;
    }
    for &pixel in &cover.touched {
        let at = [pixel % cover.size[0], pixel / cover.size[0]].map(|k| k as i32);
        let colour = style.color.mix(cover.shares[pixel]);
        area.draw_pixel((at[0], at[1]), &colour)?;
    }
    Ok(())
}

/// From a chart's numbers to pixels of its plotting area and fractions of them.
fn places(chart: &PngChart) -> impl Fn((f64, f64)) -> [f64; 2] {
    let (xs, ys) = (chart.x_range(), chart.y_range());
    let origin = chart.plotting_area().get_base_pixel();
    let pixel = |x, y| {
        let (column, row) = chart.backend_coord(&(x, y));
        [f64::from(column - origin.0), f64::from(row - origin.1)]
    };
    let (first, last) = (pixel(xs.start, ys.start), pixel(xs.end, ys.end));
    move |(x, y)| {
        let along = (x - xs.start) / (xs.end - xs.start);
        let up = (y - ys.start) / (ys.end - ys.start);
        [
            first[0] + along * (last[0] - first[0]),
            first[1] + up * (last[1] - first[1]),
        ]
    }
}

/// How much of each pixel a line covers.
struct Cover {
    size: [usize; 2],
    shares: Vec<f64>,
    /// The pixels that it covers: few of all.
    touched: Vec<usize>,
    /// Half the line's width, in pixels.
    half: f64,
}

impl Cover {
    fn add(&mut self, from: [f64; 2], to: [f64; 2]) {
        let reach = self.half + 0.5;
        let range = |axis: usize| {
            let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
            let end = (high + reach + 1.0).clamp(0.0, self.size[axis] as f64);
            (low - reach).clamp(0.0, end) as usize..end as usize
        };
        let (columns, rows) = (range(0), range(1));
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        for row in rows {
            for column in columns.clone() {
                let off = [column as f64 - from[0], row as f64 - from[1]];
                let share = if length > 0.0 {
                    ((off[0] * along[0] + off[1] * along[1]) / (length * length)).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let distance = (off[0] - share * along[0]).hypot(off[1] - share * along[1]);
                let pixel = row * self.size[0] + column;
                let share = (reach - distance).min(1.0);
                if share > 0.0 && self.shares[pixel] == 0.0 {
                    self.touched.push(pixel);
                }
                self.shares[pixel] = self.shares[pixel].max(share);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::file::png;

    /// A line that climbs a pixel in ten is as dark in every column; points rounded to pixels would leave stairs.
    #[test]
    fn a_flat_slope_is_drawn_without_stairs_and_not_across_a_gap() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("line.png");
        png(&path, 101, 21, &|root| {
            let chart = ChartBuilder::on(&root).build_cartesian_2d(0.0..100.0, 0.0..20.0)?;
            let points = [
                (10.0, 7.3),
                (60.0, 12.3),
                (f64::NAN, 0.0),
                (80.0, 8.0),
                (90.0, 9.0),
            ];
            curve(&chart, points, BLACK.stroke_width(2))
        })
        .unwrap();
        let file = std::fs::File::open(&path).unwrap();
        let mut reader = ::png::Decoder::new(file).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size()];
        reader.next_frame(&mut pixels).unwrap();
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
}
