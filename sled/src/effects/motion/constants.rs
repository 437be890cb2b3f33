//! The constants of a sled that an effect may find to be others than stated.

/// Mass, inertia and places of a sled, in vehicle axes (x forward, y left, z up, from the centre of gravity).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Constants {
    /// Mass with crew [kg].
    pub mass: f64,
    /// Pitch moment of inertia [kg m2].
    pub pitch_inertia: f64,
    /// Yaw moment of inertia [kg m2].
    pub yaw_inertia: f64,
    /// Front axle before the centre of gravity, rear axle behind it [m].
    pub axles: [f64; 2],
    /// Accelerometer [m].
    pub accelerometer: [f64; 3],
    /// Slip sensor, forward [m].
    pub slip_sensor: f64,
}
