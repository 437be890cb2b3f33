//! Whether a model that was written can be read and driven.

use crate::error::Error;
use crate::model::conditions::Conditions;
use crate::model::model_toml::Model;
use crate::model::vehicle::Vehicle;
use crate::simulate::drive::{SimulateOptions, simulate};
use crate::simulate::driver::Driver;
use crate::track::table::{Track, TrackShape};

/// A slope of 0.1 rad with a valley and a bank.
const TRACK: &str = "s_m,slope_rad,curvature_1pm,bank_rad\n\
                     0,0.1,0,0\n20,0.1,0.01,0.2\n40,0.1,0.02,0.4\n60,0.1,0.01,0.2\n80,0.1,0,0\n";

/// Reads the text of a model, switches its effects on and drives it for a second.
///
/// # Errors
/// Those of [`Model::from_toml`], [`Vehicle::with_effects`] and [`simulate`]; `file` names the text.
pub fn try_model(text: &str, file: &str) -> Result<(), Error> {
    let vehicle = Vehicle::with_effects(&Model::from_toml(text, file)?)?;
    let track = Track::from_csv(TRACK.as_bytes(), "trial", "trial")?;
    let defaults = SimulateOptions::default();
    let options = SimulateOptions {
        most_s: 1.0,
        conditions: Conditions {
            humidity_pct: Some(50.0),
            distance_m: Some(0.0),
            ..defaults.conditions
        },
        ..defaults
    };
    let driver = Driver::of_skill(0.9);
    simulate(&vehicle, &TrackShape::new(&track), &driver, &options).map(|_| ())
}
