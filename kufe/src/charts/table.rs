//! Chart of a lookup table over curvature and force: smooth interpolation, contour lines and nodes.

use std::collections::BTreeSet;

use kufe_lut::{AxisKind, Interpolator, Mode, Quantity, Table};

use crate::plot::{
    Axis, Cells, Colour, ColourBar, Figure, INK, Layer, Panel, Point, Scale, Symbol, Ticks,
    axis_ticks, contour, extent, percent, short, shown_unit,
};

/// Number of cells of the map along each axis.
const CELLS: usize = 240;
/// Number of checks that are labelled with their interpolation error: those with the largest
/// errors.
const LABELS: usize = 8;
/// Number of positions along each axis to which samples are rounded.
const PLACES: f64 = 500.0;

const WHITE: Colour = Colour::new(255, 255, 255);
/// Colours of samples inside and outside the table, visible on every colour of the map and on
/// white.
const INSIDE: Colour = Colour::new(255, 105, 190).alpha(0.7);
const OUTSIDE: Colour = Colour::new(214, 30, 30);

/// The slice of a table at the stated speed and temperature, or at the middle breakpoints where
/// they are not stated; without them if the table has no such axis.
fn slice_of(table: &Table, stated: kufe_lut::Point) -> kufe_lut::Point {
    let coordinate = |kind| {
        let axis = table.axes().get(kind)?;
        Some(stated.get(kind).unwrap_or(axis[axis.len() / 2]))
    };
    kufe_lut::Point {
        speed: coordinate(AxisKind::Speed),
        ice_c: coordinate(AxisKind::IceTemperature),
        ..stated
    }
}

fn in_words(slice: &kufe_lut::Point) -> String {
    let parts = [
        (", rocker radius", slice.rocker_radius, "m"),
        (",", slice.speed, "m/s"),
        (", ice of", slice.ice_c, "°C"),
    ];
    let parts = parts.into_iter();
    parts
        .filter_map(|(words, value, unit)| Some(format!("{words} {} {unit}", value?)))
        .collect()
}

/// The picture of a table, and how many samples of runs are outside the table.
#[derive(Clone, Debug)]
pub struct TablePicture {
    /// The picture.
    pub figure: Figure,
    /// Samples outside the table.
    pub outside: usize,
}

