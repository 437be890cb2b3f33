//! Equations of motion of the one-track sled on a track.

use crate::effects::Relaxed;
use crate::friction::GRAVITY;

use crate::conditions::Conditions;
use crate::model::vehicle::Vehicle;
use crate::motion::balance::Balance;
use crate::motion::one_track::forces_at;
use crate::motion::state::normal_forces;
use crate::motion::state::{AxleForces, Motion, State};
use crate::motion::state::{Slips, slips};
use crate::simulate::driver::{Seen, Steering};
use crate::track::table::IceAlong;
use crate::track::table::TrackShape;

/// What is integrated: distance, offset, heading, speeds, steering, and the work done so far.
///
/// Order: s [m], n [m], heading chi against the line [rad], v_x, v_y [m/s], yaw rate [rad/s],
/// steering [rad], work of gravity, of the ice, of the air (with what effects add to the body) and
/// of contacts [J], time [s].
pub(crate) type Unknowns = [f64; COUNT];

/// Number of unknowns.
pub(crate) const COUNT: usize = 12;

const N: usize = 1;
const CHI: usize = 2;
const VX: usize = 3;
const VY: usize = 4;
const YAW: usize = 5;
/// Place of the time among the unknowns.
pub(crate) const TIME: usize = 11;

/// A push from outside, such as a wall: half a wave of lateral force over a stretch of track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallContact {
    /// Where it begins [m].
    pub s_m: f64,
    /// How long it lasts [m].
    pub length_m: f64,
    /// Its peak, positive to the left [N].
    pub force_n: f64,
    /// Where it acts, before the centre of gravity [m].
    pub x_m: f64,
}

impl WallContact {
    /// Lateral force at a distance [N]: `F sin^2(pi (s - s0) / length)` within the stretch.
    pub fn force_at(&self, s: f64) -> f64 {
        let along = (s - self.s_m) / self.length_m;
        if !(0.0..=1.0).contains(&along) {
            return 0.0;
        }
        self.force_n * (std::f64::consts::PI * along).sin().powi(2)
    }
}

/// Speed that no sled reaches [m/s]: the equations of motion are no longer solved.
const MOST_SPEED: f64 = 200.0;

/// All that the equations of motion need besides the unknowns.
pub(crate) struct World<'a> {
    pub vehicle: &'a Vehicle,
    pub shape: &'a TrackShape,
    pub conditions: Conditions,
    /// Where it differs from place to place.
    pub ice: &'a IceAlong,
    pub density: f64,
    pub steering: Steering<'a>,
    pub contacts: &'a [WallContact],
    /// Curvature of the channel's cross-section [1/m]: how fast the bank grows off the line.
    pub cross_curvature: f64,
}

/// What the equations need of a moment ago, before the forces that decide it are known.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Before {
    /// Growth of the speed [m/s2].
    pub growth: f64,
    /// Rates of the slip angles, front and rear [rad/s]; only effects ask for them.
    pub slip_rate: [f64; 2],
    /// Specific force at the centre of gravity [m/s2]; only effects ask for it.
    pub accel: [f64; 3],
    /// Roll acceleration [rad/s2]; only effects ask for it.
    pub roll_accel: f64,
    /// The slip that forces follow late.
    pub relaxed: Relaxed,
}

/// Everything known at one instant of a simulation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Instant {
    /// The state, as friction sees it.
    pub state: State,
    /// Motion at the centre of gravity.
    pub motion: Motion,
    /// Forces on the runners.
    pub forces: AxleForces,
    /// Angular acceleration (roll, pitch, yaw) [rad/s2].
    pub angular_accel_radps2: [f64; 3],
    /// Slip angle at the slip sensor [rad].
    pub alpha_sensor_rad: f64,
    /// Lateral force of contacts with the wall [N].
    pub wall_n: f64,
    /// Growth of the speed at the sensor [m/s2].
    pub speed_growth: f64,
    /// Rate of the slip angle at the sensor [rad/s].
    pub alpha_sensor_rate_radps: f64,
    /// Rate of the steering angle [rad/s].
    pub steering_rate_radps: f64,
}

