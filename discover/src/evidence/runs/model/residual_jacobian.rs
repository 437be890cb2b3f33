//! Closed-form derivatives of the residuals by sensor readings and the constants of the sled.
//!
//! With z the accelerations, loads, slips and angles of an instant, x the readings and constants,
//!
//! ```text
//! d residual / dx = (d residual / dz) (dz / dx)
//! ```
//!
//! The laws are linearised, and the front runner's load is solved for, as in
//! [`Balance::laws_near`].

use kufe_sled::effects::{SENSORS, Sensor, Signals};
use kufe_sled::{Balance, LawForces, RunnerFriction, Sled, Vehicle};

/// Derivatives of the longitudinal, lateral and yaw residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResidualJacobian {
    /// By each sensor's value.
    value: [[f64; 3]; SENSORS],
    /// By each gyro's derivative: roll, pitch and yaw.
    rate: [[f64; 3]; 3],
    /// By each of [`CONSTANTS`].
    constants: [[f64; 3]; CONSTANTS.len()],
}

/// A constant of the sled.
type Constant = fn(&mut Sled) -> &mut f64;

/// Constants of the sled that installation errors change.
const CONSTANTS: [Constant; 9] = [
    |sled| &mut sled.mass_kg,
    |sled| &mut sled.j_yy_kgm2,
    |sled| &mut sled.j_zz_kgm2,
    |sled| &mut sled.l_f_m,
    |sled| &mut sled.l_r_m,
    |sled| &mut sled.accel_x_m,
    |sled| &mut sled.accel_y_m,
    |sled| &mut sled.accel_z_m,
    |sled| &mut sled.slip_x_m,
];
const MASS: usize = 0;
const PITCH_INERTIA: usize = 1;
const YAW_INERTIA: usize = 2;
const AXLES: [usize; 2] = [3, 4];
const ACCELEROMETER: [usize; 3] = [5, 6, 7];
const SLIP_SENSOR: usize = 8;

/// Changes of [`CONSTANTS`] between two sleds.
pub fn changed_constants(mut from: Sled, mut to: Sled) -> [f64; CONSTANTS.len()] {
    CONSTANTS.map(|constant| *constant(&mut to) - *constant(&mut from))
}

/// Linear combination of vectors.
#[inline]
fn sum<const N: usize>(parts: [(f64, &[f64; 3]); N]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (by, part) in parts {
        for (sum, part) in sum.iter_mut().zip(part) {
            *sum += by * part;
        }
    }
    sum
}

impl ResidualJacobian {
    /// Derivatives of the residuals by a sensor's value.
    #[inline]
    pub fn by_value(&self, sensor: Sensor) -> &[f64; 3] {
        &self.value[sensor as usize]
    }

    /// Derivatives of the residuals by the derivative of a sensor's value.
    #[inline]
    pub fn by_rate(&self, sensor: Sensor) -> &[f64; 3] {
        match sensor {
            Sensor::RollRate | Sensor::PitchRate | Sensor::YawRate => {
                &self.rate[sensor as usize - Sensor::RollRate as usize]
            }
            _ => &[0.0; 3],
        }
    }

    /// Change of the residuals by changes of a sensor's value and of its derivative.
    #[inline]
    pub fn of_sensor(&self, sensor: Sensor, value: f64, rate: f64) -> [f64; 3] {
        sum([(value, self.by_value(sensor)), (rate, self.by_rate(sensor))])
    }

    /// Derivatives of the residuals by a constant of the sled, by its place in [`CONSTANTS`].
    #[inline]
    pub fn by_constant(&self, constant: usize) -> &[f64; 3] {
        &self.constants[constant]
    }

    /// Change of the residuals between two readings of one instant.
    #[inline]
    pub fn between(&self, from: &Signals, to: &Signals) -> [f64; 3] {
        let mut total = [0.0; 3];
        for sensor in Sensor::ALL {
            let k = sensor as usize;
            let (value, rate) = (to.value[k] - from.value[k], to.rate[k] - from.rate[k]);
            if value != 0.0 || rate != 0.0 {
                total = sum([(1.0, &total), (1.0, &self.of_sensor(sensor, value, rate))]);
            }
        }
        if from.sled != to.sled {
            let changes = changed_constants(from.sled, to.sled);
            for (by, change) in self.constants.iter().zip(changes) {
                total = sum([(1.0, &total), (change, by)]);
            }
        }
        total
    }

