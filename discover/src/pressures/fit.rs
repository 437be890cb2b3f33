//! The best size of one effect: one step of differences for all, Gauss-Newton for those that it does not rule out.

use kufe_contact::effects::{Effect, Info};

use super::simulate::{Active, Bench, Misfit};
use crate::Error;

/// One effect beside those that are switched on.
pub struct Fit {
    /// Size.
    pub size: f64,
    /// Sum of squares that is left.
    pub chi2: f64,
    /// Standard error of the size.
    pub error: f64,
}

/// What a single step of differences says: the drop of chi2 if the effect were linear. `None` where it does nothing or
/// cannot be solved.
///
/// # Errors
/// Those of the contact solver without the effect.
pub fn screen(
    bench: &Bench,
    active: &Active,
    effect: &'static dyn Effect,
) -> Result<Option<Fit>, Error> {
    let now = bench.misfit(active)?;
    let size = start(bench, effect.info());
    let step = effect.info().typical;
    let at = |size: f64| bench.misfit(&with(active, effect, size));
    // Beyond a threshold (a bound on the pressure) the differences are taken about the start.
    let own = match size == 0.0 {
        true => None,
        false => at(size).ok(),
    };
    let Ok(moved) = at(size + step) else {
        return Ok(None);
    };
    let from = own.as_ref().unwrap_or(&now);
    let (dd, dr) = slopes(from, &moved, step);
    if dd <= 0.0 {
        return Ok(None);
    }
    let by = (size + dr / dd).clamp(effect.info().low, effect.info().high) - size;
    Ok(Some(Fit {
        size: size + by,
        chi2: from.chi2 - 2.0 * by * dr + by * by * dd,
        error: 1.0 / dd.sqrt(),
    }))
}

/// Gauss-Newton with shortened steps; every evaluation solves all rows.
///
/// # Errors
/// Those of the contact solver without the effect.
pub fn refine(
    bench: &Bench,
    active: &Active,
    effect: &'static dyn Effect,
) -> Result<Option<Fit>, Error> {
    let info = effect.info();
    let at = |size: f64| bench.misfit(&with(active, effect, size));
    let mut size = start(bench, info);
    let mut best = Fit {
        size: 0.0,
        chi2: bench.misfit(active)?.chi2,
        error: f64::INFINITY,
    };
    let Ok(mut now) = at(size) else {
        return Ok(None);
    };
    for round in 0..5 {
        // A hundredth of what was reached, once something was: the noise of the solves is far below it.
        let step = match round {
            0 => info.typical,
            _ => info.typical.max(0.02 * size.abs()),
        };
        let step = if size + step > info.high { -step } else { step };
        let Ok(moved) = at(size + step) else { break };
        let (dd, dr) = slopes(&now, &moved, step);
        if dd <= 0.0 {
            break;
        }
        let error = 1.0 / dd.sqrt();
        if now.chi2 <= best.chi2 {
            best = Fit {
                size,
                chi2: now.chi2,
                error,
            };
        }
        let mut share = 1.0;
        let mut better = None;
        for _ in 0..4 {
            let trial = (size + share * dr / dd).clamp(info.low, info.high);
            if let Ok(m) = at(trial)
                && m.chi2 < now.chi2
            {
                better = Some((trial, m));
                break;
            }
            share *= 0.3;
        }
        let Some((trial, m)) = better else { break };
        let gained = now.chi2 - m.chi2;
        size = trial;
        now = m;
        if now.chi2 < best.chi2 {
            best = Fit {
                size,
                chi2: now.chi2,
                error,
            };
        }
        if gained < 0.01 * now.chi2.max(1.0) {
            break;
        }
    }
    Ok(best.error.is_finite().then_some(best))
}

/// The effects with one more.
pub fn with(active: &Active, effect: &'static dyn Effect, size: f64) -> Active {
    let mut with = active.clone();
    with.push((effect, size));
    with
}

/// A bound on the pressure acts only below the peak: it starts there.
fn start(bench: &Bench, info: &Info) -> f64 {
    match info.name {
        "hardness" => 1.1 / bench.rows.iter().map(|r| r.p_max).fold(1.0, f64::max),
        _ => 0.0,
    }
}

fn slopes(now: &Misfit, moved: &Misfit, step: f64) -> (f64, f64) {
    now.rest
        .iter()
        .zip(&moved.rest)
        .fold((0.0, 0.0), |(dd, dr), (a, b)| {
            let d = (a - b) / step;
            (dd + d * d, dr + d * a)
        })
}
