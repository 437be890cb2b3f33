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
    /// The first failure to reach the requested accuracy; `None` where all points reached it.
    pub short: Option<Failure>,
}

/// Friction of a case's runner at every speed [m/s] on ice of every temperature [C]. The other
/// conditions are those of the case's `[sliding]`, or its defaults.
///
/// # Errors
/// [`Failure::BadInput`] for the case, a speed and a temperature, [`Failure::NotConverged`] if a
/// groove or a film has no solution, [`Failure::Partial`] if it was stopped.
pub fn friction_table(
    loaded: &LoadedCase,
    speeds: &[f64],
    temperatures: &[f64],
    watch: &Watch,
    options: &Options,
) -> Result<SolvedTable, Failure> {
    // Every combination is checked before the first is solved.
    let pairs = temperatures
        .iter()
        .flat_map(|ice_c| speeds.iter().map(move |v| (*v, *ice_c)));
    let cases =
        pairs.map(|(v_mps, ice_c)| Ok((ice_c, with_speed_and_temperature(loaded, v_mps, ice_c)?)));
    let cases = cases.collect::<Result<Vec<_>, Failure>>()?;
    let (mut points, mut short) = (Vec::new(), None);
    let mut last: Option<(f64, SolvedGroove)> = None;
    for (ice_c, case) in &cases {
        let table = sliding_table(case);
        // A hardness that depends on contact time depends on the speed: the groove is not reused.
        let reused = last
            .take()
            .filter(|(groove_ice_c, _)| groove_ice_c == ice_c && table.hardness.is_none());
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

/// The case at another speed [m/s] and ice temperature [C]. Where the case computes the elasticity
/// of the ice from a temperature, it uses the new one.
pub(crate) fn with_speed_and_temperature(
    loaded: &LoadedCase,
    v_mps: f64,
    ice_c: f64,
) -> Result<LoadedCase, Failure> {
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

/// The table `[sliding]` of a case; panics where the case has none.
pub(crate) fn sliding_table(loaded: &LoadedCase) -> &SlidingTable {
    let table = loaded.case.sliding.as_ref();
    table.expect("a case with [sliding]")
}

/// A parameter of the search: a key of `[runner] shape` with its bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// The key, as `rocker_radius_m`.
    pub key: String,
    /// Bounds of the search.
    pub span: Span,
}

/// The least friction within the bounds.
#[derive(Clone, Debug)]
pub struct Optimum {
    /// The document.
    pub result: FrictionOptimum,
    /// Friction of the runners that the response was fitted to, in the order of the document; the
    /// last is that of the best runner.
    pub points: Vec<FrictionRow>,
    /// The fitted response surface: mu as a function of the parameters.
    pub response: Response,
    /// Relative difference of mu to its minimum below which two runners cannot be distinguished:
    /// the relative error of mu at the optimum plus the relative scatter of the response.
    pub relative_resolution: f64,
    /// The first failure to reach the requested accuracy; `None` where all runners reached it.
    pub short: Option<Failure>,
}

/// Least friction at one speed [m/s] on ice of one temperature [C] over one or two parameters of
/// the runner's shape.
///
/// 7 runners for one parameter, 25 for two, and the best are solved; a smooth surface through them
/// is searched ([`Response`]).
///
/// # Errors
/// [`Failure::Usage`] for more or fewer parameters, [`Failure::BadInput`] for a case without a
/// shape, a key that its shape does not have, and an invalid runner within the bounds; else as
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
    let with_parameters = |values: &[f64]| {
        let mut pairs = parameters.iter().zip(values);
        pairs.try_fold(loaded.clone(), |runner, (parameter, &value)| {
            runner.with_shape(&parameter.key, value)
        })
    };
    // Every runner is checked before the first is solved.
    let mut runners = Vec::new();
    for values in Response::places(&spans) {
        let runner = with_parameters(&values)?;
        runner.stated_sliding()?;
        runners.push((values, runner));
    }
    let quiet = Watch {
        progress: None,
        ..*watch
    };
    let mut short = None;
    let mut friction = |runner: &LoadedCase| -> Result<FrictionRow, Failure> {
        let mut solved = friction_table(runner, &[v_mps], &[ice_c], &quiet, options)?;
        short = short.take().or(solved.short);
        Ok(solved.points.remove(0))
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
    let mus: Vec<f64> = solved.iter().map(|runner| runner.mu.value).collect();
    let response = loaded.valid(Response::fit(&spans, &mus))?;
    let optimum = response.least();
    watch.progress("the best runner");
    let best = friction(&with_parameters(&optimum)?)?;
    let mu = best.friction.mu;
    let relative_resolution = mu.error / mu.value + response.misfit();
    let intervals = response.flat(relative_resolution);
    let optimal = parameters.iter().zip(optimum.iter().zip(intervals));
    let optimal = optimal.map(|(parameter, (&value, [flat_from, flat_to]))| {
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
        v_mps: best.v_mps,
        ice_c: best.ice_c,
        parameters: optimal.collect(),
        mu,
        mu_ploughing: best.friction.ploughing.value,
        mu_viscous: best.friction.viscous.value,
        mu_boundary: best.friction.boundary.value,
        response_scatter: response.misfit(),
        response_miss: response.at(&optimum) / mu.value - 1.0,
        solved,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        case: CaseRecord::of(&loaded.case),
    };
    points.push(best);
    Ok(Optimum {
        result,
        points,
        response,
        relative_resolution,
        short,
    })
}

/// Indices of the points whose mu exceeds the smallest by at most the sum of both errors: these
/// runners cannot be distinguished.
pub fn lowest_friction(points: &[&FrictionRow]) -> Vec<usize> {
    let mu = |k: usize| points[k].friction.mu;
    let Some(least) = (0..points.len()).min_by(|&a, &b| mu(a).value.total_cmp(&mu(b).value)) else {
        return Vec::new();
    };
    let within =
        |k: &usize| *k == least || mu(*k).value - mu(least).value <= mu(*k).error + mu(least).error;
    (0..points.len()).filter(within).collect()
}
