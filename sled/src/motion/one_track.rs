//! The one-track sled, read both ways: forces from motion (inverse) and forces from friction (forward).
//!
//! One right-handed frame throughout: x forward, y left, z up, body = rear part. The front runner's frame is turned by
//! `R = R_x(gamma) R_z(delta)`, so that `F_f0 = R F_f`. With the aerodynamic force at the centre of gravity:
//!
//! ```text
//! m a_x = F_x,r + F_x,f0 + F_x,aero         J_zz dyaw/dt   =  l_f F_y,f0 - l_r F_y,r
//! m a_y = F_y,r + F_y,f0 + F_y,aero         J_yy dpitch/dt = -l_f F_z,f0 + l_r F_z,r
//! m a_z = F_z,r + F_z,f0
//! ```
//!
//! a is the specific force at the centre of gravity, which gravity does not enter.

use kufe_friction::{Braghin, longitudinal_force};

use crate::effects::{self, Forces};
use crate::model::runner::RunnerFriction;
use crate::model::sled::Sled;
use crate::model::vehicle::Vehicle;
use crate::motion::aero;

/// One instant of a sled, measured or simulated: all that friction and air depend on.
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
    /// Roll-split angle, positive turns the front part about +x [rad].
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
    /// Ice temperature [degrees Celsius].
    pub ice_c: f64,
    /// Air temperature [degrees Celsius].
    pub air_c: f64,
    /// Air pressure [Pa].
    pub air_pa: f64,
    /// Rates of the slip angles, front and rear [rad/s]; only effects ask for them.
    pub slip_rate_radps: [f64; 2],
    /// Specific force at the centre of gravity [m/s2]; only effects ask for it.
    pub accel_mps2: [f64; 3],
}

/// What accelerometers and differentiated gyroscopes tell about one instant, at the centre of gravity.
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
    /// On the front runner in its own frame (x, y, z) [N].
    pub front: [f64; 3],
    /// The same force in the body frame [N].
    pub front_body: [f64; 3],
    /// On the rear runner; its frame is the body's [N].
    pub rear: [f64; 3],
    /// On the body besides runners and base drag (x, y): what effects add, a headwind or a wall [N].
    pub body: [f64; 2],
}

/// Sums of what acts in the plane of the sled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resultant {
    /// Force along x at the centre of gravity [N].
    pub fx_n: f64,
    /// Force along y at the centre of gravity [N].
    pub fy_n: f64,
    /// Moment about z [N m].
    pub mz_nm: f64,
}

/// Normal forces at the axles in the body frame (front, rear) [N] from the vertical specific force at the centre of
/// gravity [m/s2] and the pitch acceleration [rad/s2].
///
/// ```text
/// F_z,f0 = (l_r m a_z - J_yy dpitch/dt) / L      F_z,r = (l_f m a_z + J_yy dpitch/dt) / L
/// ```
pub fn normal_forces(sled: &Sled, az: f64, pitch_accel: f64) -> (f64, f64) {
    let wheelbase = sled.wheelbase_m();
    let total = sled.mass_kg * az;
    let moment = sled.j_yy_kgm2 * pitch_accel;
    (
        (sled.l_r_m * total - moment) / wheelbase,
        (sled.l_f_m * total + moment) / wheelbase,
    )
}

/// `F_f0 = R_x(gamma) R_z(delta) F_f`: a force on the front runner, brought to the body frame.
pub fn front_to_body(force: [f64; 3], delta: f64, gamma: f64) -> [f64; 3] {
    let ((sd, cd), (sg, cg)) = (delta.sin_cos(), gamma.sin_cos());
    let (x, y) = (cd * force[0] - sd * force[1], sd * force[0] + cd * force[1]);
    [x, cg * y - sg * force[2], sg * y + cg * force[2]]
}

/// `F_f = R^T F_f0`: the inverse of [`front_to_body`].
pub fn body_to_front(force: [f64; 3], delta: f64, gamma: f64) -> [f64; 3] {
    let ((sd, cd), (sg, cg)) = (delta.sin_cos(), gamma.sin_cos());
    let (y, z) = (
        cg * force[1] + sg * force[2],
        -sg * force[1] + cg * force[2],
    );
    [cd * force[0] + sd * y, -sd * force[0] + cd * y, z]
}

