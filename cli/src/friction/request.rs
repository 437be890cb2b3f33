//! A request for `kufe friction --groove`, and where its results are written.

use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::FrictionPoint;

use crate::output::{OutputDir, case_inputs};
use crate::terminal::Global;

/// What is solved.
pub struct Request<'a> {
    /// The cases, one a runner.
    pub cases: &'a [PathBuf],
    /// Speeds [m/s].
    pub speeds: &'a [f64],
    /// Temperatures of the ice [C].
    pub temperatures: &'a [f64],
    /// Parameters to search over, as `KEY=LOW:HIGH`.
    pub optimise: &'a [String],
    /// Folder for friction.csv, friction.json and friction.png; nothing is written where absent.
    pub out: Option<&'a PathBuf>,
}

/// One runner with its points, temperature by temperature.
pub struct Runner {
    /// Its name.
    pub name: String,
    /// Its friction.
    pub points: Vec<FrictionPoint>,
}

impl Request<'_> {
    /// The output folder, before anything is solved.
    ///
    /// # Errors
    /// As [`OutputDir::begin`].
    pub fn output(
        &self,
        cases: &[LoadedCase],
        global: &Global,
    ) -> Result<Option<OutputDir>, Failure> {
        let Some(out) = self.out else {
            return Ok(None);
        };
        let mut inputs = Vec::new();
        for (path, loaded) in self.cases.iter().zip(cases) {
            inputs.extend(case_inputs(Some(path), loaded)?);
        }
        OutputDir::begin("friction", &inputs, out, global.force).map(Some)
    }
}
