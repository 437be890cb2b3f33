//! Motion of the sled: from the accelerometer's place to the centre of gravity, slips and loads of
//! the axles.

use nalgebra::Vector3;

use crate::column::Sensor;
use crate::conditions::Conditions;
use crate::effects::{OperatingPoint, Relaxed, Signals};
use crate::friction::film::Patch;
use crate::sled::Sled;

/// One instant of a sled, measured or simulated: the quantities that friction and air depend on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Time [s].
    pub t_s: f64,
    /// Distance along the track [m].
    pub s_m: f64,
    /// Speed [m/s].
    pub v_mps: f64,
    /// Slip angle at the centre of gravity [rad]; the chassis slip angle is its negative.
    pub alpha_cog_rad: f64,
    /// Slip angle at the front runner, steering included [rad].
    pub alpha_f_rad: f64,
    /// Slip angle at the rear runner [rad].
    pub alpha_r_rad: f64,
    /// Steering angle, positive to the left [rad].
    pub delta_rad: f64,
    /// Roll-split angle of the front part about +x [rad].
    pub gamma_rad: f64,
    /// Roll rate [rad/s].
    pub roll_rate_radps: f64,
    /// Pitch rate [rad/s].
    pub pitch_rate_radps: f64,
    /// Yaw rate [rad/s].
    pub yaw_rate_radps: f64,
    /// Roll acceleration [rad/s2].
    pub roll_accel_radps2: f64,
    /// Curvature of the track in the vertical plane, `-pitch_rate / v` [1/m].
    pub curvature_1pm: f64,
    /// Normal force at the front axle in the body frame [N].
    pub fz_f0_n: f64,
    /// Normal force at the rear runner [N].
    pub fz_r_n: f64,
    /// Air density [kg/m3].
    pub air_density_kgpm3: f64,
    /// Ice, air and finish of the runners; NaN for a quantity that is not stated.
    pub conditions: Conditions,
    /// Rates of the slip angles, or of the relaxed slip angles, front and rear [rad/s]; only
    /// effects need them.
    pub slip_rate_radps: [f64; 2],
    /// Specific force at the centre of gravity [m/s2]; only effects need it.
    pub accel_mps2: [f64; 3],
}

impl State {
    /// Rates of the relaxed slips [rad/s] with the relaxation length `distance` [m], `dt_s` [s]
    /// after the previous state; a speed below 1 m/s counts as 1 m/s.
    pub fn followed_rates(&self, relaxed: &mut Relaxed, dt_s: f64, distance: f64) -> [f64; 2] {
        let slip = [self.alpha_f_rad, self.alpha_r_rad];
        let v = self.v_mps.max(1.0);
        relaxed.rates(slip, self.slip_rate_radps, v, dt_s, distance)
    }

    /// Time, place, speed and weather, the input of effects; normal force and drag area are NaN.
    pub fn operating_point(&self) -> OperatingPoint {
        OperatingPoint {
            t: self.t_s,
            s: self.s_m,
            v: self.v_mps,
            fz: f64::NAN,
            conditions: self.conditions,
            air_density: self.air_density_kgpm3,
            drag_area: f64::NAN,
            film: f64::NAN,
            patch: Patch::UNKNOWN,
        }
    }
}

/// Motion of the centre of gravity at one instant, from accelerometers and differentiated
/// gyroscopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Specific force (x, y, z) [m/s2].
    pub accel_mps2: [f64; 3],
    /// Pitch acceleration [rad/s2].
    pub pitch_accel_radps2: f64,
    /// Yaw acceleration [rad/s2].
    pub yaw_accel_radps2: f64,
}

/// Forces of the ice on both runners.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxleForces {
    /// Force on the front runner in its own frame (x, y, z) [N].
    pub front: [f64; 3],
    /// Force on the front runner in the body frame [N].
    pub front_body: [f64; 3],
    /// Force on the rear runner, whose frame is the body frame [N].
    pub rear: [f64; 3],
    /// Force of effects on the body along x and y, e.g. of a headwind or a wall [N], and moment
    /// about z [N m].
    pub body: [f64; 3],
}

/// Sums of the forces in the plane of the sled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resultant {
    /// Force along x at the centre of gravity [N].
    pub fx_n: f64,
    /// Force along y at the centre of gravity [N].
    pub fy_n: f64,
    /// Moment about z [N m].
    pub mz_nm: f64,
}

