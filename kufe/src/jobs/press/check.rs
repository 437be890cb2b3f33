//! Check of a solution by a second method: boundary elements on the contact plane, where they
//! apply.

use std::time::Instant;

use kufe_contact::{BoundaryElements, CheckUnavailable, Problem, Solution, boundary_elements};

use crate::plot::{quantity, unit_of};
use crate::results::{Approach, Measured, PeakPressure, ResultQuantity};

/// A contact by boundary elements.
pub struct Check {
    /// The contact by boundary elements, or why they do not apply.
    pub found: Result<BoundaryElements, CheckUnavailable>,
    /// Wall time [s].
    pub seconds: f64,
}

impl Check {
    /// Solves the problem by boundary elements, unless `solution` is theirs.
    pub(super) fn of(problem: &Problem, solution: &Solution) -> Self {
        let started = Instant::now();
        let found = match solution.volume {
            Some(_) => boundary_elements(problem),
            None => Err(CheckUnavailable::FirstAnswer),
        };
        Check {
            found,
            seconds: started.elapsed().as_secs_f64(),
        }
    }

    /// Widens the errors of peak and approach where the two solutions differ by more than the sum
    /// of their errors, so that the intervals contain the second value with its error. Returns a
    /// warning for each.
    pub(super) fn widen(&self, solution: &mut Solution) -> Vec<String> {
        let Ok(found) = &self.found else {
            return Vec::new();
        };
        let peak = Measured::new(found.p_max, found.p_max_error);
        let approach = Measured::new(found.approach, found.approach_error);
        let widened = [
            widened::<PeakPressure>(solution.p_max, &mut solution.p_max_error, peak),
            widened::<Approach>(solution.approach, &mut solution.approach_error, approach),
        ];
        widened.into_iter().flatten().collect()
    }
}

/// Widens the error of a value to contain the second value with its error, if the two differ by
/// more than the sum of their errors.
fn widened<Q: ResultQuantity>(value: f64, error: &mut f64, second: Measured<Q>) -> Option<String> {
    let apart = (value - second.value).abs();
    if apart <= *error + second.error {
        return None;
    }
    let first = Measured::<Q>::new(value, *error);
    *error = apart + second.error;
    let (label, error) = (
        Q::DESCRIPTION.label,
        quantity(*error, &unit_of(Q::DESCRIPTION.key)),
    );
    Some(format!(
        "two methods differ: {label} {first} by finite elements, {second} by boundary elements: \
         the error is widened to {error}"
    ))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use kufe_contact::{Ice, Load, Options, Runner, Tilt, solve};
    use kufe_mesh::Paraboloid;

    use super::*;

    #[test]
    fn errors_of_answers_that_differ_contain_the_second_one_and_others_stay()
    -> Result<(), Box<dyn std::error::Error>> {
        let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?));
        let load = Load::central(1000.0, Tilt::Free);
        let problem = Problem::new(runner, Ice::half_space(9e9, 0.33), load);
        let solution = solve(&problem, &Options::default())?;
        let check = Check::of(&problem, &solution);
        let mut same = solution.clone();
        assert!(check.widen(&mut same).is_empty() && same == solution);
        let found = check.found.as_ref().map_err(ToString::to_string)?;
        for (p_max, approach, name) in [(1.03, 1.0, "peak"), (1.0, 0.95, "approach")] {
            let mut off = Solution {
                p_max: solution.p_max * p_max,
                approach: solution.approach * approach,
                ..solution.clone()
            };
            let warnings = check.widen(&mut off);
            assert!(
                warnings.len() == 1 && warnings[0].contains(name),
                "{warnings:?}"
            );
            let peaks = off.p_max_error + found.p_max_error;
            assert!((off.p_max - found.p_max).abs() <= peaks);
            let approaches = off.approach_error + found.approach_error;
            assert!((off.approach - found.approach).abs() <= approaches);
        }
        Ok(())
    }
}