impl World<'_> {
    /// Rates of the unknowns and the instant they belong to.
    ///
    /// The body moves on the ice: `v_z = 0`; its pitch rate is `-v / r_y`, its roll rate follows
    /// the bank. With the upward direction
    /// `u = (-sin(theta), cos(theta) sin(phi), cos(theta) cos(phi))` in body axes:
    ///
    /// ```text
    /// v_x' = f_x - g u_x + r v_y      f = (ice + air + wall) / m
    /// v_y' = f_y - g u_y - r v_x      J_zz r' = l_f F_y,f0 - l_r F_y,r + wall
    /// f_z  = p v_y - q v_x + g u_z    (p, q, r) = roll, pitch, yaw rate
    /// ```
    ///
    /// The pitch acceleration, and with it the normal forces, need the speed's growth before the
    /// forces that decide it are known: it is taken from a moment ago. In addition to the base
    /// line, the sled balances where the line puts it: its yaw rate w is the one without lateral
    /// force, and the channel's cross-section leads it back.
    pub(crate) fn rates(&self, y: &Unknowns, before: &Before) -> (Unknowns, Instant) {
        let growth = before.growth;
        let sled = &self.vehicle.sled;
        let [s, n, chi, vx, vy, yaw, integrated, ..] = *y;
        let delta = self.steering.angle(s, integrated);
        let [mut theta, mut theta_s, _] = self.shape.slope.at(s);
        if !self.vehicle.effects.is_empty() {
            let added = |s: f64| self.vehicle.effects.slope("", s);
            theta += added(s);
            theta_s += added(s + 0.5) - added(s - 0.5);
        }
        let [curvature, curvature_s, _] = self.shape.curvature.at(s);
        let [bank, bank_s, bank_ss] = self.shape.bank.at(s);

        let vys = vy + sled.slip_x_m * yaw;
        // The sled moves forward throughout, which `trouble` sees to: the plain forms do, and are
        // faster.
        let speed = (vx * vx + vys * vys).sqrt();
        let alpha = -(vys / vx).atan();
        let Slips { cog, front, rear } = slips(sled, alpha, yaw, speed, delta);

        let (sin_chi, cos_chi) = chi.sin_cos();
        let ds = vx * cos_chi - vy * sin_chi;
        let dn = vx * sin_chi + vy * cos_chi;
        let phi = bank + self.cross_curvature * n;
        let (sin_phi, cos_phi) = phi.sin_cos();
        let (sin_theta, cos_theta) = theta.sin_cos();
        let up = [-sin_theta, cos_theta * sin_phi, cos_theta * cos_phi];
        let (phi_t, theta_t) = (bank_s * ds + self.cross_curvature * dn, theta_s * ds);

        let pitch = -speed * curvature;
        let pitch_accel = -(growth * curvature + speed * curvature_s * ds);
        let tan_theta = sin_theta / cos_theta;
        let turn = pitch * sin_phi + yaw * cos_phi;
        let roll = phi_t - tan_theta * turn;

        let fz = roll * vy - pitch * vx + GRAVITY * up[2];
        let (fz_f0_n, fz_r_n) = normal_forces(sled, fz, pitch_accel);
        let gamma = self.shape.bank.value(s + sled.l_f_m) - self.shape.bank.value(s - sled.l_r_m)
            + self.cross_curvature * sled.wheelbase_m() * sin_chi;
        let mut state = State {
            t_s: y[TIME],
            s_m: s,
            v_mps: speed,
            alpha_cog_rad: cog,
            alpha_f_rad: front,
            alpha_r_rad: rear,
            delta_rad: delta,
            gamma_rad: gamma,
            roll_rate_radps: roll,
            pitch_rate_radps: pitch,
            yaw_rate_radps: yaw,
            roll_accel_radps2: before.roll_accel,
            curvature_1pm: curvature,
            fz_f0_n,
            fz_r_n,
            air_density_kgpm3: self.density,
            conditions: Conditions {
                ice_c: self.ice.at(s).unwrap_or(self.conditions.ice_c),
                ..self.conditions
            },
            slip_rate_radps: before.slip_rate,
            accel_mps2: before.accel,
        };
        let at = Balance::new(sled, &state, &Motion::default());
        let forces = forces_at(self.vehicle, &at);
        let air = at.air();
        let (mut wall, mut wall_moment) = (0.0, 0.0);
        for contact in self.contacts {
            let force = contact.force_at(s);
            wall += force;
            wall_moment += contact.x_m * force;
        }
        let ice = [
            forces.front_body[0] + forces.rear[0],
            forces.front_body[1] + forces.rear[1],
        ];
        let ice_moment = sled.l_f_m * forces.front_body[1] - sled.l_r_m * forces.rear[1];
        let body_moment = forces.body[2];
        let air = [air[0] + forces.body[0], air[1] + forces.body[1]];
        let fx = (ice[0] + air[0]) / sled.mass_kg;
        let fy = (ice[1] + air[1] + wall) / sled.mass_kg;
        let vx_t = fx - GRAVITY * up[0] + yaw * vy;
        let vy_t = fy - GRAVITY * up[1] - yaw * vx;
        let yaw_accel = (ice_moment + wall_moment + body_moment) / sled.j_zz_kgm2;

        // The line: where the apparent weight, tilted by the cross-section off it, needs no lateral
        // force.
        let weight = curvature * vx * vx + GRAVITY * cos_theta * bank.cos();
        let line_yaw = (weight * (self.cross_curvature * n).sin() - GRAVITY * up[1]) / speed;

        let turn_t = pitch_accel * sin_phi + pitch * cos_phi * phi_t + yaw_accel * cos_phi
            - yaw * sin_phi * phi_t;
        let ds_t = vx_t * cos_chi - vy_t * sin_chi - dn * (yaw - line_yaw);
        let dn_t = vx_t * sin_chi + vy_t * cos_chi + ds * (yaw - line_yaw);
        let phi_tt = bank_ss * ds * ds + bank_s * ds_t + self.cross_curvature * dn_t;
        let roll_accel = phi_tt - theta_t / (cos_theta * cos_theta) * turn - tan_theta * turn_t;
        state.roll_accel_radps2 = roll_accel;

        // Rates of the slip angles from those of the velocities, for the sensor and for effects.
        let vys_t = vy_t + sled.slip_x_m * yaw_accel;
        let speed_growth = (vx * vx_t + vys * vys_t) / speed;
        let alpha_t = -(vys_t * vx - vys * vx_t) / (speed * speed);
        let turn_rate_t = (yaw_accel - yaw * speed_growth / speed) / speed;
        let seen = Seen {
            s,
            n,
            rates: [ds, dn],
            v: speed,
            delta,
        };
        let steering_t = self.steering.rate(self.shape, sled, &seen);
        state.accel_mps2 = [fx, fy, fz];
        state.slip_rate_radps = [
            alpha_t - turn_rate_t * (sled.l_f_m - sled.slip_x_m) + steering_t,
            alpha_t - turn_rate_t * (-sled.l_r_m - sled.slip_x_m),
        ];

        let rates = [
            ds,
            dn,
            yaw - line_yaw,
            vx_t,
            vy_t,
            yaw_accel,
            steering_t,
            -sled.mass_kg * GRAVITY * (up[0] * vx + up[1] * vy),
            ice[0] * vx + ice[1] * vy + ice_moment * yaw,
            air[0] * vx + air[1] * vy + body_moment * yaw,
            wall * vy + wall_moment * yaw,
            1.0,
        ];
        let instant = Instant {
            state,
            motion: Motion {
                accel_mps2: [fx, fy, fz],
                pitch_accel_radps2: pitch_accel,
                yaw_accel_radps2: yaw_accel,
            },
            forces,
            angular_accel_radps2: [roll_accel, pitch_accel, yaw_accel],
            alpha_sensor_rad: alpha,
            wall_n: wall,
            speed_growth,
            alpha_sensor_rate_radps: alpha_t,
            steering_rate_radps: steering_t,
        };
        (rates, instant)
    }

    /// What the next moment needs of this one.
    ///
    /// The slip rate is that of the slip which forces follow late, and where none is late smoothed
    /// over ten steps: a force that follows it would otherwise answer itself from step to step and
    /// grow. The price is a lag of ten steps in such a force.
    pub(crate) fn before(&self, instant: &Instant, then: &Before, step_s: f64) -> Before {
        let (state, mut relaxed) = (&instant.state, then.relaxed);
        let slip_rate = match self.vehicle.effects.relaxation() {
            Some(distance) => state.followed_rates(&mut relaxed, step_s, distance),
            None => std::array::from_fn(|i| {
                let (now, then) = (state.slip_rate_radps[i], then.slip_rate[i]);
                then + 0.1 * (now - then)
            }),
        };
        Before {
            growth: instant.speed_growth,
            slip_rate,
            relaxed,
            accel: instant.state.accel_mps2,
            roll_accel: instant.state.roll_accel_radps2,
        }
    }

    /// Kinetic energy in the plane [J]: translation and yaw. Roll and pitch are led by the track
    /// and no part of it.
    pub(crate) fn kinetic_energy(&self, y: &Unknowns) -> f64 {
        let sled = &self.vehicle.sled;
        0.5 * sled.mass_kg * (y[VX] * y[VX] + y[VY] * y[VY])
            + 0.5 * sled.j_zz_kgm2 * y[YAW] * y[YAW]
    }

    /// Why a simulation cannot go on from here, if so.
    pub(crate) fn trouble(&self, y: &Unknowns) -> Option<String> {
        if y.iter().any(|value| !value.is_finite()) {
            return Some("the motion is no longer finite".to_string());
        }
        if y[VX] < 0.5 {
            return Some(format!(
                "speed {:.2} m/s, expected above 0.5 (slope_rad is positive downhill)",
                y[VX]
            ));
        }
        if y[VX] > MOST_SPEED {
            return Some(format!(
                "speed {:.1e} m/s, expected below {MOST_SPEED}",
                y[VX]
            ));
        }
        if y[N].abs() > 5.0 || y[CHI].abs() > 1.2 {
            return Some(format!(
                "{:.1} m off the line at a heading of {:.2} rad: the sled went off the track",
                y[N], y[CHI]
            ));
        }
        None
    }
}
