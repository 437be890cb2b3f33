//! Solution of a contact problem to the requested accuracy.

use crate::accuracy::meshes::{Meshes, Verdict};
use crate::boundary_elements::asperities::Asperities;
use crate::problem::check::{CheckedProblem, MAX_TILT, within};
use crate::{Error, Load, Options, Problem, Solution, Tilt};

/// Solves a contact problem.
///
/// Linear elasticity on trilinear hexahedra, frictionless unilateral contact; see the crate's page
/// for the method. The mesh is refined until the estimated discretisation error of the peak
/// pressure is below `options.p_max_tolerance`. A rigid runner that touches uneven ice at about a
/// thousand nodes or more is solved by boundary elements on the contact plane instead, whose cost
/// grows with n log n; [`Solution::volume`] is then `None`. If their contact set does not converge,
/// finite elements follow, with the previous grids in [`Solution::history`].
///
/// # Errors
/// - [`Error::OutOfRange`], [`Error::Unsuitable`] and [`Error::LoadExceedsHardness`]: the problem
///   has no solution.
/// - [`Error::NotConverged`]: the equations of a mesh are not solved.
/// - [`Error::AccuracyNotReached`]: the largest mesh allowed is not accurate enough; the error
///   holds the best solution.
/// - [`Error::TooFine`] and [`Error::Unsolved`]: no mesh can be made, or the solution of the last
///   mesh violates the contact conditions.
/// - [`Error::NoAnswer`]: the meshes give no contact under the load.
pub fn solve(problem: &Problem, options: &Options) -> Result<Solution, Error> {
    // On a worker thread from the start: every parallel loop begun outside would wait for a worker
    // to wake up.
    rayon::scope(|_| {
        let checked = CheckedProblem::bearable(problem, options)?;
        let mut history = Vec::new();
        let asperities = Asperities::of(&checked)?;
        let on_plane = asperities.and_then(|found| found.solve(&mut history).transpose());
        let mut solved = on_plane.unwrap_or_else(|| refined(Meshes::guess(checked, history)?));
        let best = match &mut solved {
            Ok(solution) => solution,
            Err(Error::AccuracyNotReached { best, .. }) => best,
            Err(_) => return solved,
        };
        verify(problem, options, best)?;
        add_tilt_error(problem, best);
        solved
    })
}

/// Adds the error of the small-angle approximation of a free tilt. The curvature of a round section
/// is wrong by 1.5 times the square of the tilt; pressures, areas and lengths of smooth contacts
/// depend on the curvature at most with the power 2/3.
pub(crate) fn add_tilt_error(problem: &Problem, s: &mut Solution) {
    let Load::Force {
        tilt: Tilt::Free, ..
    } = problem.load
    else {
        return;
    };
    let share = s.pitch.powi(2) + s.roll.powi(2);
    if s.hardness.is_none_or(|hardness| s.p_max < hardness) {
        s.p_max_error += share * s.p_max;
    }
    s.p_mean_error += share * s.p_mean;
    s.area_error += share * s.area;
    s.length_error += share * s.length;
    s.width_error += share * s.width;
    s.approach_error += share * s.approach;
}

/// Solves mesh after mesh to the requested accuracy.
fn refined(mut meshes: Meshes) -> Result<Solution, Error> {
    loop {
        let contact = meshes.solve_next()?;
        match meshes.judge(&contact) {
            Verdict::Reached(limits) => return Ok(meshes.solution(contact, limits)),
            Verdict::Refine(plan) => meshes.refine(contact, plan),
            Verdict::Widen(found) => meshes.widen(&contact, &found)?,
            Verdict::OutOfReach(limits) => return Err(meshes.out_of_reach(contact, limits)),
        }
    }
}

/// Checks a problem as far as possible without solving it.
///
/// # Errors
/// [`Error::OutOfRange`], [`Error::Unsuitable`], [`Error::LoadExceedsHardness`].
pub fn check_problem(problem: &Problem, options: &Options) -> Result<(), Error> {
    CheckedProblem::bearable(problem, options).map(|_| ())
}

/// Largest relative difference between the resultant of a balanced contact and the load.
const BALANCED: f64 = 1e-6;

/// Largest relative violation of equilibrium and contact conditions in a solution: the slack of
/// contact sets that cycled.
const MAX_VIOLATION: f64 = 2e-5;

/// Checks that a solution satisfies equilibrium and contact conditions on all nodes of the plane
/// (to ten times the requested residual if that is larger), and [`check_answer`].
fn verify(problem: &Problem, options: &Options, solution: &Solution) -> Result<(), Error> {
    let most = MAX_VIOLATION.max(10.0 * options.residual);
    let violation = solution.kkt_residual;
    if violation.is_nan() || violation > most {
        return Err(Error::Unsolved(format!(
            "equilibrium and contact conditions are violated by {violation:.2e} (relative; all \
             nodes of the contact plane), {most:.1e} is the most"
        )));
    }
    check_answer(problem, solution)
}

