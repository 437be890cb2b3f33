//! A table drawn: filled cells of the smooth mode, contour lines, and the nodes.

use std::path::Path;

use crate::plot::{axis_ticks, colour_bar, viridis};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use kufe_lut::{Interpolator, Mode, Quantity, Sample, Table};

use crate::charts::samples::Samples;

/// Cells of the map along each axis.
const CELLS: usize = 240;

/// Samples of runs in the table, and outside of it: to be seen on every colour of the map and on white.
const INSIDE: RGBColor = RGBColor(255, 105, 190);
const OUTSIDE: RGBColor = RGBColor(214, 30, 30);

/// Why a table could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum DrawTableError {
    /// The table has no such slice.
    #[error(transparent)]
    Table(#[from] kufe_lut::Error),
    /// The picture could not be made.
    #[error(transparent)]
    Picture(#[from] crate::plot::Error),
}

/// Which of a table's surfaces over force and curvature is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slice {
    /// Rocker radius where the table has that axis [m].
    pub rocker_radius: Option<f64>,
    /// Speed where the table has that axis [m/s]; its middle breakpoint where absent.
    pub speed: Option<f64>,
    /// Temperature of the ice where the table has that axis [C]; its middle breakpoint where absent.
    pub ice_c: Option<f64>,
}

impl Slice {
    /// The slice of a table with the middle breakpoints where nothing is said, and nothing where there is no axis.
    fn of(self, table: &Table) -> Self {
        let on = |axis: Option<&[f64]>, value: Option<f64>| {
            axis.map(|axis| value.unwrap_or(axis[axis.len() / 2]))
        };
        Slice {
            rocker_radius: self.rocker_radius,
            speed: on(table.axes().speed(), self.speed),
            ice_c: on(table.axes().ice_c(), self.ice_c),
        }
    }

    fn in_words(&self) -> String {
        [
            (", rocker radius", self.rocker_radius, "m"),
            (",", self.speed, "m/s"),
            (", ice of", self.ice_c, "°C"),
        ]
        .into_iter()
        .filter_map(|(words, value, unit)| Some(format!("{words} {} {unit}", value?)))
        .collect()
    }
}

/// Draws a quantity over curvature and (logarithmic) force as a PNG: colours and contour lines of the smooth mode, dots at
/// the nodes, crosses at the checks; and where `samples` of runs lie, with a line that counts those outside the table. Returns that count.
///
/// # Errors
/// [`DrawTableError::Table`] where the table lacks the slice, [`DrawTableError::Picture`] where the file cannot be made.
pub fn draw(
    table: &Table,
    quantity: Quantity,
    slice: Slice,
    samples: &[Sample],
    path: &Path,
) -> Result<usize, DrawTableError> {
    let slice = slice.of(table);
    let interpolator = Interpolator::new(table, quantity, Mode::Smooth, slice.rocker_radius)?;
    let map = Map::new(table, &interpolator, quantity, &slice);
    let samples = Samples::new(samples, &interpolator, map.fz, map.curvature);
    crate::plot::png(path, 1100, 760, &|root| {
        let (left, right) = root.split_horizontally(940);
        let heading = title_of(table, &map, &slice);
        let mut left = left
            .margin(12, 12, 12, 12)
            .titled(&heading, ("sans-serif", 20))?;
        if samples.count > 0 {
            left = left.titled(&samples.in_words(), ("sans-serif", 16))?;
        }
        draw_map(&left, table, &map, &samples)?;
        // The bar begins where the map does.
        let above = left.get_base_pixel().1 - right.get_base_pixel().1;
        colour_bar(
            &right.margin(above, 66, 10, 0),
            [map.range.0, map.range.1],
            |value| map.colour(value),
            &format!("{} [{}]", map.quantity.title(), map.unit),
        )
    })?;
    Ok(samples.beyond)
}

/// Values on a regular raster, force logarithmic, in the unit shown.
struct Map {
    fz: (f64, f64),
    curvature: (f64, f64),
    /// Rows of constant force; one more than cells each way.
    values: Vec<f64>,
    range: (f64, f64),
    quantity: Quantity,
    unit: &'static str,
}

