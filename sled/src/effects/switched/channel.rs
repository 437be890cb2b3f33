//! Where an effect of one's own acts.

use std::borrow::Cow;

use crate::effects::motion::Sensor;

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
