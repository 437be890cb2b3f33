//! The columns that an expression may use: name and where its value stands, looked up once.

use crate::effects::motion::{Conditions, Sensor, Signals, State};

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
