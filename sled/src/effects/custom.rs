//! User-defined effects of `model.toml`: expressions of columns.
//!
//! ```toml
//! [effects.my-drag]
//! expression = "v_mps^2 * abs(delta_rad)"   # times `value`
//! channel = "longitudinal"                  # or "lateral" (force on the body [N]), "yaw" (moment [N m]), "friction" (added to mu),
//!                                           # "grip" (times the side forces), "sensor:COLUMN" (added to its reading)
//! unit = "N s2/(m2 rad)"
//! value = 0.0                               # 0 or absent: a candidate, not yet switched on
//! low = -10.0
//! high = 10.0
//! ```

use std::borrow::Cow;

use crate::column::Sensor;
use crate::effects::expression::Expression;
use crate::effects::{EffectError, Forces, OperatingPoint, Signals, State};

/// A user-defined effect: amplitude times expression.
#[derive(Clone, Debug)]
pub struct Custom {
    /// Quantity that it acts on.
    pub channel: Channel,
    /// The formula as written.
    pub text: String,
    /// Unit of the amplitude.
    pub unit: String,
    /// Smallest admissible amplitude.
    pub low: f64,
    /// Largest admissible amplitude.
    pub high: f64,
    /// A recorded column of the formula that is not a quantity of the model: [`State::carried`]
    /// contains its values.
    pub carried: Option<String>,
    expression: Expression,
    /// Source of each name's value, in the order of [`Custom::names`].
    sources: Vec<Source>,
}

impl Custom {
    /// An effect of the formula `text` on a channel, without unit and bounds; `carried` is a
    /// recorded column that is not a quantity of the model.
    ///
    /// `None` if the formula cannot be read or names a column that the channel does not have.
    ///
    /// ```
    /// use kufe_sled::effects::{Channel, Custom, Forces, State};
    /// let drag = Custom::new(Channel::Yaw, "2 * delta_rad", None).unwrap();
    /// let mut forces = Forces::default();
    /// drag.act(10.0, &State { steering: 0.05, ..State::default() }, &mut forces);
    /// assert_eq!(forces.body_yaw, 1.0);
    /// ```
    pub fn new(channel: Channel, text: &str, carried: Option<&str>) -> Option<Self> {
        Self::read("", channel, text, carried).ok()
    }

    /// As [`Custom::new`]; `effect` is the name in errors.
    pub(super) fn read(
        effect: &str,
        channel: Channel,
        text: &str,
        carried: Option<&str>,
    ) -> Result<Self, EffectError> {
        let expression = Expression::parse(text).map_err(|source| EffectError::Expression {
            name: effect.to_owned(),
            source,
        })?;
        let of_sensor = matches!(channel, Channel::Sensor(_));
        let allowed = if of_sensor {
            columns_of_sensors()
        } else {
            columns_of_forces()
        };
        let source = |column: &String| {
            let of_sled = || Source::of_sled(column, carried);
            let source = if of_sensor {
                Source::of_sensor(column)
            } else {
                of_sled()
            };
            source.ok_or_else(|| EffectError::Value {
                name: effect.to_owned(),
                key: "expression".to_owned(),
                found: format!("the column {column}"),
                expected: allowed.join(", "),
            })
        };
        let sources = expression.names().iter().map(source);
        Ok(Self {
            channel,
            text: text.to_owned(),
            unit: String::new(),
            low: -1e12,
            high: 1e12,
            carried: carried.map(str::to_owned),
            sources: sources.collect::<Result<_, _>>()?,
            expression,
        })
    }

    /// Sets unit and bounds of the amplitude.
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

    /// Whether it acts on the reading of a sensor.
    pub fn is_of_a_sensor(&self) -> bool {
        matches!(self.channel, Channel::Sensor(_))
    }

    /// Change of the friction coefficient of a specimen at an operating point. NaN if the
    /// expression needs a quantity of a sled; 0 for channels other than friction.
    pub fn coefficient(&self, amplitude: f64, at: &OperatingPoint) -> f64 {
        if self.channel != Channel::Friction {
            return 0.0;
        }
        amplitude * self.value(at, None)
    }

    /// Value of the expression; NaN if it needs an unknown quantity.
    fn value(&self, point: &OperatingPoint, state: Option<&State>) -> f64 {
        self.expression.evaluate(|name| match self.sources[name] {
            Source::Point(value) => value(point),
            Source::Sled(value) => state.map_or(f64::NAN, value),
            Source::Sensor(_) => f64::NAN,
            Source::Carried => state.map_or(f64::NAN, |state| state.carried),
        })
    }