/// A quantity over curvature and (logarithmic) force: colours and contour lines of smooth
/// interpolation, dots at the nodes, crosses at the checks, and the `samples` of runs.
///
/// `slice` states the other coordinates of the surface; without a speed or temperature, the middle
/// breakpoint is used.
///
/// # Errors
/// Those of a table that does not have the slice.
pub fn table_picture(
    table: &Table,
    quantity: Quantity,
    slice: kufe_lut::Point,
    samples: &[kufe_lut::Point],
) -> Result<TablePicture, kufe_lut::Error> {
    let slice = slice_of(table, slice);
    let interpolator = Interpolator::new(table, quantity, Mode::Smooth, slice.rocker_radius)?;
    let axes = table.axes();
    let forces = axes.fz();
    let fz = wider([forces[0], forces[forces.len() - 1]], 0.1 * forces[0]);
    let curvature = axes.range(AxisKind::Curvature, fz[0]);
    let curvature = wider(curvature.unwrap_or_default(), 1e-3);
    let place = |(column, row): Point| at([column, row].map(|k| k / CELLS as f64), curvature, fz);
    let nodes = (0..(CELLS + 1) * (CELLS + 1)).map(|k| {
        let (column, row) = (k % (CELLS + 1), k / (CELLS + 1));
        let (curvature, fz) = place((column as f64, row as f64));
        let node = kufe_lut::Point {
            fz,
            curvature,
            ..slice
        };
        interpolator.at(node).value
    });
    let nodes: Vec<f64> = nodes.collect();
    let [low, high] = extent(nodes.iter().copied());
    let unit = shown_unit(quantity.key());
    let scale = Scale::of_all(&unit, [low, high]);
    let nodes: Vec<f64> = nodes.iter().map(|value| scale.times * value).collect();
    let value = |column: usize, row: usize| nodes[row * (CELLS + 1) + column];
    let [low, high] = [low, high].map(|value| scale.times * value);
    let range = [low, if high > low { high } else { low + 1.0 }];
    let name = scale.label(quantity.title());
    let bar = ColourBar::viridis(&*name, range);
    let cells = Cells::new([CELLS; 2], |column, row| {
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let corners = corners.map(|(i, j)| value(column + i, row + j));
        Some(bar.colour(0.25 * corners.iter().sum::<f64>()))
    });
    let mut layers = vec![Layer::map([curvature, fz], cells)];
    for level in axis_ticks(range[0], range[1], 8) {
        let segments = contour([CELLS + 1; 2], value, level).into_iter();
        let segments: Vec<[Point; 2]> = segments.map(|ends| ends.map(place)).collect();
        let middle = segments.get(segments.len() / 2).map(|ends| ends[0]);
        layers.push(Layer::segments(1.0, segments, WHITE.alpha(0.8)));
        layers.extend(middle.map(|at| Layer::text(at, short(level), [0.0, 0.6], WHITE)));
    }
    let on_picture = |node: &kufe_lut::Point| (node.curvature, node.fz);
    let checks = table.checks().iter().map(|check| on_picture(&check.point));
    let errors = table.check_errors(quantity, Mode::Smooth)?.into_iter();
    let errors = errors.zip(checks.clone());
    let mut errors: Vec<(f64, Point)> = errors.filter_map(|(e, at)| Some((e?, at))).collect();
    errors.sort_by(|a, b| b.0.total_cmp(&a.0));
    layers.push(Layer::symbols(Symbol::Cross, 4.0, checks, WHITE));
    layers.extend(
        errors
            .into_iter()
            .take(LABELS)
            .map(|(error, at)| Layer::text(at, percent(error), [0.0, 1.6], WHITE)),
    );
    let placed = Samples::new(samples, &interpolator, fz, curvature);
    layers.push(Layer::dots(1.0, placed.inside, INSIDE));
    layers.push(Layer::dots(2.0, placed.outside, OUTSIDE));
    let nodes = axes.points();
    layers.push(Layer::dots(2.0, nodes.iter().map(on_picture), INK));
    if curvature[0] < 0.0 && curvature[1] > 0.0 {
        layers.push(Layer::upright(0.0, WHITE.alpha(0.9)));
    }
    let x = Axis::new("track curvature [1/m]  (crest < 0 < valley; 0: straight)");
    let y = Axis::with("normal force [N]", Ticks::Logarithmic);
    let (x, y) = (x.within(placed.curvature), y.within(placed.fz));
    let outside = placed.count_outside;
    let panel = Panel::new(x, y, layers).titled(match samples.len() {
        0 => String::new(),
        count => format!("{count} samples (pink), {outside} of them outside the table (red)"),
    });
    let title = format!(
        "{name}{}: {} x {} nodes (dots), {} checks (crosses)",
        in_words(&slice),
        forces.len(),
        axes.curvature().len(),
        table.checks().len()
    );
    Ok(TablePicture {
        figure: Figure::new(1100.0, title).row(600.0, [panel]).bar(bar),
        outside,
    })
}

/// Curvature and force at relative positions from 0 to 1 in their ranges; that of the force is
/// logarithmic.
fn at([x, y]: [f64; 2], curvature: [f64; 2], fz: [f64; 2]) -> Point {
    let along = curvature[0] + (curvature[1] - curvature[0]) * x;
    (along, fz[0] * (fz[1] / fz[0]).powf(y))
}

/// A range; a range of zero length is extended by `room` on both sides.
fn wider([low, high]: [f64; 2], room: f64) -> [f64; 2] {
    let room = if low < high { 0.0 } else { room };
    [low - room, high + room]
}

