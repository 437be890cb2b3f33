//! Every step of a series is checked before the first is solved.

use std::sync::Arc;

use kufe::jobs::{Failure, Prepared, case_file::LoadedCase};
use kufe_contact::{Options, check_problem};

/// What is kept between steps: a hull is read and fitted once.
#[derive(Default)]
pub struct FirstStep {
    hull: Option<Arc<Prepared>>,
}

impl FirstStep {
    /// Checks that a step's case states a problem that can be begun; its runner.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with what is wrong.
    pub fn check(
        &mut self,
        loaded: &LoadedCase,
        options: &Options,
    ) -> Result<Arc<Prepared>, Failure> {
        let prepared = match &self.hull {
            Some(hull) => hull.clone(),
            None => Arc::new(Prepared::of(loaded)?),
        };
        let problem = prepared.problem(loaded)?;
        check_problem(&problem, options).map_err(|error| loaded.failure(&error))?;
        if loaded.case.runner.shape.is_none() {
            self.hull = Some(prepared.clone());
        }
        Ok(prepared)
    }
}
