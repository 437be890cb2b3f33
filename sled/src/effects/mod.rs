//! Effects of the sled that can be switched on in `[effects.NAME]` of a model.
//!
//! The same code acts in the driving simulation and in the inverse model: an effect changes the forces of the base law
//! ([`Effect::act`]), stands between the truth and a sensor ([`Effect::disturb`], [`Effect::correct`]) or changes the track
//! ([`Effect::slope`]). At default parameters it changes nothing.
//!
//! | type | what it is |
//! |---|---|
//! | [`Effect`] | one effect |
//! | [`State`], [`Measured`], [`Forces`] | what it sees and what it may change |
//! | [`Effects`], [`Active`] | the effects that a model switches on |
//! | [`CATALOGUE`] | all effects, those of the friction coefficient among them |

mod accelerometer_bias;
mod accelerometer_tilt;
mod active;
mod aero_yaw;
mod air_density;
mod asperities;
mod camber_thrust;
mod combined_slip;
mod custom;
mod drag_area;
mod headwind;
mod lever_arm;
mod load_sensitivity;
mod load_transfer;
mod mass;
mod on_ice;
mod relaxation_length;
mod roll_split_drag;
mod saturation;
pub(crate) mod schema;
mod slip_drag;
mod slip_lag;
mod slip_offset;
mod slip_scale;
mod slope;
mod speed_grip;
mod state;
mod steer_drag;
mod steer_offset;
mod temperature_grip;
mod track_profile;
mod wall_contact;

pub use active::{Active, EffectError, Effects, Kind};
pub use custom::{Channel, Custom, is_column};
pub use kufe_friction::effects::{Column, Conditions, Info, Level, Parameter};
pub use state::{Forces, Measured, State};

/// A switchable part of the sled; parameters come in the order of [`Info::parameters`].
pub trait Effect: Sync {
    /// Name, parameters and what the effect needs.
    fn info(&self) -> &'static Info;
    /// From what the sensors say to what is true.
    fn correct(&self, _parameters: &[f64], _measured: &mut Measured) {}
    /// From what is true to what the sensors say: the inverse of [`Effect::correct`].
    fn disturb(&self, _parameters: &[f64], _measured: &mut Measured) {}
    /// Changes the forces of the base law.
    fn act(&self, _parameters: &[f64], _at: &State, _forces: &mut Forces) {}
    /// What is added to the track's slope, downhill positive [rad].
    fn slope(&self, _parameters: &[f64], _s: f64) -> f64 {
        0.0
    }
}

/// All effects of the sled; a new one is a file and a line here.
pub static CATALOGUE: &[&dyn Effect] = &[
    &on_ice::OnIce("temperature"),
    &on_ice::OnIce("speed"),
    &on_ice::OnIce("load"),
    &on_ice::OnIce("plowing"),
    &on_ice::OnIce("humidity"),
    &on_ice::OnIce("wear"),
    &on_ice::OnIce("warm-up"),
    &asperities::Asperities,
    &drag_area::DragArea,
    &headwind::Headwind,
    &air_density::AirDensity,
    &slope::Slope,
    &track_profile::TrackProfile,
    &slip_drag::SlipDrag,
    &steer_drag::SteerDrag,
    &roll_split_drag::RollSplitDrag,
    &aero_yaw::AeroYaw,
    &accelerometer_bias::AccelerometerBias,
    &accelerometer_tilt::AccelerometerTilt,
    &wall_contact::WallContact,
    &load_transfer::LoadTransfer,
    &relaxation_length::RelaxationLength,
    &speed_grip::SpeedGrip,
    &temperature_grip::TemperatureGrip,
    &load_sensitivity::LoadSensitivity,
    &camber_thrust::CamberThrust,
    &saturation::Saturation,
    &combined_slip::CombinedSlip,
    &lever_arm::LeverArm,
    &slip_offset::SlipOffset,
    &slip_scale::SlipScale,
    &slip_lag::SlipLag,
    &steer_offset::SteerOffset,
    &mass::Mass,
];

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static dyn Effect> {
    CATALOGUE
        .iter()
        .copied()
        .find(|effect| effect.info().name == name)
}

#[cfg(test)]
mod tests;
