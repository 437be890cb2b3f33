//! `kufe friction CASE --groove --v-mps V --ice-c T --optimise KEY=LOW:HIGH,...`: the runner with the least friction within bounds.

use std::io::{self, Write};

use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::{Optimum, Parameter, optimise};
use kufe::jobs::{Failure, case_json};
use kufe_contact::Options;
use kufe_sled::friction::Span;
use serde_json::{Value, json};

use crate::friction::asked::{Asked, begin};
use crate::friction::optimum_picture;
use crate::output::global::Global;
use crate::output::say::say;
use crate::output::watched::watched;

/// Searches, prints and writes.
///
/// # Errors
/// [`Failure::Usage`] for a search over several cases, speeds or temperatures and for bounds that are none, else as [`optimise`].
pub fn run(asked: &Asked, global: &Global) -> Result<(), Failure> {
    let ([path], &[v_mps], &[ice_c]) = (asked.cases, asked.speeds, asked.temperatures) else {
        let text = "--optimise: expected one case, one --v-mps and one --ice-c";
        return Err(Failure::Usage(text.into()));
    };
    let parameters = asked.optimise.iter().map(|text| parameter(text));
    let parameters: Vec<Parameter> = parameters.collect::<Result<_, _>>()?;
    let loaded = LoadedCase::read(path)?;
    let staging = begin(asked, std::slice::from_ref(&loaded))?;
    let options = Options::default();
    let found = watched(global, |watch| {
        optimise(&loaded, [v_mps, ice_c], &parameters, watch, &options)
    })?;
    let mut document = document(&found, &loaded);
    if let Some(staging) = staging {
        staging.write("friction.csv", |file| write_csv(file, &found))?;
        kufe::plot::png(&staging.path("friction.png"), 900, 620, &|root| {
            optimum_picture::draw(&root, &found)
        })
        .map_err(|error| staging.failure("friction.png", &error))?;
        staging.document("friction.json", &mut document)?;
        staging.commit()?;
    }
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        say(&text(&found));
    }
    Ok(())
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

fn document(found: &Optimum, loaded: &LoadedCase) -> Value {
    let friction = &found.point.friction;
    let flat = found.flat();
    let parameters = found.parameters.iter().enumerate().map(|(k, parameter)| {
        let [low, high] = parameter.span.bounds();
        json!({
            "key": parameter.key, "value": found.values[k], "low": low, "high": high,
            "on_bound": found.on_bound(k).is_some(),
            "flat_from": flat[k][0], "flat_to": flat[k][1],
        })
    });
    let solved = found.solved.iter().map(|(values, point)| {
        let mu = point.friction.mu;
        json!({ "values": values, "mu": mu.value, "mu_error": mu.error })
    });
    json!({
        "v_mps": found.point.v_mps,
        "ice_c": found.point.ice_c,
        "parameters": parameters.collect::<Vec<Value>>(),
        "mu": friction.mu.value,
        "mu_error": friction.mu.error,
        "mu_ploughing": friction.ploughing.value,
        "mu_viscous": friction.viscous.value,
        "response_scatter": found.response.misfit(),
        "response_miss": found.miss(),
        "solved": solved.collect::<Vec<Value>>(),
        "version": env!("CARGO_PKG_VERSION"),
        "case": case_json(&loaded.case),
    })
}

fn write_csv(file: impl Write, found: &Optimum) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(file);
    let keys = found.parameters.iter().map(|p| p.key.as_str());
    csv.write_record(keys.chain(["mu", "mu_error", "mu_ploughing", "mu_viscous"]))?;
    let best = (&found.values, &found.point);
    let solved = found.solved.iter().map(|(values, point)| (values, point));
    for (values, point) in solved.chain([best]) {
        let f = &point.friction;
        let figures = [f.mu.value, f.mu.error, f.ploughing.value, f.viscous.value];
        csv.write_record(values.iter().chain(&figures).map(f64::to_string))?;
    }
    csv.flush()
}

fn text(found: &Optimum) -> String {
    let friction = &found.point.friction;
    let mut text = format!(
        "least friction at {} m/s and {} C: mu {:.3} +- {:.3}e-3 (ploughing {:.3}, film {:.3})\n",
        found.point.v_mps,
        found.point.ice_c,
        1e3 * friction.mu.value,
        1e3 * friction.mu.error,
        1e3 * friction.ploughing.value,
        1e3 * friction.viscous.value,
    );
    for (k, (parameter, [from, to])) in found.parameters.iter().zip(found.flat()).enumerate() {
        let bound = match found.on_bound(k) {
            Some(_) => ", on its bound",
            None => "",
        };
        text += &format!(
            "  {} = {:.4}{bound}; from {from:.4} to {to:.4} cannot be told from it\n",
            parameter.key, found.values[k]
        );
    }
    text + &format!(
        "  {} runners solved; they scatter by {:.2} % about a smooth surface, which misses the best by {:.2} %\n",
        found.solved.len() + 1,
        1e2 * found.response.misfit(),
        1e2 * found.miss(),
    )
}
