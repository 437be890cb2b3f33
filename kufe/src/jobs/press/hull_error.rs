//! Errors of peak pressure and approach by a hull's vertices: their noise and their distances.

use std::sync::Arc;

use crate::case::FittedHull;
use kufe_contact::{BoundaryElements, CheckUnavailable, Problem, Runner};
use kufe_contact::{boundary_elements, boundary_elements_to_compare};
use kufe_mesh::{Noise, Underside};
use rayon::prelude::*;

/// Simulated scans.
const SCANS: u64 = 12;

/// Student's t: so many times the root mean square of twelve deviations hold the next one in 95 of
/// 100.
const HOLDS: f64 = 2.179;

/// Errors that a hull's vertices cause.
#[derive(Clone, Copy, Debug)]
pub struct HullError {
    /// The peak pressure, over it.
    pub p_max: f64,
    /// The approach [m]: that of the contact, whatever a runner bends by.
    pub approach: f64,
}

/// The hull scanned again and again: vertices on its fitted surface, moved by noise and fitted on
/// the scan's knots. None where there is no scan, or no fit of one.
///
/// The noise is the largest of the hull's, of what would not show of it and of the fit's residual.
pub(crate) fn bootstrap_scans(hull: &FittedHull) -> Option<Vec<Arc<dyn Underside>>> {
    let scan = hull.scan.as_ref()?;
    let Noise { found, unseen } = hull.noise;
    let noise = found.max(unseen).max(hull.underside.quality().residual_rms);
    let scans = hull.underside.scans(scan, noise).ok()?;
    let fit = |seed| scans.fit(seed).ok();
    (0..SCANS).into_par_iter().map(fit).collect()
}

/// What the noise in `scans`, as [`bootstrap_scans`] of the problem's hull, moves in 95 of 100
/// scans.
///
/// A bootstrap by the fitted surface (B. Efron and R. J. Tibshirani, An Introduction to the
/// Bootstrap, 1993, 6.5): each is pressed by boundary elements, rigid, on ice that gives for a
/// steel too. None where there are none, or where boundary elements do not answer.
pub(super) fn moved<'a>(
    problem: &Problem,
    scans: impl FnOnce() -> Option<&'a [Arc<dyn Underside>]>,
) -> Option<HullError> {
    let problem = rigid(problem);
    let pressed = |underside| pressed(&problem, underside, boundary_elements);
    let expected = pressed(problem.runner.underside.clone())?;
    let squares: Option<Vec<[f64; 2]>> = scans()?
        .par_iter()
        .map(|scan| {
            let found = pressed(scan.clone())?;
            Some([0, 1].map(|k| (found[k] - expected[k]).powi(2)))
        })
        .collect();
    let squares = squares?;
    let [p_max, approach] = [0, 1].map(|k| {
        let mean = squares.iter().map(|both| both[k]).sum::<f64>() / SCANS as f64;
        HOLDS * mean.sqrt()
    });
    Some(HullError {
        p_max: p_max / expected[0],
        approach,
    })
}

/// What the vertices' distances leave: by how much the fits with half the knots press otherwise, by
/// boundary elements as in [`moved`]. Where they do not answer, the fit's own error on the
/// contact's `patch`, and that over how deep the ice gives there, `depth` [m].
pub(super) fn between_vertices(
    problem: &Problem,
    hull: &FittedHull,
    patch: [f64; 4],
    depth: f64,
) -> HullError {
    let problem = rigid(problem);
    let pressed = |underside| pressed(&problem, underside, boundary_elements_to_compare);
    let fine = pressed(problem.runner.underside.clone());
    let [one, other] = hull.underside.with_half_the_knots().map(pressed);
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

/// Relative error of the peak by the noise in `scans` and the vertices' distances, for a contact
/// that is not solved otherwise: [`moved`] and [`between_vertices`] added in quadrature, `None`
/// where boundary elements do not answer.
pub(crate) fn relative_peak_error(
    problem: &Problem,
    hull: &FittedHull,
    scans: Option<&[Arc<dyn Underside>]>,
) -> Option<f64> {
    let found = boundary_elements_to_compare(problem).ok()?;
    let between = between_vertices(problem, hull, found.patch, found.approach);
    let moved_by = match scans {
        Some(_) => moved(problem, || scans)?.p_max,
        None => 0.0,
    };
    Some(between.p_max.hypot(moved_by))
}

/// The problem with a rigid runner, on ice that gives for a steel too.
fn rigid(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    problem.ice.youngs_modulus *= problem.ice.compliance() / problem.compliance();
    problem.runner.elastic = None;
    problem
}

/// Peak pressure [Pa] and approach [m] under another underside, by one of the ways to boundary
/// elements.
fn pressed(
    problem: &Problem,
    underside: Arc<dyn Underside>,
    solved: impl Fn(&Problem) -> Result<BoundaryElements, CheckUnavailable>,
) -> Option<[f64; 2]> {
    let runner = Runner {
        underside,
        ..problem.runner.clone()
    };
    let problem = Problem {
        runner,
        ..problem.clone()
    };
    let found = solved(&problem).ok()?;
    Some([found.p_max, found.approach])
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
    fn what_noise_is_said_to_move_holds_scans_of_the_true_shape()
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
            // Seeds apart from those of the scans that are made up.
            let scanned = smooth.scanned(&exact, noise, 1000 + trial);
            let underside = Arc::new(FittedUnderside::new(&scanned, noise)?);
            let pressed = problem((*underside).clone());
            let hull = FittedHull {
                underside,
                report: check_hull(&scanned)?,
                noise: Noise {
                    found: noise,
                    unseen: 0.0,
                },
                strips: None,
                seconds: [0.0; 2],
                scan: Some(Arc::new(scanned)),
            };
            let off = (peak(&pressed)? / truth - 1.0).abs();
            let peak_moved = |noise| -> Result<f64, &str> {
                let noise = Noise {
                    found: noise,
                    ..hull.noise
                };
                let hull = FittedHull {
                    noise,
                    ..hull.clone()
                };
                let scans = bootstrap_scans(&hull).ok_or("no scans")?;
                let moved = moved(&pressed, || Some(&scans)).ok_or("nothing was said")?;
                Ok(moved.p_max)
            };
            let said = peak_moved(noise)?;
            covered += u64::from(off <= said);
            stated.push(said);
            if trial == 0 {
                let more = peak_moved(3.0 * noise)?;
                assert!(more > 1.3 * said, "{more} {said}");
            }
        }
        stated.sort_by(f64::total_cmp);
        println!("{covered} of {TRIALS} covered; stated {stated:?}");
        assert!(covered >= 8, "{covered} of {TRIALS}");
        assert!(stated[TRIALS as usize / 2] < 0.1, "{stated:?}");
        Ok(())
    }
}
