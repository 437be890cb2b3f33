//! Friction over speed and temperature, and the shape of a runner with the least friction.

use kufe_contact::Options;
use kufe_sled::friction::{Response, Span};

use crate::case::SlidingTable;
use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::ploughing::{Ploughing, SolvedGroove};
use crate::jobs::slide::sliding::{conditions, film_along};
use crate::jobs::watch::Watch;
use crate::results::{
    CaseRecord, Friction, FrictionOptimum, FrictionRow, OptimalParameter, SolvedRunner,
};

/// Friction at several speeds and temperatures.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedTable {
    /// All points; with a missed accuracy, the best answers and their errors.
    pub points: Vec<FrictionRow>,
    /// Why the requested accuracy was not reached, at the first point where it was not.
    pub short: Option<Failure>,
}

/// Friction of a case's runner at every speed [m/s] on ice of every temperature [C]; the case's own
/// `[sliding]`, where it has one, states the rest.
///
/// # Errors
/// [`Failure::BadInput`] for the case, a speed and a temperature, [`Failure::NotConverged`] where a
/// groove or a film has no solution, [`Failure::Partial`] where it was stopped.
pub fn friction_table(
    loaded: &LoadedCase,
    speeds: &[f64],
    temperatures: &[f64],
    watch: &Watch,
    options: &Options,
) -> Result<SolvedTable, Failure> {
    // Every combination is a case: those that are none are reported before anything is solved.
    let pairs = temperatures
        .iter()
        .flat_map(|ice_c| speeds.iter().map(move |v| (*v, *ice_c)));
    let cases = pairs.map(|(v_mps, ice_c)| Ok((ice_c, at(loaded, v_mps, ice_c)?)));
    let cases = cases.collect::<Result<Vec<_>, Failure>>()?;
    let (mut points, mut short) = (Vec::new(), None);
    let mut last: Option<(f64, SolvedGroove)> = None;
    for (ice_c, case) in &cases {
        let table = sliding_of(case);
        // A hardness over contact time is another at every speed.
        let reused = last
            .take()
            .filter(|(at, _)| at == ice_c && table.hardness.is_none());
        let groove = match reused {
            Some((_, groove)) => groove,
            None => {
                let stopped = |failure: Failure| failure.within(&loaded.name);
                watch.check().map_err(stopped)?;
                watch.progress(&format!("groove on ice of {ice_c} °C"));
                let (problem, hull) = case.stated_sliding()?;
                let options = case.case.options_on(options.clone());
                let mut found = Ploughing::new(case, table, &problem)?.groove(&options)?;
                short = short.or(found.short.take());
                case.fine_enough(hull.as_ref(), &found.solution.contact)?;
                found
            }
        };
        let SolvedGroove {
            solution, hardness, ..
        } = &groove;
        let along = film_along(case, solution, &conditions(table))?;
        points.push(FrictionRow {
            case: loaded.name.clone(),
            ice_c: *ice_c,
            v_mps: table.v_mps,
            friction: Friction::of(solution, &along),
            groove_depth: solution.groove.deepest.into(),
            film_mean_m: along.film.totals.mean_thickness,
            hardness_pa: hardness.value,
        });
        last = Some((*ice_c, groove));
    }
    Ok(SolvedTable { points, short })
}

/// The case at one speed and temperature; where the ice's elasticity follows from its temperature
/// it follows this one.
pub(crate) fn at(loaded: &LoadedCase, v_mps: f64, ice_c: f64) -> Result<LoadedCase, Failure> {
    let mut loaded = loaded.clone();
    loaded.case.sliding = Some(SlidingTable {
        v_mps,
        ice_c,
        ..loaded.case.sliding.take().unwrap_or_default()
    });
    if loaded.case.ice.temperature_c.is_some() {
        loaded.case.ice.temperature_c = Some(ice_c);
    }
    loaded.valid(loaded.case.check())?;
    Ok(loaded)
}

/// The table `[sliding]` of a case that has one.
pub(crate) fn sliding_of(loaded: &LoadedCase) -> &SlidingTable {
    let table = loaded.case.sliding.as_ref();
    table.expect("a case with [sliding]")
}

/// A key of `[runner] shape` and what it may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// The key, as `rocker_radius_m`.
    pub key: String,
    /// Its bounds, those of the rule book.
    pub span: Span,
}

