//! Groove and melt film of a sliding contact: `groove.exr`, `groove.png` and `film.csv`.

use std::io::{self, Write};

use kufe_contact::{PressureMap, SurfaceField};
use kufe_sled::friction::film::FilmStation;

use crate::jobs::failure::Failure;
use crate::jobs::field::{NewFiles, exr};
use crate::jobs::press::SolvedContact;
use crate::jobs::slide::SolvedSliding;
use crate::plot::{Axis, Figure, Layer, PALETTE, Panel, Point};

const COMMENTS: &str = "depth: plastic depth of the ice [m]. Column i, row j of the pixels is centred at x = origin_x_m + i pixel_x_m \
    (along the runner, which slides towards +x), y = origin_y_m + j pixel_y_m (across): column 0 is the groove that is left.";

/// Writes groove.exr, groove.png and film.csv.
///
/// # Errors
/// [`Failure::BadInput`] with the file that cannot be written.
pub(super) fn write_sliding(
    output: &NewFiles,
    pressed: &SolvedContact,
    map: &PressureMap,
    slid: &SolvedSliding,
) -> Result<(), Failure> {
    let depths = depths(map, &pressed.solution.surface, &slid.groove.depth);
    let numbers = [
        ("fz_n", pressed.solution.fz),
        ("hardness_pa", slid.hardness.value),
    ];
    output.write("groove.exr", |mut file| {
        exr::write_channels(&mut file, map, COMMENTS, &numbers, &[("depth", &depths)])
    })?;
    output.write("film.csv", |file| write_film(file, slid))?;
    output.picture("groove.png", &groove_picture(pressed, slid))
}

/// The film station by station, from the front.
fn write_film(mut file: impl Write, slid: &SolvedSliding) -> io::Result<()> {
    writeln!(
        file,
        "x_m,width_m,pressure_pa,film_m,temperature_c,melt_mps,shear_pa,boundary_share"
    )?;
    for station in &slid.film.film.stations {
        writeln!(
            file,
            "{:.9e},{:.6e},{:.6e},{:.6e},{:.6},{:.6e},{:.6e},{:.6e}",
            slid.film.front - station.xi,
            station.width,
            station.pressure,
            station.thickness,
            station.temperature,
            station.melt_rate,
            station.shear,
            station.boundary_share
        )?;
    }
    Ok(())
}

/// Depth at the pixels' centres [m], row by row: bilinear between the nodes of `field`, constant
/// beyond its rim.
fn depths(map: &PressureMap, field: &SurfaceField, depth: &[f64]) -> Vec<f64> {
    let columns = places(&field.x, map.x0, map.dx, map.nx);
    let rows = places(&field.y, map.y0, map.dy, map.ny);
    let nx = field.x.len();
    let mut pixels = Vec::with_capacity(map.nx * map.ny);
    for &(j, v) in &rows {
        for &(i, u) in &columns {
            let along = |j: usize| (1.0 - u) * depth[j * nx + i] + u * depth[j * nx + i + 1];
            pixels.push((1.0 - v) * along(j) + v * along(j + 1));
        }
    }
    pixels
}

/// For each pixel the index of the node before it and the fraction of the way to the next node.
fn places(nodes: &[f64], first: f64, step: f64, count: usize) -> Vec<(usize, f64)> {
    let place = |k: usize| {
        let at = first + k as f64 * step;
        let after = nodes.partition_point(|&node| node <= at);
        let i = after.clamp(1, nodes.len() - 1) - 1;
        let share = (at - nodes[i]) / (nodes[i + 1] - nodes[i]);
        (i, share.clamp(0.0, 1.0))
    };
    (0..count).map(place).collect()
}

