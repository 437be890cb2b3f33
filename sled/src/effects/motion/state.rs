//! What an effect sees of a sled and what it may change.

use crate::effects::motion::conditions::Conditions;

/// The sled at one instant, true as far as the effects on sensors have been taken out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Time, place, speed and weather; `fz` and `film` are set for each runner in turn.
    pub conditions: Conditions,
    /// Slip angle, front and rear [rad].
    pub slip: [f64; 2],
    /// Rate of the slip angle, front and rear [rad/s]; of the one that forces follow where an effect makes them follow it late.
    pub slip_rate: [f64; 2],
    /// Normal force, front and rear [N].
    pub load: [f64; 2],
    /// Friction of groove and film by the tables, front and rear, over each table's mean; NaN where a model names none.
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

/// The forces on the sled; effects change what the base law gave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forces {
    /// Along each runner, front and rear, negative when braking [N].
    pub along: [f64; 2],
    /// Across each runner, front and rear, positive to the left [N].
    pub across: [f64; 2],
    /// Slope of the lateral law over slip, front and rear [N/rad].
    pub stiffness: [f64; 2],
    /// Air and other forces on the body, forward [N].
    pub body_along: f64,
    /// Forces on the body at the centre of gravity, to the left [N].
    pub body_across: f64,
    /// Moment on the body about the vertical, positive to the left [N m].
    pub body_yaw: f64,
}
