//! `friction.png` of a search: mu over one parameter, or the map over two, with the best runner.

use kufe::jobs::slide::Optimum;
use kufe::plot::{
    Axis, Cells, Colour, ColourBar, Figure, Layer, PALETTE, Panel, Point, contour, extent, viridis,
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
        found.result.v_mps,
        found.result.ice_c,
        1e3 * found.result.mu.value
    );
    let figure = Figure::new(900.0, title);
    match found.result.parameters.len() {
        1 => figure.row(440.0, [curve(found)]),
        _ => {
            let (panel, bar) = map(found);
            figure.row(440.0, [panel]).bar(bar)
        }
    }
}

fn curve(found: &Optimum) -> Panel {
    let parameter = &found.result.parameters[0];
    let [from, to] = [parameter.low, parameter.high];
    let places = (0..=STEPS).map(|k| from + (to - from) * k as f64 / STEPS as f64);
    let surface = places.map(|x| (x, 1e3 * found.response.at(&[x])));
    let best = (parameter.value, found.result.mu);
    let solved = found.result.solved.iter();
    let solved = solved.map(|runner| (runner.values[0], runner.mu));
    let solved: Vec<_> = solved.chain([best]).collect();
    let errors = solved.iter().map(|(x, mu)| {
        [-1.0, 1.0].map(|side| -> Point { (*x, 1e3 * (mu.value + side * mu.error)) })
    });
    let [low, high] = extent(errors.clone().flatten().map(|end| end.1));
    let margin = 0.1 * (high - low);
    let points = solved.iter().map(|(x, mu)| (*x, 1e3 * mu.value));
    let [blue, red, green] = [PALETTE[0], PALETTE[1], PALETTE[2]];
    let flat = [parameter.flat_from, parameter.flat_to];
    let flat = Layer::stretch(flat, green.alpha(0.18));
    let least = Layer::dots(7.0, [(best.0, 1e3 * best.1.value)], red);
    let layers = vec![
        flat.named("not distinguishable from the best"),
        Layer::line(2.0, surface, blue).named("smooth curve through them"),
        Layer::segments(1.0, errors, red),
        Layer::dots(4.0, points, red).named("other runners solved"),
        least.named("best runner, solved"),
    ];
    let x = Axis::new(&parameter.key).within([from, to]);
    let y = Axis::new(MU).within([low - margin, high + margin]);
    Panel::new(x, y, layers)
}

fn map(found: &Optimum) -> (Panel, ColourBar) {
    let parameters = [0, 1].map(|k| &found.result.parameters[k]);
    let window = parameters.map(|parameter| [parameter.low, parameter.high]);
    let at = |axis: usize, k: f64| {
        let [from, to] = window[axis];
        from + (to - from) * k / CELLS as f64
    };
    let places = (0..=CELLS).flat_map(|row| (0..=CELLS).map(move |column| [column, row]));
    let nodes = places.map(|[column, row]| {
        found
            .response
            .at(&[at(0, column as f64), at(1, row as f64)])
    });
    let nodes: Vec<f64> = nodes.collect();
    let value = |column: usize, row: usize| nodes[row * (CELLS + 1) + column];
    let [least, most] = extent(nodes.iter().copied());
    let most = most.max(least * (1.0 + 1e-9));
    let bands = |share: f64| viridis((BANDS * share).floor().min(BANDS - 1.0) / (BANDS - 1.0));
    let bar = ColourBar::new(MU, [1e3 * least, 1e3 * most], bands);
    let cells = Cells::new([CELLS; 2], |i, j| Some(bar.colour(1e3 * value(i, j))));
    let alike = least * (1.0 + found.indistinct);
    let bound = contour([CELLS + 1; 2], value, alike).into_iter();
    let bound = bound.map(|ends| ends.map(|(i, j)| (at(0, i), at(1, j))));
    let [best, others] = [PALETTE[1], Colour::new(255, 105, 190)];
    let bound = Layer::segments(1.5, bound, others);
    let solved = found.result.solved.iter();
    let solved = solved.map(|runner| (runner.values[0], runner.values[1]));
    let [x, y] = parameters.map(|parameter| parameter.value);
    let least = Layer::dots(8.0, [(x, y)], best);
    let layers = vec![
        Layer::map(window, cells),
        bound.named("bound of what is not distinguishable from the best"),
        Layer::dots(4.0, solved, others).named("other runners solved"),
        least.named("best runner, solved"),
    ];
    let axis = |k: usize| Axis::new(&parameters[k].key).within(window[k]);
    (Panel::new(axis(0), axis(1), layers), bar)
}
