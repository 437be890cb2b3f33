//! Errors of peak pressure and approach due to the noise and the spacing of a hull's vertices.

use std::sync::Arc;

use crate::case::FittedHull;
use crate::plot::quantity;
use kufe_contact::{BoundaryElements, CheckUnavailable, Problem, Runner};
use kufe_contact::{boundary_elements, boundary_elements_to_compare};
use kufe_mesh::{Noise, Underside};
use rayon::prelude::*;

/// Number of simulated scans.
const SCANS: u64 = 12;

/// Student's t for 95 % and 12 degrees of freedom: ratio of the bound of the next deviation to the
/// root mean square of the twelve.
const STUDENT_T: f64 = 2.179;

/// Errors of a contact due to its hull's vertices.
#[derive(Clone, Copy, Debug)]
pub struct HullError {
    /// Relative error of the peak pressure.
    pub p_max: f64,
    /// Error of the approach of the contact, without the bending of the runner [m].
    pub approach: f64,
}

/// Undersides of simulated scans: vertices on the hull's fitted surface, displaced by noise and
/// fitted on the knots of the scan. `None` if there is no scan, or a fit fails.
///
/// The noise is the largest of the noise found in the hull, the noise that its spacing may hide,
/// and the residual of its fit.
pub(crate) fn bootstrap_scans(hull: &FittedHull) -> Option<Vec<Arc<dyn Underside>>> {
    let scan = hull.scan.as_ref()?;
    let Noise { found, unseen } = hull.noise;
    let noise = found.max(unseen).max(hull.underside.quality().residual_rms);
    let scans = hull.underside.scans(scan, noise).ok()?;
    let fit = |seed| scans.fit(seed).ok();
    (0..SCANS).into_par_iter().map(fit).collect()
}

/// 95 % bounds of the errors due to noise, from `scans`, which are [`bootstrap_scans`] of the
/// problem's hull.
///
/// Parametric bootstrap (B. Efron and R. J. Tibshirani, An Introduction to the Bootstrap, 1993,
/// 6.5): each scan is pressed by boundary elements as a rigid runner on ice whose compliance
/// includes that of the steel. `None` without scans, or where boundary elements do not apply.
pub(super) fn noise_error<'a>(
    problem: &Problem,
    scans: impl FnOnce() -> Option<&'a [Arc<dyn Underside>]>,
) -> Option<HullError> {
    let problem = rigid(problem);
    let figures = |underside| peak_and_approach(&problem, underside, boundary_elements);
    let expected = figures(problem.runner.underside.clone())?;
    let squares: Option<Vec<[f64; 2]>> = scans()?
        .par_iter()
        .map(|scan| {
            let values = figures(scan.clone())?;
            Some([0, 1].map(|k| (values[k] - expected[k]).powi(2)))
        })
        .collect();
    let squares = squares?;
    let [p_max, approach] = [0, 1].map(|k| {
        let mean = squares.iter().map(|both| both[k]).sum::<f64>() / SCANS as f64;
        STUDENT_T * mean.sqrt()
    });
    Some(HullError {
        p_max: p_max / expected[0],
        approach,
    })
}

/// Errors due to the spacing of the vertices: the differences to fits with half the knots, by
/// boundary elements as in [`noise_error`]. Where these do not apply, the error of the fit on the
/// contact's `patch`, and its ratio to the indentation of the ice, `depth` [m].
pub(super) fn spacing_error(
    problem: &Problem,
    hull: &FittedHull,
    patch: [f64; 4],
    depth: f64,
) -> HullError {
    let problem = rigid(problem);
    let figures = |underside| peak_and_approach(&problem, underside, boundary_elements_to_compare);
    let fine = figures(problem.runner.underside.clone());
    let [one, other] = hull.underside.with_half_the_knots().map(figures);
    let (Some(fine), Some(one), Some(other)) = (fine, one, other) else {
        let error = hull.underside.error_within(patch);
        return HullError {
            p_max: error / depth,
            approach: error,
        };
    };
    let [p_max, approach] =
        [0, 1].map(|k| f64::max((one[k] - fine[k]).abs(), (other[k] - fine[k]).abs()));
    HullError {
        p_max: p_max / fine[0],
        approach,
    }
}

/// The contact on a hull by boundary elements, and the relative error of its peak due to the noise
/// in `scans` and the spacing of the vertices: [`noise_error`] and [`spacing_error`] added in
/// quadrature. `None` where boundary elements do not apply.
pub(crate) fn contact_on_hull(
    problem: &Problem,
    hull: &FittedHull,
    scans: Option<&[Arc<dyn Underside>]>,
) -> Option<(BoundaryElements, f64)> {
    let found = boundary_elements_to_compare(problem).ok()?;
    let by_spacing = spacing_error(problem, hull, found.patch, found.approach);
    let by_noise = match scans {
        Some(_) => noise_error(problem, || scans)?.p_max,
        None => 0.0,
    };
    Some((found, by_spacing.p_max.hypot(by_noise)))
}

