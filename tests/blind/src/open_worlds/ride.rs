//! The ride: a two-track sled down a track, with a driver in the loop.
//!
//! In the frame of the ice under the sled, x along the sled, with the up direction `u` and the
//! rates `(p, q, r)` of that frame about its axes:
//!
//! ```text
//! v_x' = F_x/m - g u_x + r v_y        f_z = p v_y - q v_x + g u_z
//! v_y' = F_y/m - g u_y - r v_x        J_zz r' = sum x_i F_yi - y_i F_xi
//! N_front + N_rear = m f_z            J_yy q' = -l_f N_front + l_r N_rear - h F_x,ice
//! J_b (p' + phi_r'') = h F_y,rear + (h - h_j) F_y,front + M_rear + T
//! J_f (p' + phi_f'') = h_j F_y,front + M_front - T
//! M_i = -k_i phi_i - c_i phi_i' = b (N_left - N_right)        T = k_t gamma + c_t gamma'
//! ```
//!
//! Along the line `s' = (v_x cos(chi) - v_y sin(chi))/(1 - n w_z)` with the line's rotation w
//! [rad/m]. The channel is concave: off the line the bank grows, and the ice of a
//! growing bank rises by `n w_x`, which tilts `u`.
//!
//! `phi_r` and `phi_f` are the roll of body and front part against the ice under their axles,
//! `gamma` is the bank at the front less that at the rear plus `phi_f - phi_r`, the roll split. The
//! runners scrub sideways as the frame rolls: their contacts move with `v_y + x r + h phi'`.
//!
//! Integrated by the implicit midpoint rule, `k = f(x + h k/2)`, by fixed-point iteration. It is of
//! second order, and keeps the energy of an oscillation.
//!
//! Hairer, Lubich, Wanner, *Geometric Numerical Integration*, II.1; for the vehicle Pacejka, *Tire
//! and Vehicle Dynamics*, ch. 1.

use super::hidden::{Acts, Secret};
use super::sled::Sled;
use super::track::{GRAVITY, Here, Track};
use crate::world::noise::Smooth;

/// Steps a second.
pub const RATE_HZ: f64 = 2000.0;
/// Fixed-point iterations of a step: roll modes of 370 rad/s converge by a factor of ten in each.
const ITERATIONS: usize = 3;
/// Time by which the steering follows the handles [s].
const STEERING_S: f64 = 0.004;
/// Time constant of the slip that a hysteresis follows [s].
const HYSTERESIS_S: f64 = 0.05;

/// Who steers.
#[derive(Debug, Clone)]
pub enum Driver {
    /// Follows the line, with steering of his own [rad over s].
    Follows(Smooth),
    /// Keeps the handles where they are [rad].
    Holds(f64),
}

/// What was drawn for one run.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Who steers.
    pub driver: Driver,
    /// Speed at the start [m/s].
    pub start_mps: f64,
    /// Air density [kg/m3].
    pub air: f64,
    /// Wind against the sled [m/s], and its gusts over time.
    pub wind_mps: f64,
    /// See `wind_mps`.
    pub gusts: Option<Smooth>,
    /// Ice temperature [C], and what it differs by along the track.
    pub ice_c: f64,
    /// See `ice_c`.
    pub ice_along: Option<Smooth>,
    /// Change of mu and of lateral forces with the ice [1/K].
    pub ice_per_k: [f64; 2],
    /// Factors of mu and of lateral forces.
    pub factors: [f64; 2],
    /// A warm stretch: from, to [m], what mu gains and lateral forces lose there.
    pub warm: [f64; 4],
    /// Braking at the end: from [m], force [N].
    pub brake: [f64; 2],
    /// Centre of gravity to the left of the middle [m].
    pub left_m: f64,
    /// Runner's temperature less its mean, over time [K].
    pub runner_c: Option<Smooth>,
    /// Snow over distance.
    pub snow: Option<Smooth>,
    /// When ice chips are under the runners [s].
    pub chips_s: [f64; 4],
    /// Whether hidden walls are on this track.
    pub has_wall: bool,
}

impl Plan {
    /// A run on even ice in still air.
    pub fn still(driver: Driver, start_mps: f64) -> Self {
        Self {
            driver,
            start_mps,
            air: 1.25,
            wind_mps: 0.0,
            gusts: None,
            ice_c: REFERENCE_C,
            ice_along: None,
            ice_per_k: [0.0; 2],
            factors: [1.0; 2],
            warm: [0.0; 4],
            brake: [f64::INFINITY, 0.0],
            left_m: 0.0,
            runner_c: None,
            snow: None,
            chips_s: [-1.0; 4],
            has_wall: false,
        }
    }
}