    /// The Jacobian by forward differences.
    ///
    /// `change` returns the change of the residuals by a given perturbation of the signals.
    pub fn of_differences(change: impl Fn(&dyn Fn(&mut Signals)) -> [f64; 3]) -> Self {
        const STEP: f64 = 1e-4;
        let along = |perturb: &dyn Fn(&mut Signals)| change(perturb).map(|x| x / STEP);
        Self {
            value: Sensor::ALL.map(|sensor| along(&|signals| signals[sensor] += STEP)),
            rate: [Sensor::RollRate, Sensor::PitchRate, Sensor::YawRate]
                .map(|gyro| along(&|signals| signals.rate[gyro as usize] += STEP)),
            constants: CONSTANTS
                .map(|constant| along(&|signals| *constant(&mut signals.sled) += STEP)),
        }
    }

    /// Derivatives of [`Balance::residual`] with the forces of the base laws, by readings and
    /// constants of the sled.
    ///
    /// `signals` are those from which the balance was computed
    /// ([`from_sensors`](kufe_sled::from_sensors)). Effects are not included.
    pub fn new(at: &Balance, vehicle: &Vehicle, laws: &LawForces, signals: &Signals) -> Self {
        let (sled, state, motion) = (&at.sled, &at.state, &at.motion);
        let (m, v) = (sled.mass_kg, state.v_mps);
        let ((sd, cd), (sg, cg)) = (at.steer, at.split);
        let (fx, [fy, fy_r]) = (laws.forces.along[0], laws.forces.across);
        let (l_f, l_r, length) = (sled.l_f_m, sled.l_r_m, sled.wheelbase_m());
        let [front, rear] = &laws.lateral;
        let along = LongitudinalDerivatives::new(at, &vehicle.front, at.slips[0], laws.load_n[0]);
        let along_r = LongitudinalDerivatives::new(at, &vehicle.rear, at.slips[1], laws.load_n[1]);

        // Derivatives of the force at the centre of gravity: along x, along y, and about z.
        // (x, y) is the force of the front runner in the axes of the sled.
        let (x, y) = (cd * fx - sd * fy, sd * fx + cd * fy);
        let front_lateral = |y: f64| [0.0, y, l_f * y];
        let by_fx = [cd, sd / cg, l_f * sd / cg];
        let by_fy = [-sd, cd / cg, l_f * cd / cg];
        let (by_fx_r, by_fy_r) = ([1.0, 0.0, 0.0], [0.0, 1.0, -l_r]);
        let by_load = sum([(along.load, &by_fx), (front.fz, &by_fy)]);
        // The front load, from cos(gamma) F_z + sin(gamma) (sin(delta) F_x + cos(delta) F_y) =
        // F_z0.
        let fx_by_load = if laws.load_n[0] > 0.0 {
            fx / laws.load_n[0]
        } else {
            0.0
        };
        let load_slope = cg + sg * (sd * fx_by_load + cd * front.fz);
        let load_change = |residual: f64| -residual / load_slope;
        let by_split = sum([
            (1.0, &front_lateral((y * sg - state.fz_f0_n) / (cg * cg))),
            (load_change(cg * y - sg * laws.load_n[0]), &by_load),
        ]);
        let turned = front_lateral(x / cg);
        let by_steer = sum([
            (1.0, &[-y, turned[1], turned[2]]),
            (load_change(sg * x), &by_load),
        ]);
        let by_slip_f = sum([
            (front.alpha, &by_fy),
            (along.slip, &by_fx),
            (load_change(sg * cd * front.alpha), &by_load),
        ]);
        let by_slip_r = sum([(rear.alpha, &by_fy_r), (along_r.slip, &by_fx_r)]);
        let by_axle_f = sum([
            (1.0, &front_lateral(-sg / cg)),
            (load_change(-1.0), &by_load),
        ]);
        let by_axle_r = sum([(rear.fz, &by_fy_r), (along_r.load, &by_fx_r)]);
        let by_curvature = sum([(along.curvature, &by_fx), (along_r.curvature, &by_fx_r)]);
        let ((sine, cosine), drag) = (at.chassis, at.drag);
        let drag_by_slip = -drag_by_slip(sled, v, state.air_density_kgpm3, -state.alpha_cog_rad);
        let by_chassis = [
            drag_by_slip * cosine - drag * sine,
            -drag_by_slip * sine - drag * cosine,
            0.0,
        ];
        let drag_by_speed = 2.0 * drag / v;
        let by_speed = sum([
            (along.speed, &by_fx),
            (along_r.speed, &by_fx_r),
            (drag_by_speed, &[cosine, -sine, 0.0]),
        ]);
        let front_y = (y - sg * state.fz_f0_n) / cg;

        // By the readings; the residual decreases with the forces.
        let [a_x, a_y, a_z] = motion.accel_mps2;
        let (yaw, pitch) = (state.yaw_rate_radps, state.pitch_rate_radps);
        let lever = |place: f64| (place - sled.slip_x_m) / v;
        let by_slips = sum([(1.0, &by_chassis), (1.0, &by_slip_f), (1.0, &by_slip_r)]);
        let by_turn = sum([
            (-lever(0.0), &by_chassis),
            (-lever(l_f), &by_slip_f),
            (-lever(-l_r), &by_slip_r),
        ]);
        let turn = yaw / v;
        let by_vertical = sum([
            (-m * l_r / length, &by_axle_f),
            (-m * l_f / length, &by_axle_r),
        ]);
        let accel = [
            [m, 0.0, by_vertical[0]],
            [0.0, m, by_vertical[1]],
            [0.0, 0.0, by_vertical[2]],
        ];
        let by_pitching = sum([(1.0, &by_axle_f), (-1.0, &by_axle_r)]);
        let (force_f, force_r) = (state.fz_f0_n / length, state.fz_r_n / length);
        let weight = m * a_z / length;

        let mut jacobian = Self::default();
        jacobian.value[Sensor::Ax as usize] = [m, 0.0, 0.0];
        jacobian.value[Sensor::Ay as usize] = [0.0, m, 0.0];
        jacobian.value[Sensor::Az as usize] = by_vertical;
        jacobian.value[Sensor::Speed as usize] = sum([
            (-1.0, &by_speed),
            (-pitch / (v * v), &by_curvature),
            (turn, &by_turn),
        ]);
        jacobian.value[Sensor::Slip as usize] = sum([(-1.0, &by_slips)]);
        jacobian.value[Sensor::Steering as usize] = sum([(-1.0, &by_steer), (-1.0, &by_slip_f)]);
        jacobian.value[Sensor::RollSplit as usize] = sum([(-1.0, &by_split)]);
        let place = [sled.accel_x_m, sled.accel_y_m, sled.accel_z_m];
        let rates = signals.rates();
        for (c, g) in accel.into_iter().enumerate() {
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let cross = |a: [f64; 3], b: [f64; 3]| {
                [
                    a[1] * b[2] - a[2] * b[1],
                    a[2] * b[0] - a[0] * b[2],
                    a[0] * b[1] - a[1] * b[0],
                ]
            };
            // a = a_sensor - dw/dt x r - w (w r) + w^2 r
            let (wr, wg, rg) = (dot(rates, place), dot(rates, g), dot(place, g));
            let angular = cross(place, g);
            let tangential = cross(g, signals.angular_acceleration());
            for k in 0..3 {
                jacobian.rate[k][c] -= angular[k];
                jacobian.value[Sensor::RollRate as usize + k][c] -=
                    g[k] * wr + place[k] * wg - 2.0 * rates[k] * rg;
                jacobian.constants[ACCELEROMETER[k]][c] -=
                    tangential[k] + rates[k] * wg - dot(rates, rates) * g[k];
            }
            jacobian.rate[1][c] += sled.j_yy_kgm2 / length * by_pitching[c];
            jacobian.value[Sensor::PitchRate as usize][c] += by_curvature[c] / v;
            jacobian.value[Sensor::YawRate as usize][c] -= by_turn[c];
            jacobian.constants[MASS][c] =
                [a_x, a_y, 0.0][c] - a_z / length * (l_r * by_axle_f[c] + l_f * by_axle_r[c]);
            jacobian.constants[PITCH_INERTIA][c] =
                motion.pitch_accel_radps2 / length * by_pitching[c];
            jacobian.constants[SLIP_SENSOR][c] = -turn * by_slips[c];
            jacobian.constants[AXLES[0]][c] =
                force_f * by_axle_f[c] - (weight - force_r) * by_axle_r[c] + turn * by_slip_f[c];
            jacobian.constants[AXLES[1]][c] =
                force_r * by_axle_r[c] - (weight - force_f) * by_axle_f[c] - turn * by_slip_r[c];
        }
        jacobian.rate[2][2] += sled.j_zz_kgm2;
        jacobian.constants[YAW_INERTIA][2] = motion.yaw_accel_radps2;
        jacobian.constants[AXLES[0]][2] -= front_y;
        jacobian.constants[AXLES[1]][2] += fy_r;
        jacobian
    }
}

