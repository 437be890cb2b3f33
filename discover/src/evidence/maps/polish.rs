//! Final sizes: one Gauss-Newton step of all effects together, on finer meshes than the search's.

use nalgebra::{DMatrix, DVector};

use crate::error::Error;
use crate::evidence::maps::simulate::{Misfit, Simulations};
use crate::evidence::maps::sized::SizedEffects;

pub struct FinalSizes {
    pub active: SizedEffects,
    /// Standard errors of the sizes, for noise as stated.
    pub errors: Vec<f64>,
    pub misfit: Misfit,
}

/// `errors` are those of the search, one per effect.
pub fn polish(
    simulations: &Simulations,
    active: &SizedEffects,
    errors: &[f64],
) -> Result<FinalSizes, Error> {
    let here = simulations.reporting(active)?;
    let count = active.len();
    let mut derivative = DMatrix::zeros(here.rest.len(), count);
    for k in 0..count {
        let info = active[k].0.parameter();
        // Well above the scatter of the solves, well below the size.
        let step = (6.0 * errors[k]).clamp(0.01 * active[k].1.abs(), 0.1 * active[k].1.abs());
        let step = if active[k].1 + step > info.high {
            -step
        } else {
            step
        };
        let mut moved = active.clone();
        moved[k].1 += step;
        let Ok(there) = simulations.reporting(&moved) else {
            return Ok(FinalSizes {
                active: active.clone(),
                errors: errors.to_vec(),
                misfit: here,
            });
        };
        for (i, (a, b)) in here.rest.iter().zip(&there.rest).enumerate() {
            derivative[(i, k)] = (b - a) / step;
        }
    }
    let normal = derivative.tr_mul(&derivative);
    let Some(inverse) = normal.try_inverse() else {
        return Ok(FinalSizes {
            active: active.clone(),
            errors: errors.to_vec(),
            misfit: here,
        });
    };
    let own: Vec<f64> = (0..count)
        .map(|k| inverse[(k, k)].max(0.0).sqrt())
        .collect();
    let by = -(&inverse * derivative.tr_mul(&DVector::from_column_slice(&here.rest)));
    let mut moved = active.clone();
    for (k, (effect, size)) in moved.iter_mut().enumerate() {
        let most = 0.2 * size.abs();
        *size = (*size + by[k].clamp(-most, most))
            .clamp(effect.parameter().low, effect.parameter().high);
    }
    let (active, misfit) = match simulations.reporting(&moved) {
        Ok(better) if better.chi2 < here.chi2 => (moved, better),
        _ => (active.clone(), here),
    };
    Ok(FinalSizes {
        active,
        errors: own,
        misfit,
    })
}
