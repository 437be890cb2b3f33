//! The balances of a one-track sled at one instant: forces of laws and effects, and their residuals
//! against the motion.
//!
//! ```text
//! along:  m a_x - (F_x,f0 + F_x,r + F_air,x + F_x,body)          [N]      specific force; gravity does not enter
//! side:   m a_y - (F_y,f0 + F_y,r + F_air,y + F_y,body)          [N]
//! yaw:    J_zz dyaw/dt - (l_f F_y,f0 - l_r F_y,r + M_z,body)     [N m]
//! track:  d(v cos(alpha))/dt - g sin(slope) - a_x - r v_y        [m/s2]   slope positive downhill; free of friction
//!     or  dv/dt - g sin(slope) - a_x cos(beta) - a_y sin(beta)   [m/s2]   where the slope is that of the sled's path
//! ```
//!
//! v and alpha are those of the slip sensor at x_s, v_y = -v sin(alpha) - x_s r and beta =
//! atan(v_y/v_x) to the centre of gravity. Fits, validation, evaluation, simulation and discovery
//! all take their forces and balances from here.

use crate::effects::{self as effects, Forces, OperatingPoint};
use crate::friction::{LateralDerivatives, sin_cos_near};
use crate::model::vehicle::{RunnerFriction, Vehicle};
use crate::motion::aero;
use crate::motion::state::{AxleForces, Motion, Resultant, State, turned};
use crate::sled::Sled;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

/// One instant of a sled, with the sines, cosines and drag that its forces need repeatedly.
#[derive(Clone, Copy, Debug)]
pub struct Balance {
    /// Masses, lengths and drag at this instant.
    pub sled: Sled,
    /// Slips, loads and conditions.
    pub state: State,
    /// The measured motion; 0 where it is not needed.
    pub motion: Motion,
    /// Sine and cosine of the steering angle.
    pub steer: (f64, f64),
    /// Sine and cosine of the roll-split angle.
    pub split: (f64, f64),
    /// Sine and cosine of the slip angles at the runners.
    pub slips: [(f64, f64); 2],
    /// Sine and cosine of the slip angle at the centre of gravity.
    pub chassis: (f64, f64),
    /// Drag of the base model, never positive [N].
    pub drag: f64,
}

/// Residuals of the three balances of the sled in its plane: measured minus modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BalanceResidual {
    /// Along the sled [N].
    #[serde(deserialize_with = "nan_if_null")]
    pub along_n: f64,
    /// Across the sled, positive to the left [N].
    #[serde(deserialize_with = "nan_if_null")]
    pub side_n: f64,
    /// About the vertical [N m].
    #[serde(deserialize_with = "nan_if_null")]
    pub yaw_nm: f64,
}

/// JSON has no NaN: the residual of a balance without recorded columns is `null`.
fn nan_if_null<'de, D: Deserializer<'de>>(value: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(value)?.unwrap_or(f64::NAN))
}

impl BalanceResidual {
    /// Along [N], side [N], yaw [N m].
    pub fn values(&self) -> [f64; 3] {
        [self.along_n, self.side_n, self.yaw_nm]
    }
}

/// Steering, roll-split, slip at the front, at the rear and at the centre of gravity [rad].
#[inline]
fn angles(state: &State) -> [f64; 5] {
    [
        state.delta_rad,
        state.gamma_rad,
        state.alpha_f_rad,
        state.alpha_r_rad,
        state.alpha_cog_rad,
    ]
}

impl Balance {
    /// The balance of a sled in a state with the motion measured there.
    #[inline]
    pub fn new(sled: &Sled, state: &State, motion: &Motion) -> Self {
        // Nearly all angles are small.
        let angles = angles(state).map(|angle| sin_cos_near(angle, 0.0, (0.0, 1.0)));
        Self::with_angles(sled, state, motion, angles)
    }

    /// As [`Balance::new`], faster: with sines and cosines from the balance `known` of a nearby
    /// instant.
    #[inline]
    pub fn near(sled: &Sled, state: &State, motion: &Motion, known: &Self) -> Self {
        let [front, rear] = known.slips;
        let then = [known.steer, known.split, front, rear, known.chassis];
        let (now, before) = (angles(state), angles(&known.state));
        let angles = std::array::from_fn(|k| sin_cos_near(now[k], before[k], then[k]));
        Self::with_angles(sled, state, motion, angles)
    }