/// Load of an axle at which a load sensitivity changes nothing [N].
const REFERENCE_N: f64 = 3000.0;
/// Speed at which laws over speed change nothing [m/s].
const REFERENCE_MPS: f64 = 24.0;

/// Ice temperature at which mu and lateral forces are those of the sled [C].
pub const REFERENCE_C: f64 = -7.0;

/// Truth at the middle of a step.
#[derive(Debug, Clone, Copy, Default)]
pub struct Truth {
    /// Distance, offset to the left [m].
    pub place_m: [f64; 2],
    /// Velocity of the centre of gravity [m/s].
    pub velocity_mps: [f64; 2],
    /// Specific force at the centre of gravity [m/s2].
    pub felt_mps2: [f64; 3],
    /// Rates of the body [rad/s].
    pub rates_radps: [f64; 3],
    /// Their derivatives [rad/s2].
    pub rates_slope: [f64; 3],
    /// Roll of body and front part against the ice [rad], and their rates [rad/s].
    pub roll_rad: [[f64; 2]; 2],
    /// Roll split [rad].
    pub split_rad: f64,
    /// Steering at the handles [rad].
    pub steer_rad: f64,
    /// Power of ice, air and brakes [W].
    pub power_w: f64,
    /// Loads: front left, front right, rear left, rear right [N].
    pub load_n: [f64; 4],
    /// Lateral force of the front runners in the plane of their ice [N].
    pub front_side_n: f64,
    /// Runner's temperature less its mean [K].
    pub runner_c: f64,
}

/// Distance, offset, heading, velocity (2), yaw rate, roll and roll rate of body and of front part,
/// handles, steering, slips that forces follow (2), load that the crew has slid by.
type State = [f64; 15];

/// What depends on time and place alone, at the middle of a step.
struct Drawn {
    own_steer: f64,
    wind: f64,
    ice_k: f64,
    runner_c: f64,
    snow: f64,
    chips: f64,
}

/// A sled on a track, and what was drawn for the run.
#[derive(Debug, Clone, Copy)]
pub struct Ride<'a> {
    /// The true sled.
    pub sled: &'a Sled,
    /// The track.
    pub track: &'a Track,
    /// What was drawn.
    pub plan: &'a Plan,
    /// What is hidden.
    pub secret: &'a Secret,
    /// Steps a second.
    pub rate_hz: f64,
}

