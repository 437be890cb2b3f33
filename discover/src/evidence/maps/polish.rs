//! Final sizes: one Gauss-Newton step of all effects together, on finer meshes than the search's.

use nalgebra::{DMatrix, DVector};

use crate::error::Result;
use crate::evidence::maps::simulate::{Misfit, Simulations, SizedEffects};

/// Effects at their sizes and the misfit.
#[derive(Clone)]
pub struct MapFit {
    pub active: SizedEffects,
    /// Standard errors of the sizes, for noise as stated.
    pub errors: Vec<f64>,
    pub misfit: Misfit,
}

/// `errors` are those of the search, one per effect. They remain if a derivative cannot be solved.
pub fn polish(simulations: &Simulations, active: &SizedEffects, errors: &[f64]) -> Result<MapFit> {
    let mut fit = MapFit {
        active: active.clone(),
        errors: errors.to_vec(),
        misfit: simulations.reporting(active)?,
    };
    let rest = DVector::from_column_slice(&fit.misfit.residuals);
    let mut derivative = DMatrix::zeros(rest.len(), active.len());
    for (k, (effect, size)) in active.iter().enumerate() {
        // Well above the scatter of the solves, well below the size unless that is 0.
        let mut step = if *size == 0.0 {
            errors[k]
        } else {
            (6.0 * errors[k]).clamp(0.01 * size.abs(), 0.1 * size.abs())
        };
        if step == 0.0 {
            return Ok(fit);
        }
        if size + step > effect.parameter().high {
            step = -step;
        }
        let mut moved = active.clone();
        moved[k].1 += step;
        let Ok(there) = simulations.reporting(&moved) else {
            return Ok(fit);
        };
        let change = DVector::from_vec(there.residuals) - &rest;
        derivative.set_column(k, &(change / step));
    }
    let Some(inverse) = derivative.tr_mul(&derivative).try_inverse() else {
        return Ok(fit);
    };
    fit.errors = inverse
        .diagonal()
        .iter()
        .map(|v| v.max(0.0).sqrt())
        .collect();
    let by = -(&inverse * derivative.tr_mul(&rest));
    let mut moved = active.clone();
    for ((effect, size), by) in moved.iter_mut().zip(by.iter()) {
        let (most, bounds) = (0.2 * size.abs(), effect.parameter());
        *size = (*size + by.clamp(-most, most)).clamp(bounds.low, bounds.high);
    }
    match simulations.reporting(&moved) {
        Ok(better) if better.chi2 < fit.misfit.chi2 => {
            (fit.active, fit.misfit) = (moved, better);
        }
        _ => {}
    }
    Ok(fit)
}
