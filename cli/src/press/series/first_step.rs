//! Every step of a series is checked before the first is solved.

use kufe_contact::{Options, Problem, check_problem};
use kufe_jobs::{Failure, case_file::LoadedCase};

/// What is kept between checks: a hull is read and fitted once.
#[derive(Default)]
pub struct FirstStep {
    hull: Option<Problem>,
}

impl FirstStep {
    /// Checks that a step's case states a problem that can be begun.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with what is wrong.
    pub fn check(&mut self, loaded: &LoadedCase, options: &Options) -> Result<(), Failure> {
        let case = &loaded.case;
        case.check()
            .map_err(|error| Failure::BadInput(format!("{}: {error}", loaded.name)))?;
        let problem = match (&self.hull, &case.runner.shape) {
            (Some(hull), None) => Problem {
                track_curvature: case.track.curvature(),
                load: case.load.load(),
                ..hull.clone()
            },
            _ => loaded.stated_sliding()?.problem,
        };
        check_problem(&problem, options).map_err(|error| loaded.failure(&error))?;
        if case.runner.shape.is_none() {
            self.hull = Some(problem);
        }
        Ok(())
    }
}
