//! Effects that a person adds in `model.toml`, as an expression of columns.
//!
//! ```toml
//! [effects.my-drag]
//! expression = "v_mps^2 * abs(delta_rad)"   # times `value`
//! channel = "longitudinal"                  # or "lateral" (force on the body [N]), "yaw" (moment [N m]), "friction" (added to mu),
//!                                           # "grip" (times the side forces), "sensor:COLUMN" (added to what it reads)
//! unit = "N s2/(m2 rad)"
//! value = 0.0                               # 0 or absent: a candidate, not yet switched on
//! low = -10.0
//! high = 10.0
//! ```

use crate::effects::expression::{Expression, ExpressionError};
use crate::effects::motion::{Conditions, Forces, Sensor, Signals, State};
use crate::effects::switched::channel::Channel;
use crate::effects::switched::columns::{self, Place, Seen};

/// An effect of one's own: amplitude times expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Custom {
    /// What it acts on.
    pub channel: Channel,
    /// The formula as it was written.
    pub text: String,
    /// Unit of the amplitude.
    pub unit: String,
    /// Smallest admissible amplitude.
    pub low: f64,
    /// Largest admissible amplitude.
    pub high: f64,
    /// A recorded column that the formula names and the model does not know: [`State::carried`] holds its values.
    pub carried: Option<String>,
    expression: Expression,
    /// Where the names of the formula stand.
    places: Vec<Place>,
}

/// Why a formula is none for its channel.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Refused {
    /// It cannot be read.
    Unreadable(ExpressionError),
    /// It names a column that its channel does not have.
    UnknownColumn {
        /// The name.
        column: String,
        /// The names that it may use.
        known: Vec<&'static str>,
    },
}

/// Time over which the rate of an expression is taken [s].
const MOMENT_S: f64 = 1e-3;

impl Custom {
    /// An effect of the formula `text` on a channel, without unit and bounds; `carried` names a column beyond the model's.
    ///
    /// `None` where the formula cannot be read or names a column that the channel does not have.
    ///
    /// ```
    /// use kufe_sled::effects::{Channel, Custom, Forces, State};
    /// let drag = Custom::new(Channel::Yaw, "2 * delta_rad", None).unwrap();
    /// let mut forces = Forces::default();
    /// drag.act(10.0, &State { steering: 0.05, ..State::default() }, &mut forces);
    /// assert_eq!(forces.body_yaw, 1.0);
    /// ```
    pub fn new(channel: Channel, text: &str, carried: Option<&str>) -> Option<Self> {
        Self::read(channel, text, carried).ok()
    }

    pub(super) fn read(
        channel: Channel,
        text: &str,
        carried: Option<&str>,
    ) -> Result<Self, Refused> {
        let expression = Expression::parse(text).map_err(Refused::Unreadable)?;
        let of_sensor = matches!(channel, Channel::Sensor(_));
        let place = |name: &String| {
            let place = match of_sensor {
                true => columns::place_of_sensor(name),
                false => columns::place_of_sled(name, carried),
            };
            place.ok_or_else(|| Refused::UnknownColumn {
                column: name.clone(),
                known: match of_sensor {
                    true => columns::columns_of_sensors(),
                    false => columns::columns_of_forces(),
                },
            })
        };
        let places = expression
            .names()
            .iter()
            .map(place)
            .collect::<Result<_, _>>()?;
        Ok(Self {
            channel,
            text: text.to_owned(),
            unit: String::new(),
            low: -1e12,
            high: 1e12,
            carried: carried.map(str::to_owned),
            expression,
            places,
        })
    }

    /// The same with the unit of its amplitude and the amplitude's bounds.
    pub fn bounded(self, unit: &str, low: f64, high: f64) -> Self {
        Self {
            unit: unit.to_owned(),
            low,
            high,
            ..self
        }
    }

    /// The columns that the formula names, each once.
    pub fn names(&self) -> &[String] {
        self.expression.names()
    }

    /// Whether it acts on friction coefficients.
    pub fn acts_on_friction(&self) -> bool {
        self.channel == Channel::Friction
    }

    /// Whether it acts on what a sensor reads.
    pub fn is_of_a_sensor(&self) -> bool {
        matches!(self.channel, Channel::Sensor(_))
    }

    /// What an amplitude adds to the friction coefficient of a specimen, whose conditions alone are known; NaN where the
    /// expression asks for more, 0 on channels other than friction.
    pub fn coefficient(&self, amplitude: f64, at: &Conditions) -> f64 {
        match self.channel {
            Channel::Friction => {
                let value = |name: usize| self.places[name].of_conditions(at);
                amplitude * self.expression.evaluate(value)
            }
            _ => 0.0,
        }
    }

