//! State and motion as the sensors of one instant tell them.

use crate::effects::{Conditions, Sensor, Signals};

use crate::model::sled::Sled;
use crate::motion::axles::normal_forces;
use crate::motion::state::{Motion, State};
use crate::motion::transfer::{slips, to_centre_of_gravity};

/// What the sensors of a sled tell of one instant, their faults taken out.
///
/// Accelerations are brought to the centre of gravity, slip angles to the axles; the normal forces follow from both.
/// `at` states time, place and weather; the speed must be positive. Rates of the slip angles:
///
/// ```text
/// dalpha_P/dt = dalpha/dt - (x_P - x_s) (dr/dt - r dv/dt / v) / v      (+ ddelta/dt at the front)
/// ```
#[inline]
pub fn from_sensors(sled: &Sled, signals: &Signals, at: &Conditions) -> (State, Motion) {
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
        ice_c: at.ice_c,
        air_c: at.air_c,
        air_pa: at.air_pa,
        humidity_pct: at.humidity_pct,
        distance_before_m: at.distance,
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
