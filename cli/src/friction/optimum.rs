//! `kufe friction CASE --groove --v-mps V --ice-c T --optimise KEY=LOW:HIGH,...`: searches for the
//! runner with the lowest friction within bounds.

use std::io::{self, Write};

use kufe::jobs::Failure;
use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::{Optimum, Parameter, optimise};
use kufe::plot::{
    Axis, Cells, Colour, ColourBar, Figure, Layer, PALETTE, Panel, Point, contour, extent, percent,
    quantity, shown_unit, viridis,
};
use kufe::results::FrictionOptimum;
use kufe_contact::Options;
use kufe_sled::friction::Span;

use crate::friction::point::Args;
use crate::terminal::Global;
use crate::text::document_text;

/// Number of intervals along a parameter with which a curve is drawn.
const STEPS: usize = 200;
/// Number of colours of the map.
const BANDS: f64 = 20.0;
/// Number of cells of the map along each parameter.
const CELLS: usize = 300;

const MU: &str = "coefficient of friction mu [1e-3]";

/// Searches for the lowest friction, prints the result and writes the files.
///
/// # Errors
/// [`Failure::Usage`] for several cases, speeds or temperatures and for invalid bounds;
/// [`Failure::NotConverged`], after the files are written, where a runner does not reach its
/// accuracy; otherwise as [`optimise`].
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let ([path], &[v_mps], &[ice_c]) = (&args.cases[..], &args.v_mps[..], &args.ice_c[..]) else {
        let text = "--optimise: expected one case, one --v-mps and one --ice-c";
        return Err(Failure::Usage(text.into()));
    };
    let parameters = args.optimise.iter().map(|text| parameter(text));
    let parameters: Vec<Parameter> = parameters.collect::<Result<_, _>>()?;
    let loaded = LoadedCase::read(path)?;
    let output = args.output(std::slice::from_ref(&loaded), global)?;
    let options = Options::default();
    let found =
        global.watched(|watch| optimise(&loaded, [v_mps, ice_c], &parameters, watch, &options))?;
    let result = &found.result;
    let text = text(result)?;
    match output {
        None => global.print(result, || text)?,
        Some(output) => {
            output.write("friction.csv", |file| write_csv(file, &found))?;
            output.picture("friction.png", &picture(&found))?;
            output.finish("friction.json", result, global, || text)?;
        }
    }
    found.short.map_or(Ok(()), Err)
}

/// Parses `KEY=LOW:HIGH`.
fn parameter(text: &str) -> Result<Parameter, Failure> {
    let wrong = |reason: &str| Failure::Usage(format!("--optimise {text}: {reason}"));
    let parts = text
        .split_once('=')
        .and_then(|(key, bounds)| Some((key, bounds.split_once(':')?)));
    let (key, (low, high)) = parts.ok_or_else(|| wrong("expected KEY=LOW:HIGH"))?;
    let number = |part: &str| {
        let number = part.trim().parse::<f64>();
        number.map_err(|_| wrong(&format!("found {part:?}, expected a number")))
    };
    let span = Span::new(number(low)?, number(high)?).map_err(|error| wrong(&error.to_string()))?;
    Ok(Parameter {
        key: key.trim().to_owned(),
        span,
    })
}

fn write_csv(file: impl Write, found: &Optimum) -> io::Result<()> {
    let figures = [
        "mu",
        "mu_error",
        "mu_ploughing",
        "mu_viscous",
        "mu_boundary",
    ];
    let parameters = &found.result.parameters;
    let mut csv = csv::Writer::from_writer(file);
    csv.write_record(parameters.iter().map(|p| p.key.as_str()).chain(figures))?;
    let best: Vec<f64> = parameters.iter().map(|p| p.value).collect();
    let solved = found.result.solved.iter().map(|runner| &runner.values);
    for (values, point) in solved.chain([&best]).zip(&found.points) {
        let f = &point.friction;
        let parts = [f.ploughing.value, f.viscous.value, f.boundary.value];
        let figures = [f.mu.value, f.mu.error].into_iter().chain(parts);
        let record = values.iter().copied().chain(figures);
        csv.write_record(record.map(|number| number.to_string()))?;
    }
    csv.flush()
}

fn text(found: &FrictionOptimum) -> Result<String, Failure> {
    let (speed, ice) = (found.v_mps, found.ice_c);
    let shown = |mu| quantity(mu, &shown_unit("mu"));
    let [ploughing, viscous, boundary] =
        [found.mu_ploughing, found.mu_viscous, found.mu_boundary].map(shown);
    let (mu, parameters) = (&found.mu, document_text(&found.parameters)?);
    let (count, scatter) = (found.solved.len() + 1, percent(found.response_scatter));
    let miss = percent(found.response_miss);
    Ok(format!(
        "least friction at {speed} m/s and {ice} °C: mu {mu} (ploughing {ploughing}, film {viscous}, boundary {boundary})\n\
         {parameters}from flat_from to flat_to all is as good within the errors\n\
         {count} runners solved; they scatter by {scatter} about a smooth surface, which misses the best by {miss}\n"
    ))
}

/// The picture of the search over one or two parameters.
fn picture(found: &Optimum) -> Figure {
    let title = format!(
        "mu at {} m/s and {} °C, least {}",
        found.result.v_mps, found.result.ice_c, found.result.mu
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

/// The friction as a curve over one parameter.
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
    let lowest = Layer::dots(7.0, [(best.0, 1e3 * best.1.value)], red);
    let layers = vec![
        flat.named("not distinguishable from the best"),
        Layer::line(2.0, surface, blue).named("smooth curve through them"),
        Layer::segments(1.0, errors, red),
        Layer::dots(4.0, points, red).named("other runners solved"),
        lowest.named("best runner, solved"),
    ];
    let x = Axis::new(&parameter.key).within([from, to]);
    let y = Axis::new(MU).within([low - margin, high + margin]);
    Panel::new(x, y, layers)
}

/// The friction as a map over two parameters.
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
    let [min, max] = extent(nodes.iter().copied());
    let max = max.max(min * (1.0 + 1e-9));
    let bands = |share: f64| viridis((BANDS * share).floor().min(BANDS - 1.0) / (BANDS - 1.0));
    let bar = ColourBar::new(MU, [1e3 * min, 1e3 * max], bands);
    let cells = Cells::new([CELLS; 2], |i, j| Some(bar.colour(1e3 * value(i, j))));
    let limit = min * (1.0 + found.relative_resolution);
    let bound = contour([CELLS + 1; 2], value, limit).into_iter();
    let bound = bound.map(|ends| ends.map(|(i, j)| (at(0, i), at(1, j))));
    let [best, others] = [PALETTE[1], Colour::new(255, 105, 190)];
    let bound = Layer::segments(1.5, bound, others);
    let solved = found.result.solved.iter();
    let solved = solved.map(|runner| (runner.values[0], runner.values[1]));
    let [x, y] = parameters.map(|parameter| parameter.value);
    let lowest = Layer::dots(8.0, [(x, y)], best);
    let layers = vec![
        Layer::map(window, cells),
        bound.named("limit of the runners indistinguishable from the best"),
        Layer::dots(4.0, solved, others).named("other runners solved"),
        lowest.named("best runner, solved"),
    ];
    let axis = |k: usize| Axis::new(&parameters[k].key).within(window[k]);
    (Panel::new(axis(0), axis(1), layers), bar)
}
