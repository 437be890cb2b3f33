//! The recorded channels of a sled at one instant, and the constants that go with them.

use crate::effects::motion::constants::Constants;

/// Number of recorded sensors.
pub const SENSORS: usize = 10;

/// A recorded channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// Specific force forward [m/s2].
    Ax,
    /// Specific force to the left [m/s2].
    Ay,
    /// Specific force up [m/s2].
    Az,
    /// Roll rate [rad/s].
    RollRate,
    /// Pitch rate [rad/s].
    PitchRate,
    /// Yaw rate [rad/s].
    YawRate,
    /// Speed [m/s].
    Speed,
    /// Slip angle [rad].
    Slip,
    /// Steering angle [rad].
    Steering,
    /// Roll-split angle [rad].
    RollSplit,
}

impl Sensor {
    /// All sensors, in the order of [`Signals`].
    pub const ALL: [Sensor; SENSORS] = [
        Sensor::Ax,
        Sensor::Ay,
        Sensor::Az,
        Sensor::RollRate,
        Sensor::PitchRate,
        Sensor::YawRate,
        Sensor::Speed,
        Sensor::Slip,
        Sensor::Steering,
        Sensor::RollSplit,
    ];

    /// The column's name in a run's file.
    pub fn name(self) -> &'static str {
        [
            "ax_mps2",
            "ay_mps2",
            "az_mps2",
            "roll_rate_radps",
            "pitch_rate_radps",
            "yaw_rate_radps",
            "v_mps",
            "alpha_rad",
            "delta_rad",
            "gamma_rad",
        ][self as usize]
    }

    /// The sensor of this column.
    pub fn named(name: &str) -> Option<Sensor> {
        Sensor::ALL.into_iter().find(|sensor| sensor.name() == name)
    }
}

/// What every sensor says, or what is true of it: the faults of sensors lie between the two.
///
/// Indexed by [`Sensor`]: `signals[Sensor::YawRate]` [rad/s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Signals {
    /// Values, in the order of [`Sensor::ALL`].
    pub value: [f64; SENSORS],
    /// Their derivatives by time [1/s], where they are known; 0 elsewhere.
    pub rate: [f64; SENSORS],
    /// The sled that carries the sensors.
    pub sled: Constants,
}

impl Signals {
    /// Derivative of a sensor's value by time.
    pub fn rate(&self, of: Sensor) -> f64 {
        self.rate[of as usize]
    }

    /// Sets a value and its derivative.
    pub fn set(&mut self, of: Sensor, value: f64, rate: f64) {
        self.value[of as usize] = value;
        self.rate[of as usize] = rate;
    }

    /// Specific force forward, left, up [m/s2].
    pub fn acceleration(&self) -> [f64; 3] {
        [self[Sensor::Ax], self[Sensor::Ay], self[Sensor::Az]]
    }

    /// Roll, pitch and yaw rate [rad/s].
    pub fn rates(&self) -> [f64; 3] {
        [
            self[Sensor::RollRate],
            self[Sensor::PitchRate],
            self[Sensor::YawRate],
        ]
    }

    /// Roll, pitch and yaw acceleration [rad/s2].
    pub fn angular_acceleration(&self) -> [f64; 3] {
        [
            self.rate(Sensor::RollRate),
            self.rate(Sensor::PitchRate),
            self.rate(Sensor::YawRate),
        ]
    }
}

impl std::ops::Index<Sensor> for Signals {
    type Output = f64;

    fn index(&self, of: Sensor) -> &f64 {
        &self.value[of as usize]
    }
}

impl std::ops::IndexMut<Sensor> for Signals {
    fn index_mut(&mut self, of: Sensor) -> &mut f64 {
        &mut self.value[of as usize]
    }
}
