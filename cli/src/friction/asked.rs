//! What `kufe friction --groove` is asked, and where it writes.

use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::FrictionPoint;

use crate::output::folder::OutputDir;
use crate::output::global::Global;
use crate::output::paths::case_inputs;

/// What is asked.
pub struct Asked<'a> {
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
    /// What to call it.
    pub name: String,
    /// Its friction.
    pub points: Vec<FrictionPoint>,
}

/// The output folder, before anything is solved.
pub fn begin(
    asked: &Asked,
    cases: &[LoadedCase],
    global: &Global,
) -> Result<Option<OutputDir>, Failure> {
    let Some(out) = asked.out else {
        return Ok(None);
    };
    let mut inputs = Vec::new();
    for (path, loaded) in asked.cases.iter().zip(cases) {
        inputs.extend(case_inputs(Some(path), loaded)?);
    }
    OutputDir::begin("friction", &inputs, out, global.force).map(Some)
}