/// Aerodynamic force at the centre of gravity in the body frame (x, y) [N]: the drag against the driving direction.
pub fn aero_force(sled: &Sled, state: &State) -> [f64; 2] {
    let drag = aero::drag(
        sled,
        state.v_mps,
        state.air_density_kgpm3,
        -state.alpha_cog_rad,
    );
    let (sine, cosine) = state.alpha_cog_rad.sin_cos();
    [drag * cosine, -drag * sine]
}

/// Forces on the runners as the motion demands them.
///
/// Momentum along y and z and both moments give `F_y` and `F_z` at the axles in the body frame. `F_x,f0` cannot be
/// measured; it follows from the longitudinal friction of the front runner in its own frame:
///
/// ```text
/// F_z,f  = cos(gamma) F_z,f0 - sin(gamma) F_y,f0
/// F_x,f  = -mu F_z,f cos(alpha_f)
/// F_x,f0 = (F_x,f - cos(gamma) sin(delta) F_y,f0 - sin(gamma) sin(delta) F_z,f0) / cos(delta)
/// ```
///
/// The rear runner's `F_x` is that of its friction, too. Forces in N. A lifted runner's normal force comes out negative
/// and is left so.
pub fn inverse(vehicle: &Vehicle, state: &State, motion: &Motion) -> AxleForces {
    let sled = &vehicle.sled;
    let lateral = sled.mass_kg * motion.accel_mps2[1] - aero_force(sled, state)[1];
    let moment = sled.j_zz_kgm2 * motion.yaw_accel_radps2;
    let wheelbase = sled.wheelbase_m();
    let fy_f0 = (sled.l_r_m * lateral + moment) / wheelbase;
    let fy_r = (sled.l_f_m * lateral - moment) / wheelbase;
    let (fz_f0, fz_r) = normal_forces(sled, motion.accel_mps2[2], motion.pitch_accel_radps2);

    let ((sd, cd), (sg, cg)) = (state.delta_rad.sin_cos(), state.gamma_rad.sin_cos());
    let fz_f = cg * fz_f0 - sg * fy_f0;
    let fx_f = longitudinal(&vehicle.front, fz_f, state.alpha_f_rad, state.curvature_1pm);
    let fx_f0 = (fx_f - cg * sd * fy_f0 - sg * sd * fz_f0) / cd;
    let front_body = [fx_f0, fy_f0, fz_f0];
    let fx_r = longitudinal(&vehicle.rear, fz_r, state.alpha_r_rad, state.curvature_1pm);
    AxleForces {
        front: body_to_front(front_body, state.delta_rad, state.gamma_rad),
        front_body,
        rear: [fx_r, fy_r, fz_r],
        body: [0.0; 2],
    }
}

fn longitudinal(runner: &RunnerFriction, fz: f64, alpha: f64, curvature: f64) -> f64 {
    // A lifted runner does not push.
    longitudinal_force(fz.max(0.0), alpha, runner.mu(fz, curvature))
}

/// Forces on the runners as the friction laws give them at the state's slip angles and normal forces.
///
/// The front runner's own `F_z,f` depends on its lateral force through the roll-split; one Newton step on
/// `cos(gamma) F_z,f = F_z,f0 - sin(gamma) (sin(delta) F_x,f + cos(delta) F_y,f)` leaves less than 1e-6 of it.
pub fn forward(vehicle: &Vehicle, state: &State) -> AxleForces {
    let ((sd, cd), (sg, cg)) = (state.delta_rad.sin_cos(), state.gamma_rad.sin_cos());
    let runner = &vehicle.front;
    let mut fz_f = state.fz_f0_n / cg;
    if sg != 0.0 {
        let law = runner.lateral.derivatives(state.alpha_f_rad, fz_f);
        let fx_f = longitudinal(runner, fz_f, state.alpha_f_rad, state.curvature_1pm);
        let residual = cg * fz_f + sg * (sd * fx_f + cd * law.fy) - state.fz_f0_n;
        let by_load = if fz_f > 0.0 { fx_f / fz_f } else { 0.0 };
        fz_f -= residual / (cg + sg * (sd * by_load + cd * law.fz));
    }
    let front = [
        longitudinal(runner, fz_f, state.alpha_f_rad, state.curvature_1pm),
        runner.lateral.force(state.alpha_f_rad, fz_f),
        fz_f,
    ];
    let (x, y) = (cd * front[0] - sd * front[1], sd * front[0] + cd * front[1]);
    let fz_r = state.fz_r_n;
    let base = AxleForces {
        front,
        front_body: [x, cg * y - sg * fz_f, sg * y + cg * fz_f],
        rear: [
            longitudinal(&vehicle.rear, fz_r, state.alpha_r_rad, state.curvature_1pm),
            vehicle.rear.lateral.force(state.alpha_r_rad, fz_r),
            fz_r,
        ],
        body: [0.0; 2],
    };
    if vehicle.effects.is_empty() {
        return base;
    }
    with_effects(vehicle, state, &base)
}

