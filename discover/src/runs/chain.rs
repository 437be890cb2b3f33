//! From measured signals to residuals, through the model with its effects.
//!
//! ```text
//! along:  m a_x - (F_x,f0 + F_x,r + F_air)            [N]     specific force; gravity does not enter
//! side:   m a_y - (F_y,f0 + F_y,r + F_air,y + F_ext)  [N]
//! yaw:    J_zz dyaw/dt - (l_f F_y,f0 - l_r F_y,r)     [N m]
//! track:  d(v cos(alpha))/dt - g sin(slope) - a_x - r v_y             [m/s2]   slope positive downhill; free of friction
//! ```
//!
//! v and alpha belong to the slip sensor at x_s, v_y = -v sin(alpha) - x_s r to the centre of gravity. The balance along
//! the sled's own axis holds at any bank, which runs on different lines feel differently.

use kufe_friction::MagicFormula;
use kufe_sled::effects::{Active, Conditions, Effects, Forces, Kind, Measured, State};
use kufe_sled::{Vehicle, aero, to_centre_of_gravity};

use super::data::Frame;

/// Gravity [m/s2].
pub const GRAVITY: f64 = 9.81;
/// Number of residual channels.
pub const CHANNELS: usize = 4;
/// Their names and units.
pub const CHANNEL_NAMES: [(&str, &str); CHANNELS] = [
    ("along", "N"),
    ("side", "N"),
    ("yaw", "N m"),
    ("track", "m/s2"),
];
/// Number of base parameters.
pub const BASE: usize = 5;
/// Multipliers of the base model: what they multiply.
pub const BASE_NAMES: [&str; BASE] = [
    "longitudinal mu",
    "front mu_zeta",
    "front k_n_per_rad",
    "rear mu_zeta",
    "rear k_n_per_rad",
];

/// The base model, its multipliers and the effects that are switched on.
#[derive(Clone)]
pub struct Chain {
    /// The model as it was given.
    pub vehicle: Vehicle,
    /// Multipliers of the base parameters.
    pub base: [f64; BASE],
    /// Effects.
    pub effects: Effects,
    /// Names of effects whose size is not fitted with the forces: it comes from the track channel.
    pub frozen: Vec<String>,
}

/// Residuals by channel; an unused channel is empty.
pub type Rows = [Vec<f64>; CHANNELS];

impl Chain {
    /// The same with one more effect.
    pub fn with(&self, effect: Active) -> Self {
        let mut chain = self.clone();
        chain.effects.active.push(effect);
        chain
    }

    /// Residuals of one run.
    pub fn residuals(&self, frame: &Frame) -> Rows {
        let n = frame.len();
        let mut rows: Rows = std::array::from_fn(|_| Vec::with_capacity(n));
        let effects = self.on_track(&frame.track);
        let laws = self.laws();
        let humidity = frame.extra.get("humidity_pct");
        let wear = frame.extra.get("distance_m");
        for i in 0..n {
            let humidity = humidity.map_or(f64::NAN, |x| x[i]);
            let distance = wear.map_or(frame.distance_before, |x| x[i]);
            self.one(frame, i, &effects, &laws, (humidity, distance), &mut rows);
        }
        rows
    }

    fn on_track(&self, track: &str) -> Effects {
        let acts = |e: &&Active| e.track.as_deref().is_none_or(|only| only == track);
        let mut active: Vec<Active> = self.effects.active.iter().filter(acts).cloned().collect();
        active.iter_mut().for_each(|e| e.track = None);
        Effects { active }
    }

    /// The lateral laws with the base multipliers applied.
    pub fn laws(&self) -> [MagicFormula; 2] {
        let scaled = |law: MagicFormula, mu: f64, k: f64| MagicFormula {
            mu_zeta: law.mu_zeta * mu,
            k_n_per_rad: law.k_n_per_rad * k,
            ..law
        };
        [
            scaled(self.vehicle.front.lateral, self.base[1], self.base[2]),
            scaled(self.vehicle.rear.lateral, self.base[3], self.base[4]),
        ]
    }