impl Map {
    fn new(table: &Table, interpolator: &Interpolator, quantity: Quantity, slice: &Slice) -> Self {
        let (factor, unit) = match quantity {
            Quantity::PMax | Quantity::PMean => (1e-6, "MPa"),
            Quantity::Area => (1e6, "mm²"),
            Quantity::Length | Quantity::Width => (1e3, "mm"),
            Quantity::Approach | Quantity::GrooveDepth | Quantity::FilmMean => (1e6, "µm"),
            Quantity::Mu | Quantity::MuPloughing | Quantity::MuViscous | Quantity::MuBoundary => {
                (1e3, "1e-3")
            }
        };
        // One breakpoint has no extent: a little room around it keeps the axes drawable.
        let widened = |values: &[f64], room: f64| {
            let (low, high) = (values[0], values[values.len() - 1]);
            if low < high {
                (low, high)
            } else {
                (low - room, low + room)
            }
        };
        let fz = table.axes().fz();
        let fz = widened(fz, 0.1 * fz[0]);
        let curvature = widened(&table.axes().curvature_range(fz.0), 1e-3);
        let [speed, ice_c] = [slice.speed, slice.ice_c].map(|value| value.unwrap_or(f64::NAN));
        let mut values = Vec::with_capacity((CELLS + 1) * (CELLS + 1));
        for i in 0..=CELLS {
            let force = fz.0 * (fz.1 / fz.0).powf(i as f64 / CELLS as f64);
            for j in 0..=CELLS {
                let k = curvature.0 + (curvature.1 - curvature.0) * j as f64 / CELLS as f64;
                values.push(
                    factor
                        * interpolator
                            .at(Sample {
                                fz: force,
                                curvature: k,
                                speed,
                                ice_c,
                            })
                            .value,
                );
            }
        }
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Map {
            fz,
            curvature,
            values,
            range: (low, if high > low { high } else { low + 1.0 }),
            quantity,
            unit,
        }
    }

    fn force(&self, i: f64) -> f64 {
        self.fz.0 * (self.fz.1 / self.fz.0).powf(i / CELLS as f64)
    }

    fn k(&self, j: f64) -> f64 {
        self.curvature.0 + (self.curvature.1 - self.curvature.0) * j / CELLS as f64
    }

    fn value(&self, i: usize, j: usize) -> f64 {
        self.values[i * (CELLS + 1) + j]
    }

    fn colour(&self, value: f64) -> RGBColor {
        viridis((value - self.range.0) / (self.range.1 - self.range.0))
    }

    fn levels(&self) -> Vec<f64> {
        axis_ticks(self.range.0, self.range.1, 8)
    }

    /// Pieces of the contour line of a level: marching squares.
    fn contour(&self, level: f64) -> Vec<[(f64, f64); 2]> {
        let mut pieces = Vec::new();
        for i in 0..CELLS {
            for j in 0..CELLS {
                let corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)];
                let mut crossings = Vec::with_capacity(4);
                for n in 0..4 {
                    let (p, q) = (corners[n], corners[(n + 1) % 4]);
                    let (a, b) = (self.value(p.0, p.1), self.value(q.0, q.1));
                    if (a < level) != (b < level) {
                        let t = (level - a) / (b - a);
                        let along = |p: usize, q: usize| p as f64 + t * (q as f64 - p as f64);
                        crossings.push((self.k(along(p.1, q.1)), self.force(along(p.0, q.0))));
                    }
                }
                pieces.extend(crossings.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
            }
        }
        pieces
    }
}

fn title_of(table: &Table, map: &Map, slice: &Slice) -> String {
    format!(
        "{} [{}]{}: {} x {} nodes (dots), {} checks (crosses)",
        map.quantity.title(),
        map.unit,
        slice.in_words(),
        table.axes().fz().len(),
        table.axes().curvature().len(),
        table.checks().len()
    )
}

