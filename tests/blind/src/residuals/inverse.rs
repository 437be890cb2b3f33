//! From recorded channels back to what the base model leaves unexplained.
//!
//! Written from the momentum equations on their own, in the other direction than the drive, so
//! that it also checks it: without noise and hidden effects the residual is zero.

use crate::world::drive::SAMPLE_S;
use crate::world::sensors::Sample;
use crate::world::sled::{Conditions, Lateral, Sled};

/// Residual of the three momentum equations at one sample.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Residual {
    /// Longitudinal acceleration [m/s2].
    pub x_mps2: f64,
    /// Speed derivative against gravity along the surveyed slope, ice and air [m/s2].
    pub v_mps2: f64,
    /// Lateral acceleration [m/s2].
    pub y_mps2: f64,
    /// Yaw acceleration [rad/s2].
    pub yaw_radps2: f64,
}

/// Central difference of an evenly sampled channel, one-sided at the ends.
pub fn derivative(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    (0..n)
        .map(|i| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
            (values[high] - values[low]) / ((high - low).max(1) as f64 * SAMPLE_S)
        })
        .collect()
}

/// Second-order Butterworth low-pass, forwards and backwards, started from the first value.
pub fn low_pass(values: &mut [f64], cutoff_hz: f64) {
    let k = (std::f64::consts::PI * cutoff_hz * SAMPLE_S).tan();
    let norm = 1.0 / (1.0 + std::f64::consts::SQRT_2 * k + k * k);
    let b0 = k * k * norm;
    let a1 = 2.0 * (k * k - 1.0) * norm;
    let a2 = (1.0 - std::f64::consts::SQRT_2 * k + k * k) * norm;
    for _ in 0..2 {
        let Some(&first) = values.first() else { return };
        let (mut x1, mut x2, mut y1, mut y2) = (first, first, first, first);
        for value in values.iter_mut() {
            let y = b0 * (*value + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
            (x2, x1, y2, y1) = (x1, *value, y1, y);
            *value = y;
        }
        values.reverse();
    }
}

/// Residuals of a run against the base model; `slope` gives the surveyed slope at a distance.
pub fn residuals(
    sled: &Sled,
    at: &Conditions,
    samples: &[Sample],
    slope: &dyn Fn(f64) -> f64,
) -> Vec<Residual> {
    residuals_every(1, sled, at, samples, slope)
}

/// The same at every so many samples; derivatives and distance are those of all.
pub fn residuals_every(
    stride: usize,
    sled: &Sled,
    at: &Conditions,
    samples: &[Sample],
    slope: &dyn Fn(f64) -> f64,
) -> Vec<Residual> {
    let channel = |pick: &dyn Fn(&Sample) -> f64| samples.iter().map(pick).collect::<Vec<f64>>();
    let angular = [0, 1, 2].map(|i| derivative(&channel(&|s: &Sample| s.rates_radps[i])));
    let speed = channel(&|s: &Sample| s.v_mps);
    let speed_dot = derivative(&speed);
    let mut distance = vec![0.0; samples.len()];
    for i in 1..samples.len() {
        distance[i] = distance[i - 1] + 0.5 * (speed[i] + speed[i - 1]) * SAMPLE_S;
    }
    samples
        .iter()
        .enumerate()
        .step_by(stride)
        .map(|(i, sample)| {
            let w = sample.rates_radps;
            let w_dot = [angular[0][i], angular[1][i], angular[2][i]];
            let at_sensor = cross(w_dot, sled.accel_m);
            let centripetal = cross(w, cross(w, sled.accel_m));
            let f: [f64; 3] =
                std::array::from_fn(|a| sample.accel_mps2[a] - at_sensor[a] - centripetal[a]);
            let m = sled.mass_kg;
            let base = sled.l_f_m + sled.l_r_m;
            let front_z = (sled.l_r_m * m * f[2] - sled.j_yy_kgm2 * w_dot[1]) / base;
            let rear_z = m * f[2] - front_z;
            let v = sample.v_mps;
            let slip_r = sample.alpha_rad - w[2] * (-sled.l_r_m - sled.slip_x_m) / v;
            let slip_f =
                sample.alpha_rad - w[2] * (sled.l_f_m - sled.slip_x_m) / v + sample.delta_rad;
            let beta = -(sample.alpha_rad + w[2] * sled.slip_x_m / v);

            let rear = [
                -sled.mu * rear_z * slip_r.cos(),
                magic(&sled.rear, slip_r, rear_z),
            ];
            let front = front_forces(sled, sample, slip_f, front_z);
            let area = sled.cda_m2 * (1.0 + sled.yaw_drag_per_deg * beta.to_degrees().abs());
            let drag = 0.5 * at.air_density() * area * v * v;
            let along = (front[0] + rear[0] - drag * beta.cos()) / m;
            Residual {
                x_mps2: f[0] - along,
                v_mps2: speed_dot[i]
                    - (along * beta.cos() + f[1] * beta.sin() - 9.81 * slope(distance[i]).sin()),
                y_mps2: f[1] - (front[1] + rear[1] - drag * beta.sin()) / m,
                yaw_radps2: w_dot[2]
                    - (sled.l_f_m * front[1] - sled.l_r_m * rear[1]) / sled.j_zz_kgm2,
            }
        })
        .collect()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The magic formula through its stiffness and saturation, not through `D` and `B`.
fn magic(law: &Lateral, slip: f64, load: f64) -> f64 {
    let limit = law.c * law.mu_zeta * load.max(1.0);
    let x = law.k_n_per_rad * slip / limit;
    let inner = (1.0 - law.e) * x + law.e * x.atan();
    limit / law.c * (law.c * inner.atan()).sin()
}

/// `[x, y]` of the front runner in body axes; its normal load by the secant method on the z
/// balance.
fn front_forces(sled: &Sled, sample: &Sample, slip: f64, load_body: f64) -> [f64; 2] {
    let (sg, cg) = sample.gamma_rad.sin_cos();
    let (sd, cd) = sample.delta_rad.sin_cos();
    let runner = |load: f64| (-sled.mu * load * slip.cos(), magic(&sled.front, slip, load));
    let defect = |load: f64| {
        let (x, y) = runner(load);
        sg * (sd * x + cd * y) + cg * load - load_body
    };
    let (mut last, mut load) = (0.99 * load_body, load_body);
    let mut last_defect = defect(last);
    for _ in 0..8 {
        let here = defect(load);
        if here.abs() < 1e-9 || (load - last).abs() < 1e-12 {
            break;
        }
        let next = load - here * (load - last) / (here - last_defect);
        (last, last_defect, load) = (load, here, next);
    }
    let (x, y) = runner(load);
    [cd * x - sd * y, cg * (sd * x + cd * y) - sg * load]
}
