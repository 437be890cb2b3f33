//! How noisy the sensors are: as the model states, or as the recording itself shows.

use crate::model::sled::{Noise, Sled};
use crate::record::run::Run;

/// Standard deviation of white noise on a smooth signal, from its third differences.
///
/// ```text
/// var(y_{i+3} - 3 y_{i+2} + 3 y_{i+1} - y_i) = 20 sd^2   for white noise
/// ```
///
/// What the signal itself does within four samples is mostly cancelled; the median makes the rest of little weight.
/// 0 where there are fewer than four samples. Unit: that of the signal.
pub fn white_noise_sd(values: &[f64]) -> f64 {
    noise_sd_within(std::iter::once(values))
}

/// The same over several stretches of a signal.
pub fn noise_sd_within<'a>(stretches: impl Iterator<Item = &'a [f64]>) -> f64 {
    let mut sizes: Vec<f64> = stretches
        .flat_map(|values| values.windows(4))
        .map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs())
        .collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    // The median magnitude of a normal variable is 0.6745 of its deviation.
    median / 0.674_489_75 / 20.0_f64.sqrt()
}

/// Noise of every sensor of a run at its own rate, estimated by [`white_noise_sd`]; 0 for those that are not recorded.
pub fn estimate_noise(run: &Run) -> Noise {
    let sd = |name: &str| {
        let column = run.columns.get(name);
        column.map_or(0.0, |column| noise_sd_within(run.gaps.within(column)))
    };
    let largest = |names: [&str; 3]| names.into_iter().map(sd).fold(0.0, f64::max);
    Noise {
        accel_mps2: largest(["ax_mps2", "ay_mps2", "az_mps2"]),
        rate_radps: largest(["roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"]),
        speed_mps: sd("v_mps"),
        slip_rad: sd("alpha_rad"),
        steer_rad: sd("delta_rad"),
        roll_split_rad: sd("gamma_rad"),
    }
}

/// Standard deviations of the slip angles at the front and the rear runner [rad], before any filter.
///
/// ```text
/// var(alpha_P) = var(alpha) + ((x_P - x_s) / v)^2 var(yaw_rate) (+ var(delta) at the front)
/// ```
pub fn slip_noise(sled: &Sled, noise: &Noise, v: f64) -> (f64, f64) {
    let at = |x: f64| {
        let lever = (x - sled.slip_x_m) / v;
        noise.slip_rad.powi(2) + (lever * noise.rate_radps).powi(2)
    };
    (
        (at(sled.l_f_m) + noise.steer_rad.powi(2)).sqrt(),
        at(-sled.l_r_m).sqrt(),
    )
}
