//! Friction over speed and temperature: one groove a temperature, or a point where its hardness
//! follows the speed, and one film a point.

use crate::case::{SlidingTable, StatedProblem};
use kufe_contact::{Measure, Options};

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::film::{conditions, film_along, film_failure};
use crate::jobs::slide::groove::{Grooved, Ploughing};
use crate::jobs::slide::sliding::Friction;
use crate::jobs::watch::Watch;

/// Friction at one speed on ice of one temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionPoint {
    /// Speed [m/s].
    pub v_mps: f64,
    /// Temperature of the ice [C].
    pub ice_c: f64,
    /// The coefficient of friction and its parts.
    pub friction: Friction,
    /// Depth of the groove [m].
    pub groove_depth: Measure,
    /// Thickness of the film averaged over the patch [m].
    pub film_mean: f64,
    /// Hardness of the ice [Pa].
    pub hardness: f64,
}

/// Friction of a case's runner at every speed [m/s] on ice of every temperature [C]; a `[sliding]`
/// of its own says the rest.
///
/// # Errors
/// [`Failure::BadInput`] for the case, a speed and a temperature, [`Failure::NotConverged`] where a
/// groove or a film stops short, [`Failure::Partial`] where it was stopped.
pub fn friction_table(
    loaded: &LoadedCase,
    speeds: &[f64],
    temperatures: &[f64],
    watch: &Watch,
    options: &Options,
) -> Result<Vec<FrictionPoint>, Failure> {
    // Every combination is a case: those that are none are reported before anything is solved.
    let mut cases = Vec::new();
    for &ice_c in temperatures {
        for &v_mps in speeds {
            cases.push((at(loaded, v_mps, ice_c)?, v_mps, ice_c));
        }
    }
    let mut points = Vec::new();
    for group in cases.chunks(speeds.len().max(1)) {
        let Some((case, _, ice_c)) = group.first() else {
            continue;
        };
        if watch.stopped() {
            return Err(Failure::Partial(format!(
                "{}: stopped before the end",
                loaded.name
            )));
        }
        watch.progress(&format!("groove on ice of {ice_c} C"));
        let options = Options {
            p_max_tolerance: case.case.accuracy.p_max,
            stiffness: case.case.solver.stiffness.into(),
            ..options.clone()
        };
        let mut grooved: Option<Grooved> = None;
        for (case, v_mps, ice_c) in group {
            // A hardness over contact time is another at every speed.
            if grooved.is_none() || table(case).hardness.is_some() {
                let StatedProblem { problem, hull } = case.stated_sliding()?;
                let found = Ploughing::new(case, table(case), &problem)?.groove(&options)?;
                case.fine_enough(hull.as_ref(), &found.solution.contact)?;
                grooved = Some(found);
            }
            let Some(Grooved { solution, hardness }) = &grooved else {
                continue;
            };
            let along = film_along(solution, &conditions(table(case)));
            let along = along.map_err(|error| film_failure(case, &error))?;
            points.push(FrictionPoint {
                v_mps: *v_mps,
                ice_c: *ice_c,
                friction: Friction::of(solution, &along),
                groove_depth: solution.groove.deepest,
                film_mean: along.film.totals.mean_thickness,
                hardness: hardness.value,
            });
        }
    }
    Ok(points)
}

/// The case at one speed and temperature; where the ice's elasticity follows from its temperature
/// it follows this one.
pub(crate) fn at(loaded: &LoadedCase, v_mps: f64, ice_c: f64) -> Result<LoadedCase, Failure> {
    let mut loaded = loaded.clone();
    let own = loaded.case.sliding.take();
    loaded.case.sliding = Some(match own {
        Some(own) => SlidingTable {
            v_mps,
            ice_c,
            ..own
        },
        None => SlidingTable::new(v_mps, ice_c),
    });
    if loaded.case.ice.temperature_c.is_some() {
        loaded.case.ice.temperature_c = Some(ice_c);
    }
    let checked = loaded.case.check();
    checked.map_err(|error| Failure::BadInput(format!("{}: {error}", loaded.name)))?;
    Ok(loaded)
}

fn table(loaded: &LoadedCase) -> &SlidingTable {
    let Some(table) = &loaded.case.sliding else {
        unreachable!("every case of a friction table slides");
    };
    table
}
