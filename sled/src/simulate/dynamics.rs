//! Equations of motion of the one-track sled on a track.

use schemars::JsonSchema;
use serde::Serialize;

use crate::effects::{Active, Relaxed};
use crate::friction::{GRAVITY, sin_cos_near};

use crate::conditions::Conditions;
use crate::model::vehicle::Vehicle;
use crate::motion::balance::Balance;
use crate::motion::one_track::forces_at;
use crate::motion::state::{AxleForces, Motion, Slips, State, normal_forces, slips};
use crate::simulate::driver::Steering;
use crate::track::table::{IceAlong, TrackShape};

/// The unknowns of the integration: distance, offset, heading, speeds, steering, and work.
///
/// Order: s [m], n [m], heading chi against the line [rad], v_x, v_y [m/s], yaw rate [rad/s],
/// steering [rad], work of gravity, of the ice, of the air (with forces of effects on the body) and
/// of contacts [J], time [s].
pub(crate) type Unknowns = [f64; COUNT];

/// Number of unknowns.
pub(crate) const COUNT: usize = 12;

/// Index of the distance among the unknowns.
pub(crate) const S: usize = 0;
/// Index of the offset.
pub(crate) const N: usize = 1;
/// Index of the heading.
pub(crate) const CHI: usize = 2;
/// Index of the speed along the sled.
pub(crate) const VX: usize = 3;
const VY: usize = 4;
const YAW: usize = 5;
/// Index of the time.
pub(crate) const TIME: usize = 11;

/// A force from outside, such as of a wall: a half wave of lateral force over a stretch of track.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct WallContact {
    /// Start of the stretch [m].
    pub s_m: f64,
    /// Length of the stretch [m].
    pub length_m: f64,
    /// Peak force, positive to the left [N].
    pub force_n: f64,
    /// Point of action, forward of the centre of gravity [m].
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

/// Speed that no sled reaches [m/s]; above it the simulation stops.
const MAX_SPEED: f64 = 200.0;

/// Data of the equations of motion.
pub(crate) struct World<'a> {
    pub vehicle: &'a Vehicle,
    pub shape: &'a TrackShape,
    pub conditions: Conditions,
    /// Temperature of the ice along the track; empty if only `conditions` state it.
    pub ice: &'a IceAlong,
    pub density: f64,
    pub steering: Steering<'a>,
    pub contacts: &'a [WallContact],
    /// Curvature of the channel's cross-section [1/m]: growth of the bank per metre off the line.
    pub cross_curvature: f64,
}

/// Quantities of the previous step that the equations need before the forces that determine them
/// are known.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Before {
    /// Growth of the speed [m/s2].
    pub growth: f64,
    /// Rates of the slip angles, front and rear [rad/s]; only effects need them.
    pub slip_rate: [f64; 2],
    /// Specific force at the centre of gravity [m/s2]; only effects need it.
    pub accel: [f64; 3],
    /// Roll acceleration [rad/s2].
    pub roll_accel: f64,
    /// State of the relaxed slips.
    pub relaxed: Relaxed,
}

/// State, motion and forces at one instant of a simulation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Instant {
    /// The state, input of the friction laws.
    pub state: State,
    /// Motion at the centre of gravity.
    pub motion: Motion,
    /// Forces on the runners.
    pub forces: AxleForces,
    /// Angular acceleration (roll, pitch, yaw) [rad/s2].
    pub angular_accel_radps2: [f64; 3],
    /// Slip angle at the slip sensor [rad].
    pub alpha_sensor_rad: f64,
    /// Growth of the speed at the sensor [m/s2].
    pub speed_growth: f64,
    /// Rate of the slip angle at the sensor [rad/s].
    pub alpha_sensor_rate_radps: f64,
    /// Rate of the steering angle [rad/s].
    pub steering_rate_radps: f64,
}

/// Velocity and rotation of ice and body at one instant, before the forces are known.
///
/// Suffixes: `_0` the ice's frame on the line, `_n` the ice's frame below the sled, `_s` a growth per
/// metre along the line, `_t` a rate.
struct Frame {
    /// Speed at the slip sensor [m/s].
    speed: f64,
    /// Lateral speed at the slip sensor [m/s].
    vys: f64,
    /// Slip angle at the slip sensor [rad].
    alpha: f64,
    /// Sine and cosine of the heading chi.
    heading: (f64, f64),
    /// Velocity along and across the line [m/s].
    ds: f64,
    dn: f64,
    /// Direction up in body axes.
    up: [f64; 3],
    /// Roll and pitch rate of the body [rad/s].
    roll: f64,
    pitch: f64,
    /// Rate of the heading against the line [rad/s].
    chi_t: f64,
    /// Pitch acceleration of the ice's frame below the sled [rad/s2].
    pitch_n_t: f64,
    /// Growth of the bank along the line [rad/m], and of that [rad/m2].
    bank_s: f64,
    bank_ss: f64,
    /// Terms of the roll acceleration: rate of `tan(theta)` times the heading rate of the line, and
    /// `tan(theta)` times its acceleration [rad/s2].
    slope_term: f64,
    heading_term: f64,
}

