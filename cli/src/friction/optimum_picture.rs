//! `friction.png` of a search: mu over one parameter, or the map over two, with the best runner.

use kufe::jobs::slide::Optimum;
use kufe::plot::{
    Axis, Colour, ColourBar, Figure, Layer, Mark, PALETTE, Panel, Point, contour, viridis,
};

/// Places along a parameter at which the curve is drawn.
const STEPS: usize = 200;
/// Colours of the map, and its cells along each parameter.
const BANDS: f64 = 20.0;
const CELLS: usize = 300;

const MU: &str = "coefficient of friction mu [1e-3]";

/// What was found over its one or two parameters.
pub fn optimum_picture(found: &Optimum) -> Figure {
    let title = format!(
        "mu at {} m/s and {} C, least {:.3}e-3",
        found.point.v_mps,
        found.point.ice_c,
        1e3 * found.point.friction.mu.value
    );
    let figure = Figure::new(900.0, title);
    match found.parameters.len() {
        1 => figure.row(440.0, [curve(found)]),
        _ => {
            let (panel, bar) = map(found);
            figure.row(440.0, [panel]).bar(bar)
        }
    }
}

fn curve(found: &Optimum) -> Panel {
    let [from, to] = found.parameters[0].span.bounds();
    let places = (0..=STEPS).map(|k| from + (to - from) * k as f64 / STEPS as f64);
    let surface = places.map(|x| (x, 1e3 * found.response.at(&[x])));
    let best = (found.values[0], found.point.friction.mu);
    let solved = found
        .solved
        .iter()
        .map(|(values, point)| (values[0], point.friction.mu));
    let solved: Vec<_> = solved.chain([best]).collect();
    let errors = solved.iter().map(|(x, mu)| {
        [-1.0, 1.0].map(|side| -> Point { (*x, 1e3 * (mu.value + side * mu.error)) })
    });
    let errors: Vec<[Point; 2]> = errors.collect();
    let low = errors
        .iter()
        .map(|ends| ends[0].1)
        .fold(f64::INFINITY, f64::min);
    let high = errors.iter().map(|ends| ends[1].1).fold(0.0, f64::max);
    let margin = 0.1 * (high - low);
    let points = solved.iter().map(|(x, mu)| (*x, 1e3 * mu.value));
    let [blue, red, green] = [PALETTE[0], PALETTE[1], PALETTE[2]];
    Panel {
        x: Axis::new(&found.parameters[0].key).within([from, to]),
        y: Axis::new(MU).within([low - margin, high + margin]),
        layers: vec![
            Layer::stretch(found.flat()[0], green.alpha(0.18))
                .named("not distinguishable from the best"),
            Layer::line(2.0, surface, blue).named("smooth curve through them"),
            Layer::segments(1.0, errors, red),
            Layer::dots(4.0, points, red).named("other runners solved"),
            Layer::dots(7.0, [(best.0, 1e3 * best.1.value)], red).named("best runner, solved"),
        ],
        ..Panel::default()
    }
}

fn map(found: &Optimum) -> (Panel, ColourBar) {
    let [x, y] = [0, 1].map(|k| found.parameters[k].span.bounds());
    let at = |[from, to]: [f64; 2], k: f64| from + (to - from) * k / CELLS as f64;
    let nodes: Vec<f64> = (0..=CELLS)
        .flat_map(|row| (0..=CELLS).map(move |column| [column as f64, row as f64]))
        .map(|[column, row]| found.response.at(&[at(x, column), at(y, row)]))
        .collect();
    let value = |column: usize, row: usize| nodes[row * (CELLS + 1) + column];
    let least = nodes.iter().copied().fold(f64::INFINITY, f64::min);
    let most = nodes.iter().copied().fold(least * (1.0 + 1e-9), f64::max);
    let bands = |share: f64| viridis((BANDS * share).floor().min(BANDS - 1.0) / (BANDS - 1.0));
    let bar = ColourBar::new(MU, [1e3 * least, 1e3 * most], bands);
    let cells = (0..CELLS)
        .rev()
        .flat_map(|row| (0..CELLS).map(move |column| (column, row)));
    let cells = cells.map(|(column, row)| Some(bar.colour(1e3 * value(column, row))));
    let map = Mark::Map {
        window: [x, y],
        size: [CELLS; 2],
        cells: cells.collect(),
    };
    let alike = least * (1.0 + found.indistinct());
    let bound = contour([CELLS + 1; 2], value, alike).into_iter();
    let bound = bound.map(|ends| ends.map(|(i, j)| (at(x, i), at(y, j))));
    let [best, others] = [PALETTE[1], Colour::new(255, 105, 190)];
    let solved = found
        .solved
        .iter()
        .map(|(values, _)| (values[0], values[1]));
    let panel = Panel {
        x: Axis::new(&found.parameters[0].key).within(x),
        y: Axis::new(&found.parameters[1].key).within(y),
        layers: vec![
            Layer::new(map, others),
            Layer::segments(1.5, bound, others)
                .named("bound of what is not distinguishable from the best"),
            Layer::dots(4.0, solved, others).named("other runners solved"),
            Layer::dots(8.0, [(found.values[0], found.values[1])], best)
                .named("best runner, solved"),
        ],
        ..Panel::default()
    };
    (panel, bar)
}
