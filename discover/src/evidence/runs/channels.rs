//! Residual channels in use.

use kufe_sled::effects::Column;
use kufe_sled::friction::Longitudinal;
use kufe_sled::{Model, State, outside_tables};

use crate::evidence::runs::model::on_run::ModelOnRun;
use crate::evidence::runs::model::residual_model::{CHANNELS, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::prepare::Data;
use crate::options::Options;

/// Whether the longitudinal, lateral, yaw and track channels are used.
pub fn channels_in_use(data: &Data, model: &Model, options: &Options) -> [bool; CHANNELS] {
    let recorded = data.available.contains(&Column::LongitudinalAcceleration);
    let along = recorded && !is_silent(model) && options.longitudinal;
    let surveyed = data.frames.iter().all(|f| f.slope.len() == f.len());
    [along, options.lateral, options.lateral, along && surveyed]
}

/// Remarks on the longitudinal channel.
pub fn remarks_on_channels(model: &Model, along: bool) -> Vec<String> {
    let mut remarks = Vec::new();
    if is_silent(model) {
        remarks.push(
            "the model has no friction and no drag along: the longitudinal channel is omitted"
                .to_owned(),
        );
    }
    if along {
        remarks.push("the longitudinal residual uses the specific force a_x, which gravity does not enter; the speed's derivative enters the track channel alone".to_owned());
    }
    remarks
}

/// Whether the model has no longitudinal forces.
fn is_silent(model: &Model) -> bool {
    let longitudinal = model.friction.longitudinal.model();
    model.sled.cda_m2 == 0.0 && matches!(longitudinal, Ok(Longitudinal::Fixed(mu)) if mu <= 1e-9)
}

/// Remarks on tables that do not span every sample.
pub fn outside(given: &ResidualModel, frames: &[Frame]) -> Vec<String> {
    if given.vehicle.tables().iter().all(Option::is_none) {
        return Vec::new();
    }
    let of_run = |frame: &Frame| {
        let model = ModelOnRun::new(given, frame);
        let states: Vec<State> = frame.samples().map(|i| model.state(i)).collect();
        states
    };
    let states: Vec<State> = frames.iter().flat_map(of_run).collect();
    let outside = outside_tables(&given.vehicle, states.iter());
    outside.iter().map(ToString::to_string).collect()
}
