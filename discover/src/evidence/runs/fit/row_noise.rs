//! Covariance of the residuals due to sensor noise.
//!
//! A model that gives less weight to noisy terms has smaller residuals without explaining anything.
//! The criterion of a fit is therefore relative to the covariance expected of noise. Let V be the
//! covariance of the residuals r of the balances due to noise of the accelerations a and of the
//! inputs of the forces, and b the model error as a variance of each acceleration. The criterion is
//!
//! ```text
//! n (ln det S - ln det E) / 2,   S = r r' / n,   E = V + diag(b (dr/da)^2)
//! ```
//!
//! Halving masses, forces and inertias halves both the residual and its expected size. With the
//! derivatives J of the residuals by a reading and its derivative, and the variance of their noise
//! in a row, V is the sum over readings of the mean of `J J'` times the variance over some samples
//! of each run: the noise of sensors is independent. b is estimated from the mean squares of the
//! residuals in excess of V.
//!
//! Source: R. J. Carroll, D. Ruppert, L. A. Stefanski, C. M. Crainiceanu, Measurement Error in
//! Nonlinear Models (2006), section 3.4, where b is the error in the equation; A. Zellner, An
//! efficient method of estimating seemingly unrelated regressions, Journal of the American
//! Statistical Association 57 (1962) 348, for balances that share their noise.

use kufe_sled::effects::Sensor;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::evidence::runs::model::design::OWN_LEVELS;
use crate::evidence::runs::model::installation::InstallationError;
use crate::evidence::runs::model::on_run::ModelOnRun;
use crate::evidence::runs::model::residual_model::{
    BALANCES, CHANNELS, ChannelRows, ResidualModel,
};
use crate::evidence::runs::model::whiten::{Whitener, scaled};
use crate::evidence::runs::recordings::frame::Frame;

/// `inv(L) dL` of `E = L L'` over all runs, by fitted column before the discrepancy: run levels,
/// free base parameters, amplitudes and installation errors.
pub fn noise_gradients(
    model: &ResidualModel,
    frames: &[Frame],
    free_base: &[usize],
    used: [bool; CHANNELS],
) -> Vec<Matrix3<f64>> {
    /// Step of the differences, in the unit in which a parameter is fitted.
    const STEP: f64 = 0.01;
    let expected = mean_expected(model, frames);
    let whitener = Whitener::of(&expected, used);
    let root = whitener.root_inverse();
    let gradient = |moved: &ResidualModel| -> Matrix3<f64> {
        let mut change = (mean_expected(moved, frames) - expected) / STEP;
        for c in (0..BALANCES).filter(|c| !used[*c]) {
            change.row_mut(c).fill(0.0);
            change.column_mut(c).fill(0.0);
        }
        // Derivative of a Cholesky factor: the lower triangle, with half of the diagonal.
        let relative = root * change * root.transpose();
        relative.lower_triangle() - Matrix3::from_diagonal(&relative.diagonal()) * 0.5
    };
    let moved = |change: &dyn Fn(&mut ResidualModel)| {
        let mut moved = model.clone();
        change(&mut moved);
        gradient(&moved)
    };
    let base = free_base.iter().map(|b| moved(&|m| m.base[*b] += STEP));
    let amplitudes = model
        .free()
        .into_iter()
        .map(|(e, q)| moved(&|m| m.effects.active[e].values[q] += STEP * model.scale(e, q)));
    let error = |k: usize| -> Vec<f64> {
        if model.installation.errors[k].is_additive() {
            return vec![0.0; BALANCES * BALANCES];
        }
        let gradient = moved(&|m| m.installation = model.installation.with_error_changed(k, STEP));
        gradient.as_slice().to_vec()
    };
    let errors: Vec<_> = (0..model.installation.fitted_count()).map(error).collect();
    let installation = model.installation.combined(&errors);
    let installation = installation.iter().map(|x| Matrix3::from_column_slice(x));
    let levels = std::iter::repeat_n(Matrix3::zeros(), OWN_LEVELS);
    let parameters = base.chain(amplitudes).chain(installation);
    levels.chain(parameters).collect()
}

/// E over all runs.
fn mean_expected(model: &ResidualModel, frames: &[Frame]) -> Matrix3<f64> {
    let model = &without_additive_errors(model);
    let of_run = |frame: &Frame| expected_of(model, frame) * frame.row_count() as f64;
    let each: Vec<Matrix3<f64>> = frames.par_iter().map(of_run).collect();
    let rows: usize = frames.iter().map(Frame::row_count).sum();
    // Sequential, so that the sum does not depend on the threads.
    each.iter().sum::<Matrix3<f64>>() / rows.max(1) as f64
}