/// State and motion at one instant from corrected readings of the sensors.
///
/// Accelerations are transferred to the centre of gravity and slip angles to the axles; the normal
/// forces follow from the accelerations. `at` states time, place and weather; the speed must be
/// positive. Rates of the slip angles:
///
/// ```text
/// dalpha_P/dt = dalpha/dt - (x_P - x_s) (dr/dt - r dv/dt / v) / v      (+ ddelta/dt at the front)
/// ```
#[inline]
pub fn from_sensors(sled: &Sled, signals: &Signals, at: &OperatingPoint) -> (State, Motion) {
    let place = [sled.accel_x_m, sled.accel_y_m, sled.accel_z_m];
    let (rates, angular) = (signals.rates(), signals.angular_acceleration());
    let accel = to_centre_of_gravity(signals.acceleration(), rates, angular, place);
    let [roll, pitch, yaw] = rates;
    let [roll_accel, pitch_accel, yaw_accel] = angular;
    let (v, delta) = (signals[Sensor::Speed], signals[Sensor::Steering]);
    let slip = slips(sled, signals[Sensor::Slip], yaw, v, delta);
    let (fz_f0_n, fz_r_n) = normal_forces(sled, accel[2], pitch_accel);
    let turn = (yaw_accel - yaw * signals.rate(Sensor::Speed) / v) / v;
    let slip_rate = |x: f64| signals.rate(Sensor::Slip) - turn * (x - sled.slip_x_m);
    let state = State {
        t_s: at.t,
        s_m: at.s,
        v_mps: v,
        alpha_cog_rad: slip.cog,
        alpha_f_rad: slip.front,
        alpha_r_rad: slip.rear,
        delta_rad: delta,
        gamma_rad: signals[Sensor::RollSplit],
        roll_rate_radps: roll,
        pitch_rate_radps: pitch,
        yaw_rate_radps: yaw,
        roll_accel_radps2: roll_accel,
        curvature_1pm: -pitch / v,
        fz_f0_n,
        fz_r_n,
        air_density_kgpm3: at.air_density,
        conditions: at.conditions,
        slip_rate_radps: [
            slip_rate(sled.l_f_m) + signals.rate(Sensor::Steering),
            slip_rate(-sled.l_r_m),
        ],
        accel_mps2: accel,
    };
    let motion = Motion {
        accel_mps2: accel,
        pitch_accel_radps2: pitch_accel,
        yaw_accel_radps2: yaw_accel,
    };
    (state, motion)
}

/// Specific force at the centre of gravity [m/s2] from the specific force at the accelerometer.
///
/// ```text
/// a_cog = a_sensor - dw/dt x r - w x (w x r)
/// ```
///
/// `rates` w [rad/s] and `accelerations` dw/dt [rad/s2] are (roll, pitch, yaw) about x forward, y
/// left, z up; `r` [m] is the place of the accelerometer relative to the centre of gravity. Gravity
/// cancels. This is the rigid-body matrix of the paper.
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

/// Acceleration of a point at `r` [m] relative to the centre of gravity [m/s2]:
/// `dw/dt x r + w x (w x r)`.
#[inline]
pub fn lever_acceleration(rates: [f64; 3], accelerations: [f64; 3], r: [f64; 3]) -> [f64; 3] {
    let [w, dw, r] = [rates, accelerations, r].map(Vector3::from);
    (dw.cross(&r) + w.cross(&w.cross(&r))).into()
}

/// Slip angles [rad] at the centre of gravity and the runners.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slips {
    /// At the centre of gravity; the chassis slip angle is `beta = -cog`.
    pub cog: f64,
    /// At the front runner, steering included.
    pub front: f64,
    /// At the rear runner.
    pub rear: f64,
}

/// Slip angles at the centre of gravity and both runners from the slip angle at the sensor.
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

/// Normal forces at the axles in the body frame (front, rear) [N] from the vertical specific force
/// at the centre of gravity [m/s2] and the pitch acceleration [rad/s2].
///
/// ```text
/// F_z,f0 = (l_r m a_z - J_yy dpitch/dt) / L      F_z,r = (l_f m a_z + J_yy dpitch/dt) / L
/// ```
#[inline]
pub fn normal_forces(sled: &Sled, az: f64, pitch_accel: f64) -> (f64, f64) {
    let wheelbase = sled.wheelbase_m();
    let total = sled.mass_kg * az;
    let moment = sled.j_yy_kgm2 * pitch_accel;
    (
        (sled.l_r_m * total - moment) / wheelbase,
        (sled.l_f_m * total + moment) / wheelbase,
    )
}

/// `F_f0 = R_x(gamma) R_z(delta) F_f`: transforms a force on the front runner to the body frame.
pub fn front_to_body(force: [f64; 3], delta: f64, gamma: f64) -> [f64; 3] {
    turned(force, delta.sin_cos(), gamma.sin_cos())
}

/// [`front_to_body`] with sine and cosine of both angles known.
#[inline]
pub(crate) fn turned(force: [f64; 3], (sd, cd): (f64, f64), (sg, cg): (f64, f64)) -> [f64; 3] {
    let (x, y) = (cd * force[0] - sd * force[1], sd * force[0] + cd * force[1]);
    [x, cg * y - sg * force[2], sg * y + cg * force[2]]
}

/// `F_f = R^T F_f0`: the inverse of [`front_to_body`].
pub fn body_to_front(force: [f64; 3], delta: f64, gamma: f64) -> [f64; 3] {
    let ((sd, cd), (sg, cg)) = (delta.sin_cos(), gamma.sin_cos());
    let y = cg * force[1] + sg * force[2];
    let z = -sg * force[1] + cg * force[2];
    [cd * force[0] + sd * y, -sd * force[0] + cd * y, z]
}
