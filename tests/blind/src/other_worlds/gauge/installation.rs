//! What a refit may move: base parameters freely, and what the installation may be off by.

use crate::other_worlds::recorder::{ROWS_HZ, Row};
use crate::other_worlds::wrong::{CHANNELS, Fault};
use crate::world::sled::Sled as Stated;

/// Defaults of `[tolerances]`, standard deviations: of clocks [s], of gyroscopes (of one, [rad/s]),
/// of accelerometers (of one, [m/s2]), of the steering's scale.
const DELAY_S: f64 = 0.002;
const GYRO: [f64; 2] = [0.005, 0.001];
const ACCELEROMETER: [f64; 2] = [0.005, 0.02];
const STEER_SCALE: f64 = 0.01;

/// Channels that may be off, by a standard deviation.
pub fn faults() -> Vec<(Fault, f64)> {
    let mut faults: Vec<(Fault, f64)> = (0..CHANNELS).map(|c| (Fault::Delay(c), DELAY_S)).collect();
    for (channels, [scale, bias]) in [(0..3, ACCELEROMETER), (3..6, GYRO)] {
        faults.extend(channels.clone().map(|c| (Fault::Scale(c), scale)));
        faults.extend(channels.map(|c| (Fault::Bias(c), bias)));
    }
    faults.push((Fault::Scale(8), STEER_SCALE));
    faults
}

/// A change of the stated sled.
pub type Change = fn(&mut Stated);

/// The stated sled off by a standard deviation: places 2 cm, mass 1 %, inertias 5 %.
pub const SLEDS: [Change; 8] = [
    |s| s.accel_m[0] += 0.02,
    |s| s.accel_m[1] += 0.02,
    |s| s.accel_m[2] += 0.02,
    |s| s.slip_x_m += 0.02,
    |s| s.say_centre_back(0.02),
    |s| s.mass_kg *= 1.01,
    |s| s.j_yy_kgm2 *= 1.05,
    |s| s.j_zz_kgm2 *= 1.05,
];

/// Base parameters, which a refit moves freely.
pub const BASE: [Change; 5] = [
    |s| s.mu *= 1.02,
    |s| s.front.mu_zeta *= 1.02,
    |s| s.front.k_n_per_rad *= 1.02,
    |s| s.rear.mu_zeta *= 1.02,
    |s| s.rear.k_n_per_rad *= 1.02,
];

/// Rows as they read where a channel is off; a delay to first order.
pub fn faulty(rows: &[Row], fault: Fault, sd: f64) -> Vec<Row> {
    let c = fault.channel();
    let last = rows.len() - 1;
    let mut off = rows.to_vec();
    for (k, row) in off.iter_mut().enumerate() {
        row[c] = match fault {
            Fault::Delay(_) => {
                let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
                let rise = (rows[b][c] - rows[a][c]) / (b - a).max(1) as f64;
                rows[k][c] - sd * ROWS_HZ * rise
            }
            _ => fault.read(c, sd, rows[k][c], 0.0),
        };
    }
    off
}