/// `ln(det E) / 2` over all runs.
pub fn log_noise(model: &ResidualModel, frames: &[Frame], used: [bool; CHANNELS]) -> f64 {
    Whitener::of(&mean_expected(model, frames), used).log_scale()
}

/// `ln(det E) / 2` of one run.
pub fn log_noise_of(model: &ResidualModel, frame: &Frame, used: [bool; CHANNELS]) -> f64 {
    Whitener::of(&expected(model, frame), used).log_scale()
}

/// E of one run.
pub fn expected(model: &ResidualModel, frame: &Frame) -> Matrix3<f64> {
    expected_of(&without_additive_errors(model), frame)
}

/// E of one run with a model without delays and biases.
fn expected_of(model: &ResidualModel, frame: &Frame) -> Matrix3<f64> {
    let noise = noise_covariance(model, frame);
    let mut expected = noise.covariance;
    for (c, excess) in model.model_error.iter().enumerate() {
        expected[(c, c)] += excess * noise.gain[c] * noise.gain[c];
    }
    expected
}

/// Model error of each balance as a variance of its acceleration, at least 0: `(mean square - noise
/// variance) / (dr/da)^2`.
///
/// `rows` are the residuals given the discrepancy.
pub fn model_error(
    model: &ResidualModel,
    frames: &[Frame],
    rows: &[ChannelRows],
) -> [f64; BALANCES] {
    let model = &without_additive_errors(model);
    let of_run = |(frame, rows): (&Frame, &ChannelRows)| -> [[f64; 2]; BALANCES] {
        let noise = noise_covariance(model, frame);
        let ones = rows.each_ref().map(|rows| vec![1.0; rows.len()]);
        let [residual, weights] = [rows, &ones].map(|rows| scaled(frame, rows));
        let squares = |rows: &[f64]| rows.iter().map(|r| r * r).sum::<f64>();
        std::array::from_fn(|c| {
            let gain = (noise.gain[c] * noise.gain[c]).max(1e-300);
            let n = squares(&weights[c]);
            let excess = squares(&residual[c]) - n * noise.covariance[(c, c)];
            [n, excess / gain]
        })
    };
    let each: Vec<[[f64; 2]; BALANCES]> = frames.par_iter().zip(rows).map(of_run).collect();
    std::array::from_fn(|c| {
        let [n, excess] = [0, 1].map(|k| each.iter().map(|run| run[c][k]).sum::<f64>());
        (excess / n.max(1.0)).max(0.0)
    })
}

/// Covariance of the balances due to sensor noise, and the mean `|dr/da|` of each balance.
struct NoiseCovariance {
    covariance: Matrix3<f64>,
    gain: [f64; BALANCES],
}

/// The model without delays and biases: thinned samples cannot be read at another time.
fn without_additive_errors(model: &ResidualModel) -> ResidualModel {
    let installation = &model.installation;
    ResidualModel {
        installation: installation.with_zeroed(InstallationError::is_additive),
        ..model.clone()
    }
}

/// Noise covariance of one run with a model without delays and biases.
fn noise_covariance(model: &ResidualModel, frame: &Frame) -> NoiseCovariance {
    let mut total = NoiseCovariance {
        covariance: Matrix3::zeros(),
        gain: [0.0; BALANCES],
    };
    let Some(noise) = &frame.noise else {
        return total;
    };
    let on_run = ModelOnRun::new(model, &noise.samples);
    let share = 1.0 / noise.samples.len().max(1) as f64;
    for i in 0..noise.samples.len() {
        let jacobian = on_run.jacobian_of_readings(i, &on_run.instant(i));
        let change = |sensor: Sensor, value: f64, rate: f64| {
            Vector3::from(jacobian.of_sensor(sensor, value, rate)) / on_run.scale(sensor)
        };
        for (sensor, variances) in Sensor::ALL.into_iter().zip(&noise.variances) {
            let directions = [change(sensor, 1.0, 0.0), change(sensor, 0.0, 1.0)];
            for (direction, variance) in directions.iter().zip(variances) {
                total.covariance += direction * direction.transpose() * (variance * share);
            }
        }
        let gains = [
            change(Sensor::Ax, 1.0, 0.0),
            change(Sensor::Ay, 1.0, 0.0),
            change(Sensor::YawRate, 0.0, 1.0),
        ];
        for (c, gain) in gains.iter().enumerate() {
            total.gain[c] += gain[c].abs() * share;
        }
    }
    total
}
