//! The runner with the least friction: parameters of its shape within bounds.

use kufe_contact::Options;
use kufe_sled::friction::{Response, Span};

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::table::{FrictionPoint, friction_table};
use crate::jobs::watch::Watch;

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

    /// What the response says where the friction was solved, over what was solved, less 1.
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
        let mut runner = loaded.clone();
        for (parameter, &value) in parameters.iter().zip(values) {
            runner = runner.with_shape(&parameter.key, value)?;
        }
        Ok(runner)
    };
    // Every runner is checked before the first is solved.
    let mut runners = Vec::new();
    for values in Response::places(&spans) {
        let runner = runner(&values)?;
        runner.stated_sliding()?;
        runners.push((values, runner));
    }
    let friction = |runner: &LoadedCase| {
        let points = friction_table(
            runner,
            &[v_mps],
            &[ice_c],
            &Watch {
                progress: None,
                ..*watch
            },
            options,
        )?;
        Ok(points[0])
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