fn draw_map<DB: DrawingBackend>(
    area: &DrawingArea<DB, plotters::coord::Shift>,
    table: &Table,
    map: &Map,
    samples: &Samples,
) -> Result<(), crate::plot::Error>
where
    DB::ErrorType: 'static,
{
    let mut chart = ChartBuilder::on(area)
        .x_label_area_size(54)
        .y_label_area_size(74)
        .build_cartesian_2d(
            samples.curvature.0..samples.curvature.1,
            (samples.fz.0..samples.fz.1)
                .log_scale()
                .with_key_points(decades(samples.fz)),
        )?;
    chart.draw_series((0..CELLS).flat_map(|i| {
        (0..CELLS).map(move |j| {
            let middle = 0.25
                * (map.value(i, j)
                    + map.value(i + 1, j)
                    + map.value(i, j + 1)
                    + map.value(i + 1, j + 1));
            let (i, j) = (i as f64, j as f64);
            Rectangle::new(
                [
                    (map.k(j), map.force(i)),
                    (map.k(j + 1.0), map.force(i + 1.0)),
                ],
                map.colour(middle).filled(),
            )
        })
    }))?;
    for level in map.levels() {
        let pieces = map.contour(level);
        let middle = pieces.get(pieces.len() / 2).map(|piece| piece[0]);
        chart.draw_series(
            pieces
                .into_iter()
                .map(|piece| PathElement::new(piece.to_vec(), WHITE.mix(0.8).stroke_width(1))),
        )?;
        let style = ("sans-serif", 13)
            .into_text_style(area)
            .color(&WHITE)
            .pos(Pos::new(HPos::Center, VPos::Bottom));
        chart.draw_series(
            middle
                .into_iter()
                .map(|at| Text::new(short(level), at, style.clone())),
        )?;
    }
    chart.draw_series(table.checks().iter().map(|check| {
        Cross::new(
            (check.point.curvature, check.point.fz),
            4,
            WHITE.stroke_width(1),
        )
    }))?;
    let spots = |places: &[(f64, f64)], size, colour: RGBAColor| {
        let dots = places.iter();
        dots.map(|&at| Circle::new(at, size, colour.filled()))
            .collect::<Vec<_>>()
    };
    chart.draw_series(spots(&samples.inside, 1, INSIDE.mix(0.7)))?;
    chart.draw_series(spots(&samples.outside, 2, OUTSIDE.mix(1.0)))?;
    let nodes = table.axes().points().into_iter();
    chart
        .draw_series(nodes.map(|node| Circle::new((node.curvature, node.fz), 2, BLACK.filled())))?;
    if map.curvature.0 < 0.0 && map.curvature.1 > 0.0 {
        let straight = [(0.0, map.fz.0), (0.0, map.fz.1)];
        let line = DashedPathElement::new(straight, 6, 6, WHITE.mix(0.9));
        chart.draw_series(std::iter::once(line))?;
    }
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("track curvature [1/m]  (crest < 0 < valley; 0: straight)")
        .y_desc("normal force [N]")
        .label_style(("sans-serif", 15))
        .y_label_formatter(&|fz| short(*fz))
        .draw()?;
    Ok(())
}

/// Once, twice and five times the powers of ten between two positive numbers, the ends themselves where none lies between.
fn decades((low, high): (f64, f64)) -> Vec<f64> {
    let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let all = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|times| times * 10f64.powi(power)));
    let between: Vec<f64> = all.filter(|at| (low..=high).contains(at)).collect();
    match between.len() {
        0 | 1 => vec![low, high],
        _ => between,
    }
}

/// Four significant figures, without trailing zeros.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').into(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_decade_of_forces_has_ticks() {
        let near = |range, expected: &[f64]| {
            let found = decades(range);
            assert_eq!(found.len(), expected.len(), "{found:?}");
            let close = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() < 1e-12;
            assert!(found.iter().zip(expected).all(close), "{found:?}");
        };
        near((500.0, 2000.0), &[500.0, 1000.0, 2000.0]);
        near(
            (90.0, 8000.0),
            &[100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0],
        );
        near((600.0, 900.0), &[600.0, 900.0]);
    }
}
