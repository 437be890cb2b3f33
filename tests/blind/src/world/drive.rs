//! The drive: equations of motion down a track, a driver with noise, and the true channels.

use std::cell::Cell;

use crate::world::hidden::{Hidden, Kind};
use crate::world::noise::{Smooth, Source};
use crate::world::sled::{Conditions, Motion, Sled, forces};
use crate::world::track::Track;

const GRAVITY: f64 = 9.81;
/// Sampling interval of the files [s].
pub const SAMPLE_S: f64 = 0.01;
const SUBSTEPS: usize = 2;

/// Everything about one run that is drawn before it starts.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Speed at s = 0 [m/s].
    pub start_mps: f64,
    /// Longest duration [s].
    pub duration_s: f64,
    /// Steering that the line does not ask for [rad] over time.
    pub steering: Smooth,
    /// Roll-split in addition to the track's twist [rad] over time.
    pub roll_split: Smooth,
    /// Pitch rate over ice that is not the table's [rad/s] over time.
    pub pitch: Smooth,
    /// Roll rate that is not the table's [rad/s] over time.
    pub roll: Smooth,
    /// Recorded extra channel over time.
    pub extra: Smooth,
}

impl Plan {
    /// Draws a plan; `skill` scales the driver's superfluous steering.
    pub fn draw(duration_s: f64, skill: f64, source: &mut Source) -> Self {
        Self {
            start_mps: 12.0 + 0.4 * source.normal(),
            duration_s,
            steering: Smooth::new(0.007 * skill, 0.15, 1.4, source),
            roll_split: Smooth::new(0.012, 0.2, 2.0, source),
            pitch: Smooth::new(0.02, 0.3, 2.5, source),
            roll: Smooth::new(0.05, 0.3, 2.0, source),
            extra: Smooth::new(1.0, 0.1, 0.8, source),
        }
    }
}

/// True values at one sample.
#[derive(Debug, Clone, Copy, Default)]
pub struct Truth {
    /// What the forces saw.
    pub motion: Motion,
    /// Specific force at the centre of gravity [m/s2].
    pub specific_mps2: [f64; 3],
    /// Roll, pitch and yaw rates [rad/s].
    pub rates_radps: [f64; 3],
    /// Roll, pitch and yaw accelerations [rad/s2].
    pub angular_radps2: [f64; 3],
    /// Velocity at the centre of gravity along x and y [m/s].
    pub velocity_mps: [f64; 2],
    /// Offset from the line, left positive [m].
    pub offset_m: f64,
    /// Angle of the velocity to the line [rad].
    pub course_rad: f64,
    /// Height lost since the start [m].
    pub drop_m: f64,
    /// Work of ice and air since the start [J].
    pub work_j: f64,
}

const STATES: usize = 11;
type State = [f64; STATES];
const S: usize = 0;
const N: usize = 1;
const E: usize = 2;
const VX: usize = 3;
const VY: usize = 4;
const R: usize = 5;
const DELTA: usize = 6;
const LAG_F: usize = 7;
const LAG_R: usize = 8;
const DROP: usize = 9;
const WORK: usize = 10;

struct Ride<'a> {
    sled: &'a Sled,
    track: &'a Track,
    at: &'a Conditions,
    plan: &'a Plan,
    hidden: &'a [Hidden],
    relaxation_m: f64,
    /// The plan at the last requested time: two stages of a step share theirs.
    drawn: Cell<(f64, Drawn)>,
}

/// A plan's values at one time.
#[derive(Clone, Copy, Default)]
struct Drawn {
    roll: f64,
    roll_slope: f64,
    pitch: f64,
    pitch_slope: f64,
    roll_split: f64,
    extra: f64,
    steering: f64,
}

