//! Friction over speed and temperature, and the shape of a runner with the least friction.

use kufe_contact::{Measure, Options};
use kufe_sled::friction::{Response, Span};

use crate::case::{Case, SlidingTable, StatedProblem};
use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::ploughing::{Grooved, Ploughing};
use crate::jobs::slide::sliding::{Friction, conditions, film_along};
use crate::jobs::watch::Watch;
use crate::results::{CaseRecord, FrictionOptimum, FrictionRow, OptimalParameter, SolvedRunner};

/// Friction at one speed on ice of one temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionPoint {
    /// Speed [m/s].
    pub v_mps: f64,
    /// Temperature of the ice [C].
    pub ice_c: f64,
    /// The coefficient of friction and its parts.
    pub friction: Friction,
    /// Depth of the groove [m].
    pub groove_depth: Measure,
    /// Thickness of the film averaged over the patch [m].
    pub film_mean: f64,
    /// Hardness of the ice [Pa].
    pub hardness: f64,
}

/// Friction of a case's runner at every speed [m/s] on ice of every temperature [C]; a `[sliding]`
/// of its own says the rest.
///
/// # Errors
/// [`Failure::BadInput`] for the case, a speed and a temperature, [`Failure::NotConverged`] where a
/// groove or a film stops short, [`Failure::Partial`] where it was stopped.
pub fn friction_table(
    loaded: &LoadedCase,
    speeds: &[f64],
    temperatures: &[f64],
    watch: &Watch,
    options: &Options,
) -> Result<Vec<FrictionPoint>, Failure> {
    // Every combination is a case: those that are none are reported before anything is solved.
    let mut cases = Vec::new();
    for &ice_c in temperatures {
        for &v_mps in speeds {
            cases.push((ice_c, at(loaded, v_mps, ice_c)?));
        }
    }
    let mut points = Vec::new();
    let mut last: Option<(f64, Grooved)> = None;
    for (ice_c, case) in &cases {
        let table = sliding_of(case);
        // A hardness over contact time is another at every speed.
        let reused = last
            .take()
            .filter(|(at, _)| at == ice_c && table.hardness.is_none());
        let grooved = match reused {
            Some((_, grooved)) => grooved,
            None => {
                watch
                    .check()
                    .map_err(|failure| failure.within(&loaded.name))?;
                watch.progress(&format!("groove on ice of {ice_c} C"));
                let StatedProblem { problem, hull } = case.stated_sliding()?;
                let options = case.case.options_on(options.clone());
                let found = Ploughing::new(case, table, &problem)?.groove(&options)?;
                case.fine_enough(hull.as_ref(), &found.solution.contact)?;
                found
            }
        };
        let Grooved { solution, hardness } = &grooved;
        let along = film_along(case, solution, &conditions(table))?;
        points.push(FrictionPoint {
            v_mps: table.v_mps,
            ice_c: *ice_c,
            friction: Friction::of(solution, &along),
            groove_depth: solution.groove.deepest,
            film_mean: along.film.totals.mean_thickness,
            hardness: hardness.value,
        });
        last = Some((*ice_c, grooved));
    }
    Ok(points)
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
    let checked = loaded.case.check();
    checked.map_err(|error| loaded.bad_input(error))?;
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
    /// What was varied.
    pub parameters: Vec<Parameter>,
    /// The parameters' values there.
    pub values: Vec<f64>,
    /// Friction there, solved.
    pub point: FrictionPoint,
    /// The runners that the response was fitted to: values and friction.
    pub solved: Vec<(Vec<f64>, FrictionPoint)>,
    /// The response, mu over the parameters.
    pub response: Response,
}

impl Optimum {
    /// The bound on which a parameter's value lies, if it does.
    pub fn on_bound(&self, k: usize) -> Option<f64> {
        let bounds = self.parameters[k].span.bounds();
        bounds.into_iter().find(|&bound| bound == self.values[k])
    }

