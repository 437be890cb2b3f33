//! An effect as a value: a plain description with plain functions, one static of it in each file of the catalogue.

use crate::effects::known::Info;
use crate::effects::law::example::Example;
use crate::effects::law::fault::Fault;
use crate::effects::motion::{Conditions, Constants, Forces, Signals, State};

/// The friction coefficient from an effect's parameters, the coefficient without it, and the conditions.
pub type FrictionLaw = fn(&[f64], f64, &Conditions) -> f64;

/// A switchable part of the model; parameters come in the order of [`Info::parameters`].
///
/// At default parameters it changes nothing. A law that an effect does not have is `None`.
pub struct Effect {
    /// Name, formula, parameters, what it needs and how it is judged.
    pub info: Info,
    /// The friction coefficient with the effect, from parameters, the coefficient without it, and the conditions.
    ///
    /// On a sled it acts on both runners, unless the effect has a law for forces or for the slope.
    pub on_friction: Option<FrictionLaw>,
    /// Changes the forces of the base law.
    pub on_forces: Option<fn(&[f64], &State, &mut Forces)>,
    /// What sensors read.
    pub on_sensors: &'static [Fault],
    /// The parameter that is a distance after which forces follow the slip ([`Relaxed`](crate::effects::Relaxed)).
    pub relaxes: Option<usize>,
    /// Changes the stated constants of the sled to the true ones.
    pub on_sled: Option<fn(&[f64], &mut Constants)>,
    /// What is added to the track's slope at a distance [m], downhill positive [rad].
    pub on_slope: Option<fn(&[f64], f64) -> f64>,
    /// A number that it must give.
    pub example: Example,
}

impl Effect {
    /// What a file of an effect leaves out: no law at all.
    pub const NEW: Effect = Effect {
        info: Info::NEW,
        on_friction: None,
        on_forces: None,
        on_sensors: &[],
        relaxes: None,
        on_sled: None,
        on_slope: None,
        example: Example::NEW,
    };

    /// What is known of it.
    pub fn info(&'static self) -> &'static Info {
        &self.info
    }

    /// The coefficient with the effect, from the coefficient without it; the same where it does not act on it.
    pub fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        self.on_friction.map_or(mu, |law| law(parameters, mu, at))
    }

    /// Changes the forces of the base law.
    pub fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        if let Some(law) = self.on_forces {
            law(parameters, at, forces);
        } else if self.on_friction.is_some() && self.on_slope.is_none() {
            self.scale_along(parameters, at, forces);
        }
    }

    /// The coefficient behind the force along each runner is replaced, and the force follows.
    fn scale_along(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        for runner in 0..2 {
            let load = at.load[runner];
            if load <= 0.0 {
                continue;
            }
            let mut conditions = at.conditions;
            conditions.fz = load;
            conditions.film = at.film[runner];
            let mu = -forces.along[runner] / load;
            forces.along[runner] = -load * self.coefficient(parameters, mu, &conditions);
        }
    }

    /// Whether it stands between a sensor and the truth or changes a constant of the sled.
    pub fn moves_signals(&self) -> bool {
        !self.on_sensors.is_empty() || self.on_sled.is_some()
    }

    /// From what the sensors say to what is true, and from the stated constants of the sled to the true ones.
    pub fn correct(&self, parameters: &[f64], signals: &mut Signals) {
        for fault in self.on_sensors.iter().rev() {
            fault.correct(parameters[fault.parameter], signals);
        }
        self.find_constants(parameters, &mut signals.sled);
    }

    /// From what is true to what the sensors say.
    pub fn disturb(&self, parameters: &[f64], signals: &mut Signals) {
        for fault in self.on_sensors {
            fault.disturb(parameters[fault.parameter], signals);
        }
    }

    /// From the stated constants of the sled to the true ones.
    pub fn find_constants(&self, parameters: &[f64], sled: &mut Constants) {
        if let Some(law) = self.on_sled {
            law(parameters, sled);
        }
    }

    /// What is added to the track's slope at `s` [m], downhill positive [rad].
    pub fn slope(&self, parameters: &[f64], s: f64) -> f64 {
        self.on_slope.map_or(0.0, |law| law(parameters, s))
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Effect").field(&self.info.name).finish()
    }
}
