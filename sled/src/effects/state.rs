//! State of a sled as effects see it, and the forces and signals that they may change.

use crate::column::{SENSORS, Sensor};
use crate::conditions::Conditions;
use crate::friction::film::Patch;
use crate::sled::Sled;

/// True state of the sled at one instant, i.e. without the active faults of sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Time, place, speed and weather; `fz` and `film` are set for each runner in turn.
    pub point: OperatingPoint,
    /// Slip angle, front and rear [rad].
    pub slip: [f64; 2],
    /// Rate of the slip angle, front and rear [rad/s]; if an effect delays the forces, the rate of
    /// the delayed slip.
    pub slip_rate: [f64; 2],
    /// Normal force, front and rear [N].
    pub load: [f64; 2],
    /// Ratio of the friction of groove and film, read from the table, to the mean of the table,
    /// front and rear; NaN without a table.
    pub film: [f64; 2],
    /// Chassis slip at the centre of gravity [rad].
    pub chassis_slip: f64,
    /// Steering angle [rad].
    pub steering: f64,
    /// Roll-split angle [rad].
    pub roll_split: f64,
    /// Roll rate [rad/s].
    pub roll_rate: f64,
    /// Roll acceleration [rad/s2].
    pub roll_acceleration: f64,
    /// Pitch rate [rad/s].
    pub pitch_rate: f64,
    /// Yaw rate [rad/s].
    pub yaw_rate: f64,
    /// Specific force at the centre of gravity [m/s2].
    pub acceleration: [f64; 3],
    /// Mass [kg].
    pub mass: f64,
    /// A further recorded column, for the expression that names it.
    pub carried: f64,
}

/// The forces on the sled: those of the base law, as changed by effects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forces {
    /// Along each runner, front and rear, negative when braking [N].
    pub along: [f64; 2],
    /// Across each runner, front and rear, positive to the left [N].
    pub across: [f64; 2],
    /// Derivative of the lateral law with respect to slip, front and rear [N/rad].
    pub stiffness: [f64; 2],
    /// Air and other forces on the body, forward [N].
    pub body_along: f64,
    /// Forces on the body at the centre of gravity, to the left [N].
    pub body_across: f64,
    /// Moment on the body about the vertical, positive to the left [N m].
    pub body_yaw: f64,
}

/// Quantities that a friction coefficient may depend on; NaN for an unknown quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OperatingPoint {
    /// Time since the start of the run [s].
    pub t: f64,
    /// Distance along the track [m].
    pub s: f64,
    /// Speed [m/s].
    pub v: f64,
    /// Normal force of the runner, or of the whole sled in a gliding run [N].
    pub fz: f64,
    /// Ice, air and finish of the runners.
    pub conditions: Conditions,
    /// Air density [kg/m3].
    pub air_density: f64,
    /// Drag area of the base model [m2].
    pub drag_area: f64,
    /// Ratio of the friction of groove and film, read from the runner's table, to the mean of the
    /// table.
    pub film: f64,
    /// The contact of a friction experiment.
    pub patch: Patch,
}

/// Readings of all sensors, or the true values; faults of sensors convert between the two.
///
/// Indexed by [`Sensor`]: `signals[Sensor::YawRate]` [rad/s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Signals {
    /// Values, in the order of [`Sensor::ALL`].
    pub value: [f64; SENSORS],
    /// Time derivatives of the values [1/s]; 0 where unknown.
    pub rate: [f64; SENSORS],
    /// The sled that carries the sensors.
    pub sled: Sled,
}

impl Signals {
    /// Time derivative of the value of sensor `of`.
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
        Sensor::ACCELEROMETER.map(|axis| self[axis])
    }

    /// Roll, pitch and yaw rate [rad/s].
    pub fn rates(&self) -> [f64; 3] {
        Sensor::GYROSCOPE.map(|axis| self[axis])
    }

    /// Roll, pitch and yaw acceleration [rad/s2].
    pub fn angular_acceleration(&self) -> [f64; 3] {
        Sensor::GYROSCOPE.map(|axis| self.rate(axis))
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
