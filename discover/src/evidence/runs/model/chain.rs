//! From measured signals to residuals, through the model with its effects.
//!
//! ```text
//! along:  m a_x - (F_x,f0 + F_x,r + F_air)            [N]     specific force; gravity does not enter
//! side:   m a_y - (F_y,f0 + F_y,r + F_air,y + F_ext)  [N]
//! yaw:    J_zz dyaw/dt - (l_f F_y,f0 - l_r F_y,r)     [N m]
//! track:  d(v cos(alpha))/dt - g sin(slope) - a_x - r v_y             [m/s2]   slope positive downhill; free of friction
//!     or  dv/dt - g sin(slope) - a_x cos(beta) - a_y sin(beta)        [m/s2]   where the slope holds along the sled's way
//! ```
//!
//! v and alpha belong to the slip sensor at x_s, v_y = -v sin(alpha) - x_s r and beta = atan(v_y/v_x) to the centre of
//! gravity. Balances are taken at the rate of the kept samples and low-passed afterwards, all terms alike: a product of
//! two smoothed signals is not the smoothed product.

use kufe_friction::{LateralDerivatives, MagicFormula};
use kufe_sled::effects::{Active, Conditions, Effects, Forces, Kind, Measured, State};
use kufe_sled::{Vehicle, aero, to_centre_of_gravity};

use crate::evidence::runs::recordings::frame::Frame;

