//! Effects that a person adds in `model.toml`, as expressions of columns.
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

use std::borrow::Cow;

use crate::column::Sensor;
use crate::effects::expression::Expression;
use crate::effects::{EffectError, Forces, OperatingPoint, Signals, State};

/// An effect that a person adds: amplitude times expression.
#[derive(Clone, Debug)]
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
    /// A recorded column that the formula names and the model does not know: [`State::carried`]
    /// contains its values.
    pub carried: Option<String>,
    expression: Expression,
    /// Where the values of the formula's names are.
    places: Vec<Place>,
}

impl Custom {
    /// An effect of the formula `text` on a channel, without unit and bounds; `carried` names a
    /// column that the model does not have.
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
        Self::read("", channel, text, carried).ok()
    }

    /// The same; `effect` names it in errors.
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
        let known = if of_sensor {
            columns_of_sensors()
        } else {
            columns_of_forces()
        };
        let place = |column: &String| {
            let of_sled = || Place::of_sled(column, carried);
            let place = if of_sensor {
                Place::of_sensor(column)
            } else {
                of_sled()
            };
            place.ok_or_else(|| EffectError::Value {
                name: effect.to_owned(),
                key: "expression".to_owned(),
                found: format!("the column {column}"),
                expected: known.join(", "),
            })
        };
        let places = expression.names().iter().map(place);
        Ok(Self {
            channel,
            text: text.to_owned(),
            unit: String::new(),
            low: -1e12,
            high: 1e12,
            carried: carried.map(str::to_owned),
            places: places.collect::<Result<_, _>>()?,
            expression,
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

    /// Whether it acts on the reading of a sensor.
    pub fn is_of_a_sensor(&self) -> bool {
        matches!(self.channel, Channel::Sensor(_))
    }

    /// What an amplitude adds to the friction coefficient of a specimen, of which only the
    /// operating point is known; NaN where the expression needs more, 0 on channels other than
    /// friction.
    pub fn coefficient(&self, amplitude: f64, at: &OperatingPoint) -> f64 {
        if self.channel != Channel::Friction {
            return 0.0;
        }
        amplitude * self.value(at, None)
    }

    /// The expression's value; NaN where it needs what is not known.
    fn value(&self, point: &OperatingPoint, state: Option<&State>) -> f64 {
        self.expression.evaluate(|name| match self.places[name] {
            Place::Point(value) => value(point),
            Place::Sled(value) => state.map_or(f64::NAN, value),
            Place::Sensor(_) => f64::NAN,
            Place::Carried => state.map_or(f64::NAN, |state| state.carried),
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
        let of_itself = |place: &Place| matches!(place, Place::Sensor(own) if *own == sensor);
        if !self.places.iter().any(of_itself) {
            return self.disturb(-amplitude, at, signals);
        }
        let place = sensor as usize;
        let read = signals.value[place];
        let mut slope = 1.0;
        for _ in 0..30 {
            let x = signals.value[place];
            let [value, by_itself] = self.derivative(at, signals, |place| match place {
                Place::Sensor(own) if own == sensor => 1.0,
                _ => 0.0,
            });
            let off = x + amplitude * value - read;
            slope = 1.0 + amplitude * by_itself;
            // Nearer than this the difference is one of two roundings.
            let near = off.abs() <= 4.0 * f64::EPSILON * (x.abs() + read.abs());
            if near || !slope.is_finite() || slope == 0.0 {
                break;
            }
            signals.value[place] = x - off / slope;
        }
        // The reading's rate is that of the truth and of what is added, which is linear in it.
        let rates = signals.rate;
        let mut without = rates;
        without[place] = 0.0;
        let [_, added] = self.in_time(at, signals, without);
        signals.rate[place] = (rates[place] - amplitude * added) / slope;
    }

    fn sensor(&self, amplitude: f64) -> Option<Sensor> {
        match self.channel {
            Channel::Sensor(sensor) if amplitude != 0.0 => Some(sensor),
            _ => None,
        }
    }

    /// The expression's value and its derivative by time [1/s], along these rates of the signals.
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
        self.derivative(at, signals, |place| match place {
            // Time and distance grow steadily.
            Place::Point(value) => value(&later) - value(at),
            Place::Sensor(sensor) => rates[sensor as usize],
            Place::Sled(_) | Place::Carried => 0.0,
        })
    }

    /// The expression's value and its derivative where its names change at these rates.
    fn derivative(
        &self,
        at: &OperatingPoint,
        signals: &Signals,
        rate: impl Fn(Place) -> f64,
    ) -> [f64; 2] {
        self.expression.derivative(|name| {
            let place = self.places[name];
            let value = match place {
                Place::Point(value) => value(at),
                Place::Sensor(sensor) => signals[sensor],
                Place::Sled(_) | Place::Carried => f64::NAN,
            };
            [value, rate(place)]
        })
    }
}

/// Where an effect that a person adds acts.
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
    /// Added to what this sensor reads, in the unit of its column.
    Sensor(Sensor),
}

impl Channel {
    /// The channels that are no sensor's, by the names that a model gives them.
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

    /// The names that a model may give, in words.
    pub(super) fn expected() -> String {
        let sensors = Sensor::ALL.map(Sensor::name).join(", ");
        let names = Self::NAMED.map(|(name, _)| format!("\"{name}\""));
        let names = names.join(", ");
        format!("{names} or \"sensor:COLUMN\" with a column of {sensors}")
    }
}

/// A column's name and its value.
type NamedColumn<T> = (&'static str, fn(&T) -> f64);

/// Columns that a friction coefficient may depend on without a sled around it.
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

/// Further columns, of a sled.
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
    let own = |name: &&str| Sensor::named(name).is_none() && *name != "fz_n";
    let further = names(&OF_POINT).into_iter().filter(own);
    let sensors = Sensor::ALL.map(Sensor::name).into_iter();
    sensors.chain(further).collect()
}

fn names<T>(columns: &[NamedColumn<T>]) -> Vec<&'static str> {
    columns.iter().map(|(name, _)| *name).collect()
}

/// Whether expressions on forces may use a column of this name.
pub fn is_column(name: &str) -> bool {
    Place::of_sled(name, None).is_some()
}

/// Where the value of a name is found.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// Among [`OF_POINT`].
    Point(fn(&OperatingPoint) -> f64),
    /// Among [`OF_SLED`].
    Sled(fn(&State) -> f64),
    /// A sensor.
    Sensor(Sensor),
    /// A column that the model does not have.
    Carried,
}

impl Place {
    /// The place of a column for an expression on forces.
    fn of_sled(name: &str, carried: Option<&str>) -> Option<Place> {
        if carried == Some(name) {
            return Some(Place::Carried);
        }
        let sled = value_of(&OF_SLED, name).map(Place::Sled);
        sled.or_else(|| value_of(&OF_POINT, name).map(Place::Point))
    }

    /// The place of a column for an expression on a sensor.
    fn of_sensor(name: &str) -> Option<Place> {
        let own = Sensor::named(name).map(Place::Sensor);
        let point = value_of(&OF_POINT, name).filter(|_| name != "fz_n");
        own.or(point.map(Place::Point))
    }
}

fn value_of<T>(columns: &[NamedColumn<T>], name: &str) -> Option<fn(&T) -> f64> {
    let known = columns.iter().find(|(known, _)| *known == name);
    known.map(|(_, value)| *value)
}
