//! A series of contacts: one case with several loads, radii and tilts, one step per combination.

use std::sync::Arc;

use kufe_contact::{Options, check_problem};

use crate::case::TiltWord;
use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::press::{Prepared, SolvedContact, press_prepared};
use crate::jobs::watch::Watch;
use crate::results::{CaseRecord, ContactResult, SeriesRow, VariedKeys};

/// One step of a series.
pub struct Step {
    /// Number of the step, from 1.
    pub number: usize,
    /// Folder of its results within the folder of the series.
    pub folder: String,
    varied: VariedKeys,
    loaded: LoadedCase,
    runner: Arc<Prepared>,
}

impl Step {
    /// The steps of a series. Each is checked here, before any is solved; a hull is read and fitted
    /// once.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the step and what is wrong with its case.
    pub fn of(
        varied: Vec<VariedKeys>,
        loaded: &LoadedCase,
        options: &Options,
    ) -> Result<Vec<Step>, Failure> {
        let digits = varied.len().to_string().len().max(3);
        let mut fitted: Option<Arc<Prepared>> = None;
        let mut steps = Vec::new();
        for (k, varied) in varied.into_iter().enumerate() {
            let folder = format!("step-{:0digits$}", k + 1);
            let loaded = varied.applied_to(loaded)?;
            let has_shape = loaded.case.runner.shape.is_some();
            let prepared = || {
                let runner = match fitted.clone().filter(|_| !has_shape) {
                    Some(runner) => runner,
                    None => Arc::new(Prepared::of(&loaded, &Watch::default())?),
                };
                loaded.solved(check_problem(&runner.problem(&loaded)?, options))?;
                Ok::<_, Failure>(runner)
            };
            let runner = prepared().map_err(|failure| failure.within(&folder))?;
            fitted = Some(runner.clone());
            steps.push(Step {
                number: k + 1,
                folder,
                varied,
                loaded,
                runner,
            });
        }
        Ok(steps)
    }

    /// Solves the step.
    ///
    /// # Errors
    /// As [`press_prepared`].
    pub fn solve(&self, watch: &Watch, options: &Options) -> Result<SolvedContact, Failure> {
        press_prepared(self.loaded.clone(), &self.runner, watch, options.clone())
    }

    /// Whether a result is valid for this step: same version, same case, same content of its files
    /// ([`LoadedCase::content`]), and accurate enough.
    pub fn is_solved_by(&self, result: &ContactResult, content: &str) -> bool {
        result.version == env!("CARGO_PKG_VERSION")
            && result.content_sha256 == content
            && result.case == CaseRecord::of(&self.loaded.case)
            && result.accuracy_reached
    }

    /// The step as a row of the table.
    pub fn row(&self, result: Option<&ContactResult>, error: Option<String>) -> SeriesRow {
        SeriesRow {
            step: self.number,
            folder: self.folder.clone(),
            varied: self.varied.clone(),
            result: result.map(Into::into),
            error,
        }
    }
}

impl VariedKeys {
    /// The case with these values.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a rocker radius of a hull.
    pub fn applied_to(&self, loaded: &LoadedCase) -> Result<LoadedCase, Failure> {
        let mut loaded = loaded.clone();
        let case = &mut loaded.case;
        if let Some(fz_n) = self.fz_n {
            case.load.fz_n = fz_n;
        }
        if let Some(radius) = &self.radius_m {
            case.track.curvature_1pm = None;
            case.track.radius_m = Some(radius.metres());
        }
        if self.pitch_rad.is_some() || self.roll_rad.is_some() {
            case.load.tilt = TiltWord::Fixed;
            case.load.pitch_rad = self.pitch_rad.or(case.load.pitch_rad);
            case.load.roll_rad = self.roll_rad.or(case.load.roll_rad);
        }
        if let Some(radius) = self.rocker_radius_m {
            let Some(shape) = &mut case.runner.shape else {
                return Err(loaded.bad_input(
                    "--rocker-radius-m: the runner is a hull, expected a shape with a rocker radius",
                ));
            };
            *shape.rocker_radius_m() = radius;
        }
        Ok(loaded)
    }
}
