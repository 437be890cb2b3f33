//! What contacts of one runner share: its hull read and fitted once.

use std::sync::{Arc, OnceLock};

use crate::case::{CaseError, FittedHull};
use kufe_contact::{Problem, Runner};
use kufe_mesh::Underside;

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::press::hull_error::{found_noise, made_up};

/// A case's runner and what is made of its files. Cases that differ in load, track and tilt alone share one.
pub struct Prepared {
    /// What the case's files held: [`LoadedCase::content`].
    pub(super) content: String,
    runner: Runner,
    /// The hull, where the case names one.
    pub(super) hull: Option<FittedHull>,
    /// The hull as scans with its noise would have it; made where asked for.
    scans: OnceLock<Option<Vec<Arc<dyn Underside>>>>,
}

impl Prepared {
    /// Reads the case's files and fits its hull.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the hull cannot be had, or the case is out of range.
    pub fn of(loaded: &LoadedCase) -> Result<Self, Failure> {
        let content = loaded.content()?;
        let (runner, hull) = told(loaded, loaded.case.runner(&loaded.base))?;
        Ok(Prepared {
            content,
            runner,
            hull,
            scans: OnceLock::new(),
        })
    }

    /// The problem that a case of this runner states.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the case is out of range.
    pub fn problem(&self, loaded: &LoadedCase) -> Result<Problem, Failure> {
        let runner = self.runner.clone();
        told(loaded, loaded.case.problem_of(runner, &loaded.base))
    }

    /// Scans of the hull made up with its noise.
    pub(super) fn scans(&self) -> Option<&[Arc<dyn Underside>]> {
        let fitted = || self.hull.as_ref().and_then(|h| made_up(h, found_noise(h)));
        self.scans.get_or_init(fitted).as_deref()
    }
}

fn told<T>(loaded: &LoadedCase, found: Result<T, CaseError>) -> Result<T, Failure> {
    found.map_err(|error| Failure::BadInput(format!("{}: {error}", loaded.name)))
}