impl Ride<'_> {
    /// Rides to the track's end or for so many seconds.
    pub fn ridden(&self, seconds: f64) -> Vec<Truth> {
        let h = 1.0 / self.rate_hz;
        let mut x: State = [0.0; 15];
        x[3] = self.plan.start_mps;
        let mut k: State = [0.0; 15];
        let mut truth = Truth::default();
        let mut truths = Vec::new();
        for step in 0..(seconds * self.rate_hz) as usize {
            let t = (step as f64 + 0.5) * h;
            let drawn = self.drawn(t, x[0] + 0.5 * h * x[3]);
            for _ in 0..ITERATIONS {
                let middle: State = std::array::from_fn(|i| x[i] + 0.5 * h * k[i]);
                (k, truth) = self.slopes(&drawn, &middle, &k, truth.front_side_n);
            }
            truths.push(truth);
            x.iter_mut().zip(&k).for_each(|(x, k)| *x += h * k);
            if x[0] > self.track.length_m || x[3] < 3.0 {
                break;
            }
        }
        truths
    }

    fn drawn(&self, t: f64, s: f64) -> Drawn {
        let at = |curve: &Option<Smooth>, x: f64| curve.as_ref().map_or(0.0, |curve| curve.at(x));
        let plan = self.plan;
        let chips = plan
            .chips_s
            .iter()
            .filter(|from| (0.0..0.4).contains(&(t - **from)));
        Drawn {
            own_steer: match &plan.driver {
                Driver::Follows(own) => own.at(t),
                Driver::Holds(angle) => *angle,
            },
            wind: plan.wind_mps + at(&plan.gusts, t),
            ice_k: plan.ice_c + at(&plan.ice_along, s) - REFERENCE_C,
            runner_c: at(&plan.runner_c, t),
            snow: at(&plan.snow, s),
            chips: chips.count() as f64,
        }
    }

    /// How the state changes, given how it changed in the iteration before and the front's lateral
    /// force there.
    fn slopes(&self, drawn: &Drawn, x: &State, last: &State, side_f: f64) -> (State, Truth) {
        let (sled, secret) = (self.sled, self.secret);
        let [
            s,
            n,
            chi,
            vx,
            vy,
            yaw,
            roll,
            roll_t,
            front,
            front_t,
            handles,
            steer,
            ..,
        ] = *x;
        let concave = self.track.concave_1pm;
        let at_line = self.track.at(s);
        let here = at_line.off_the_line(concave * n);
        let (sin_chi, cos_chi) = chi.sin_cos();
        let way = vx * cos_chi - vy * sin_chi;
        let aside = vx * sin_chi + vy * cos_chi;
        // Along the line: the inner way round a curve is shorter.
        let shorter = 1.0 - n * at_line.turn[2];
        let line = way / shorter;
        let line_t = (last[3] * cos_chi - last[4] * sin_chi - aside * last[2]) / shorter;
        let along = |turn: &[f64; 3]| {
            [
                turn[0] * cos_chi + turn[1] * sin_chi,
                -turn[0] * sin_chi + turn[1] * cos_chi,
            ]
        };
        let ([turn_x, turn_y], [turn_xs, turn_ys]) = (along(&here.turn), along(&here.turn_s));
        let chi_t = yaw - line * here.turn[2];
        let (p, q) = (line * turn_x + concave * aside, line * turn_y);
        let aside_t = last[3] * sin_chi + last[4] * cos_chi + way * last[2];
        let p_t = line_t * turn_x + line * line * turn_xs + chi_t * q + concave * aside_t;
        let q_t = line_t * turn_y + line * line * turn_ys - chi_t * p;
        let up = here.up(chi, n * here.turn[0] / shorter);
        let fz = p * vy - q * vx + GRAVITY * up[2];

        // Bank of the ice under the front less that under the rear.
        let [ahead, behind] = [sled.axle_m[0], -sled.axle_m[1]].map(|l| self.track.at(s + l));
        let across = (sled.axle_m[0] + sled.axle_m[1]) * sin_chi;
        let twist = ahead.bank - behind.bank + concave * across;
        let twist_t = line * (ahead.turn[0] - behind.turn[0]);
        let split = twist + front - roll;
        let torsion = sled.torsion[0] * split + sled.torsion[1] * (twist_t + front_t - roll_t);
        let moments = [
            -sled.mounts[0][0] * front - sled.mounts[0][1] * front_t,
            -sled.mounts[1][0] * roll - sled.mounts[1][1] * roll_t,
        ];

        let air = self.air(drawn, vx, vy);
        let slid = x[14] * secret.of(Acts::CrewSlides);
        let reach = [sled.axle_m[0] - slid, -sled.axle_m[1] - slid];
        let load = sled.mass_kg * fz;
        let ground = sled.mass_kg * (last[3] + GRAVITY * up[0] - yaw * vy) - air[0];
        let front_load = (-reach[1] * load - sled.j_yy_kgm2 * q_t - sled.height_m * ground)
            / (reach[0] - reach[1]);
        let factors = self.factors(drawn, s, vx, [p, q]);
        let levers = [sled.height_m - sled.joint_m, sled.joint_m, sled.height_m];
        let axle = |axle: usize, load_n: f64| Axle {
            axle,
            load_n,
            lean_n: (moments[axle] + load_n * self.plan.left_m) / (2.0 * sled.half_track_m),
            velocity: [vx, vy, yaw],
            scrub: match axle {
                0 => levers[0] * roll_t + levers[1] * front_t,
                _ => levers[2] * roll_t,
            },
            reach_m: reach[axle],
            steer: if axle == 0 { steer } else { 0.0 },
            split: if axle == 0 { split } else { 0.0 },
            twist: if axle == 0 { twist } else { 0.0 },
            follows: x[12 + axle],
            factors,
        };
        // N cos(twist) + F_y sin(twist) is the front's load.
        let settled = (front_load - side_f * twist.sin()) / twist.cos();
        let pushes = [
            self.axle(&axle(0, settled)),
            self.axle(&axle(1, load - front_load)),
        ];
        let [side_f, side_r] = [pushes[0].side, pushes[1].side];
        let wall = self.wall(s);
        let [brake_from, brake_n] = self.plan.brake;
        let brake = if s > brake_from { -brake_n } else { 0.0 };
        let fx = pushes[0].x + pushes[1].x + air[0] + brake;
        let fy = pushes[0].y + pushes[1].y + air[1] + wall;
        let turn = pushes[0].turn + pushes[1].turn;

        let sideways = levers[2] * side_r + levers[0] * side_f;
        let roll_tt = (sideways + moments[1] + torsion) / sled.j_xx_kgm2[0] - p_t;
        let front_tt = (levers[1] * side_f + moments[0] - torsion) / sled.j_xx_kgm2[1] - p_t;
        let vx_t = fx / sled.mass_kg - GRAVITY * up[0] + yaw * vy;
        let vy_t = fy / sled.mass_kg - GRAVITY * up[1] - yaw * vx;
        let yaw_t = turn / sled.j_zz_kgm2;
        let yielded = sled.yield_rad(side_f, secret.of(Acts::Play));
        let slopes = [
            line,
            aside,
            chi_t,
            vx_t,
            vy_t,
            yaw_t,
            roll_t,
            roll_tt,
            front_t,
            front_tt,
            self.handles(drawn, x, &here),
            (handles - yielded - steer) / STEERING_S,
            pushes[0].follows_t,
            pushes[1].follows_t,
            (fz - GRAVITY - x[14]) / 0.5,
        ];
        // In the axes of the rolled body.
        let (sine, cosine) = roll.sin_cos();
        let rolled = |[x, y, z]: [f64; 3]| [x, cosine * y + sine * z, cosine * z - sine * y];
        let rates = rolled([p + roll_t, q, yaw]);
        let turned = rolled([p_t + roll_tt, q_t, yaw_t]);
        let truth = Truth {
            place_m: [s, n],
            velocity_mps: [vx, vy],
            felt_mps2: rolled([fx / sled.mass_kg, fy / sled.mass_kg, fz]),
            rates_radps: rates,
            rates_slope: [
                turned[0],
                turned[1] + roll_t * rates[2],
                turned[2] - roll_t * rates[1],
            ],
            roll_rad: [[roll, roll_t], [front, front_t]],
            split_rad: split,
            steer_rad: handles,
            power_w: pushes[0].power
                + pushes[1].power
                + (air[0] + brake) * vx
                + (air[1] + wall) * vy,
            load_n: std::array::from_fn(|i| pushes[i / 2].load_n[i % 2]),
            front_side_n: side_f,
            runner_c: drawn.runner_c,
        };
        (slopes, truth)
    }

    /// Force of the runners of an axle.
    fn axle(&self, at: &Axle) -> Push {
        let (sled, secret) = (self.sled, self.secret);
        let [vx, vy, yaw] = at.velocity;
        let drift = -(vy + at.reach_m * yaw + at.scrub).atan2(vx) + at.steer;
        let relaxation = secret.of(Acts::Relaxation);
        let rate = match relaxation > 0.0 {
            true => (vx / relaxation).min(1000.0),
            false => 1.0 / HYSTERESIS_S,
        };
        let ahead = drift - at.follows;
        let followed = if relaxation > 0.0 { at.follows } else { drift };
        let bent = match secret.of(Acts::Hysteresis) {
            0.0 => 0.0,
            size => size * (ahead * drift.signum() / 1e-3).tanh(),
        };
        let half = 0.5 * at.load_n.max(0.0);
        let lean = at.lean_n.clamp(-half, half);
        let ((sin_a, cos_a), (sin_t, cos_t)) = (at.steer.sin_cos(), at.twist.sin_cos());
        let mut push = Push {
            follows_t: rate * ahead,
            load_n: [half + lean, half - lean],
            ..Push::default()
        };
        for right in [0, 1] {
            let n = push.load_n[right];
            let y_m = [1.0, -1.0][right] * sled.half_track_m - self.plan.left_m;
            let slip = followed + sled.toe_rad[2 * at.axle + right];
            let load_grip = match secret.of(Acts::LoadGrip) {
                0.0 => 1.0,
                exponent => (2.0 * n.max(1.0) / REFERENCE_N).powf(exponent),
            };
            let grip = at.factors[1] * (1.0 + bent) * load_grip;
            let mut fy = grip * sled.grip[at.axle].force(0.5, slip, n);
            let mut fx = -at.factors[0] * n * slip.cos();
            fx -= secret.of(Acts::SlipDrag) * (fy * slip).abs();
            fx -= secret.of(Acts::SteerDrag) * n * at.steer.abs();
            fy += secret.of(Acts::Camber) * at.split * n;
            let (x, y) = (cos_a * fx - sin_a * fy, sin_a * fx + cos_a * fy);
            let flat = cos_t * y - sin_t * n;
            push.x += x;
            push.y += flat;
            push.side += y;
            push.turn += at.reach_m * flat - y_m * x;
            push.power += x * (vx - y_m * yaw) + flat * (vy + at.reach_m * yaw) + y * at.scrub;
        }
        push
    }

    /// mu and the factor of lateral forces.
    fn factors(&self, drawn: &Drawn, s: f64, v: f64, [p, q]: [f64; 2]) -> [f64; 2] {
        let (plan, secret) = (self.plan, self.secret);
        let [from, to, more, less] = plan.warm;
        let warm = if (from..to).contains(&s) { 1.0 } else { 0.0 };
        let k = |acts| secret.of(acts);
        let mu = self.sled.mu
            * plan.factors[0]
            * (1.0 + plan.ice_per_k[0] * drawn.ice_k)
            * (1.0 + more * warm)
            * (1.0 + k(Acts::Temperature) * drawn.ice_k)
            * (v / REFERENCE_MPS).powf(k(Acts::Speed))
            * (1.0 + k(Acts::RollFriction) * p * p)
            * (1.0 + k(Acts::DriftedSnow) * drawn.snow)
            * (1.0 + k(Acts::IceChips) * drawn.chips);
        let hump = match k(Acts::HumpGrip) {
            0.0 => 0.0,
            size => size * (-((v - REFERENCE_MPS) / 3.0).powi(2)).exp(),
        };
        let grip = plan.factors[1]
            * (1.0 + plan.ice_per_k[1] * drawn.ice_k)
            * (1.0 - less * warm)
            * (1.0 + k(Acts::TemperatureGrip) * drawn.ice_k)
            * (1.0 + k(Acts::SpeedGrip) * (v - REFERENCE_MPS))
            * (1.0 + k(Acts::PitchGrip) * q * q)
            * (1.0 + hump)
            * (1.0 + k(Acts::WarmRunnerGrip) * drawn.runner_c);
        [mu.max(0.0), grip.max(0.05)]
    }

    /// Force of the air [N].
    fn air(&self, drawn: &Drawn, vx: f64, vy: f64) -> [f64; 2] {
        let sled = self.sled;
        let beta = (vy / vx).atan().to_degrees().abs();
        let pressure = 0.5 * self.plan.air * (vx + drawn.wind).powi(2);
        let area = sled.cda_m2 + self.secret.of(Acts::DragArea);
        let drag = pressure * area * (1.0 + sled.yaw_drag_per_deg * beta);
        let more = 0.5 * self.plan.air * vx * vx * sled.cda_m2 * beta;
        [
            -drag - more * self.secret.of(Acts::AeroYaw),
            -drag * vy / vx,
        ]
    }

    fn wall(&self, s: f64) -> f64 {
        let hidden = self.secret.0.iter().filter(|_| self.plan.has_wall);
        hidden
            .filter(|h| h.effect.acts == Acts::Wall && (h.place_m[0]..h.place_m[1]).contains(&s))
            .map(|h| h.size)
            .sum()
    }

    /// How the handles move: the driver steers for the curve ahead, for the side force that the
    /// bank leaves, and back to the line, within 60 ms.
    fn handles(&self, drawn: &Drawn, x: &State, here: &Here) -> f64 {
        let sled = self.sled;
        let [s, n, chi, vx, vy, _, _, _, _, _, handles, ..] = *x;
        if let Driver::Holds(angle) = self.plan.driver {
            return (angle - handles) / 0.06;
        }
        let next = self.track.at(s + 0.06 * vx);
        let side = sled.mass_kg * (vx * vx * here.turn[2] + GRAVITY * here.up(chi, 0.0)[1]);
        let [l_f, l_r] = sled.axle_m;
        let [k_f, k_r] = [0, 1].map(|axle: usize| sled.grip[axle].stiffness_n_per_rad);
        let bend = side / (l_f + l_r) * (l_r / k_f - l_f / k_r);
        let aim = (l_f + l_r) * next.turn[2] + bend - 0.3 * (chi + vy / vx) - 0.02 * n;
        ((aim + drawn.own_steer).clamp(-0.12, 0.12) - handles) / 0.06
    }
}

/// An axle at an instant.
struct Axle {
    axle: usize,
    load_n: f64,
    /// Half the difference of its runners' loads [N].
    lean_n: f64,
    velocity: [f64; 3],
    /// Lateral speed of the contacts by the roll [m/s].
    scrub: f64,
    reach_m: f64,
    steer: f64,
    split: f64,
    twist: f64,
    follows: f64,
    factors: [f64; 2],
}

/// What the runners of an axle do to the sled.
#[derive(Default)]
struct Push {
    x: f64,
    y: f64,
    /// Lateral force in the ice's plane under the axle [N].
    side: f64,
    turn: f64,
    power: f64,
    load_n: [f64; 2],
    follows_t: f64,
}