/// Derivatives of a runner's longitudinal force by its load, the curvature, the speed and its slip.
struct LongitudinalDerivatives {
    load: f64,
    curvature: f64,
    speed: f64,
    slip: f64,
}

impl LongitudinalDerivatives {
    fn new(
        balance: &Balance,
        runner: &RunnerFriction,
        (sine, cosine): (f64, f64),
        load: f64,
    ) -> Self {
        let at = &balance.state;
        let mu = runner.mu(load, at.curvature_1pm, at.v_mps, at.conditions.ice_c);
        let [by_load, by_curvature, by_speed] = mu_by(
            runner,
            load,
            at.curvature_1pm,
            at.v_mps,
            at.conditions.ice_c,
        );
        let pressing = load.max(0.0);
        let mu_pressing = if load > 0.0 { mu } else { 0.0 };
        Self {
            load: -(by_load * pressing + mu_pressing) * cosine,
            curvature: -by_curvature * pressing * cosine,
            speed: -by_speed * pressing * cosine,
            slip: mu * pressing * sine,
        }
    }
}

/// Derivatives of [`RunnerFriction::mu`] by normal force [1/N], curvature [m] and speed [s/m]: 0
/// without a table, else central differences with a relative step of a thousandth.
fn mu_by(runner: &RunnerFriction, fz: f64, curvature: f64, speed: f64, ice_c: f64) -> [f64; 3] {
    if runner.table().is_none() {
        return [0.0; 3];
    }
    let at = [fz, curvature, speed];
    let min_step = [1.0, 1e-6, 1e-3];
    std::array::from_fn(|k| {
        let step = (1e-3 * at[k].abs()).max(min_step[k]);
        let mu = |by: f64| {
            let mut there = at;
            there[k] += by;
            runner.mu(there[0], there[1], there[2], ice_c)
        };
        (mu(step) - mu(-step)) / (2.0 * step)
    })
}

