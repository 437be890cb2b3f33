//! The base model with what may be fitted of it: multipliers, effects, what the installation is off by.

use kufe_sled::Vehicle;
use kufe_sled::effects::{Active, Effects, Kind, Sensor};
use kufe_sled::friction::MagicFormula;

use crate::evidence::runs::contacts::model::Contacts;
use crate::evidence::runs::model::discrepancy::Discrepancy;
use crate::evidence::runs::model::installation::Installation;

/// Number of residual channels.
pub const CHANNELS: usize = 4;
/// Those of them that the forces enter: the first.
pub const BALANCES: usize = 3;
/// The track channel behind them.
pub const TRACK: usize = BALANCES;
/// Their names and units.
pub const CHANNEL_NAMES: [(&str, &str); CHANNELS] = [
    ("along", "N"),
    ("side", "N"),
    ("yaw", "N m"),
    ("track", "m/s2"),
];
/// Number of base parameters.
pub const BASE: usize = 5;
/// Least and largest multiplier of a base parameter.
pub const BOUNDS: [f64; 2] = [0.02, 50.0];
/// Multipliers of the base model: what they multiply.
pub const BASE_NAMES: [&str; BASE] = [
    "longitudinal mu",
    "front mu_zeta",
    "front k_n_per_rad",
    "rear mu_zeta",
    "rear k_n_per_rad",
];

/// The base model, its multipliers and the effects that are switched on.
#[derive(Clone)]
pub struct ResidualModel {
    /// The model as it was given.
    pub vehicle: Vehicle,
    /// Multipliers of the base parameters.
    pub base: [f64; BASE],
    /// Effects.
    pub effects: Effects,
    /// What the installation may be off by, and by how much it is.
    pub installation: Installation,
    /// What the balances leave over place on every run of a track alike.
    pub discrepancy: Discrepancy,
    /// Contacts with walls that each run has its own of.
    pub contacts: Option<Contacts>,
    /// Variance that each balance leaves above the sensors' noise, over the square of what it takes of its acceleration.
    pub beyond_noise: [f64; BALANCES],
    /// Names of effects whose size is not fitted with the forces: it comes from the track channel.
    pub frozen: Vec<String>,
}

/// Residuals by channel; an unused channel is empty.
pub type ChannelRows = [Vec<f64>; CHANNELS];

impl ResidualModel {
    /// A model with nothing wrong with its installation, no discrepancy and no contacts with walls.
    pub fn new(vehicle: Vehicle, base: [f64; BASE], effects: Effects) -> Self {
        Self {
            vehicle,
            base,
            effects,
            installation: Installation::default(),
            discrepancy: Discrepancy::default(),
            contacts: None,
            beyond_noise: [0.0; BALANCES],
            frozen: Vec::new(),
        }
    }

    /// Whether a base parameter is between its bounds.
    pub fn within(&self, parameter: usize) -> bool {
        !BOUNDS.contains(&self.base[parameter])
    }

    /// The same with one more effect.
    pub fn with(&self, effect: Active) -> Self {
        let mut residual_model = self.clone();
        residual_model.effects.active.push(effect);
        residual_model
    }

    /// How late a sensor is on a track [s], by effects and installation.
    pub fn delay(&self, sensor: Sensor, track: &str) -> f64 {
        let own = self.effects.active.iter().filter(|e| e.acts_on(track));
        let by_effects: f64 = own.map(|e| e.delays()[sensor as usize]).sum();
        by_effects + self.installation.delay(sensor)
    }

    /// The lateral laws with the base multipliers applied, front and rear.
    pub fn laws(&self) -> [MagicFormula; 2] {
        let vehicle = self.scaled_vehicle();
        [vehicle.front.lateral, vehicle.rear.lateral]
    }

    /// The vehicle with its base parameters times the base multipliers.
    pub fn scaled_vehicle(&self) -> Vehicle {
        let by = &self.base;
        let law = |law: &MagicFormula, grip: f64, stiffness: f64| MagicFormula {
            mu_zeta: law.mu_zeta * grip,
            k_n_per_rad: law.k_n_per_rad * stiffness,
            ..*law
        };
        let mut vehicle = self.vehicle.with_lateral(
            law(&self.vehicle.front.lateral, by[1], by[2]),
            law(&self.vehicle.rear.lateral, by[3], by[4]),
        );
        vehicle.front.mu_scale *= by[0];
        vehicle.rear.mu_scale *= by[0];
        vehicle
    }

    /// The same, with installation and discrepancy fixed or not.
    pub fn hold(&self, fixed: bool) -> Self {
        Self {
            installation: self.installation.hold(fixed),
            discrepancy: self.discrepancy.hold(fixed),
            ..self.clone()
        }
    }

    /// The same without a discrepancy.
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

    /// The amplitudes that are fitted: place of the effect, place of the parameter.
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