impl Plan {
    fn drawn(&self, t: f64) -> Drawn {
        Drawn {
            roll: self.roll.at(t),
            roll_slope: self.roll.slope_at(t),
            pitch: self.pitch.at(t),
            pitch_slope: self.pitch.slope_at(t),
            roll_split: self.roll_split.at(t),
            extra: self.extra.at(t),
            steering: self.steering.at(t),
        }
    }
}

impl Ride<'_> {
    fn drawn(&self, t: f64) -> Drawn {
        let (at, known) = self.drawn.get();
        if at == t {
            return known;
        }
        let drawn = self.plan.drawn(t);
        self.drawn.set((t, drawn));
        drawn
    }

    /// Derivative of the state and the sample's truth; `vdot` is the last speed derivative.
    fn evaluate(&self, t: f64, x: &State, vdot: f64) -> (State, Truth) {
        let (sled, track) = (self.sled, self.track);
        let s = x[S];
        let plan = self.drawn(t);
        let (vx, vy, r) = (x[VX], x[VY], x[R]);
        let v = vx.hypot(vy);
        let profile = |values: &[f64]| track.at(values, s);
        let along = |values: &[f64]| {
            let h = track.step_m;
            (track.at(values, s + h) - track.at(values, s - h)) / (2.0 * h)
        };
        let path = vx * x[E].cos() - vy * x[E].sin();
        let e_dot = r - path * profile(&track.yaw_1pm);
        let p = path * profile(&track.roll_1pm) + plan.roll;
        let q = -path * profile(&track.curvature_1pm) + plan.pitch;
        let p_dot = vdot * profile(&track.roll_1pm)
            + path * path * along(&track.roll_1pm)
            + plan.roll_slope;
        let q_dot = -vdot * profile(&track.curvature_1pm)
            - path * path * along(&track.curvature_1pm)
            + plan.pitch_slope;
        // slope and bank are those along the way the sled takes, so that height goes with distance
        let (theta, phi) = (-profile(&track.slope_rad), profile(&track.bank_rad));
        let (sin_b, cos_b) = vy.atan2(vx).sin_cos();
        let (ahead, aside) = (GRAVITY * theta.sin(), -GRAVITY * theta.cos() * phi.sin());
        let gravity = [
            cos_b * ahead - sin_b * aside,
            cos_b * aside + sin_b * ahead,
            -GRAVITY * theta.cos() * phi.cos(),
        ];

        let f_z = p * vy - q * vx - gravity[2];
        let wheelbase = sled.l_f_m + sled.l_r_m;
        let fz_f0 = (sled.l_r_m * sled.mass_kg * f_z - sled.j_yy_kgm2 * q_dot) / wheelbase;
        let gamma = profile(&track.roll_1pm) * wheelbase + plan.roll_split;
        let slip_f = -(vy + r * sled.l_f_m).atan2(vx) + x[DELTA];
        let slip_r = -(vy - r * sled.l_r_m).atan2(vx);
        let lagged = self.relaxation_m > 0.0;
        let motion = Motion {
            t_s: t,
            s_m: s,
            v_mps: v,
            beta_rad: vy.atan2(vx),
            slip_f_rad: if lagged { x[LAG_F] } else { slip_f },
            slip_r_rad: if lagged { x[LAG_R] } else { slip_r },
            delta_rad: x[DELTA],
            gamma_rad: gamma,
            fz_f0_n: fz_f0,
            fz_r_n: sled.mass_kg * f_z - fz_f0,
            roll_rate_radps: p,
            roll_acc_radps2: p_dot,
            pitch_rate_radps: q,
            extra: plan.extra,
        };
        let force = forces(sled, self.at, &motion, self.hidden);
        let f_x = force.x_n / sled.mass_kg;
        let f_y = force.y_n / sled.mass_kg;

        let mut d = [0.0; STATES];
        d[S] = path;
        d[N] = vx * x[E].sin() + vy * x[E].cos();
        d[E] = e_dot;
        d[VX] = f_x + r * vy + gravity[0];
        d[VY] = f_y - r * vx + gravity[1];
        d[R] = force.yaw_nm / sled.j_zz_kgm2;
        d[DELTA] = (self.steering(t, x, path, phi, theta, &motion) - x[DELTA]) / 0.06;
        if lagged {
            d[LAG_F] = v / self.relaxation_m * (slip_f - x[LAG_F]);
            d[LAG_R] = v / self.relaxation_m * (slip_r - x[LAG_R]);
        }
        d[DROP] = (gravity[0] * vx + gravity[1] * vy) / GRAVITY;
        d[WORK] = force.x_n * vx + force.y_n * vy;
        let truth = Truth {
            motion,
            specific_mps2: [f_x, f_y, f_z],
            rates_radps: [p, q, r],
            angular_radps2: [p_dot, q_dot, d[R]],
            velocity_mps: [vx, vy],
            offset_m: x[N],
            course_rad: x[E] + vy.atan2(vx),
            drop_m: x[DROP],
            work_j: x[WORK],
        };
        (d, truth)
    }

    /// The driver: steady-state steering for the line's yaw rate and side force, feedback on
    /// heading and offset, and steering of his own.
    fn steering(&self, t: f64, x: &State, path: f64, phi: f64, theta: f64, m: &Motion) -> f64 {
        let sled = self.sled;
        let ahead = x[S] + 0.06 * path;
        let yaw = path * self.track.at(&self.track.yaw_1pm, ahead);
        let side = sled.mass_kg * (path * yaw + GRAVITY * phi.sin() * theta.cos());
        let wheelbase = sled.l_f_m + sled.l_r_m;
        let front = side * sled.l_r_m / wheelbase / sled.front.k_n_per_rad;
        let rear = side * sled.l_f_m / wheelbase / sled.rear.k_n_per_rad;
        let heading = x[E] + m.beta_rad;
        let wish = wheelbase * yaw / path.max(3.0) + front - rear - 0.35 * heading - 0.006 * x[N]
            + self.drawn(t).steering;
        wish.clamp(-0.12, 0.12)
    }
}

