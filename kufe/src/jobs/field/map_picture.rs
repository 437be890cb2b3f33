//! `pressure.png`: the map with its outline and colour bar, and two cuts through the peak.

use kufe_contact::PressureMap;

use crate::plot::{
    Axis, Colour, ColourBar, Figure, INK, Layer, Mark, PALETTE, Panel, Point, Scales, contour,
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
    let digits = |[from, to]: [f64; 2], at: f64| crate::plot::tick_text(1e3 * at, to - from);
    let columns = (0..main.nx).map(|i| main.x0 + i as f64 * main.dx);
    let along = columns.map(|x| (1e3 * x, main.pressure_at(x, y_peak) / 1e6));
    let rows = (0..main.ny).map(|j| main.y0 + j as f64 * main.dy);
    let across = rows.map(|y| (1e3 * y, main.pressure_at(x_peak, y) / 1e6));
    let cuts = [
        (
            format!("along, at y = {} mm", digits(y, y_peak)),
            "x [mm]",
            along.collect(),
        ),
        (
            format!("across, at x = {} mm", digits(x, x_peak)),
            "y [mm]",
            across.collect(),
        ),
    ];
    figure
        .row(450.0, maps.iter().map(|map| map_panel(map, &bar)))
        .bar(bar.clone())
        .row(
            270.0,
            cuts.map(|(title, axis, points)| cut(title, axis, points, peak)),
        )
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
    let [x, y] = window(map);
    let edge = EDGE * bar.range[1];
    let middle = |[from, to]: [f64; 2], k: usize, count: usize| {
        from + (k as f64 + 0.5) / count as f64 * (to - from)
    };
    let cells = (0..CELLS[1])
        .rev()
        .flat_map(|row| (0..CELLS[0]).map(move |column| (column, row)));
    let cells = cells.map(|(column, row)| {
        let at = [middle(x, column, CELLS[0]), middle(y, row, CELLS[1])];
        let pressure = map.pressure_at(1e-3 * at[0], 1e-3 * at[1]) / 1e6;
        (pressure > edge).then(|| bar.colour(pressure))
    });
    let cells = Mark::Map {
        window: [x, y],
        size: CELLS,
        cells: cells.collect(),
    };
    let value = |i: usize, j: usize| map.pressure[j * map.nx + i];
    let outline = contour([map.nx, map.ny], value, 1e6 * edge).into_iter();
    let place = |(i, j): Point| (1e3 * (map.x0 + i * map.dx), 1e3 * (map.y0 + j * map.dy));
    let outline = outline.map(|ends| ends.map(place));
    Panel {
        x: Axis::new("x along the runner [mm]").within(x),
        y: Axis::new("y across [mm]").within(y),
        layers: vec![
            Layer::rectangle(x, y, GROUND),
            Layer::new(cells, INK),
            Layer::segments(1.0, outline, INK),
        ],
        scales: Scales::Stretched,
        ..Panel::default()
    }
}

/// Pressure along a line through the peak.
fn cut(title: String, axis: &str, points: Vec<Point>, peak: f64) -> Panel {
    let first = points.first().map_or(0.0, |point| point.0);
    let last = points.last().map_or(1.0, |point| point.0);
    let ends = [(first, 0.0), (last, 0.0)];
    let below = std::iter::once(ends[0])
        .chain(points.iter().copied())
        .chain([ends[1]]);
    Panel {
        title,
        x: Axis::new(axis).within([first, last]),
        y: Axis::new("p [MPa]").within([0.0, 1.05 * peak]),
        layers: vec![
            Layer::area(below, PALETTE[0].alpha(0.15)),
            Layer::line(2.0, points, PALETTE[0]),
        ],
        ..Panel::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::field::hertz_map::hertz_map;

    #[test]
    fn a_needle_is_drawn_stretched_in_its_colours_and_to_the_last_row() {
        let map = hertz_map();
        let [x, y] = window(&map);
        let figure = map_picture(&[map], "test");
        let panel = &figure.rows[0].panels[0];
        let Mark::Map { window, cells, .. } = &panel.layers[1].mark else {
            panic!("{:?}", panel.layers[1]);
        };
        assert_eq!(*window, [x, y]);
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