/// Gravity [m/s2].
pub const GRAVITY: f64 = 9.81;
/// Number of residual channels.
pub const CHANNELS: usize = 4;
/// Those of them that the forces enter: the first.
pub const BALANCES: usize = 3;
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
    /// Whether the track's slope holds along the sled's way rather than along its axis.
    pub along_path: bool,
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

    /// Residuals of one run, low-passed and thinned to rows.
    pub fn residuals(&self, frame: &Frame) -> Rows {
        self.raw(frame).map(|channel| frame.rows(&channel))
    }

    /// Residuals of one run at every kept sample.
    pub fn raw(&self, frame: &Frame) -> Rows {
        let mut rows: Rows = std::array::from_fn(|_| Vec::with_capacity(frame.len()));
        let here = Here::new(self, frame);
        for i in 0..frame.len() {
            let m = here.measured(i, self.vehicle.sled.mass_kg);
            let values = here.residual(i, &m);
            for (row, value) in rows.iter_mut().zip(values) {
                row.push(value);
            }
        }
        if frame.slope.is_empty() {
            rows[3].clear();
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

    /// The unit in which an active amplitude is fitted.
    pub fn scale(&self, effect: usize, parameter: usize) -> f64 {
        let active = &self.effects.active[effect];
        match &active.kind {
            Kind::Catalogue(kind) => kind.info().parameters[parameter].typical,
            Kind::Custom(_) => active.values[parameter].abs().max(1e-9),
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

/// What one sample says before any law is asked.
#[derive(Clone, Copy)]
pub struct Instant {
    /// What the effects see; the loads are those of the laws that were asked last.
    pub state: State,
    signals: Measured,
    front_z: f64,
    rear_z: f64,
    curvature: f64,
    drag: f64,
    yaw_slope: f64,
    split: (f64, f64),
    steer: (f64, f64),
    chassis: (f64, f64),
    laws: [LateralDerivatives; 2],
}

/// A chain on one run: the effects that act there, the laws, the weather.
pub struct Here<'a> {
    chain: &'a Chain,
    frame: &'a Frame,
    effects: Effects,
    laws: [MagicFormula; 2],
    humidity: Option<&'a Vec<f64>>,
    wear: Option<&'a Vec<f64>>,
}

impl<'a> Here<'a> {
    /// Prepares a run.
    pub fn new(chain: &'a Chain, frame: &'a Frame) -> Self {
        Self {
            chain,
            frame,
            effects: chain.on_track(&frame.track),
            laws: chain.laws(),
            humidity: frame.extra.get("humidity_pct"),
            wear: frame.extra.get("distance_m"),
        }
    }

    /// The signals of a sample, corrected by the active effects.
    pub fn measured(&self, i: usize, mass: f64) -> Measured {
        let (frame, sled) = (self.frame, &self.chain.vehicle.sled);
        let mut m = Measured {
            acceleration: std::array::from_fn(|axis| frame.acceleration[axis][i]),
            slip: frame.slip[i],
            slip_rate: frame.slip_rate[i],
            steering: frame.steer[i],
            accelerometer: [sled.accel_x_m, sled.accel_y_m, sled.accel_z_m],
            mass,
        };
        self.effects.correct(&mut m);
        m
    }

    /// The motion of a sample, from its corrected signals.
    pub fn instant(&self, i: usize, m: &Measured) -> Instant {
        let (frame, sled) = (self.frame, &self.chain.vehicle.sled);
        let rate: [f64; 3] = std::array::from_fn(|axis| frame.rate[axis][i]);
        let rate_slope: [f64; 3] = std::array::from_fn(|axis| frame.rate_slope[axis][i]);
        let a = to_centre_of_gravity(m.acceleration, rate, rate_slope, m.accelerometer);
        let v = frame.v[i].max(0.5);
        let turn = |x: f64| (x - sled.slip_x_m) / v;
        let chassis = m.slip - rate[2] * turn(0.0);
        let wheelbase = sled.l_f_m + sled.l_r_m;
        let (weight, pitch) = (m.mass * a[2], sled.j_yy_kgm2 * rate_slope[1]);
        let air_density = aero::air_density(frame.air_pa, frame.air_c);
        Instant {
            state: State {
                conditions: Conditions {
                    t: frame.t[i],
                    s: frame.s[i],
                    v,
                    fz: f64::NAN,
                    ice_c: frame.ice_c,
                    air_c: frame.air_c,
                    air_pa: frame.air_pa,
                    humidity_pct: self.humidity.map_or(f64::NAN, |x| x[i]),
                    distance: self.wear.map_or(frame.distance_before, |x| x[i]),
                    air_density,
                    drag_area: sled.cda_m2,
                },
                slip: [
                    m.slip - rate[2] * turn(sled.l_f_m) + m.steering,
                    m.slip - rate[2] * turn(-sled.l_r_m),
                ],
                slip_rate: [
                    m.slip_rate - rate_slope[2] * turn(sled.l_f_m) + frame.steer_rate[i],
                    m.slip_rate - rate_slope[2] * turn(-sled.l_r_m),
                ],
                load: [f64::NAN; 2],
                chassis_slip: chassis,
                steering: m.steering,
                roll_split: frame.roll_split[i],
                roll_rate: rate[0],
                roll_acceleration: rate_slope[0],
                yaw_rate: rate[2],
                acceleration: a,
                mass: m.mass,
            },
            signals: *m,
            front_z: (sled.l_r_m * weight - pitch) / wheelbase,
            rear_z: (sled.l_f_m * weight + pitch) / wheelbase,
            curvature: -rate[1] / v,
            drag: aero::drag(sled, v, air_density, -chassis),
            yaw_slope: rate_slope[2],
            split: frame.roll_split[i].sin_cos(),
            steer: m.steering.sin_cos(),
            chassis: chassis.sin_cos(),
            laws: [LateralDerivatives::default(); 2],
        }
    }

    /// Forces of the base laws, which stay with `at`.
    fn base_forces(&self, at: &mut Instant) -> Forces {
        let (sg, cg) = at.split;
        let cd = at.steer.1;
        let slip = at.state.slip;
        // One Newton step settles how the front runner's load hangs on its side force through the roll split.
        let mut front_load = at.front_z / cg;
        let mut front = self.laws[0].derivatives(slip[0], front_load);
        if sg != 0.0 {
            let residual = cg * front_load + sg * cd * front.fy - at.front_z;
            let step = residual / (cg + sg * cd * front.fz);
            front_load -= step;
            front.fy -= front.fz * step;
        }
        at.laws = [front, self.laws[1].derivatives(slip[1], at.rear_z)];
        self.as_forces(at, front_load)
    }

    /// The same from the laws of a motion close by, to first order.
    fn base_forces_near(&self, at: &mut Instant, known: &Instant) -> Forces {
        let (sg, cg) = at.split;
        let cd = at.steer.1;
        at.laws = known.laws;
        for (runner, law) in at.laws.iter_mut().enumerate() {
            law.fy += law.alpha * (at.state.slip[runner] - known.state.slip[runner]);
        }
        let front = &mut at.laws[0];
        let mut front_load = known.state.load[0];
        let residual = cg * front_load + sg * cd * front.fy - at.front_z;
        let step = residual / (cg + sg * cd * front.fz);
        front_load -= step;
        front.fy -= front.fz * step;
        let rear = &mut at.laws[1];
        rear.fy += rear.fz * (at.rear_z - known.rear_z);
        self.as_forces(at, front_load)
    }

    fn as_forces(&self, at: &mut Instant, front_load: f64) -> Forces {
        at.state.load = [front_load, at.rear_z];
        let vehicle = &self.chain.vehicle;
        let along = |runner: usize, law: &kufe_sled::RunnerFriction| {
            let load = at.state.load[runner];
            let mu = self.chain.base[0] * law.mu(load, at.curvature);
            -mu * load * at.state.slip[runner].cos()
        };
        Forces {
            along: [along(0, &vehicle.front), along(1, &vehicle.rear)],
            across: at.laws.map(|law| law.fy),
            stiffness: at.laws.map(|law| law.alpha),
            body_along: 0.0,
            body_across: 0.0,
        }
    }

    fn with_effects(&self, at: &Instant, mut forces: Forces) -> Forces {
        if !self.effects.is_empty() {
            self.effects.act("", &at.state, &mut forces);
        }
        forces
    }

    /// Forces of the base laws, and with the chain's effects.
    pub fn forces(&self, at: &mut Instant) -> [Forces; 2] {
        let base = self.base_forces(at);
        [base, self.with_effects(at, base)]
    }

    /// Balances with base multiplier `b` moved by a small `step`; `base` are the base laws' forces.
    pub fn balances_with_base(
        &self,
        at: &Instant,
        base: &Forces,
        b: usize,
        step: f64,
    ) -> [f64; BALANCES] {
        let mut forces = *base;
        let change = step / self.chain.base[b];
        match b {
            0 => forces.along.iter_mut().for_each(|f| *f *= 1.0 + change),
            _ => {
                let runner = (b - 1) / 2;
                let (law, by) = (&self.laws[runner], &at.laws[runner]);
                forces.across[runner] += if b % 2 == 1 {
                    law.mu_zeta * change * by.mu_zeta
                } else {
                    law.k_n_per_rad * change * by.k_n_per_rad
                };
            }
        }
        self.balances(at, &self.with_effects(at, forces))
    }

    /// What the balances along, aside and about the vertical leave of these forces.
    pub fn balances(&self, at: &Instant, forces: &Forces) -> [f64; BALANCES] {
        let sled = &self.chain.vehicle.sled;
        let (m, a) = (&at.signals, &at.state.acceleration);
        let ((sg, cg), (sd, cd), (sa, ca)) = (at.split, at.steer, at.chassis);
        let (fx, fy) = (forces.along[0], forces.across[0]);
        let front_load = (at.front_z - sg * (sd * fx + cd * fy)) / cg;
        let front_x = cd * fx - sd * fy;
        let front_y = cg * (sd * fx + cd * fy) - sg * front_load;
        [
            m.mass * a[0] - (front_x + forces.along[1] + at.drag * ca + forces.body_along),
            m.mass * a[1] - (front_y + forces.across[1] - at.drag * sa + forces.body_across),
            sled.j_zz_kgm2 * at.yaw_slope - (sled.l_f_m * front_y - sled.l_r_m * forces.across[1]),
        ]
    }

    /// What the track channel leaves; 0 without a survey.
    fn track(&self, i: usize, at: &Instant) -> f64 {
        let (frame, sled) = (self.frame, &self.chain.vehicle.sled);
        let (a, (sa, ca)) = (&at.state.acceleration, at.chassis);
        let Some(slope) = frame.slope.get(i) else {
            return 0.0;
        };
        let gravity = GRAVITY * (slope + self.effects.slope("", frame.s[i])).sin();
        if self.chain.along_path {
            return frame.v_slope[i] - gravity - a[0] * ca + a[1] * sa;
        }
        let (sin, cos) = at.signals.slip.sin_cos();
        let forward = frame.v_slope[i] * cos - frame.v[i] * sin * at.signals.slip_rate;
        let rate = at.state.yaw_rate;
        let across = -frame.v[i] * sin - sled.slip_x_m * rate;
        forward - gravity - a[0] - rate * across
    }

    /// Residual of a sample with these corrected signals.
    pub fn residual(&self, i: usize, m: &Measured) -> [f64; CHANNELS] {
        let mut at = self.instant(i, m);
        let [_, forces] = self.forces(&mut at);
        let [along, side, yaw] = self.balances(&at, &forces);
        [along, side, yaw, self.track(i, &at)]
    }

    /// Balances of a sample by this chain, `at` and `base` being motion and base forces of one with the same base laws.
    pub fn balances_beside(&self, i: usize, at: &Instant, base: &Forces) -> [f64; BALANCES] {
        let m = self.measured(i, self.chain.vehicle.sled.mass_kg);
        if m == at.signals {
            return self.balances(at, &self.with_effects(at, *base));
        }
        let mut other = self.instant(i, &m);
        let [_, forces] = self.forces(&mut other);
        self.balances(&other, &forces)
    }

    /// Balances of a sample with one more effect at a small size, `at` and `forces` being those without it.
    pub fn balances_with(
        &self,
        i: usize,
        effect: &Active,
        at: &Instant,
        forces: &Forces,
    ) -> [f64; BALANCES] {
        if effect
            .track
            .as_deref()
            .is_some_and(|only| only != self.frame.track)
        {
            return self.balances(at, forces);
        }
        match &effect.kind {
            Kind::Custom(custom) => {
                let mut forces = *forces;
                custom.act(effect.values[0], &at.state, &mut forces);
                self.balances(at, &forces)
            }
            Kind::Catalogue(kind) => {
                let mut m = at.signals;
                kind.correct(&effect.values, &mut m);
                if m == at.signals {
                    let mut forces = *forces;
                    kind.act(&effect.values, &at.state, &mut forces);
                    return self.balances(at, &forces);
                }
                // Another signal is another motion.
                let mut other = self.instant(i, &m);
                let base = self.base_forces_near(&mut other, at);
                let mut forces = self.with_effects(&other, base);
                kind.act(&effect.values, &other.state, &mut forces);
                self.balances(&other, &forces)
            }
        }
    }
}