const POSITIVE: &str = "a positive number";
const FINITE: &str = "a finite number";
const SMALL: &str = "a load under which the runner turns by at most 0.12 rad either way";

/// Checks that the figures of a solution are finite, that there is a contact, and that it carries
/// the load.
pub(crate) fn check_answer(problem: &Problem, s: &Solution) -> Result<(), Error> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let small = |tilt: f64| tilt.abs() <= MAX_TILT;
    let carried = match problem.load {
        Load::Force { fz, .. } => (s.fz / fz - 1.0).abs() <= BALANCED,
        Load::Approach { .. } => true,
    };
    let (kkt, requested) = (s.kkt_residual, "the requested normal force");
    for (name, tilt) in [("pitch [rad]", s.pitch), ("roll [rad]", s.roll)] {
        within(small(tilt), name, tilt, SMALL)?;
    }
    for (name, value, holds, expected) in [
        ("peak pressure [Pa]", s.p_max, positive(s.p_max), POSITIVE),
        ("mean pressure [Pa]", s.p_mean, positive(s.p_mean), POSITIVE),
        ("contact area [m2]", s.area, positive(s.area), POSITIVE),
        ("contact length [m]", s.length, positive(s.length), POSITIVE),
        ("contact width [m]", s.width, positive(s.width), POSITIVE),
        ("approach [m]", s.approach, s.approach.is_finite(), FINITE),
        ("residual", kkt, kkt.is_finite(), FINITE),
        ("force carried [N]", s.fz, carried, requested),
    ] {
        if !holds {
            return Err(Error::NoAnswer {
                name,
                value,
                expected,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::meshes::REGRADINGS;
    use crate::grid::patch::COARSE;
    use crate::{Ice, Runner};
    use kufe_mesh::{BobRunner, Paraboloid, Rocker, Section, Swept};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn a_solve_ends_when_it_is_asked_to_before_and_in_between()
    -> Result<(), Box<dyn std::error::Error>> {
        let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?));
        let ice = Ice::half_space(9e9, 0.33);
        let problem = Problem::new(runner, ice, Load::central(1000.0, Tilt::Free));
        let stop = Arc::new(AtomicBool::new(true));
        let options = Options {
            stop: Some(stop.clone()),
            ..Options::default()
        };
        assert_eq!(solve(&problem, &options).err(), Some(Error::Stopped));
        // Raised after the first mesh; the second one's solve ends.
        stop.store(false, Ordering::Relaxed);
        let raised = stop.clone();
        let options = Options {
            progress: Some(Arc::new(move |_| raised.store(true, Ordering::Relaxed))),
            ..options
        };
        assert_eq!(solve(&problem, &options).err(), Some(Error::Stopped));
        Ok(())
    }

    /// A runner that is worn flat, with hardly rounded rims where its pressure peaks.
    fn worn() -> Result<Problem, Box<dyn std::error::Error>> {
        let bob = BobRunner::default();
        let section = Section::arc(0.005, bob.width)?.worn(2e-6, 0.05)?;
        let rocker = Rocker::arc(30.0)?;
        let hull = Swept::with_rounded_ends(rocker, section, bob.length, bob.height)?;
        let ice = Ice::half_space(9e9, 0.33);
        let runner = Runner::rigid(Arc::new(hull));
        Ok(Problem::new(runner, ice, Load::central(1000.0, Tilt::Free)))
    }

    #[test]
    fn meshes_that_agree_and_are_too_coarse_where_the_pressure_peaks_are_refused_once_no_grading_is_left()
    -> Result<(), Box<dyn std::error::Error>> {
        let problem = worn()?;
        let options = Options {
            p_max_tolerance: 0.12,
            ..Options::default()
        };
        let graded = solve(&problem, &Options::default())?;
        let start = CheckedProblem::bearable(&problem, &options)?;
        let mut meshes = Meshes::guess(start, Vec::new())?;
        // As if the ridge had been overlooked.
        meshes.patch.y.sizes.clear();
        meshes.regraded = REGRADINGS;
        let Err(Error::AccuracyNotReached {
            estimate,
            finest,
            best,
            ..
        }) = refined(meshes)
        else {
            return Err("meshes without a grading were taken for an answer".into());
        };
        // The meshes agree to the requested accuracy, and are too coarse all the same.
        assert!(estimate <= options.p_max_tolerance, "{estimate}");
        assert!(finest < COARSE, "{finest}");
        let off = (best.p_max / graded.p_max - 1.0).abs();
        assert!(off > 0.05, "{off} {estimate}");
        Ok(())
    }

    fn paraboloid() -> Result<Problem, Box<dyn std::error::Error>> {
        let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?));
        let ice = Ice::half_space(9e9, 0.33);
        Ok(Problem::new(runner, ice, Load::central(1000.0, Tilt::Free)))
    }

    #[test]
    fn tilts_that_are_not_small_are_refused_fixed_or_free() -> Result<(), Box<dyn std::error::Error>>
    {
        let with = |offset_y: f64, tilt: Tilt| -> Result<Problem, Box<dyn std::error::Error>> {
            let load = Load::Force {
                fz: 1000.0,
                offset_x: 0.0,
                offset_y,
                tilt,
            };
            Ok(Problem {
                load,
                ..paraboloid()?
            })
        };
        for roll in [0.3, -0.9] {
            let fixed = with(0.0, Tilt::Fixed { pitch: 0.0, roll })?;
            let refused = solve(&fixed, &Options::default()).err();
            assert!(
                matches!(refused, Some(Error::OutOfRange { value, .. }) if value == roll),
                "{refused:?}"
            );
        }
        // A section of 5 mm leans by y / 5 mm.
        let settled = with(0.002, Tilt::Free)?;
        let refused = solve(&settled, &Options::default()).err();
        assert!(
            matches!(refused, Some(Error::OutOfRange { name: "roll [rad]", value, .. }) if (value + 0.4).abs() < 0.01),
            "{refused:?}"
        );
        Ok(())
    }

    #[test]
    fn errors_under_a_free_tilt_have_its_square_in_them() -> Result<(), Box<dyn std::error::Error>>
    {
        let load = Load::Force {
            fz: 1000.0,
            offset_x: 0.0,
            offset_y: -5e-4,
            tilt: Tilt::Free,
        };
        let problem = Problem {
            load,
            ..paraboloid()?
        };
        let options = Options {
            p_max_tolerance: 0.02,
            ..Options::default()
        };
        let rolled = solve(&problem, &options)?;
        assert!((rolled.roll - 0.1).abs() < 1e-3, "{}", rolled.roll);
        assert!(rolled.p_max_error > 0.01 * rolled.p_max);
        Ok(())
    }

    #[test]
    fn what_does_not_reach_its_accuracy_holds_the_best_solution_with_its_error()
    -> Result<(), Box<dyn std::error::Error>> {
        let options = Options {
            max_dofs: 100_000,
            p_max_tolerance: 1e-4,
            ..Options::default()
        };
        let Err(Error::AccuracyNotReached {
            best,
            dofs,
            estimate,
            ..
        }) = solve(&paraboloid()?, &options)
        else {
            return Err("more was reached than requested".into());
        };
        // The limit is on what is expected of a mesh; the second one came out at 108 thousand.
        assert!(dofs <= 115_000 && dofs == best.dofs, "{dofs}");
        assert!(best.history.iter().any(|i| i.level == 1));
        assert!((best.p_max_error / best.p_max - estimate).abs() < 1e-12);
        // Hertz's peak of this contact.
        let off = (best.p_max / 138.52e6 - 1.0).abs();
        assert!(off < estimate && estimate < 0.02, "{off} {estimate}");
        // The message names the criterion that failed, not the error alone.
        let coarse = Error::AccuracyNotReached {
            dofs,
            estimate: 0.5e-4,
            tolerance: 1e-4,
            finest: 0.25,
            best,
        };
        let reported = coarse.to_string();
        assert!(
            reported.contains("cells of 0.25 times the present size, less than the accepted 0.4"),
            "{reported}"
        );
        Ok(())
    }

    #[test]
    fn updates_are_told_in_order_with_the_values_of_their_moment()
    -> Result<(), Box<dyn std::error::Error>> {
        let reported = Arc::new(std::sync::Mutex::new(Vec::new()));
        let stored = reported.clone();
        let begun = Arc::new(std::sync::Mutex::new(Vec::new()));
        let (meshes, so_far) = (begun.clone(), reported.clone());
        let options = Options {
            next_mesh: Some(Arc::new(move |mesh: &crate::NextMesh| {
                let updates: Vec<crate::Iterate> = so_far.lock().expect("no failure").clone();
                assert!(updates.iter().all(|update| update.level < mesh.level));
                meshes.lock().expect("no failure").push(*mesh);
            })),
            progress: Some(Arc::new(move |i: &crate::Iterate| {
                stored.lock().expect("no watcher has failed").push(*i);
            })),
            ..Options::default()
        };
        let solution = solve(&paraboloid()?, &options)?;
        let reported = reported.lock().expect("no watcher has failed");
        assert_eq!(*reported, solution.history);
        let begun = begun.lock().expect("no failure");
        assert_eq!(begun.len(), reported[reported.len() - 1].level + 1);
        for update in reported.iter() {
            let mesh = begun[update.level];
            let of_mesh = (mesh.dofs, mesh.error_before);
            assert_eq!(of_mesh, (update.dofs, update.error_before));
        }
        assert!(reported.windows(2).all(|w| w[0].level <= w[1].level));
        // Two sets of one mesh have two peaks: neither is given the other's.
        let changed = |w: &[crate::Iterate]| w[0].level != w[1].level || w[0].p_max != w[1].p_max;
        assert!(reported.windows(2).all(changed));
        assert!(
            reported
                .iter()
                .all(|i| (i.p_max / 138.5e6 - 1.0).abs() < 0.1)
        );
        Ok(())
    }
}