/// The warning that most of the length of a contact `patch` `[x_min, x_max, y_min, y_max]` [m] has
/// no vertices, as in a hole of a scan.
pub(crate) fn in_hole(hull: &FittedHull, patch: [f64; 4]) -> Option<String> {
    let [x0, x1, y0, y1] = patch;
    let [from, to] = hull.underside.longest_gap(patch);
    (to - from > 0.5 * (x1 - x0)).then(|| {
        format!(
            "no vertex of the hull lies in the contact ({} x {}) from x = {} to {}: the surface there is interpolated, which no stated \
             error includes where it is a hole of the scan",
            quantity(x1 - x0, "m"),
            quantity(y1 - y0, "m"),
            quantity(from, "m"),
            quantity(to, "m")
        )
    })
}

/// The problem with a rigid runner, on ice whose compliance includes that of the steel.
fn rigid(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    problem.ice.youngs_modulus *= problem.ice.compliance() / problem.compliance();
    problem.runner.elastic = None;
    problem
}

/// Peak pressure [Pa] and approach [m] under another underside; `solve` is a boundary element
/// solver.
fn peak_and_approach(
    problem: &Problem,
    underside: Arc<dyn Underside>,
    solve: impl Fn(&Problem) -> Result<BoundaryElements, CheckUnavailable>,
) -> Option<[f64; 2]> {
    let runner = Runner {
        underside,
        ..problem.runner.clone()
    };
    let problem = Problem {
        runner,
        ..problem.clone()
    };
    let solution = solve(&problem).ok()?;
    Some([solution.p_max, solution.approach])
}

#[cfg(test)]
mod tests {
    use kufe_contact::{Ice, Load, Tilt};
    use kufe_mesh::{FittedUnderside, Hull, Paraboloid, check_hull};

    use super::*;

    /// A grid of triangles over four times a patch, 49 vertices a side.
    fn paraboloid(shape: &Paraboloid, [long, short]: [f64; 2]) -> Hull {
        const SIDE: u32 = 49;
        let at = |half: f64, k: u32| half * (2.0 * f64::from(k) / f64::from(SIDE - 1) - 1.0);
        let positions = (0..SIDE * SIDE).map(|n| {
            let (x, y) = (at(long, n % SIDE), at(short, n / SIDE));
            [x, y, shape.height(x, y)]
        });
        let corners = (0..(SIDE - 1) * (SIDE - 1)).flat_map(|n| {
            let a = n / (SIDE - 1) * SIDE + n % (SIDE - 1);
            [[a, a + SIDE, a + 1], [a + 1, a + SIDE, a + SIDE + 1]]
        });
        Hull {
            positions: positions.collect(),
            triangles: corners.collect(),
        }
    }

    /// Together with scans of the true shape with noise of their own: their peaks scatter as much,
    /// and more noise moves the peak by more.
    #[test]
    fn the_stated_effect_of_noise_covers_scans_of_the_true_shape()
    -> Result<(), Box<dyn std::error::Error>> {
        let shape = Paraboloid::new(2.0, 0.01)?;
        let patch = [4.0 * 7e-3, 4.0 * 3e-4];
        let exact = paraboloid(&shape, patch);
        let noise = 2e-7;
        let load = Load::central(1000.0, Tilt::LEVEL);
        let problem = |underside: FittedUnderside| {
            let runner = Runner::rigid(Arc::new(underside));
            Problem::new(runner, Ice::half_space(9e9, 0.33), load)
        };
        let smooth = FittedUnderside::new(&exact, 0.0)?;
        let peak = |problem: &Problem| boundary_elements(problem).map(|found| found.p_max);
        let truth = peak(&problem(smooth.clone()))?;
        let (mut covered, mut stated) = (0, Vec::new());
        const TRIALS: u64 = 10;
        for trial in 0..TRIALS {
            // Seeds apart from those of the simulated scans.
            let scanned = smooth.scanned(&exact, noise, 1000 + trial);
            let underside = FittedUnderside::new(&scanned, noise)?;
            let pressed = problem(underside.clone());
            let report = check_hull(&scanned)?;
            let noise_of = |found| Noise { found, unseen: 0.0 };
            let hull = FittedHull::new(underside, scanned, report, noise_of(noise), None);
            let off = (peak(&pressed)? / truth - 1.0).abs();
            let peak_moved = |noise| -> Result<f64, &str> {
                let hull = FittedHull {
                    noise: noise_of(noise),
                    ..hull.clone()
                };
                let scans = bootstrap_scans(&hull).ok_or("no scans")?;
                let error = noise_error(&pressed, || Some(&scans)).ok_or("no error")?;
                Ok(error.p_max)
            };
            let printed = peak_moved(noise)?;
            covered += u64::from(off <= printed);
            stated.push(printed);
            if trial == 0 {
                let more = peak_moved(3.0 * noise)?;
                assert!(more > 1.3 * printed, "{more} {printed}");
            }
        }
        stated.sort_by(f64::total_cmp);
        println!("{covered} of {TRIALS} covered; stated {stated:?}");
        assert!(covered >= 8, "{covered} of {TRIALS}");
        assert!(stated[TRIALS as usize / 2] < 0.1, "{stated:?}");
        Ok(())
    }
}
