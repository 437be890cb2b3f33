//! Twins: data simulated from the fitted model and sent through the whole measurement chain.
//!
//! A twin takes the measured motion as the truth, moves the measured accelerations to where the model says they are, and
//! adds each sensor's white noise at the recorded rate, smoothed and differentiated as the data were; what the residual
//! holds beyond that comes back as a shifted copy of itself with a random sign, run by run. Nothing is missing from the
//! model in a twin: what a statistic shows there is bias of noisy inputs and chance.

use kufe_sled::Noise;
use rand::Rng;

use super::chain::{CHANNELS, Chain, Rows};
use super::data::{CUTOFF_HZ, Frame, RATE_HZ};
use crate::random::{below, normal, sign, stream};
use crate::smooth::Kernel;

/// How twins are made.
#[derive(Clone, Debug)]
pub struct TwinMaker {
    noise: Noise,
    /// Share of each channel's residual, as a deviation, that the sensors' noise does not explain.
    pub beyond: [f64; CHANNELS],
    /// By how much the stated noise had to be lowered because the residual is quieter; 1 where it fits.
    pub noise_scale: f64,
    seed: u64,
}

impl TwinMaker {
    /// Finds how much of the residuals the sensors' noise explains.
    pub fn new(
        frames: &[Frame],
        chain: &Chain,
        noise: Noise,
        used: [bool; CHANNELS],
        seed: u64,
    ) -> Self {
        let mut maker = Self {
            noise,
            beyond: [0.0; CHANNELS],
            noise_scale: 1.0,
            seed,
        };
        let power = |rows: &[Rows], c: usize| -> f64 {
            let (sum, count) = rows
                .iter()
                .flat_map(|r| r[c].iter())
                .fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
            if count > 0.0 { sum / count } else { 0.0 }
        };
        let real: Vec<Rows> = frames.iter().map(|f| chain.residuals(f)).collect();
        let quiet = maker.make(frames, chain, &real, 1_000_003);
        let simulated: Vec<Rows> = quiet.iter().map(|f| chain.residuals(f)).collect();
        let mut least: f64 = 1.0;
        for c in (0..CHANNELS).filter(|c| used[*c]) {
            let (have, explained) = (power(&real, c), power(&simulated, c));
            if have > 0.0 && explained > 1.05 * have {
                least = least.min(have / explained);
            }
        }
        maker.noise_scale = least.sqrt();
        maker.noise = scaled(noise, maker.noise_scale);
        for (c, used) in used.iter().enumerate() {
            let (have, explained) = (power(&real, c), power(&simulated, c) * least);
            if *used && have > 0.0 {
                maker.beyond[c] = (1.0 - explained / have).max(0.0).sqrt();
            }
        }
        maker
    }

    /// The `k`-th twin of these runs; `residuals` are those of the real runs under the same chain.
    pub fn make(&self, frames: &[Frame], chain: &Chain, residuals: &[Rows], k: u64) -> Vec<Frame> {
        frames
            .iter()
            .zip(residuals)
            .enumerate()
            .map(|(i, (frame, rows))| {
                let mut rng = stream(self.seed, 0x7417 + k, i as u64);
                let mut twin = truth(frame, chain, rows);
                self.add_rest(&mut twin, chain, rows, &mut rng);
                self.add_noise(&mut twin, &mut rng);
                twin
            })
            .collect()
    }

    fn add_rest(&self, twin: &mut Frame, chain: &Chain, rows: &Rows, rng: &mut impl Rng) {
        let n = twin.len();
        let shift = below(rng, n);
        let flip = sign(rng);
        let sled = &chain.vehicle.sled;
        let rest = |c: usize, i: usize| -> f64 {
            match rows[c].get((i + shift) % n) {
                Some(r) => flip * self.beyond[c] * r,
                None => 0.0,
            }
        };
        for i in 0..n {
            let yaw = rest(2, i) / sled.j_zz_kgm2;
            twin.rate_slope[2][i] += yaw;
            twin.acceleration[0][i] += rest(0, i) / sled.mass_kg - sled.accel_y_m * yaw;
            twin.acceleration[1][i] += rest(1, i) / sled.mass_kg + sled.accel_x_m * yaw;
            twin.v_slope[i] += rest(3, i);
        }
    }

    fn add_noise(&self, twin: &mut Frame, rng: &mut impl Rng) {
        let (recorded, dt) = twin.recorded;
        let kernel = Kernel::new(dt, CUTOFF_HZ.min(0.2 / dt), RATE_HZ);
        let n = twin.len();
        // Long enough for n outputs whatever was cut away at the ends.
        let length = recorded.max((n - 1) * kernel.stride + 2 * kernel.margin() + 1);
        let mut white = |sd: f64| -> Vec<f64> { (0..length).map(|_| sd * normal(rng)).collect() };
        let add = |to: &mut [f64], what: Vec<f64>| {
            for (x, e) in to.iter_mut().zip(what) {
                *x += e;
            }
        };
        let noise = self.noise;
        for axis in 0..3 {
            let e = white(noise.accel_mps2);
            add(&mut twin.acceleration[axis], kernel.smooth(&e));
            let e = white(noise.rate_radps);
            add(&mut twin.rate[axis], kernel.smooth(&e));
            add(&mut twin.rate_slope[axis], kernel.slope(&e));
        }
        let e = white(noise.speed_mps);
        add(&mut twin.v, kernel.smooth(&e));
        add(&mut twin.v_slope, kernel.slope(&e));
        let e = white(noise.slip_rad);
        add(&mut twin.slip, kernel.smooth(&e));
        add(&mut twin.slip_rate, kernel.slope(&e));
        let e = white(noise.steer_rad);
        add(&mut twin.steer, kernel.smooth(&e));
        add(&mut twin.steer_rate, kernel.slope(&e));
        let e = white(noise.roll_split_rad);
        add(&mut twin.roll_split, kernel.smooth(&e));
    }
}

fn scaled(noise: Noise, factor: f64) -> Noise {
    Noise {
        accel_mps2: noise.accel_mps2 * factor,
        rate_radps: noise.rate_radps * factor,
        speed_mps: noise.speed_mps * factor,
        slip_rad: noise.slip_rad * factor,
        steer_rad: noise.steer_rad * factor,
        roll_split_rad: noise.roll_split_rad * factor,
    }
}

/// The run with the accelerations that the model gives for its measured inputs: its residuals are zero.
fn truth(frame: &Frame, chain: &Chain, rows: &Rows) -> Frame {
    let mut twin = frame.clone();
    let sled = &chain.vehicle.sled;
    for (i, ((along, side), moment)) in rows[0].iter().zip(&rows[1]).zip(&rows[2]).enumerate() {
        let yaw = moment / sled.j_zz_kgm2;
        twin.rate_slope[2][i] -= yaw;
        twin.acceleration[0][i] += sled.accel_y_m * yaw - along / sled.mass_kg;
        twin.acceleration[1][i] -= sled.accel_x_m * yaw + side / sled.mass_kg;
    }
    if !rows[3].is_empty() {
        let left = chain.residuals(&twin);
        for (slope, r) in twin.v_slope.iter_mut().zip(&left[3]) {
            *slope -= r;
        }
    }
    twin
}