    #[inline]
    fn with_angles(
        sled: &Sled,
        state: &State,
        motion: &Motion,
        [steer, split, front, rear, chassis]: [(f64, f64); 5],
    ) -> Self {
        let density = state.air_density_kgpm3;
        Self {
            sled: *sled,
            state: *state,
            motion: *motion,
            steer,
            split,
            slips: [front, rear],
            chassis,
            drag: aero::drag(sled, state.v_mps, density, -state.alpha_cog_rad),
        }
    }

    /// Forces of the base laws with the vehicle's effects.
    ///
    /// The vehicle's effects must be those of the track ([`Vehicle::on_track`]).
    pub fn forces(&self, vehicle: &Vehicle, laws: &LawForces) -> Forces {
        let mut forces = laws.forces;
        if !vehicle.effects.is_empty() {
            let seen = self.seen(vehicle, laws.load_n);
            vehicle.effects.act(&seen, &mut forces);
        }
        forces
    }

    /// Input of effects at this instant, with the normal forces of the runners in their own frames
    /// [N].
    pub fn seen(&self, vehicle: &Vehicle, load_n: [f64; 2]) -> effects::State {
        let state = &self.state;
        let runners = [&vehicle.front, &vehicle.rear];
        effects::State {
            point: self.operating_point(),
            slip: [state.alpha_f_rad, state.alpha_r_rad],
            slip_rate: state.slip_rate_radps,
            load: load_n,
            film: std::array::from_fn(|i| {
                let (v, ice_c) = (state.v_mps, state.conditions.ice_c);
                runners[i].film(load_n[i], state.curvature_1pm, v, ice_c)
            }),
            chassis_slip: state.alpha_cog_rad,
            steering: state.delta_rad,
            roll_split: state.gamma_rad,
            roll_rate: state.roll_rate_radps,
            roll_acceleration: state.roll_accel_radps2,
            pitch_rate: state.pitch_rate_radps,
            yaw_rate: state.yaw_rate_radps,
            acceleration: state.accel_mps2,
            mass: self.sled.mass_kg,
            carried: f64::NAN,
        }
    }

    /// Time, place, speed and weather, the input of effects.
    pub fn operating_point(&self) -> OperatingPoint {
        OperatingPoint {
            drag_area: self.sled.cda_m2,
            ..self.state.operating_point()
        }
    }

    /// Normal force on the front runner in its own frame [N], from the axle's normal force and the
    /// runner's forces along and across.
    ///
    /// ```text
    /// F_z,f = (F_z,f0 - sin(gamma) (sin(delta) F_x,f + cos(delta) F_y,f)) / cos(gamma)
    /// ```
    #[inline]
    pub fn front_load(&self, forces: &Forces) -> f64 {
        let ((sd, cd), (sg, cg)) = (self.steer, self.split);
        (self.state.fz_f0_n - sg * (sd * forces.along[0] + cd * forces.across[0])) / cg
    }

    /// Forces on both runners and the body; `front_load` [N] is the front runner's normal force in
    /// its own frame.
    #[inline]
    pub fn axle_forces(&self, forces: &Forces, front_load: f64) -> AxleForces {
        let front = [forces.along[0], forces.across[0], front_load];
        AxleForces {
            front,
            front_body: turned(front, self.steer, self.split),
            rear: [forces.along[1], forces.across[1], self.state.fz_r_n],
            body: [forces.body_along, forces.body_across, forces.body_yaw],
        }
    }

    /// Air drag of the base model at the centre of gravity in the body frame (x, y) [N].
    #[inline]
    pub fn air(&self) -> [f64; 2] {
        let (sine, cosine) = self.chassis;
        [self.drag * cosine, -self.drag * sine]
    }

    /// Resultant of runners, air and effects at the centre of gravity.
    #[inline]
    pub fn resultant(&self, forces: &AxleForces) -> Resultant {
        let (air, f, r) = (self.air(), &forces.front_body, &forces.rear);
        Resultant {
            fx_n: f[0] + r[0] + air[0] + forces.body[0],
            fy_n: f[1] + r[1] + air[1] + forces.body[1],
            mz_nm: self.sled.l_f_m * f[1] - self.sled.l_r_m * r[1] + forces.body[2],
        }
    }

    /// Residuals of the balances along, across and about the vertical with these forces.
    #[inline]
    pub fn residual(&self, forces: &Forces) -> BalanceResidual {
        let sum = self.resultant(&self.axle_forces(forces, self.front_load(forces)));
        let (m, a) = (self.sled.mass_kg, &self.motion.accel_mps2);
        BalanceResidual {
            along_n: m * a[0] - sum.fx_n,
            side_n: m * a[1] - sum.fy_n,
            yaw_nm: self.sled.j_zz_kgm2 * self.motion.yaw_accel_radps2 - sum.mz_nm,
        }
    }
}

