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

use std::borrow::Cow;

use crate::effects::expression::{Expression, ExpressionError};
use crate::effects::{Conditions, Forces, Sensor, Signals, State};

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
                true => place_of_sensor(name),
                false => place_of_sled(name, carried),
            };
            place.ok_or_else(|| Refused::UnknownColumn {
                column: name.clone(),
                known: match of_sensor {
                    true => columns_of_sensors(),
                    false => columns_of_forces(),
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

/// Where an effect of one's own acts.
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
        let names = Self::NAMED
            .map(|(name, _)| format!("\"{name}\""))
            .join(", ");
        format!("{names} or \"sensor:COLUMN\" with a column of {sensors}")
    }
}

/// What an expression on a sensor sees: the readings, corrected as far as they are, and time, place and weather.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    /// Time, place and weather.
    pub(super) conditions: &'a Conditions,
    /// The sensors.
    pub(super) signals: &'a Signals,
}

/// A column's name and where its value stands.
type NamedColumn<T> = (&'static str, fn(&T) -> f64);

/// Columns of a sled, for forces; the last one stands for a column that the model has no name for.
const OF_SLED: [NamedColumn<State>; 24] = [
    ("t_s", |at| at.conditions.t),
    ("s_m", |at| at.conditions.s),
    ("v_mps", |at| at.conditions.v),
    ("fz_n", |at| at.load[0] + at.load[1]),
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
    ("ice_c", |at| at.conditions.ice_c),
    ("air_c", |at| at.conditions.air_c),
    ("air_pa", |at| at.conditions.air_pa),
    ("humidity_pct", |at| at.conditions.humidity_pct),
    ("distance_m", |at| at.conditions.distance),
    ("", |at| at.carried),
];

/// Columns that a friction coefficient may depend on without a sled around it.
const OF_CONDITIONS: [NamedColumn<Conditions>; 9] = [
    ("t_s", |at| at.t),
    ("s_m", |at| at.s),
    ("v_mps", |at| at.v),
    ("fz_n", |at| at.fz),
    ("ice_c", |at| at.ice_c),
    ("air_c", |at| at.air_c),
    ("air_pa", |at| at.air_pa),
    ("humidity_pct", |at| at.humidity_pct),
    ("distance_m", |at| at.distance),
];

/// Whether expressions on forces may use a column of this name.
pub fn is_column(name: &str) -> bool {
    !name.is_empty() && OF_SLED.iter().any(|(known, _)| *known == name)
}

/// Names of the columns that expressions on forces may use.
pub fn columns_of_forces() -> Vec<&'static str> {
    let named = OF_SLED.iter().map(|(name, _)| *name);
    named.filter(|name| !name.is_empty()).collect()
}

/// Names of the columns that expressions on a sensor may use.
pub fn columns_of_sensors() -> Vec<&'static str> {
    let conditions = OF_CONDITIONS.iter().map(|(name, _)| *name);
    let own = conditions.filter(|name| Sensor::named(name).is_none() && *name != "fz_n");
    Sensor::ALL
        .into_iter()
        .map(Sensor::name)
        .chain(own)
        .collect()
}

/// Where the value of a name stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// Among the columns of a sled, by index; the same among those of the conditions alone, where it is one.
    Sled(usize, Option<usize>),
    /// A sensor.
    Sensor(Sensor),
    /// Among the columns of the conditions, by index.
    Condition(usize),
}

/// The place of a column for an expression on forces; a carried one stands in the last place.
pub(super) fn place_of_sled(name: &str, carried: Option<&str>) -> Option<Place> {
    let conditions = OF_CONDITIONS.iter().position(|(known, _)| *known == name);
    if carried == Some(name) {
        return Some(Place::Sled(OF_SLED.len() - 1, conditions));
    }
    let at = OF_SLED.iter().position(|(known, _)| *known == name)?;
    (!name.is_empty()).then_some(Place::Sled(at, conditions))
}

/// The place of a column for an expression on a sensor.
pub(super) fn place_of_sensor(name: &str) -> Option<Place> {
    if let Some(sensor) = Sensor::named(name) {
        return Some(Place::Sensor(sensor));
    }
    let at = OF_CONDITIONS.iter().position(|(known, _)| *known == name)?;
    (name != "fz_n").then_some(Place::Condition(at))
}

impl Place {
    /// The value on a sled; NaN for a place of a sensor.
    pub(super) fn on_sled(self, at: &State) -> f64 {
        match self {
            Place::Sled(index, _) => OF_SLED[index].1(at),
            _ => f64::NAN,
        }
    }

    /// The value where the conditions alone are known; NaN for everything else.
    pub(super) fn of_conditions(self, at: &Conditions) -> f64 {
        match self {
            Place::Sled(_, Some(index)) | Place::Condition(index) => OF_CONDITIONS[index].1(at),
            _ => f64::NAN,
        }
    }

    /// The value among the sensors; NaN for a place on the sled.
    pub(super) fn of_sensors(self, seen: Seen) -> f64 {
        match self {
            Place::Sensor(sensor) => seen.signals[sensor],
            Place::Condition(index) => OF_CONDITIONS[index].1(seen.conditions),
            Place::Sled(..) => f64::NAN,
        }
    }
}