    fn one(
        &self,
        frame: &Frame,
        i: usize,
        effects: &Effects,
        laws: &[MagicFormula; 2],
        (humidity_pct, distance): (f64, f64),
        rows: &mut Rows,
    ) {
        let sled = &self.vehicle.sled;
        let mut m = Measured {
            acceleration: [
                frame.acceleration[0][i],
                frame.acceleration[1][i],
                frame.acceleration[2][i],
            ],
            slip: frame.slip[i],
            slip_rate: frame.slip_rate[i],
            steering: frame.steer[i],
            accelerometer: [sled.accel_x_m, sled.accel_y_m, sled.accel_z_m],
            mass: sled.mass_kg,
        };
        effects.correct(&mut m);
        let rate = [frame.rate[0][i], frame.rate[1][i], frame.rate[2][i]];
        let rate_slope = [
            frame.rate_slope[0][i],
            frame.rate_slope[1][i],
            frame.rate_slope[2][i],
        ];
        let a = to_centre_of_gravity(m.acceleration, rate, rate_slope, m.accelerometer);
        let v = frame.v[i].max(0.5);
        let turn = |x: f64| (x - sled.slip_x_m) / v;
        let chassis = m.slip - rate[2] * turn(0.0);
        let slip = [
            m.slip - rate[2] * turn(sled.l_f_m) + m.steering,
            m.slip - rate[2] * turn(-sled.l_r_m),
        ];
        let slip_rate = [
            m.slip_rate - rate_slope[2] * turn(sled.l_f_m) + frame.steer_rate[i],
            m.slip_rate - rate_slope[2] * turn(-sled.l_r_m),
        ];
        let wheelbase = sled.l_f_m + sled.l_r_m;
        let (weight, pitch) = (m.mass * a[2], sled.j_yy_kgm2 * rate_slope[1]);
        let front_z = (sled.l_r_m * weight - pitch) / wheelbase;
        let rear_z = (sled.l_f_m * weight + pitch) / wheelbase;

        let air_density = aero::air_density(frame.air_pa, frame.air_c);
        let drag = aero::drag(sled, v, air_density, -chassis);
        let (sg, cg) = frame.roll_split[i].sin_cos();
        let (sd, cd) = m.steering.sin_cos();
        let curvature = -rate[1] / v;
        let mu = |runner: &kufe_sled::RunnerFriction, load: f64| {
            self.base[0] * runner.mu(load, curvature)
        };

        // One Newton step settles how the front runner's load hangs on its side force through the roll split.
        let mut front_load = front_z / cg;
        if sg != 0.0 {
            let law = laws[0].derivatives(slip[0], front_load);
            let residual = cg * front_load + sg * cd * law.fy - front_z;
            front_load -= residual / (cg + sg * cd * law.fz);
        }
        let front = laws[0].derivatives(slip[0], front_load);
        let rear = laws[1].derivatives(slip[1], rear_z);
        let load = [front_load, rear_z];
        let mut forces = Forces {
            along: [
                -mu(&self.vehicle.front, front_load) * front_load * slip[0].cos(),
                -mu(&self.vehicle.rear, rear_z) * rear_z * slip[1].cos(),
            ],
            across: [front.fy, rear.fy],
            stiffness: [front.alpha, rear.alpha],
            body_along: 0.0,
            body_across: 0.0,
        };
        if !effects.is_empty() {
            let state = State {
                conditions: Conditions {
                    t: frame.t[i],
                    s: frame.s[i],
                    v,
                    fz: f64::NAN,
                    ice_c: frame.ice_c,
                    air_c: frame.air_c,
                    air_pa: frame.air_pa,
                    humidity_pct,
                    distance,
                    air_density,
                    drag_area: sled.cda_m2,
                },
                slip,
                slip_rate,
                load,
                chassis_slip: chassis,
                steering: m.steering,
                roll_split: frame.roll_split[i],
                roll_rate: rate[0],
                roll_acceleration: rate_slope[0],
                yaw_rate: rate[2],
                acceleration: a,
                mass: m.mass,
            };
            effects.act("", &state, &mut forces);
        }
        let (fx, fy) = (forces.along[0], forces.across[0]);
        let front_load = (front_z - sg * (sd * fx + cd * fy)) / cg;
        let front_x = cd * fx - sd * fy;
        let front_y = cg * (sd * fx + cd * fy) - sg * front_load;
        let (sa, ca) = chassis.sin_cos();
        rows[0].push(m.mass * a[0] - (front_x + forces.along[1] + drag * ca + forces.body_along));
        rows[1].push(m.mass * a[1] - (front_y + forces.across[1] - drag * sa + forces.body_across));
        rows[2].push(
            sled.j_zz_kgm2 * rate_slope[2] - (sled.l_f_m * front_y - sled.l_r_m * forces.across[1]),
        );
        if let Some(slope) = frame.slope.get(i) {
            let slope = slope + effects.slope("", frame.s[i]);
            let (sin, cos) = m.slip.sin_cos();
            let forward = frame.v_slope[i] * cos - frame.v[i] * sin * m.slip_rate;
            let across = -frame.v[i] * sin - sled.slip_x_m * rate[2];
            rows[3].push(forward - GRAVITY * slope.sin() - a[0] - rate[2] * across);
        }
    }

    /// The amplitudes that are fitted: place of the effect, place of the parameter.
    pub fn free(&self) -> Vec<(usize, usize)> {
        let mut free = Vec::new();
        for (e, effect) in self.effects.active.iter().enumerate() {
            if self.frozen.contains(&effect.name) {
                continue;
            }
            match &effect.kind {
                Kind::Custom(_) => free.push((e, 0)),
                Kind::Catalogue(kind) => {
                    for (p, parameter) in kind.info().parameters.iter().enumerate() {
                        if parameter.is_amplitude() && effect.values[p] != 0.0 {
                            free.push((e, p));
                        }
                    }
                }
            }
        }
        free
    }
}
