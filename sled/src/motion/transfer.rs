//! From the places of the sensors to the centre of gravity and the axles.

use crate::model::sled::Sled;

/// Specific force at the centre of gravity [m/s2] from that at the accelerometer.
///
/// ```text
/// a_cog = a_sensor - dw/dt x r - w x (w x r)
/// ```
///
/// `rates` w [rad/s] and `accelerations` dw/dt [rad/s2] are (roll, pitch, yaw) about x forward, y left, z up; `r` [m] is
/// the accelerometer from the centre of gravity. Gravity enters both sides alike. The rigid-body matrix of the paper.
#[inline]
pub fn to_centre_of_gravity(
    sensor: [f64; 3],
    rates: [f64; 3],
    accelerations: [f64; 3],
    r: [f64; 3],
) -> [f64; 3] {
    let d = lever_acceleration(rates, accelerations, r);
    [sensor[0] - d[0], sensor[1] - d[1], sensor[2] - d[2]]
}

/// Acceleration of a point at `r` [m] beyond that of the centre of gravity [m/s2]: `dw/dt x r + w x (w x r)`.
#[inline]
pub fn lever_acceleration(rates: [f64; 3], accelerations: [f64; 3], r: [f64; 3]) -> [f64; 3] {
    let inner = cross(rates, r);
    let centripetal = cross(rates, inner);
    let tangential = cross(accelerations, r);
    [
        tangential[0] + centripetal[0],
        tangential[1] + centripetal[1],
        tangential[2] + centripetal[2],
    ]
}

#[inline]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Slip angles [rad] at the places that matter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slips {
    /// At the centre of gravity; the chassis slip angle is `beta = -cog`.
    pub cog: f64,
    /// At the front runner, steering included.
    pub front: f64,
    /// At the rear runner.
    pub rear: f64,
}

/// Slip angles at the centre of gravity and both runners from that at the slip sensor.
///
/// ```text
/// alpha_P = alpha - yaw_rate (x_P - x_s) / v,   alpha_f = alpha_{l_f} + delta,   alpha_r = alpha_{-l_r}
/// ```
///
/// `alpha` [rad], `yaw_rate` [rad/s], speed `v` [m/s] (positive), steering `delta` [rad].
#[inline]
pub fn slips(sled: &Sled, alpha: f64, yaw_rate: f64, v: f64, delta: f64) -> Slips {
    let turn = yaw_rate / v;
    let at = |x: f64| alpha - turn * (x - sled.slip_x_m);
    Slips {
        cog: at(0.0),
        front: at(sled.l_f_m) + delta,
        rear: at(-sled.l_r_m),
    }
}