/// The least friction within the bounds.
#[derive(Clone, Debug)]
pub struct Optimum {
    /// The document.
    pub result: FrictionOptimum,
    /// Friction of the runners that the response was fitted to, in the order of the document, and
    /// last of the best one.
    pub points: Vec<FrictionRow>,
    /// The response, mu over the parameters.
    pub response: Response,
    /// How much more friction than the least, over it, cannot be distinguished from it: the error
    /// of mu there and the scatter of the response.
    pub indistinct: f64,
}

/// Least friction at one speed [m/s] on ice of one temperature [C] over one or two parameters of
/// the runner's shape.
///
/// 7 runners for one parameter, 25 for two, and the best are solved; a smooth surface through them
/// is searched ([`Response`]).
///
/// # Errors
/// [`Failure::Usage`] for more or fewer parameters, [`Failure::BadInput`] for a case without a
/// shape, a key that its shape does not have, and a runner within the bounds that is none; else as
/// [`friction_table`].
pub fn optimise(
    loaded: &LoadedCase,
    [v_mps, ice_c]: [f64; 2],
    parameters: &[Parameter],
    watch: &Watch,
    options: &Options,
) -> Result<Optimum, Failure> {
    let twice = matches!(parameters, [a, b] if a.key == b.key);
    if !(1..=2).contains(&parameters.len()) || twice {
        let text = "expected one parameter or two, each once";
        return Err(Failure::Usage(text.into()));
    }
    let spans: Vec<Span> = parameters.iter().map(|p| p.span).collect();
    let runner = |values: &[f64]| {
        let mut given = parameters.iter().zip(values);
        given.try_fold(loaded.clone(), |runner, (parameter, &value)| {
            runner.with_shape(&parameter.key, value)
        })
    };
    // Every runner is checked before the first is solved.
    let mut runners = Vec::new();
    for values in Response::places(&spans) {
        let runner = runner(&values)?;
        runner.stated_sliding()?;
        runners.push((values, runner));
    }
    let quiet = Watch {
        progress: None,
        ..*watch
    };
    let friction = |runner: &LoadedCase| -> Result<FrictionRow, Failure> {
        let mut solved = friction_table(runner, &[v_mps], &[ice_c], &quiet, options)?;
        solved.short.map_or(Ok(solved.points.remove(0)), Err)
    };
    let (mut points, mut solved) = (Vec::new(), Vec::new());
    let count = runners.len();
    for (k, (values, runner)) in runners.into_iter().enumerate() {
        watch.progress(&format!("runner {} of {count}", k + 1));
        let point = friction(&runner)?;
        let mu = point.friction.mu;
        points.push(point);
        solved.push(SolvedRunner { values, mu });
    }
    let values: Vec<f64> = solved.iter().map(|runner| runner.mu.value).collect();
    let response = loaded.valid(Response::fit(&spans, &values))?;
    let values = response.least();
    watch.progress("the best runner");
    let point = friction(&runner(&values)?)?;
    let friction_there = point.friction;
    let mu = friction_there.mu;
    let indistinct = mu.error / mu.value + response.misfit();
    let flat = response.flat(indistinct);
    let found = parameters.iter().zip(values.iter().zip(flat));
    let found = found.map(|(parameter, (&value, [flat_from, flat_to]))| {
        let [low, high] = parameter.span.bounds();
        OptimalParameter {
            key: parameter.key.clone(),
            value,
            low,
            high,
            on_bound: value == low || value == high,
            flat_from,
            flat_to,
        }
    });
    let result = FrictionOptimum {
        v_mps: point.v_mps,
        ice_c: point.ice_c,
        parameters: found.collect(),
        mu,
        mu_ploughing: friction_there.ploughing.value,
        mu_viscous: friction_there.viscous.value,
        mu_boundary: friction_there.boundary.value,
        response_scatter: response.misfit(),
        response_miss: response.at(&values) / mu.value - 1.0,
        solved,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        case: CaseRecord::of(&loaded.case),
    };
    points.push(point);
    Ok(Optimum {
        result,
        points,
        response,
        indistinct,
    })
}

/// The runners of `mu` that are not slower than the one with the least friction by more than both
/// errors: one is the fastest, several cannot be distinguished.
pub fn fastest(points: &[&FrictionRow]) -> Vec<usize> {
    let mu = |k: usize| points[k].friction.mu;
    let Some(least) = (0..points.len()).min_by(|&a, &b| mu(a).value.total_cmp(&mu(b).value)) else {
        return Vec::new();
    };
    let within =
        |k: &usize| *k == least || mu(*k).value - mu(least).value <= mu(*k).error + mu(least).error;
    (0..points.len()).filter(within).collect()
}