/// The base law's forces as the vehicle's effects change them; the front runner's `F_z,f` follows its changed force.
fn with_effects(vehicle: &Vehicle, state: &State, base: &AxleForces) -> AxleForces {
    let stiffness = |law: &kufe_friction::MagicFormula, alpha, fz| law.derivatives(alpha, fz).alpha;
    let mut forces = Forces {
        along: [base.front[0], base.rear[0]],
        across: [base.front[1], base.rear[1]],
        stiffness: [
            stiffness(&vehicle.front.lateral, state.alpha_f_rad, base.front[2]),
            stiffness(&vehicle.rear.lateral, state.alpha_r_rad, base.rear[2]),
        ],
        body_along: 0.0,
        body_across: 0.0,
    };
    let seen = effects::State {
        conditions: effects::Conditions {
            t: state.t_s,
            s: state.s_m,
            v: state.v_mps,
            fz: f64::NAN,
            ice_c: state.ice_c,
            air_c: state.air_c,
            air_pa: state.air_pa,
            humidity_pct: f64::NAN,
            distance: 0.0,
            air_density: state.air_density_kgpm3,
            drag_area: vehicle.sled.cda_m2,
        },
        slip: [state.alpha_f_rad, state.alpha_r_rad],
        slip_rate: state.slip_rate_radps,
        load: [base.front[2], base.rear[2]],
        chassis_slip: state.alpha_cog_rad,
        steering: state.delta_rad,
        roll_split: state.gamma_rad,
        roll_rate: state.roll_rate_radps,
        roll_acceleration: state.roll_accel_radps2,
        yaw_rate: state.yaw_rate_radps,
        acceleration: state.accel_mps2,
        mass: vehicle.sled.mass_kg,
    };
    vehicle.effects.act("", &seen, &mut forces);
    let ((sd, cd), (sg, cg)) = (state.delta_rad.sin_cos(), state.gamma_rad.sin_cos());
    let (fx, fy) = (forces.along[0], forces.across[0]);
    let front = [fx, fy, (state.fz_f0_n - sg * (sd * fx + cd * fy)) / cg];
    AxleForces {
        front,
        front_body: front_to_body(front, state.delta_rad, state.gamma_rad),
        rear: [forces.along[1], forces.across[1], state.fz_r_n],
        body: [forces.body_along, forces.body_across],
    }
}

/// [`forward`] with Braghin's lateral law on both runners, the paper's comparison.
pub fn forward_braghin(vehicle: &Vehicle, law: &Braghin, state: &State) -> AxleForces {
    let (sd, cd) = state.delta_rad.sin_cos();
    let (sg, cg) = state.gamma_rad.sin_cos();
    let mut fz_f = state.fz_f0_n / cg;
    let mut front = [0.0; 3];
    // The force is proportional to the load: two rounds settle the roll-split's coupling.
    for _ in 0..3 {
        front = [
            longitudinal(&vehicle.front, fz_f, state.alpha_f_rad, state.curvature_1pm),
            law.force(state.alpha_f_rad, fz_f),
            fz_f,
        ];
        fz_f = (state.fz_f0_n - sg * (sd * front[0] + cd * front[1])) / cg;
    }
    AxleForces {
        front,
        front_body: front_to_body(front, state.delta_rad, state.gamma_rad),
        rear: [
            longitudinal(
                &vehicle.rear,
                state.fz_r_n,
                state.alpha_r_rad,
                state.curvature_1pm,
            ),
            law.force(state.alpha_r_rad, state.fz_r_n),
            state.fz_r_n,
        ],
        body: [0.0; 2],
    }
}

/// What runners and air together do at the centre of gravity.
pub fn resultant(sled: &Sled, state: &State, forces: &AxleForces) -> Resultant {
    let aero = aero_force(sled, state);
    let (f, r) = (&forces.front_body, &forces.rear);
    Resultant {
        fx_n: f[0] + r[0] + aero[0] + forces.body[0],
        fy_n: f[1] + r[1] + aero[1] + forces.body[1],
        mz_nm: sled.l_f_m * f[1] - sled.l_r_m * r[1],
    }
}