/// Derivative of the base model's drag by `beta` [N/rad]; 0 at `beta = 0`, where it has a kink.
fn drag_by_slip(sled: &Sled, speed: f64, density: f64, beta: f64) -> f64 {
    let side = if beta == 0.0 { 0.0 } else { beta.signum() };
    match sled.cda_m2 * sled.yaw_drag_per_deg * side.to_degrees() {
        0.0 => 0.0,
        by => -0.5 * density * by * speed * speed,
    }
}

#[cfg(test)]
mod tests {
    use kufe_sled::effects::OperatingPoint;
    use kufe_sled::{Model, from_sensors};

    use super::*;

    /// A sled that slips, steers, pitches and turns, all at once.
    fn signals(sled: &Sled, k: usize) -> Signals {
        let wave = |c: usize| (1.7 * c as f64 + 0.9 * k as f64).sin();
        let mut signals = Signals {
            sled: Sled {
                accel_x_m: 0.3,
                accel_y_m: -0.1,
                accel_z_m: 0.25,
                slip_x_m: -0.6,
                ..*sled
            },
            ..Signals::default()
        };
        signals[Sensor::Ax] = 0.5 * wave(1);
        signals[Sensor::Ay] = 4.0 * wave(2);
        signals[Sensor::Az] = 18.0 + 8.0 * wave(3);
        signals.set(Sensor::RollRate, 0.4 * wave(4), 2.0 * wave(5));
        signals.set(Sensor::PitchRate, 0.5 * wave(6), 1.5 * wave(7));
        signals.set(Sensor::YawRate, 0.3 * wave(8), 1.1 * wave(9));
        signals.set(Sensor::Speed, 28.0 + 7.0 * wave(10), 0.4);
        signals.set(Sensor::Slip, 0.02 * wave(11), 0.1);
        signals.set(Sensor::Steering, 0.03 * wave(12), 0.2);
        signals[Sensor::RollSplit] = 0.05 * wave(13);
        signals
    }

    fn residual(vehicle: &Vehicle, signals: &Signals) -> [f64; 3] {
        let balance = balance(signals);
        balance.residual(&balance.laws(vehicle).forces).values()
    }

