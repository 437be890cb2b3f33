//! Zero-phase low pass and down-sampling.

use sci_rs::signal::filter::design::{
    DigitalFilter, FilterBandType, FilterOutputType, Sos, butter_dyn,
};
use sci_rs::signal::filter::sosfiltfilt_dyn;

/// Order of the Butterworth filter; run forwards and backwards, its amplitude is that of twice the order.
pub const ORDER: usize = 4;
/// Fewest samples that the filter's odd extension at the ends needs.
pub const LEAST_SAMPLES: usize = 16;

/// Butterworth low pass of order 4, run forwards and backwards: no phase, amplitude -6 dB at the corner.
///
/// The ends are extended oddly by 15 samples and the filter starts in its steady state, as SciPy's
/// `sosfiltfilt(butter(4, cutoff, fs=rate, output="sos"), x)` does, to which it is equal within 1e-12.
/// A corner at or above half the rate leaves the signal as it is.
///
/// # Panics
/// Where there are fewer than 16 samples; [`crate::record::check::LEAST_SAMPLES`] keeps runs above that.
pub fn low_pass(values: &[f64], rate_hz: f64, cutoff_hz: f64) -> Vec<f64> {
    if cutoff_hz >= 0.5 * rate_hz {
        return values.to_vec();
    }
    assert!(
        values.len() >= LEAST_SAMPLES,
        "low pass needs {LEAST_SAMPLES} samples, got {}",
        values.len()
    );
    sosfiltfilt_dyn(values.iter(), &sections(rate_hz, cutoff_hz))
}

fn sections(rate_hz: f64, cutoff_hz: f64) -> Vec<Sos<f64>> {
    let filter = butter_dyn(
        ORDER,
        vec![cutoff_hz],
        Some(FilterBandType::Lowpass),
        Some(false),
        Some(FilterOutputType::Sos),
        Some(rate_hz),
    );
    match filter {
        DigitalFilter::Sos(filter) => filter.sos,
        _ => unreachable!("second-order sections were asked for"),
    }
}

/// Share of white noise at `rate_hz` that [`low_pass`] lets through, as a ratio of standard deviations.
///
/// The root of the summed squares of the impulse response; used to tell how noisy a filtered sensor is.
pub fn noise_gain(rate_hz: f64, cutoff_hz: f64) -> f64 {
    if cutoff_hz >= 0.5 * rate_hz {
        return 1.0;
    }
    // Long enough for the response to die out: its slowest pole decays over about a period of the corner.
    let half = ((20.0 * rate_hz / cutoff_hz) as usize).clamp(200, 200_000);
    let mut impulse = vec![0.0; 2 * half + 1];
    impulse[half] = 1.0;
    low_pass(&impulse, rate_hz, cutoff_hz)
        .iter()
        .map(|h| h * h)
        .sum::<f64>()
        .sqrt()
}

/// Samples at `from_hz` for one at the lower `to_hz`: whole where it is within a thousandth of a whole number.
pub fn ratio(from_hz: f64, to_hz: f64) -> f64 {
    let ratio = from_hz / to_hz;
    let whole = ratio.round();
    if (ratio - whole).abs() < 1e-3 * ratio {
        whole
    } else {
        ratio
    }
}

/// Brings a signal to a lower rate: low pass at 0.4 of the new rate, then every k-th sample, or, where the rates are
/// no multiples of each other, cubic interpolation (Catmull-Rom) of the low-passed signal.
///
/// A rate at or below the new one is left as it is: nothing is invented between samples.
pub fn resample(values: &[f64], from_hz: f64, to_hz: f64) -> Vec<f64> {
    resample_from(values, from_hz, to_hz, 0.0)
}

/// The same with the first sample of the result `offset` samples after the first of `values`.
pub fn resample_from(values: &[f64], from_hz: f64, to_hz: f64, offset: f64) -> Vec<f64> {
    // Rates told by rounded times: 99.99 Hz is 100 Hz.
    if to_hz >= from_hz * (1.0 - 1e-3) {
        return values.to_vec();
    }
    let smooth = low_pass(values, from_hz, 0.4 * to_hz);
    let ratio = ratio(from_hz, to_hz);
    if ratio.fract() == 0.0 {
        let first = offset.round() as usize;
        return smooth
            .into_iter()
            .skip(first)
            .step_by(ratio as usize)
            .collect();
    }
    let last = smooth.len() - 1;
    let at = |i: isize| smooth[i.clamp(0, last as isize) as usize];
    let count = ((last as f64 - offset) / ratio + 1e-9).floor() as usize + 1;
    (0..count)
        .map(|k| {
            let position = offset + k as f64 * ratio;
            let i = (position as usize).min(last);
            let t = position - i as f64;
            let i = i as isize;
            let (a, b, c, d) = (at(i - 1), at(i), at(i + 1), at(i + 2));
            b + 0.5
                * t
                * ((c - a) + t * ((2.0 * a - 5.0 * b + 4.0 * c - d) + t * (3.0 * (b - c) + d - a)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(frequency: f64, rate: f64, count: usize) -> Vec<f64> {
        (0..count)
            .map(|i| (std::f64::consts::TAU * frequency * i as f64 / rate).sin())
            .collect()
    }

    #[test]
    fn amplitude_is_the_squared_butterworth_and_phase_is_zero() {
        // |H|^2 of the order-4 bilinear Butterworth: 1 / (1 + (tan(pi f/fs) / tan(pi fc/fs))^8).
        let (rate, corner) = (100.0, 20.0);
        for frequency in [5.0, 15.0, 20.0, 30.0] {
            let input = sine(frequency, rate, 4000);
            let output = low_pass(&input, rate, corner);
            let warp = |f: f64| (std::f64::consts::PI * f / rate).tan();
            let gain = 1.0 / (1.0 + (warp(frequency) / warp(corner)).powi(8));
            for i in 1500..2500 {
                assert!(
                    (output[i] - gain * input[i]).abs() < 1e-9,
                    "{frequency} Hz at {i}: {} instead of {}",
                    output[i],
                    gain * input[i]
                );
            }
        }
    }

    #[test]
    fn down_sampling_keeps_slow_and_drops_fast_signals() {
        for rate in [500.0, 250.0] {
            let slow = resample(&sine(3.0, rate, 5000), rate, 100.0);
            let expected = sine(3.0, 100.0, slow.len());
            for i in 100..slow.len() - 100 {
                assert!((slow[i] - expected[i]).abs() < 2e-4, "{rate} Hz, {i}");
            }
            let fast = resample(&sine(97.0, rate, 5000), rate, 100.0);
            let most = fast[100..fast.len() - 100]
                .iter()
                .fold(0.0_f64, |m, v| m.max(v.abs()));
            assert!(most < 2e-3, "97 Hz leaves {most} at {rate} Hz");
        }
    }

    #[test]
    fn noise_gain_is_that_of_the_bandwidth() {
        // An ideal low pass at 20 of 50 Hz lets sqrt(0.4) through; order 4 twice is a little below.
        let gain = noise_gain(100.0, 20.0);
        assert!((gain - 0.4_f64.sqrt()).abs() < 0.03, "{gain}");
    }
}
