//! One effect that a model switches on, with its parameters.

use crate::effects::known::Parameter;
use crate::effects::law::{Effect, Reading};
use crate::effects::motion::{Conditions, Forces, SENSORS, Signals, State};
use crate::effects::switched::custom::Custom;

/// What kind of effect is active.
#[derive(Clone, Debug)]
pub enum Kind {
    /// From the catalogue.
    Catalogue(&'static Effect),
    /// A person's own.
    Custom(Custom),
}

/// One effect with its parameters.
#[derive(Clone, Debug)]
pub struct Active {
    /// The table's name; what follows an `@` tells several of one effect apart.
    pub name: String,
    /// What it does.
    pub kind: Kind,
    /// Parameters in the effect's order; the amplitude alone for an effect of one's own.
    pub values: Vec<f64>,
    /// The only track on which it acts; everywhere where absent.
    pub track: Option<String>,
}

impl Active {
    /// The effect's name without what follows an `@`.
    pub fn effect_name(&self) -> &str {
        self.name.split('@').next().unwrap_or(&self.name)
    }

    /// Whether it acts on the track of this name.
    pub fn acts_on(&self, track: &str) -> bool {
        self.track.as_deref().is_none_or(|only| only == track)
    }

    /// Whether an amplitude is not 0.
    pub fn is_on(&self) -> bool {
        match &self.kind {
            Kind::Custom(_) => self.values[0] != 0.0,
            Kind::Catalogue(effect) => {
                let parameters = effect.info.parameters.iter();
                parameters
                    .zip(&self.values)
                    .any(|(p, value)| p.is_amplitude() && *value != 0.0)
            }
        }
    }

    /// Whether its size and place are each recorded run's own: its spread from run to run is not 0.
    pub fn varies(&self) -> bool {
        let Kind::Catalogue(effect) = &self.kind else {
            return false;
        };
        let mut parameters = effect.info.parameters.iter().zip(&self.values);
        parameters.any(|(p, value)| p.name == Parameter::SPREAD.name && *value > 0.0)
    }

    /// Names of the columns that it needs.
    pub fn columns(&self) -> Vec<&str> {
        match &self.kind {
            Kind::Catalogue(effect) => effect.info.needs.iter().map(|c| c.name()).collect(),
            Kind::Custom(custom) => custom.names().iter().map(String::as_str).collect(),
        }
    }

    /// Whether it stands between a sensor and the truth or changes a constant of the sled.
    pub fn moves_signals(&self) -> bool {
        match &self.kind {
            Kind::Catalogue(effect) => effect.moves_signals(),
            Kind::Custom(custom) => custom.is_of_a_sensor(),
        }
    }

    /// The distance after which forces follow the slip by it [m]; 0 where they do so at once.
    pub fn relaxation(&self) -> f64 {
        match &self.kind {
            Kind::Catalogue(effect) => effect.relaxes.map_or(0.0, |p| self.values[p]),
            Kind::Custom(_) => 0.0,
        }
    }

    /// How late each sensor is by it [s], in the order of [`Sensor::ALL`](crate::effects::Sensor::ALL).
    pub fn delays(&self) -> [f64; SENSORS] {
        let mut delays = [0.0; SENSORS];
        if let Kind::Catalogue(effect) = &self.kind {
            let late = effect.on_sensors.iter();
            for fault in late.filter(|fault| fault.reading == Reading::Late) {
                delays[fault.of as usize] += self.values[fault.parameter];
            }
        }
        delays
    }

    /// Whether it makes a sensor late.
    pub fn is_late(&self) -> bool {
        self.delays().iter().any(|delay| *delay != 0.0)
    }

    /// The same with every sensor in time.
    pub(super) fn in_time(mut self) -> Self {
        if let Kind::Catalogue(effect) = &self.kind {
            let late = effect.on_sensors.iter();
            for fault in late.filter(|fault| fault.reading == Reading::Late) {
                self.values[fault.parameter] = 0.0;
            }
        }
        self
    }

    /// From what the sensors say to what is true, and from the stated constants of the sled to the true ones.
    pub fn correct(&self, at: &Conditions, signals: &mut Signals) {
        match &self.kind {
            Kind::Catalogue(effect) => effect.correct(&self.values, signals),
            Kind::Custom(custom) => custom.correct(self.values[0], at, signals),
        }
    }

    /// From what is true to what the sensors say.
    pub fn disturb(&self, at: &Conditions, signals: &mut Signals) {
        match &self.kind {
            Kind::Catalogue(effect) => effect.disturb(&self.values, signals),
            Kind::Custom(custom) => custom.disturb(self.values[0], at, signals),
        }
    }

    /// Changes the forces of the base law, whatever the track.
    pub fn act(&self, at: &State, forces: &mut Forces) {
        match &self.kind {
            Kind::Catalogue(effect) => effect.act(&self.values, at, forces),
            Kind::Custom(custom) => custom.act(self.values[0], at, forces),
        }
    }

    /// The coefficient with the effect, from that without it, of a specimen whose conditions alone are known.
    ///
    /// `None` where it does not act on a friction coefficient; NaN where a condition that it needs is not known.
    pub fn coefficient(&self, mu: f64, at: &Conditions) -> Option<f64> {
        match &self.kind {
            Kind::Catalogue(effect) => effect.on_friction.map(|law| law(&self.values, mu, at)),
            Kind::Custom(custom) => custom
                .acts_on_friction()
                .then(|| mu + custom.coefficient(self.values[0], at)),
        }
    }

    /// What is added to the track's slope at `s` [m], downhill positive [rad].
    pub fn slope(&self, s: f64) -> f64 {
        match &self.kind {
            Kind::Catalogue(effect) => effect.slope(&self.values, s),
            Kind::Custom(_) => 0.0,
        }
    }

    /// The table that states it in a model.
    pub fn table(&self) -> toml::Table {
        let mut table = toml::Table::new();
        match &self.kind {
            Kind::Catalogue(effect) => {
                for (parameter, value) in effect.info.parameters.iter().zip(&self.values) {
                    if *value != 0.0 || !parameter.is_amplitude() {
                        table.insert(parameter.name.to_owned(), (*value).into());
                    }
                }
            }
            Kind::Custom(custom) => {
                let channel = custom.channel.name().into_owned();
                table.insert("expression".to_owned(), custom.text.clone().into());
                table.insert("channel".to_owned(), channel.into());
                table.insert("unit".to_owned(), custom.unit.clone().into());
                table.insert("value".to_owned(), self.values[0].into());
                table.insert("low".to_owned(), custom.low.into());
                table.insert("high".to_owned(), custom.high.into());
            }
        }
        if let Some(track) = &self.track {
            table.insert("track".to_owned(), track.clone().into());
        }
        table
    }
}