/// Samples of runs in a picture, each position once.
struct Samples {
    /// Ranges of force [N] and curvature [1/m] of the picture: those of the table, extended to
    /// samples not far outside.
    fz: [f64; 2],
    curvature: [f64; 2],
    /// Curvature and force of positions with samples in the table.
    inside: Vec<Point>,
    /// Curvature and force of positions with samples outside the table, also by speed or
    /// temperature; samples outside the picture are moved to its border.
    outside: Vec<Point>,
    /// Number of samples outside the table.
    count_outside: usize,
}

impl Samples {
    /// `fz` and `curvature` are the ranges of the table.
    fn new(
        samples: &[kufe_lut::Point],
        interpolator: &Interpolator,
        fz: [f64; 2],
        curvature: [f64; 2],
    ) -> Self {
        let room = 0.5 * (curvature[1] - curvature[0]);
        let fz = extended(fz, [fz[0] / 4.0, fz[1] * 4.0], samples.iter().map(|s| s.fz));
        let bounds = [curvature[0] - room, curvature[1] + room];
        let curvature = extended(curvature, bounds, samples.iter().map(|s| s.curvature));
        let mut places = [BTreeSet::new(), BTreeSet::new()];
        let mut count_outside = 0;
        for sample in samples {
            let outside = interpolator.at(*sample).out_of_range;
            count_outside += usize::from(outside);
            let x = (sample.curvature - curvature[0]) / (curvature[1] - curvature[0]);
            let y = (sample.fz.max(fz[0]) / fz[0]).ln() / (fz[1] / fz[0]).ln();
            let place = |share: f64| (share.clamp(0.0, 1.0) * PLACES) as u32;
            if x.is_finite() && sample.fz.is_finite() {
                places[usize::from(outside)].insert((place(x), place(y)));
            }
        }
        let at = |(x, y): (u32, u32)| at([x, y].map(|k| f64::from(k) / PLACES), curvature, fz);
        let [inside, outside] = places.map(|places| places.into_iter().map(at).collect());
        Samples {
            fz,
            curvature,
            inside,
            outside,
            count_outside,
        }
    }
}

/// A range extended to these values, within `bounds`.
fn extended(range: [f64; 2], bounds: [f64; 2], values: impl Iterator<Item = f64>) -> [f64; 2] {
    let values = values.filter(|v| v.is_finite());
    values.fold(range, |[low, high], v| {
        [low.min(v.max(bounds[0])), high.max(v.min(bounds[1]))]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use kufe_lut::{Axes, Figures};

    #[test]
    fn samples_outside_are_counted_shown_and_moved_to_the_border() -> Result<(), kufe_lut::Error> {
        let axes = Axes::new(vec![500.0, 4000.0], vec![0.0, 0.02])?;
        let node = Figures::at_rest([1e7, 6e6, 1e-5, 0.05, 3e-4, 1e-5]);
        let node = node.with_error(Quantity::PMax, 0.0);
        let table = Table::new(axes, &[node; 4], vec![])?;
        let lookup = Interpolator::new(&table, Quantity::PMax, Mode::Smooth, None)?;
        let at = |fz, curvature| kufe_lut::Point::sliding(fz, curvature, 30.0, -5.0);
        let samples = [
            at(1000.0, 0.01),
            at(1000.0, 0.01),
            at(6000.0, 0.01),
            at(-50.0, 0.5),
            at(f64::NAN, 0.01),
        ];
        let found = Samples::new(&samples, &lookup, [500.0, 4000.0], [0.0, 0.02]);
        assert_eq!(found.count_outside, 3);
        assert_eq!((found.inside.len(), found.outside.len()), (1, 2));
        assert_eq!(found.fz, [125.0, 6000.0]);
        assert_eq!(found.curvature, [0.0, 0.03]);
        let edge = found
            .outside
            .iter()
            .any(|&(k, fz)| (k / 0.03 - 1.0).abs() < 1e-12 && (fz / 125.0 - 1.0).abs() < 1e-12);
        assert!(edge, "{:?}", found.outside);
        let picture = table_picture(&table, Quantity::PMax, kufe_lut::Point::default(), &samples)?;
        let title = &picture.figure.rows[0].panels[0].title;
        assert!(title.starts_with("5 samples (pink), 3"), "{title}");
        Ok(())
    }
}
