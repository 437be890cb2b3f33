//! The fitted model: base multipliers, effects, installation errors, discrepancy and contacts.

use kufe_sled::Vehicle;
use kufe_sled::effects::{Active, Effects, Kind, Sensor};
use kufe_sled::friction::MagicFormula;

use crate::evidence::runs::contacts::model::Contacts;
use crate::evidence::runs::model::discrepancy::Discrepancy;
use crate::evidence::runs::model::installation::Installation;

/// Number of residual channels.
pub const CHANNELS: usize = 4;
/// Number of force balances, the first of the channels.
pub const BALANCES: usize = 3;
/// Index of the track channel.
pub const TRACK: usize = BALANCES;
/// Names and units of the channels.
pub const CHANNEL_NAMES: [(&str, &str); CHANNELS] = [
    ("along", "N"),
    ("side", "N"),
    ("yaw", "N m"),
    ("track", "m/s2"),
];
/// Number of base parameters.
pub const BASE: usize = 5;
/// Bounds of a base multiplier.
pub const BOUNDS: [f64; 2] = [0.02, 50.0];
/// Names of the base multipliers.
pub const BASE_NAMES: [&str; BASE] = [
    "longitudinal mu",
    "front mu_zeta",
    "front k_n_per_rad",
    "rear mu_zeta",
    "rear k_n_per_rad",
];

/// The base model, its multipliers and active effects.
#[derive(Clone)]
pub struct ResidualModel {
    /// The model as given.
    pub vehicle: Vehicle,
    pub base: [f64; BASE],
    pub effects: Effects,
    pub installation: Installation,
    /// Discrepancy over place, common to all runs of a track.
    pub discrepancy: Discrepancy,
    /// Contacts with walls, which differ from run to run.
    pub contacts: Option<Contacts>,
    /// Model error of each balance as a variance of its acceleration, above the sensor noise.
    pub model_error: [f64; BALANCES],
    /// Names of effects whose size comes from the track channel and is not fitted with the forces.
    pub frozen: Vec<String>,
}

/// Residuals by channel; an unused channel is empty.
pub type ChannelRows = [Vec<f64>; CHANNELS];

impl ResidualModel {
    /// A model without installation errors, discrepancy and contacts.
    pub fn new(vehicle: Vehicle, base: [f64; BASE], effects: Effects) -> Self {
        Self {
            vehicle,
            base,
            effects,
            installation: Installation::default(),
            discrepancy: Discrepancy::default(),
            contacts: None,
            model_error: [0.0; BALANCES],
            frozen: Vec::new(),
        }
    }

    /// The model with one more effect.
    pub fn with(&self, effect: Active) -> Self {
        let mut with = self.clone();
        with.effects.active.push(effect);
        with
    }

    /// Delay of a sensor on a track [s], by effects and installation.
    pub fn delay(&self, sensor: Sensor, track: &str) -> f64 {
        let effects = self.effects.active.iter().filter(|e| e.acts_on(track));
        let by_effects: f64 = effects.map(|e| e.delays()[sensor as usize]).sum();
        by_effects + self.installation.delay(sensor)
    }

    /// The lateral laws with the base multipliers applied, front and rear.
    pub fn laws(&self) -> [MagicFormula; 2] {
        let vehicle = self.scaled_vehicle();
        [vehicle.front.lateral, vehicle.rear.lateral]
    }

    /// The vehicle with its base parameters times the base multipliers.
    pub fn scaled_vehicle(&self) -> Vehicle {
        let [mu, front_grip, front_stiffness, rear_grip, rear_stiffness] = self.base;
        let law = |law: &MagicFormula, grip: f64, stiffness: f64| MagicFormula {
            mu_zeta: law.mu_zeta * grip,
            k_n_per_rad: law.k_n_per_rad * stiffness,
            ..*law
        };
        let mut vehicle = self.vehicle.with_lateral(
            law(&self.vehicle.front.lateral, front_grip, front_stiffness),
            law(&self.vehicle.rear.lateral, rear_grip, rear_stiffness),
        );
        vehicle.front.mu_scale *= mu;
        vehicle.rear.mu_scale *= mu;
        vehicle
    }

    /// The model with installation and discrepancy fixed or free in fits.
    pub fn with_fixed(&self, fixed: bool) -> Self {
        let mut residual_model = self.clone();
        residual_model.installation.fixed = fixed;
        residual_model.discrepancy = self.discrepancy.with_fixed(fixed);
        residual_model
    }

    /// The model without a discrepancy.
    pub fn without_discrepancy(&self) -> Self {
        Self {
            discrepancy: Discrepancy::default(),
            ..self.clone()
        }
    }

    /// The unit in which an active amplitude is fitted.
    pub fn scale(&self, effect: usize, parameter: usize) -> f64 {
        let active = &self.effects.active[effect];
        match &active.kind {
            Kind::Catalogue(kind) => kind.info().parameters[parameter].typical,
            Kind::Custom(_) => active.values[parameter].abs().max(1e-9),
        }
    }

    /// The range in which a model file may state an active amplitude.
    pub fn bounds(&self, effect: usize, parameter: usize) -> [f64; 2] {
        match &self.effects.active[effect].kind {
            Kind::Catalogue(kind) => {
                let parameter = &kind.info().parameters[parameter];
                [parameter.low, parameter.high]
            }
            Kind::Custom(custom) => [custom.low, custom.high],
        }
    }

    /// The amplitudes that are fitted: index of the effect, index of the parameter.
    pub fn free(&self) -> Vec<(usize, usize)> {
        let mut free = Vec::new();
        for (e, effect) in self.effects.active.iter().enumerate() {
            if self.frozen.contains(&effect.name) {
                continue;
            }
            match &effect.kind {
                Kind::Custom(_) => free.push((e, 0)),
                Kind::Catalogue(kind) => {
                    for (p, parameter) in kind.info().parameters.iter().enumerate() {
                        if parameter.is_amplitude() && effect.values[p] != 0.0 {
                            free.push((e, p));
                        }
                    }
                }
            }
        }
        free
    }
}
