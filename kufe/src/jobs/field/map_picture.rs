//! `pressure.png`: the map with its outline and colour bar, and two cuts through the peak.

use kufe_contact::PressureMap;

use crate::plot::{
    Axis, Cells, Colour, ColourBar, Figure, INK, Layer, PALETTE, Panel, Point, Rgb, Scales,
    contour, extent, tick_text,
};

/// Ground of a map where there is nothing to show.
pub const GROUND: Colour = Colour::new(244, 244, 246);
/// Below this part of the peak a point is outside the contact, for the outline and the colouring.
const EDGE: f64 = 0.01;
/// Columns and rows of the picture of a map.
const CELLS: [usize; 2] = [1200, 480];

/// The maps of a contact's parts side by side, and cuts through the highest of them.
pub fn map_picture(maps: &[PressureMap], title: &str) -> Figure {
    let highest = |map: &PressureMap| map.pressure.iter().copied().fold(0.0, f64::max) / 1e6;
    let figure = Figure::new(1500.0, title);
    let Some(main) = maps.iter().max_by(|a, b| highest(a).total_cmp(&highest(b))) else {
        return figure;
    };
    let peak = match highest(main) {
        peak if peak > 0.0 => peak,
        _ => 1.0,
    };
    let bar = ColourBar::viridis("contact pressure [MPa]", [0.0, peak]);
    let [x, y] = window(main);
    let (x_peak, y_peak) = main.peak();
    let at = |[from, to]: [f64; 2], at: f64| tick_text(1e3 * at, to - from);
    let columns = (0..main.nx).map(|i| main.x0 + i as f64 * main.dx);
    let along = columns.map(|x| (1e3 * x, main.pressure_at(x, y_peak) / 1e6));
    let rows = (0..main.ny).map(|j| main.y0 + j as f64 * main.dy);
    let across = rows.map(|y| (1e3 * y, main.pressure_at(x_peak, y) / 1e6));
    let along = cut("x [mm]", along.collect(), peak);
    let across = cut("y [mm]", across.collect(), peak);
    let cuts = [
        along.titled(format!("along, at y = {} mm", at(y, y_peak))),
        across.titled(format!("across, at x = {} mm", at(x, x_peak))),
    ];
    let maps = maps.iter().map(|map| map_panel(map, &bar));
    figure.row(450.0, maps).bar(bar.clone()).row(270.0, cuts)
}

/// From where to where a map reaches along and across [mm].
fn window(map: &PressureMap) -> [[f64; 2]; 2] {
    let span = |first: f64, step: f64, count: usize| {
        [
            1e3 * (first - 0.5 * step),
            1e3 * (first + (count as f64 - 0.5) * step),
        ]
    };
    [span(map.x0, map.dx, map.nx), span(map.y0, map.dy, map.ny)]
}

fn map_panel(map: &PressureMap, bar: &ColourBar) -> Panel {
    let edge = EDGE * bar.range[1];
    let cell = |x: f64, y: f64| {
        let pressure = map.pressure_at(1e-3 * x, 1e-3 * y) / 1e6;
        (pressure > edge).then(|| bar.colour(pressure))
    };
    let value = |i: usize, j: usize| map.pressure[j * map.nx + i];
    let outline = contour([map.nx, map.ny], value, 1e6 * edge).into_iter();
    let place = |(i, j): Point| (1e3 * (map.x0 + i * map.dx), 1e3 * (map.y0 + j * map.dy));
    let outline = Layer::segments(1.0, outline.map(|ends| ends.map(place)), INK);
    coloured_panel(window(map), cell, vec![outline])
}

/// A map over a window [mm] with the colour of each place [mm], and further layers on it.
pub(super) fn coloured_panel(
    [x, y]: [[f64; 2]; 2],
    cell: impl Fn(f64, f64) -> Option<Rgb>,
    above: Vec<Layer>,
) -> Panel {
    let middle = |[from, to]: [f64; 2], k: usize, count: usize| {
        from + (k as f64 + 0.5) / count as f64 * (to - from)
    };
    let cells = Cells::new(CELLS, |column, row| {
        cell(middle(x, column, CELLS[0]), middle(y, row, CELLS[1]))
    });
    let ground = [Layer::rectangle(x, y, GROUND), Layer::map([x, y], cells)];
    let layers = ground.into_iter().chain(above).collect();
    let x = Axis::new("x along the runner [mm]").within(x);
    let y = Axis::new("y across [mm]").within(y);
    Panel::new(x, y, layers).scaled(Scales::Stretched)
}

/// Pressure along a line through the peak.
fn cut(axis: &str, points: Vec<Point>, peak: f64) -> Panel {
    let [first, last] = extent(points.iter().map(|point| point.0));
    let below = points.iter().copied().chain([(last, 0.0), (first, 0.0)]);
    let layers = vec![
        Layer::area(below, PALETTE[0].alpha(0.15)),
        Layer::line(2.0, points, PALETTE[0]),
    ];
    let y = Axis::new("p [MPa]").within([0.0, 1.05 * peak]);
    Panel::new(Axis::new(axis).within([first, last]), y, layers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::field::hertz_map::hertz_map;
    use crate::plot::Mark;

    #[test]
    fn a_needle_is_drawn_stretched_in_its_colours_and_to_the_last_row() {
        let map = hertz_map();
        let [x, y] = window(&map);
        let figure = map_picture(&[map], "test");
        let panel = &figure.rows[0].panels[0];
        let Mark::Map(window, cells) = &panel.layers[1].mark else {
            panic!("{:?}", panel.layers[1]);
        };
        assert_eq!(*window, [x, y]);
        let cells = &cells.colours;
        // The ellipse of half axes 25 and 0.14 mm covers this share of a window of 75 x 0.7 mm, but
        // for its edge.
        let share = std::f64::consts::PI * 25.0 * 0.14 / (75.0 * 0.7);
        let coloured = cells.iter().flatten().count() as f64 / cells.len() as f64;
        assert!((coloured / share - 1.0).abs() < 0.01, "{coloured} {share}");
        let svg = figure.svg();
        assert!(svg.contains("y across [mm], stretched "), "{svg}");
        if let Some(folder) = std::env::var_os("KUFE_KEEP_PICTURES") {
            let path = std::path::Path::new(&folder).join("pressure-test.png");
            std::fs::write(path, figure.png()).unwrap();
        }
    }
}
