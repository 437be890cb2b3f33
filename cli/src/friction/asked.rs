//! What `kufe friction --groove` is asked, and where it writes.

use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::FrictionPoint;

use crate::output::apart::case_inputs;
use crate::output::staging::Staging;

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
pub fn begin(asked: &Asked, cases: &[LoadedCase]) -> Result<Option<Staging>, Failure> {
    let Some(out) = asked.out else {
        return Ok(None);
    };
    let mut inputs = Vec::new();
    for (path, loaded) in asked.cases.iter().zip(cases) {
        inputs.extend(case_inputs(Some(path), loaded)?);
    }
    let names = ["friction.json", "friction.csv", "friction.png"];
    let staging = Staging::beside(&inputs, out, &names)?;
    staging.remove_on_interrupt();
    Ok(Some(staging))
}