impl Frame {
    /// Pitch acceleration of the body [rad/s2], with the roll acceleration of the previous step.
    fn pitch_accel(&self, roll_accel: f64) -> f64 {
        let (sin_chi, cos_chi) = self.heading;
        self.pitch_n_t / cos_chi
            - (roll_accel - self.chi_t * self.pitch) * sin_chi / cos_chi
            - self.chi_t * self.roll
    }

    /// Roll acceleration of the body [rad/s2], with the rates of its velocity [m/s2].
    fn roll_accel(&self, cross_curvature: f64, vx_t: f64, vy_t: f64) -> f64 {
        let Frame { ds, dn, chi_t, .. } = *self;
        let (sin_chi, cos_chi) = self.heading;
        let ds_t = vx_t * cos_chi - vy_t * sin_chi - dn * chi_t;
        let dn_t = vx_t * sin_chi + vy_t * cos_chi + ds * chi_t;
        let roll_n_t = self.bank_ss * ds * ds + self.bank_s * ds_t + cross_curvature * dn_t
            - self.slope_term
            - self.heading_term;
        roll_n_t * cos_chi + self.pitch_n_t * sin_chi + chi_t * self.pitch
    }
}

impl World<'_> {
    /// Rates of the unknowns, and the instant.
    ///
    /// The body moves on the ice, whose frame has the slope theta and the bank phi along the line
    /// and turns with `(p, q, r)_line`; off the line it is rolled by the cross-section, and the
    /// body is turned in it by its heading chi. With the upward direction u in body axes:
    ///
    /// ```text
    /// v_x' = f_x - g u_x + r v_y      f = (ice + air + wall) / m
    /// v_y' = f_y - g u_y - r v_x      J_zz r' = l_f F_y,f0 - l_r F_y,r + wall
    /// f_z  = p v_y - q v_x + g u_z    (p, q, r) = roll, pitch, yaw rate
    /// u    = R_z(-chi) (dh/ds, dh/dn, cos(theta) cos(phi + k n))
    /// h    = -int sin(theta) ds + cos(theta) (cos(phi) - cos(phi + k n)) / k
    /// ```
    ///
    /// The work of gravity thus depends only on the altitude h, whatever the path of the sled. The
    /// line turns like a sled on it without lateral force: its pitch rate is `-v/r_y`, its yaw rate
    /// `-g cos(theta) sin(phi)/v`.
    ///
    /// The pitch acceleration, and with it the normal forces, needs accelerations before the forces
    /// that determine them are known. They are taken from the previous step (`before`).
    pub(crate) fn rates(&self, y: &Unknowns, before: &Before) -> (Unknowns, Instant) {
        let sled = &self.vehicle.sled;
        let [s, n, _, vx, vy, yaw, ..] = *y;
        let frame = self.frame(y, before.growth);
        let Frame { speed, vys, up, .. } = frame;
        let pitch_accel = frame.pitch_accel(before.roll_accel);
        let fz = frame.roll * vy - frame.pitch * vx + GRAVITY * up[2];
        let mut state = self.state(y, &frame, normal_forces(sled, fz, pitch_accel), before);

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
        let roll_accel = frame.roll_accel(self.cross_curvature, vx_t, vy_t);

        // Rates of the slip angles from those of the velocities, for the sensor and for effects.
        let vys_t = vy_t + sled.slip_x_m * yaw_accel;
        let speed_growth = (vx * vx_t + vys * vys_t) / speed;
        let alpha_t = -(vys_t * vx - vys * vx_t) / (speed * speed);
        let turn_rate_t = (yaw_accel - yaw * speed_growth / speed) / speed;
        state.roll_accel_radps2 = roll_accel;
        let steering = &self.steering;
        let steering_t = steering.rate(self.shape, sled, &state, n, [frame.ds, frame.dn]);
        state.accel_mps2 = [fx, fy, fz];
        state.slip_rate_radps = [
            alpha_t - turn_rate_t * (sled.l_f_m - sled.slip_x_m) + steering_t,
            alpha_t - turn_rate_t * (-sled.l_r_m - sled.slip_x_m),
        ];

        let rates = [
            frame.ds,
            frame.dn,
            frame.chi_t,
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
            alpha_sensor_rad: frame.alpha,
            speed_growth,
            alpha_sensor_rate_radps: alpha_t,
            steering_rate_radps: steering_t,
        };
        (rates, instant)
    }

    /// Slope of the line with the effects on it [rad], and its growth along the line [rad/m].
    fn slope(&self, s: f64) -> (f64, f64) {
        let [mut theta, mut theta_s, _] = self.shape.slope.at(s);
        if !self.vehicle.effects.is_empty() {
            let added = |s: f64| self.vehicle.effects.slope(s);
            theta += added(s);
            theta_s += added(s + 0.5) - added(s - 0.5);
        }
        (theta, theta_s)
    }

    /// The frames of ice and body at the unknowns `y`, with the growth of the speed [m/s2].
    fn frame(&self, y: &Unknowns, growth: f64) -> Frame {
        let [s, n, chi, vx, vy, yaw, ..] = *y;
        let (theta, theta_s) = self.slope(s);
        let [curvature, curvature_s, _] = self.shape.curvature.at(s);
        let [bank, bank_s, bank_ss] = self.shape.bank.at(s);

        let vys = vy + self.vehicle.sled.slip_x_m * yaw;
        // `trouble` ensures that the sled moves forward, so that these faster forms suffice.
        let speed = (vx * vx + vys * vys).sqrt();
        let alpha = -libm::atan(vys / vx);

        // Velocity along and across the line, and the direction up.
        let small = |angle| sin_cos_near(angle, 0.0, (0.0, 1.0));
        let (sin_chi, cos_chi) = small(chi);
        let ds = vx * cos_chi - vy * sin_chi;
        let dn = vx * sin_chi + vy * cos_chi;
        let tilt = self.cross_curvature * n;
        let tilt_t = self.cross_curvature * dn;
        let phi = bank + tilt;
        let (sin_theta, cos_theta) = libm::sincos(theta);
        let (sin_bank, cos_bank) = libm::sincos(bank);
        let half = 0.5 * tilt;
        let chord = if half == 0.0 {
            n
        } else {
            n * half.sin() / half
        };
        let near_bank = |angle| sin_cos_near(angle, bank, (sin_bank, cos_bank));
        let ((sin_mean, cos_mean), (sin_phi, cos_phi)) = (near_bank(bank + half), near_bank(phi));
        let climb = chord * (bank_s * cos_theta * cos_mean - theta_s * sin_theta * sin_mean);
        let rise = [climb - sin_theta, cos_theta * sin_phi];
        let up = [
            rise[0] * cos_chi + rise[1] * sin_chi,
            rise[1] * cos_chi - rise[0] * sin_chi,
            cos_theta * cos_phi,
        ];

        // Rotation of the ice's frame on the line, off the line (tilted by the cross-section), and
        // of the body.
        let (sin_tilt, cos_tilt) = small(tilt);
        let pitch_0 = -speed * curvature;
        let yaw_0 = -GRAVITY * cos_theta * sin_bank / speed;
        let pitch_n = pitch_0 * cos_tilt + yaw_0 * sin_tilt;
        let yaw_n = yaw_0 * cos_tilt - pitch_0 * sin_tilt;
        let heading_rate = pitch_0 * sin_bank + yaw_0 * cos_bank;
        let tan_theta = sin_theta / cos_theta;
        let roll_n = bank_s * ds + tilt_t - tan_theta * heading_rate;

        // Rates of these rotations.
        let bank_t = bank_s * ds;
        let theta_t = theta_s * ds;
        let pitch_0_t = -(growth * curvature + speed * curvature_s * ds);
        let yaw_0_t = -yaw_0 * growth / speed
            - GRAVITY * (cos_theta * cos_bank * bank_t - sin_theta * sin_bank * theta_t) / speed;
        let pitch_n_t = pitch_0_t * cos_tilt + yaw_0_t * sin_tilt + tilt_t * yaw_n;
        let heading_rate_t = pitch_0_t * sin_bank
            + yaw_0_t * cos_bank
            + bank_t * (pitch_0 * cos_bank - yaw_0 * sin_bank);
        Frame {
            speed,
            vys,
            alpha,
            heading: (sin_chi, cos_chi),
            ds,
            dn,
            up,
            roll: roll_n * cos_chi + pitch_n * sin_chi,
            pitch: pitch_n * cos_chi - roll_n * sin_chi,
            chi_t: yaw - yaw_n,
            pitch_n_t,
            bank_s,
            bank_ss,
            slope_term: theta_t / (cos_theta * cos_theta) * heading_rate,
            heading_term: tan_theta * heading_rate_t,
        }
    }

    /// The state with the normal forces of the front and the rear axle [N]; roll acceleration, slip
    /// rates and accelerations are those of the previous step.
    fn state(
        &self,
        y: &Unknowns,
        frame: &Frame,
        (fz_f0_n, fz_r_n): (f64, f64),
        before: &Before,
    ) -> State {
        let sled = &self.vehicle.sled;
        let [s, _, _, _, _, yaw, integrated, ..] = *y;
        let delta = self.steering.angle(s, integrated);
        let Slips { cog, front, rear } = slips(sled, frame.alpha, yaw, frame.speed, delta);
        let gamma = self.shape.bank.value(s + sled.l_f_m) - self.shape.bank.value(s - sled.l_r_m)
            + self.cross_curvature * sled.wheelbase_m() * frame.heading.0;
        State {
            t_s: y[TIME],
            s_m: s,
            v_mps: frame.speed,
            alpha_cog_rad: cog,
            alpha_f_rad: front,
            alpha_r_rad: rear,
            delta_rad: delta,
            gamma_rad: gamma,
            roll_rate_radps: frame.roll,
            pitch_rate_radps: frame.pitch,
            yaw_rate_radps: yaw,
            roll_accel_radps2: before.roll_accel,
            curvature_1pm: -frame.pitch / frame.speed,
            fz_f0_n,
            fz_r_n,
            air_density_kgpm3: self.density,
            conditions: Conditions {
                ice_c: self.ice.at(s).unwrap_or(self.conditions.ice_c),
                ..self.conditions
            },
            slip_rate_radps: before.slip_rate,
            accel_mps2: before.accel,
        }
    }

    /// Spectral radius [1/s] of the Jacobian of lateral and yaw acceleration with respect to
    /// lateral speed and yaw rate; `rates` are those of `y`.
    pub(crate) fn fastest_rate(&self, y: &Unknowns, rates: &Unknowns, before: &Before) -> f64 {
        const STEP: f64 = 1e-5;
        let column = |k: usize| {
            let mut moved = *y;
            moved[k] += STEP;
            let (there, _) = self.rates(&moved, before);
            [VY, YAW].map(|of| (there[of] - rates[of]) / STEP)
        };
        let [[a, c], [b, d]] = [column(VY), column(YAW)];
        let (half, determinant) = (0.5 * (a + d), a * d - b * c);
        match half * half - determinant {
            root if root > 0.0 => half.abs() + root.sqrt(),
            _ => determinant.sqrt(),
        }
    }

    /// The quantities of this instant that the next step needs.
    ///
    /// The slip rate is that of the relaxed slip. Without relaxation it is smoothed over ten steps,
    /// since a force that depends on it would otherwise be unstable from step to step. Such a force
    /// therefore lags by ten steps.
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

    /// Kinetic energy in the plane [J]: translation and yaw. Roll and pitch follow the track and
    /// are not included.
    pub(crate) fn kinetic_energy(&self, y: &Unknowns) -> f64 {
        let sled = &self.vehicle.sled;
        0.5 * sled.mass_kg * (y[VX] * y[VX] + y[VY] * y[VY])
            + 0.5 * sled.j_zz_kgm2 * y[YAW] * y[YAW]
    }

    /// Text with the effects whose forces are not finite at a state.
    pub(crate) fn not_finite(&self, state: &State) -> String {
        let is_finite = |effect: &Active| {
            let mut alone = self.vehicle.clone();
            alone.effects.active = vec![effect.clone()];
            let at = Balance::new(&alone.sled, state, &Motion::default());
            let forces = forces_at(&alone, &at);
            let all = forces.front_body.iter().chain(&forces.rear);
            all.chain(&forces.body).all(|force| force.is_finite())
        };
        let active = self.vehicle.effects.active.iter();
        let names = active.filter(|effect| !is_finite(effect));
        let names = names.map(|effect| format!(", for [effects.{}] is not", effect.name));
        names.collect()
    }

    /// The reason why a simulation cannot continue; `None` if it can.
    pub(crate) fn trouble(&self, y: &Unknowns) -> Option<String> {
        if y.iter().any(|value| !value.is_finite()) {
            return Some("the motion is not finite after this".to_string());
        }
        let (v, n, chi) = (y[VX], y[N], y[CHI]);
        if v < 0.5 {
            let expected = "expected above 0.5 (slope_rad is positive downhill)";
            return Some(format!("speed {v:.2} m/s, {expected}"));
        }
        if v > MAX_SPEED {
            return Some(format!("speed {v:.1e} m/s, expected below {MAX_SPEED}"));
        }
        (n.abs() > 5.0 || chi.abs() > 1.2).then(|| {
            format!(
                "{n:.1} m off the line at a heading of {chi:.2} rad: the sled went off the track"
            )
        })
    }
}