/// Forces of the base laws of both runners, without effects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LawForces {
    /// Normal force on each runner in its own frame, front and rear [N].
    pub load_n: [f64; 2],
    /// Lateral law of each runner with its derivatives.
    pub lateral: [LateralDerivatives; 2],
    /// The forces; those on the body are 0.
    pub forces: Forces,
}

impl Balance {
    /// Longitudinal force on each runner in its own frame at its normal force [N], as
    /// [`crate::friction::longitudinal_force`].
    ///
    /// The force on a lifted runner is 0.
    #[inline]
    pub(crate) fn longitudinal(&self, vehicle: &Vehicle, load: [f64; 2]) -> [f64; 2] {
        [
            self.longitudinal_of(&vehicle.front, self.slips[0], load[0]),
            self.longitudinal_of(&vehicle.rear, self.slips[1], load[1]),
        ]
    }

    #[inline]
    fn longitudinal_of(&self, runner: &RunnerFriction, slip: (f64, f64), load: f64) -> f64 {
        let at = &self.state;
        let mu = runner.mu(load, at.curvature_1pm, at.v_mps, at.conditions.ice_c);
        -mu * load.max(0.0) * slip.1
    }

    /// Forces of the vehicle's base laws at the state's slip angles and normal forces.
    ///
    /// The front runner's own `F_z,f` depends on its forces through the roll-split; one Newton step
    /// on
    ///
    /// ```text
    /// cos(gamma) F_z,f = F_z,f0 - sin(gamma) (sin(delta) F_x,f + cos(delta) F_y,f)
    /// ```
    ///
    /// from `F_z,f0 / cos(gamma)` has a relative error below 1e-6. F_x enters because the axle's
    /// vertical force is the z component of the turned runner's force. The laws are then evaluated
    /// at this load.
    pub fn laws(&self, vehicle: &Vehicle) -> LawForces {
        let ((sd, cd), (sg, cg)) = (self.steer, self.split);
        let (state, runner) = (&self.state, &vehicle.front);
        let alpha = state.alpha_f_rad;
        let mut load = state.fz_f0_n / cg;
        let mut near = None;
        let mut front = runner.lateral.derivatives_near(alpha, load, &mut near);
        if sg != 0.0 {
            let fx = self.longitudinal_of(runner, self.slips[0], load);
            let residual = cg * load + sg * (sd * fx + cd * front.fy) - state.fz_f0_n;
            let by_load = if load > 0.0 { fx / load } else { 0.0 };
            load -= residual / (cg + sg * (sd * by_load + cd * front.fz));
            front = runner.lateral.derivatives_near(alpha, load, &mut near);
        }
        let rear = &vehicle.rear.lateral;
        let rear = rear.derivatives(state.alpha_r_rad, state.fz_r_n);
        self.law_forces(vehicle, [load, state.fz_r_n], [front, rear])
    }

    /// As [`Balance::laws`] to first order, from the forces `known_laws` of a nearby balance
    /// `known`.
    #[inline]
    pub fn laws_near(
        &self,
        vehicle: &Vehicle,
        known: &Balance,
        known_laws: &LawForces,
    ) -> LawForces {
        let ((sd, cd), (sg, cg)) = (self.steer, self.split);
        let (state, then) = (&self.state, &known.state);
        let [mut front, mut rear] = known_laws.lateral;
        front.fy += front.alpha * (state.alpha_f_rad - then.alpha_f_rad);
        rear.fy += rear.alpha * (state.alpha_r_rad - then.alpha_r_rad);
        let (load, fx) = (known_laws.load_n[0], known_laws.forces.along[0]);
        let residual = cg * load + sg * (sd * fx + cd * front.fy) - state.fz_f0_n;
        let by_load = if load > 0.0 { fx / load } else { 0.0 };
        let step = residual / (cg + sg * (sd * by_load + cd * front.fz));
        front.fy -= front.fz * step;
        rear.fy += rear.fz * (state.fz_r_n - then.fz_r_n);
        self.law_forces(vehicle, [load - step, state.fz_r_n], [front, rear])
    }

    #[inline]
    fn law_forces(
        &self,
        vehicle: &Vehicle,
        load_n: [f64; 2],
        lateral: [LateralDerivatives; 2],
    ) -> LawForces {
        LawForces {
            load_n,
            lateral,
            forces: Forces {
                along: self.longitudinal(vehicle, load_n),
                across: lateral.map(|law| law.fy),
                stiffness: lateral.map(|law| law.alpha),
                ..Forces::default()
            },
        }
    }
}