    /// Changes the forces.
    pub fn act(&self, amplitude: f64, at: &State, forces: &mut Forces) {
        if amplitude == 0.0 || matches!(self.channel, Channel::Sensor(_)) {
            return;
        }
        let name = |name: usize| self.places[name].on_sled(at);
        let value = amplitude * self.expression.evaluate(name);
        match self.channel {
            Channel::Longitudinal => forces.body_along += value,
            Channel::Lateral => forces.body_across += value,
            Channel::Yaw => forces.body_yaw += value,
            Channel::Friction => {
                for runner in 0..2 {
                    forces.along[runner] -= value * at.load[runner].max(0.0);
                }
            }
            Channel::Grip => {
                for across in &mut forces.across {
                    *across *= 1.0 + value;
                }
            }
            Channel::Sensor(_) => {}
        }
    }

    /// From what is true to what its sensor says: `read = true + amplitude * expression(true)`.
    pub fn disturb(&self, amplitude: f64, at: &Conditions, signals: &mut Signals) {
        if let Some(sensor) = self.sensor(amplitude) {
            let [value, rate] = self.added(at, signals);
            signals.value[sensor as usize] += amplitude * value;
            signals.rate[sensor as usize] += amplitude * rate;
        }
    }

    /// From what its sensor says to what is true: the inverse of [`Custom::disturb`].
    ///
    /// An expression of the sensor itself asks for the root of `true + amplitude * expression(true) - read`, which secants find.
    pub fn correct(&self, amplitude: f64, at: &Conditions, signals: &mut Signals) {
        let Some(sensor) = self.sensor(amplitude) else {
            return;
        };
        let place = sensor as usize;
        let (read, read_rate) = (signals.value[place], signals.rate[place]);
        let off = |x: f64, signals: &mut Signals| {
            signals.value[place] = x;
            x + amplitude * self.at_signals(at, signals) - read
        };
        if !self.places.contains(&Place::Sensor(sensor)) {
            let [value, rate] = self.added(at, signals);
            signals.value[place] -= amplitude * value;
            signals.rate[place] -= amplitude * rate;
            return;
        }
        let (mut x0, mut f0) = (read, off(read, signals));
        let mut x1 = read - f0;
        for _ in 0..30 {
            let f1 = off(x1, signals);
            let slope = (f1 - f0) / (x1 - x0);
            // Nearer than this the difference of two roundings is no slope.
            let near = f1.abs() <= 4.0 * f64::EPSILON * (x1.abs() + read.abs());
            if near || !slope.is_finite() || slope == 0.0 {
                break;
            }
            (x0, f0) = (x1, f1);
            x1 -= f1 / slope;
        }
        signals.value[place] = x1;
        // The reading's rate is that of the truth but for what is added, which is linear in that rate.
        signals.rate[place] = 0.0;
        let without = self.rate(at, signals);
        signals.rate[place] = 1.0;
        let with = self.rate(at, signals);
        let slope = 1.0 + amplitude * (with - without);
        signals.rate[place] = (read_rate - amplitude * without) / slope;
    }

    fn sensor(&self, amplitude: f64) -> Option<Sensor> {
        match self.channel {
            Channel::Sensor(sensor) if amplitude != 0.0 => Some(sensor),
            _ => None,
        }
    }

    fn at_signals(&self, conditions: &Conditions, signals: &Signals) -> f64 {
        let seen = Seen {
            conditions,
            signals,
        };
        self.expression
            .evaluate(|name| self.places[name].of_sensors(seen))
    }

    /// The expression and its derivative by time [1/s].
    fn added(&self, at: &Conditions, signals: &Signals) -> [f64; 2] {
        [self.at_signals(at, signals), self.rate(at, signals)]
    }

    /// The expression's derivative by time [1/s], along the rates of the signals.
    fn rate(&self, at: &Conditions, signals: &Signals) -> f64 {
        let moved = |by: f64| {
            let (mut then, mut there) = (*signals, *at);
            there.t += by;
            there.s += by * signals[Sensor::Speed];
            for (value, rate) in then.value.iter_mut().zip(signals.rate) {
                *value += by * rate;
            }
            self.at_signals(&there, &then)
        };
        (moved(MOMENT_S) - moved(-MOMENT_S)) / (2.0 * MOMENT_S)
    }
}