/// Three panels: the remaining groove, its deepest line, and the film along the patch. Dots are
/// nodes of the mesh or stations of the film.
fn groove_picture(pressed: &SolvedContact, slid: &SolvedSliding) -> Figure {
    let groove = &slid.groove;
    let widths = groove.sections.iter().map(|section| section.width);
    let widest = 0.75e3 * widths.fold(0.0, f64::max);
    let profile = groove.profile.y().iter().zip(groove.profile.depth());
    let across = profile.map(|(y, depth)| (1e3 * y, -1e6 * depth));
    let across = across.filter(|(y, _)| y.abs() <= widest).collect();
    let groove = "the remaining groove (dots: nodes of the mesh)";
    let line =
        "the groove's deepest line under the runner, which slides to the right (dots: nodes)";
    let patch = "the patch (dots: stations of the film)";
    let x = "x along the runner [mm]";
    let (unloaded, deepest) = (
        "height of the unloaded ice [µm]",
        deepest_line(pressed, slid),
    );
    let panels = [
        panel(
            groove,
            "y across [mm]",
            "height of the ice [µm]",
            vec![("", across)],
        ),
        panel(line, x, unloaded, vec![("", deepest)]),
        panel(patch, x, "each in its own unit", along(slid)),
    ];
    Figure::new(1100.0, "").column(300.0, panels)
}

/// Plastic depth along the deepest line of the groove, under the patch and 20 % beyond its ends.
fn deepest_line(pressed: &SolvedContact, slid: &SolvedSliding) -> Vec<Point> {
    let field = &pressed.solution.surface;
    let groove = &slid.groove;
    let nx = field.x.len();
    let deepest = (0..field.y.len())
        .max_by(|&i, &j| groove.depth[i * nx].total_cmp(&groove.depth[j * nx]))
        .unwrap_or(0);
    let length = groove.front.value - groove.back.value;
    let from = groove.lowest + groove.back.value - 0.2 * length;
    let to = groove.lowest + groove.front.value + 0.2 * length;
    let nodes = field.x.iter().zip(&groove.depth[deepest * nx..]);
    let nodes = nodes.filter(|(x, _)| (from..=to).contains(*x));
    nodes.map(|(x, depth)| (1e3 * x, -1e6 * depth)).collect()
}

/// Name and points of a line.
type Line = (&'static str, Vec<Point>);

/// Film, pressure and width over the stations.
fn along(slid: &SolvedSliding) -> Vec<Line> {
    let dots = |value: fn(&FilmStation) -> f64| -> Vec<Point> {
        let point = |s: &FilmStation| (1e3 * (slid.film.front - s.xi), value(s));
        slid.film.film.stations.iter().map(point).collect()
    };
    let mut lines = vec![
        ("film [0.1 µm]", dots(|s| 1e7 * s.thickness)),
        ("pressure [MPa]", dots(|s| 1e-6 * s.pressure)),
        ("width [0.1 mm]", dots(|s| 1e4 * s.width)),
    ];
    if slid.friction.boundary.value > 0.0 {
        let share = dots(|s| 1e2 * s.boundary_share);
        lines.push(("boundary contact [%]", share));
    }
    lines
}

fn panel(title: &str, x: &str, y: &str, lines: Vec<Line>) -> Panel {
    let layers = lines.into_iter().zip(PALETTE);
    let layers = layers.flat_map(|((name, points), colour)| {
        let line = Layer::line(2.0, points.iter().copied(), colour);
        [line.named(name), Layer::dots(3.0, points, colour)]
    });
    Panel::new(Axis::new(x), Axis::new(y), layers.collect()).titled(title)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::field::tests::hertz_map;

    #[test]
    fn a_depth_that_is_linear_is_so_at_every_pixel() {
        let map = hertz_map();
        let [width, height] = [map.nx as f64 * map.dx, map.ny as f64 * map.dy];
        let x: Vec<f64> = (0..5)
            .map(|i| map.x0 + width * (f64::from(i) - 1.0) / 3.0)
            .collect();
        let y: Vec<f64> = (0..5)
            .map(|j| map.y0 + height * (f64::from(j) - 1.0) / 3.0)
            .collect();
        let linear = |x: f64, y: f64| 1e-5 + 2e-4 * x - 3e-3 * y;
        let depth: Vec<f64> = (0..25).map(|k| linear(x[k % 5], y[k / 5])).collect();
        let field = SurfaceField {
            pressure: vec![0.0; 25],
            gap: vec![0.0; 25],
            yielded: vec![0.0; 25],
            uz: vec![0.0; 25],
            x,
            y,
        };
        for (k, found) in depths(&map, &field, &depth).iter().enumerate() {
            let at = linear(
                map.x0 + (k % map.nx) as f64 * map.dx,
                map.y0 + (k / map.nx) as f64 * map.dy,
            );
            assert!((found - at).abs() < 1e-15);
        }
    }
}