/// Integrates a run with the classical Runge-Kutta method at half the sampling interval.
///
/// Ends at the plan's duration or five metres before the track's end.
pub fn drive(
    sled: &Sled,
    track: &Track,
    at: &Conditions,
    plan: &Plan,
    hidden: &[Hidden],
) -> Vec<Truth> {
    let relaxation_m = hidden
        .iter()
        .find(|effect| effect.kind == Kind::RelaxationLength)
        .map_or(0.0, |effect| effect.size);
    let ride = Ride {
        sled,
        track,
        at,
        plan,
        hidden,
        relaxation_m,
        drawn: Cell::new((f64::NAN, Drawn::default())),
    };
    let mut x = [0.0; STATES];
    x[VX] = plan.start_mps;
    let h = SAMPLE_S / SUBSTEPS as f64;
    let mut truths = Vec::new();
    let mut vdot = 0.8;
    let samples = (plan.duration_s / SAMPLE_S) as usize;
    for k in 0..samples {
        for sub in 0..SUBSTEPS {
            let t = (k * SUBSTEPS + sub) as f64 * h;
            let (k1, truth) = ride.evaluate(t, &x, vdot);
            vdot = k1[VX];
            if sub == 0 {
                truths.push(truth);
            }
            let moved = |d: &State, f: f64| std::array::from_fn(|i| x[i] + f * d[i]);
            let (k2, _) = ride.evaluate(t + 0.5 * h, &moved(&k1, 0.5 * h), vdot);
            let (k3, _) = ride.evaluate(t + 0.5 * h, &moved(&k2, 0.5 * h), vdot);
            let (k4, _) = ride.evaluate(t + h, &moved(&k3, h), vdot);
            for i in 0..STATES {
                x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
        if x[S] > track.length_m() - 5.0 || x[VX] < 2.0 {
            break;
        }
    }
    truths
}