    /// Changes the forces.
    pub fn act(&self, amplitude: f64, at: &State, forces: &mut Forces) {
        if amplitude == 0.0 || self.is_of_a_sensor() {
            return;
        }
        let point = OperatingPoint {
            fz: at.load[0] + at.load[1],
            ..at.point
        };
        let value = amplitude * self.value(&point, Some(at));
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

    /// From true values to readings: `read = true + amplitude * expression(true)`.
    pub fn disturb(&self, amplitude: f64, at: &OperatingPoint, signals: &mut Signals) {
        if let Some(sensor) = self.sensor(amplitude) {
            let [value, rate] = self.in_time(at, signals, signals.rate);
            signals.value[sensor as usize] += amplitude * value;
            signals.rate[sensor as usize] += amplitude * rate;
        }
    }

    /// From readings to true values: the inverse of [`Custom::disturb`].
    ///
    /// An expression of the sensor itself needs the root of
    /// `true + amplitude * expression(true) - read`, which Newton's method finds.
    pub fn correct(&self, amplitude: f64, at: &OperatingPoint, signals: &mut Signals) {
        let Some(sensor) = self.sensor(amplitude) else {
            return;
        };
        let is_own = |source: &Source| matches!(source, Source::Sensor(other) if *other == sensor);
        if !self.sources.iter().any(is_own) {
            return self.disturb(-amplitude, at, signals);
        }
        let index = sensor as usize;
        let read = signals.value[index];
        let mut slope = 1.0;
        for _ in 0..30 {
            let x = signals.value[index];
            let [value, derivative] = self.derivative(at, signals, |source| match source {
                Source::Sensor(other) if other == sensor => 1.0,
                _ => 0.0,
            });
            let residual = x + amplitude * value - read;
            slope = 1.0 + amplitude * derivative;
            // A smaller residual is rounding.
            let converged = residual.abs() <= 4.0 * f64::EPSILON * (x.abs() + read.abs());
            if converged || !slope.is_finite() || slope == 0.0 {
                break;
            }
            signals.value[index] = x - residual / slope;
        }
        // The rate of the reading is the rate of the true value plus that of the expression, which
        // is linear in it.
        let rates = signals.rate;
        let mut other_rates = rates;
        other_rates[index] = 0.0;
        let [_, added] = self.in_time(at, signals, other_rates);
        signals.rate[index] = (rates[index] - amplitude * added) / slope;
    }

    fn sensor(&self, amplitude: f64) -> Option<Sensor> {
        match self.channel {
            Channel::Sensor(sensor) if amplitude != 0.0 => Some(sensor),
            _ => None,
        }
    }

    /// Value of the expression and its time derivative [1/s] for the given rates of the signals.
    fn in_time(
        &self,
        at: &OperatingPoint,
        signals: &Signals,
        rates: [f64; Sensor::ALL.len()],
    ) -> [f64; 2] {
        let later = OperatingPoint {
            t: at.t + 1.0,
            s: at.s + signals[Sensor::Speed],
            ..*at
        };
        self.derivative(at, signals, |source| match source {
            // Time and distance grow steadily.
            Source::Point(value) => value(&later) - value(at),
            Source::Sensor(sensor) => rates[sensor as usize],
            Source::Sled(_) | Source::Carried => 0.0,
        })
    }

    /// Value of the expression and its derivative for the given rates of its names.
    fn derivative(
        &self,
        at: &OperatingPoint,
        signals: &Signals,
        rate: impl Fn(Source) -> f64,
    ) -> [f64; 2] {
        self.expression.derivative(|name| {
            let source = self.sources[name];
            let value = match source {
                Source::Point(value) => value(at),
                Source::Sensor(sensor) => signals[sensor],
                Source::Sled(_) | Source::Carried => f64::NAN,
            };
            [value, rate(source)]
        })
    }
}

/// Quantity on which a user-defined effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Force on the body, forward [N].
    Longitudinal,
    /// Force on the body at the centre of gravity, to the left [N].
    Lateral,
    /// Moment on the body about the vertical, positive to the left [N m].
    Yaw,
    /// Added to the friction coefficient of both runners.
    Friction,
    /// The side forces of both runners are multiplied by 1 + value * expression.
    Grip,
    /// Added to the reading of this sensor, in the unit of its column.
    Sensor(Sensor),
}

impl Channel {
    /// Channels other than sensors, by their names in a model.
    pub const NAMED: [(&'static str, Channel); 5] = [
        ("longitudinal", Channel::Longitudinal),
        ("lateral", Channel::Lateral),
        ("yaw", Channel::Yaw),
        ("friction", Channel::Friction),
        ("grip", Channel::Grip),
    ];

    /// Its name in a model: `sensor:COLUMN` for a sensor.
    pub fn name(self) -> Cow<'static, str> {
        if let Channel::Sensor(sensor) = self {
            return format!("sensor:{}", sensor.name()).into();
        }
        let known = Self::NAMED.iter().find(|(_, channel)| *channel == self);
        known.map_or("", |(name, _)| name).into()
    }

