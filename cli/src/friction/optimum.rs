//! `kufe friction CASE --groove --v-mps V --ice-c T --optimise KEY=LOW:HIGH,...`: the runner with
//! the least friction within bounds.

use std::io::{self, Write};

use kufe::jobs::Failure;
use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::{Optimum, Parameter, optimise};
use kufe::results::FrictionOptimum;
use kufe_contact::Options;
use kufe_sled::friction::Span;

use crate::friction::optimum_picture::optimum_picture;
use crate::friction::point::Args;
use crate::terminal::Global;

/// Searches, prints and writes.
///
/// # Errors
/// [`Failure::Usage`] for a search over several cases, speeds or temperatures and for bounds that
/// are none, else as [`optimise`].
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
    if let Some(output) = output {
        output.write("friction.csv", |file| write_csv(file, &found))?;
        output.picture("friction.png", &optimum_picture(&found))?;
        output.json("friction.json", &found.result)?;
        output.commit()?;
    }
    global.print(&found.result, || text(&found.result))
}

/// `KEY=LOW:HIGH`.
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

fn text(found: &FrictionOptimum) -> String {
    let (speed, ice) = (found.v_mps, found.ice_c);
    let [mu, error] = [found.mu.value, found.mu.error].map(|mu| 1e3 * mu);
    let [ploughing, viscous, boundary] =
        [found.mu_ploughing, found.mu_viscous, found.mu_boundary].map(|mu| 1e3 * mu);
    let mut text = format!(
        "least friction at {speed} m/s and {ice} C: mu {mu:.3} +- {error:.3}e-3 (ploughing {ploughing:.3}, film {viscous:.3}, boundary {boundary:.3})\n"
    );
    for parameter in &found.parameters {
        let bound = if parameter.on_bound {
            ", on its bound"
        } else {
            ""
        };
        let (key, value) = (&parameter.key, parameter.value);
        let (from, to) = (parameter.flat_from, parameter.flat_to);
        text += &format!(
            "  {key} = {value:.4}{bound}; from {from:.4} to {to:.4} is as good within the errors\n"
        );
    }
    let (count, scatter) = (found.solved.len() + 1, 1e2 * found.response_scatter);
    let miss = 1e2 * found.response_miss;
    text + &format!(
        "  {count} runners solved; they scatter by {scatter:.2} % about a smooth surface, which misses the best by {miss:.2} %\n"
    )
}