    /// How much more friction than the least, over it, cannot be distinguished from it: the error
    /// of mu there and the scatter of the response.
    pub fn indistinct(&self) -> f64 {
        let mu = self.point.friction.mu;
        mu.error / mu.value + self.response.misfit()
    }

    /// From where to where each parameter goes over all runners that cannot be distinguished from
    /// the best ([`indistinct`](Self::indistinct)).
    pub fn flat(&self) -> Vec<[f64; 2]> {
        self.response.flat(self.indistinct())
    }

    /// Relative error of the response at the optimum, where the friction was solved.
    pub fn miss(&self) -> f64 {
        self.response.at(&self.values) / self.point.friction.mu.value - 1.0
    }
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
    let friction = |runner: &LoadedCase| -> Result<FrictionPoint, Failure> {
        Ok(friction_table(runner, &[v_mps], &[ice_c], &quiet, options)?[0])
    };
    let mut solved = Vec::new();
    let count = runners.len();
    for (k, (values, runner)) in runners.into_iter().enumerate() {
        watch.progress(&format!("runner {} of {count}", k + 1));
        solved.push((values, friction(&runner)?));
    }
    let values: Vec<f64> = solved.iter().map(|(_, p)| p.friction.mu.value).collect();
    let refusal = |error| Failure::bad_input(error).within(&loaded.name);
    let response = Response::fit(&spans, &values).map_err(refusal)?;
    let values = response.least();
    watch.progress("the best runner");
    let point = friction(&runner(&values)?)?;
    Ok(Optimum {
        parameters: parameters.to_vec(),
        values,
        point,
        solved,
        response,
    })
}

/// The runners of `mu` that are not slower than the one with the least friction by more than both
/// errors: one is the fastest, several cannot be distinguished.
pub fn fastest(points: &[FrictionPoint]) -> Vec<usize> {
    let mu = |k: usize| points[k].friction.mu;
    let Some(least) = (0..points.len()).min_by(|&a, &b| mu(a).value.total_cmp(&mu(b).value)) else {
        return Vec::new();
    };
    let within =
        |k: &usize| *k == least || mu(*k).value - mu(least).value <= mu(*k).error + mu(least).error;
    (0..points.len()).filter(within).collect()
}

impl FrictionRow {
    /// The row of a runner's point.
    pub fn new(case: &str, point: &FrictionPoint) -> Self {
        FrictionRow {
            case: case.to_owned(),
            ice_c: point.ice_c,
            v_mps: point.v_mps,
            mu: point.friction.mu.into(),
            mu_ploughing: point.friction.ploughing.into(),
            mu_viscous: point.friction.viscous.into(),
            mu_boundary: point.friction.boundary.into(),
            groove_depth: point.groove_depth.into(),
            film_mean_m: point.film_mean,
            hardness_pa: point.hardness,
        }
    }
}

impl FrictionOptimum {
    /// The document of a search.
    pub fn new(found: &Optimum, case: &Case) -> Self {
        let flat = found.flat();
        let parameters = found.parameters.iter().enumerate().map(|(k, parameter)| {
            let [low, high] = parameter.span.bounds();
            OptimalParameter {
                key: parameter.key.clone(),
                value: found.values[k],
                low,
                high,
                on_bound: found.on_bound(k).is_some(),
                flat_from: flat[k][0],
                flat_to: flat[k][1],
            }
        });
        let solved = found.solved.iter().map(|(values, point)| SolvedRunner {
            values: values.clone(),
            mu: point.friction.mu.into(),
        });
        FrictionOptimum {
            v_mps: found.point.v_mps,
            ice_c: found.point.ice_c,
            parameters: parameters.collect(),
            mu: found.point.friction.mu.into(),
            mu_ploughing: found.point.friction.ploughing.value,
            mu_viscous: found.point.friction.viscous.value,
            mu_boundary: found.point.friction.boundary.value,
            response_scatter: found.response.misfit(),
            response_miss: found.miss(),
            solved: solved.collect(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            case: CaseRecord::of(case),
        }
    }
}
