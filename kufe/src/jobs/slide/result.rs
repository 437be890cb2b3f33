//! Documents of computed friction.

use crate::case::Case;
use crate::jobs::slide::{FrictionPoint, Optimum};
use crate::results::{CaseRecord, FrictionOptimum, FrictionRow, OptimalParameter, SolvedRunner};

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