    /// The channel of this name.
    pub fn named(name: &str) -> Option<Self> {
        if let Some(column) = name.strip_prefix("sensor:") {
            return Sensor::named(column).map(Channel::Sensor);
        }
        let known = Self::NAMED.iter().find(|(known, _)| *known == name);
        known.map(|(_, channel)| *channel)
    }

    /// List of the valid names, for errors.
    pub(super) fn expected() -> String {
        let sensors = Sensor::ALL.map(Sensor::name).join(", ");
        let names = Self::NAMED.map(|(name, _)| format!("\"{name}\""));
        let names = names.join(", ");
        format!("{names} or \"sensor:COLUMN\" with a column of {sensors}")
    }
}

/// A column's name and its value.
type NamedColumn<T> = (&'static str, fn(&T) -> f64);

/// Columns of an operating point, which friction experiments have too.
const OF_POINT: [NamedColumn<OperatingPoint>; 9] = [
    ("t_s", |at| at.t),
    ("s_m", |at| at.s),
    ("v_mps", |at| at.v),
    ("fz_n", |at| at.fz),
    ("ice_c", |at| at.conditions.ice_c),
    ("air_c", |at| at.conditions.air_c),
    ("air_pa", |at| at.conditions.air_pa),
    ("humidity_pct", |at| at.conditions.humidity_pct),
    ("distance_m", |at| at.conditions.distance_m),
];

/// Columns of a sled.
const OF_SLED: [NamedColumn<State>; 14] = [
    ("fz_f_n", |at| at.load[0]),
    ("fz_r_n", |at| at.load[1]),
    ("alpha_rad", |at| at.chassis_slip),
    ("alpha_f_rad", |at| at.slip[0]),
    ("alpha_r_rad", |at| at.slip[1]),
    ("delta_rad", |at| at.steering),
    ("gamma_rad", |at| at.roll_split),
    ("roll_rate_radps", |at| at.roll_rate),
    ("roll_acceleration_radps2", |at| at.roll_acceleration),
    ("pitch_rate_radps", |at| at.pitch_rate),
    ("yaw_rate_radps", |at| at.yaw_rate),
    ("ax_mps2", |at| at.acceleration[0]),
    ("ay_mps2", |at| at.acceleration[1]),
    ("az_mps2", |at| at.acceleration[2]),
];

/// Names of the columns that expressions on forces may use.
pub fn columns_of_forces() -> Vec<&'static str> {
    let [point, sled] = [names(&OF_POINT), names(&OF_SLED)];
    // Time, place, speed and load come first, the weather last.
    let (motion, weather) = point.split_at(4);
    [motion, &sled, weather].concat()
}

/// Names of the columns that expressions on a sensor may use.
pub fn columns_of_sensors() -> Vec<&'static str> {
    let is_allowed = |name: &&str| Sensor::named(name).is_none() && *name != "fz_n";
    let further = names(&OF_POINT).into_iter().filter(is_allowed);
    let sensors = Sensor::ALL.map(Sensor::name).into_iter();
    sensors.chain(further).collect()
}

fn names<T>(columns: &[NamedColumn<T>]) -> Vec<&'static str> {
    columns.iter().map(|(name, _)| *name).collect()
}

/// Whether expressions on forces may use a column of this name.
pub fn is_column(name: &str) -> bool {
    Source::of_sled(name, None).is_some()
}

/// Source of the value of a name.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// Among [`OF_POINT`].
    Point(fn(&OperatingPoint) -> f64),
    /// Among [`OF_SLED`].
    Sled(fn(&State) -> f64),
    /// A sensor.
    Sensor(Sensor),
    /// The column `carried`.
    Carried,
}

impl Source {
    /// Source of a column's value in an expression on forces.
    fn of_sled(name: &str, carried: Option<&str>) -> Option<Source> {
        if carried == Some(name) {
            return Some(Source::Carried);
        }
        let sled = value_of(&OF_SLED, name).map(Source::Sled);
        sled.or_else(|| value_of(&OF_POINT, name).map(Source::Point))
    }

    /// Source of a column's value in an expression on a sensor.
    fn of_sensor(name: &str) -> Option<Source> {
        let sensor = Sensor::named(name).map(Source::Sensor);
        let point = value_of(&OF_POINT, name).filter(|_| name != "fz_n");
        sensor.or(point.map(Source::Point))
    }
}

fn value_of<T>(columns: &[NamedColumn<T>], name: &str) -> Option<fn(&T) -> f64> {
    let known = columns.iter().find(|(known, _)| *known == name);
    known.map(|(_, value)| *value)
}
