//! A second answer to compare the first with: boundary elements on the contact plane, where they
//! apply.

use std::time::Instant;

use kufe_contact::{BoundaryElements, CheckUnavailable, Problem, Solution, boundary_elements};

/// What boundary elements say of a contact.
pub struct Check {
    /// Their figures, or why there are none.
    pub found: Result<BoundaryElements, CheckUnavailable>,
    /// Wall time [s].
    pub seconds: f64,
}

impl Check {
    /// Solves the problem by boundary elements, unless they gave its solution.
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

    /// A warning where the two answers part by more than both errors.
    pub(super) fn parted(&self, solution: &Solution) -> Option<String> {
        let found = self.found.as_ref().ok()?;
        let pairs = [
            (
                "peak pressure",
                [solution.p_max, found.p_max],
                [solution.p_max_error, found.p_max_error],
                (1e-6, "MPa"),
            ),
            (
                "approach",
                [solution.approach, found.approach],
                [solution.approach_error, found.approach_error],
                (1e6, "µm"),
            ),
        ];
        pairs.into_iter().find_map(|(name, values, errors, (factor, unit))| {
            let [first, second] = values.map(|value| value * factor);
            let [own, theirs] = errors.map(|error| error * factor);
            ((first - second).abs() > own + theirs).then(|| {
                format!(
                    "two methods part: {name} {first:.4} +- {own:.4} {unit} by finite elements, {second:.4} +- {theirs:.4} {unit} by \
                     boundary elements: one of the errors is too small"
                )
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use kufe_contact::{Ice, Load, Options, Runner, Tilt, solve};
    use kufe_mesh::Paraboloid;

    use super::*;

    #[test]
    fn answers_that_agree_are_silent_and_a_peak_or_an_approach_off_is_told()
    -> Result<(), Box<dyn std::error::Error>> {
        let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?));
        let load = Load::central(1000.0, Tilt::Free);
        let problem = Problem::new(runner, Ice::half_space(9e9, 0.33), load);
        let solution = solve(&problem, &Options::default())?;
        let check = Check::of(&problem, &solution);
        assert_eq!(check.parted(&solution), None);
        for (p_max, approach, name) in [(1.03, 1.0, "peak"), (1.0, 0.95, "approach")] {
            let off = Solution {
                p_max: solution.p_max * p_max,
                approach: solution.approach * approach,
                ..solution.clone()
            };
            let warning = check.parted(&off).ok_or("no warning")?;
            assert!(warning.contains(name), "{warning}");
        }
        Ok(())
    }
}