    fn balance(signals: &Signals) -> Balance {
        let sled = signals.sled;
        let at = OperatingPoint {
            air_density: 1.2,
            ..OperatingPoint::default()
        };
        let (state, motion) = from_sensors(&sled, signals, &at);
        Balance::new(&sled, &state, &motion)
    }

    #[test]
    fn derivatives_by_every_sensor_and_constant_are_those_of_the_balances() {
        let vehicle = Vehicle::new(&Model::published()).unwrap();
        type Move = (&'static str, f64, fn(&mut Signals, f64));
        let mut moves: Vec<Move> = vec![
            ("mass", 1.0, |s, by| s.sled.mass_kg += by),
            ("pitch inertia", 1.0, |s, by| s.sled.j_yy_kgm2 += by),
            ("yaw inertia", 1.0, |s, by| s.sled.j_zz_kgm2 += by),
            ("front axle", 1e-3, |s, by| s.sled.l_f_m += by),
            ("rear axle", 1e-3, |s, by| s.sled.l_r_m += by),
            ("accelerometer x", 1e-3, |s, by| s.sled.accel_x_m += by),
            ("accelerometer y", 1e-3, |s, by| s.sled.accel_y_m += by),
            ("accelerometer z", 1e-3, |s, by| s.sled.accel_z_m += by),
            ("slip sensor", 1e-3, |s, by| s.sled.slip_x_m += by),
            ("roll acceleration", 1e-3, |s, by| {
                s.rate[Sensor::RollRate as usize] += by
            }),
            ("pitch acceleration", 1e-3, |s, by| {
                s.rate[Sensor::PitchRate as usize] += by
            }),
            ("yaw acceleration", 1e-3, |s, by| {
                s.rate[Sensor::YawRate as usize] += by
            }),
        ];
        moves.extend([
            (
                "ax",
                1e-3,
                (|s, by| s[Sensor::Ax] += by) as fn(&mut Signals, f64),
            ),
            ("ay", 1e-3, |s, by| s[Sensor::Ay] += by),
            ("az", 1e-3, |s, by| s[Sensor::Az] += by),
            ("roll rate", 1e-4, |s, by| s[Sensor::RollRate] += by),
            ("pitch rate", 1e-4, |s, by| s[Sensor::PitchRate] += by),
            ("yaw rate", 1e-4, |s, by| s[Sensor::YawRate] += by),
            ("speed", 1e-3, |s, by| s[Sensor::Speed] += by),
            ("slip", 1e-5, |s, by| s[Sensor::Slip] += by),
            ("steering", 1e-5, |s, by| s[Sensor::Steering] += by),
            ("roll-split", 1e-5, |s, by| s[Sensor::RollSplit] += by),
        ]);
        for k in 0..12 {
            let at = signals(&vehicle.sled, k);
            let here = balance(&at);
            let laws = here.laws(&vehicle);
            let by = ResidualJacobian::new(&here, &vehicle, &laws, &at);
            let own = residual(&vehicle, &at);
            let differences = ResidualJacobian::of_differences(|moved| {
                let mut there = at;
                moved(&mut there);
                let there = residual(&vehicle, &there);
                std::array::from_fn(|c| there[c] - own[c])
            });
            for (name, step, moved) in &moves {
                let there = |by: f64| {
                    let mut there = at;
                    moved(&mut there, by);
                    there
                };
                let (up, down) = (there(*step), there(-step));
                let (plus, minus) = (residual(&vehicle, &up), residual(&vehicle, &down));
                let closed = by.between(&down, &up);
                let forward = differences.between(&down, &up);
                let largest = plus.iter().zip(minus).map(|(p, m)| (p - m).abs());
                let size = largest.fold(1e-9, f64::max);
                for c in 0..3 {
                    // The load equation is solved to 1e-6, and the second-order error of the
                    // differences is below that.
                    let off = (plus[c] - minus[c] - closed[c]).abs();
                    assert!(
                        off < 2e-4 * size,
                        "{name} {c} at {k}: {} {}",
                        plus[c] - minus[c],
                        closed[c]
                    );
                    let off = (forward[c] - closed[c]).abs();
                    assert!(
                        off < 2e-2 * size,
                        "{name} {c} at {k}: {forward:?} {closed:?}"
                    );
                }
            }
        }
    }
}
