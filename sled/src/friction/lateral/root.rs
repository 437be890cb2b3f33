//! Root of the corrected score, which parameters are free in it, and its covariance.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::friction::error::Error;
use crate::friction::lateral::identifiability::{Combination, Identifiability};
use crate::friction::lateral::law::MagicFormula;
use crate::friction::lateral::least_squares::least_squares;
use crate::friction::lateral::options::LateralFitOptions;
use crate::friction::lateral::score::{LateralSample, Score, model_of, theta_of};

/// Decides by the three-parameter fit whether C is free.
pub(crate) fn choose_freedom(
    samples: &[LateralSample],
    held: MagicFormula,
    options: &LateralFitOptions,
) -> Result<([bool; 3], MagicFormula, Identifiability), Error> {
    let squares = |model: &MagicFormula| -> f64 {
        samples
            .iter()
            .map(|s| (s.fy - model.force(s.alpha, s.fz)).powi(2))
            .sum()
    };
    let mut best = held;
    for c in [options.c, 1.0] {
        let mu_zeta = held.mu_zeta_c() / c;
        let start = MagicFormula { mu_zeta, c, ..held };
        // A direction without curvature may stop the search early; the held fit is then the better one.
        if let Ok(found) = least_squares(samples, start, [true; 3])
            && found.c < 2.0
            && squares(&found) < squares(&best)
        {
            best = found;
        }
    }
    let judged = judge(samples, &best, options.slip_sd);
    if judged.rank() == 3 {
        return Ok(([true; 3], best, judged));
    }
    let judged = judge(samples, &held, options.slip_sd);
    let strongest = judged.combinations[0];
    if !strongest.determined {
        return Err(Error::Undetermined {
            what: "cornering stiffness K",
            ratio: Combination::LIMIT / strongest.relative_sd,
        });
    }
    Ok(([true, true, false], held, judged))
}

fn judge(samples: &[LateralSample], model: &MagicFormula, slip_sd: f64) -> Identifiability {
    let clusters = by_cluster(samples, model, slip_sd);
    let mut total = Score::ZERO;
    let mut meat = Matrix3::zeros();
    for cluster in clusters.values() {
        total.add(cluster);
        meat += cluster.score * cluster.score.transpose();
    }
    Identifiability::new(&total.slope, &meat, samples.len())
}

pub(crate) fn by_cluster(
    samples: &[LateralSample],
    model: &MagicFormula,
    slip_sd: f64,
) -> BTreeMap<u32, Score> {
    let mut clusters = BTreeMap::new();
    for sample in samples {
        clusters
            .entry(sample.cluster)
            .or_insert(Score::ZERO)
            .add(&Score::of_sample(model, sample, slip_sd));
    }
    clusters
}

/// Step `slope^-1 score` over the free parameters, through a pseudo-inverse.
fn step(slope: &Matrix3<f64>, score: &Vector3<f64>, free: [bool; 3]) -> Option<Vector3<f64>> {
    let kept: Vec<usize> = (0..3).filter(|&i| free[i]).collect();
    let matrix = DMatrix::from_fn(kept.len(), kept.len(), |i, j| slope[(kept[i], kept[j])]);
    let right = DVector::from_fn(kept.len(), |i, _| score[kept[i]]);
    let solved = matrix.cholesky()?.solve(&right);
    let mut whole = Vector3::zeros();
    for (i, &k) in kept.iter().enumerate() {
        whole[k] = solved[i];
    }
    Some(whole)
}

/// Root of the corrected score from the least-squares fit, by Gauss-Newton steps of at most one unit of logarithm.
pub(crate) fn corrected_root(
    samples: &[LateralSample],
    start: &MagicFormula,
    free: [bool; 3],
    options: &LateralFitOptions,
) -> Result<Vector3<f64>, Error> {
    const MOST: usize = 100;
    const TOLERANCE: f64 = 1e-9;
    let mut theta = theta_of(start);
    let mut length = f64::INFINITY;
    for _ in 0..MOST {
        let model = model_of(&theta, options.e);
        let mut total = Score::ZERO;
        for sample in samples {
            total.add(&Score::of_sample(&model, sample, options.slip_sd));
        }
        let Some(move_by) = step(&total.slope, &total.score, free) else {
            return Err(Error::Undetermined {
                what: "K with mu_zeta*c (slip too small against its noise, or no saturation)",
                ratio: 0.0,
            });
        };
        length = move_by.norm();
        theta += move_by / length.max(1.0);
        if length < TOLERANCE {
            return Ok(theta);
        }
    }
    Err(Error::NotConverged {
        what: "lateral fit, corrected score",
        iterations: MOST,
        residual: length,
        tolerance: TOLERANCE,
    })
}

/// Covariance by leaving out one cluster at a time, one Newton step each (the jackknife "CR3" of Bell and McCaffrey).
pub(crate) fn leave_one_cluster_out(
    samples: &[LateralSample],
    model: &MagicFormula,
    free: [bool; 3],
    slip_sd: f64,
) -> Result<Matrix3<f64>, Error> {
    let clusters = by_cluster(samples, model, slip_sd);
    let count = clusters.len() as f64;
    let mut total = Score::ZERO;
    for cluster in clusters.values() {
        total.add(cluster);
    }
    let mut covariance = Matrix3::zeros();
    for cluster in clusters.values() {
        let rest = total.slope - cluster.slope;
        let Some(change) = step(&rest, &cluster.score, free) else {
            return Err(Error::Undetermined {
                what: "the fit without one of its runs",
                ratio: 0.0,
            });
        };
        covariance += change * change.transpose();
    }
    Ok(covariance * ((count - 1.0) / count))
}
