//! Uniformly sampled series: zero-phase low pass, down-sampling, derivative, correlation.

use std::sync::LazyLock;

use nalgebra::{DMatrix, DVector};
use sci_rs::signal::filter::design::{
    DigitalFilter, FilterBandType, FilterOutputType, Sos, butter_dyn,
};
use sci_rs::signal::filter::sosfiltfilt_dyn;

/// Order of the Butterworth filter; forward and backward filtering doubles its effective order.
pub const ORDER: usize = 4;
/// Smallest number of samples for the filter's odd extension at the ends.
pub const MIN_FILTER_SAMPLES: usize = 16;

/// Pearson correlation of two series over the samples that are finite in both; 0 where either is
/// constant.
pub fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let both = || {
        a.iter()
            .zip(b)
            .filter(|(a, b)| a.is_finite() && b.is_finite())
    };
    let count = both().count().max(1) as f64;
    let (sum_a, sum_b) = both().fold((0.0, 0.0), |(x, y), (a, b)| (x + a, y + b));
    let (mean_a, mean_b) = (sum_a / count, sum_b / count);
    let [aa, ab, bb] = both().fold([0.0; 3], |[aa, ab, bb], (a, b)| {
        let (a, b) = (a - mean_a, b - mean_b);
        [aa + a * a, ab + a * b, bb + b * b]
    });
    if aa * bb > 0.0 {
        ab / (aa * bb).sqrt()
    } else {
        0.0
    }
}

/// Butterworth low pass of order 4, run forwards and backwards: zero phase, amplitude -6 dB at the
/// cutoff frequency.
///
/// The ends are extended oddly by 15 samples and the filter starts in its steady state, as SciPy's
/// `sosfiltfilt(butter(4, cutoff, fs=rate, output="sos"), x)` does, to which it is equal within
/// 1e-12. A cutoff at or above half the rate returns the signal unchanged.
///
/// # Panics
/// Panics with fewer than 16 samples; runs have at least [`crate::record::check::MIN_RUN_SAMPLES`].
pub fn low_pass(values: &[f64], rate_hz: f64, cutoff_hz: f64) -> Vec<f64> {
    if cutoff_hz >= 0.5 * rate_hz {
        return values.to_vec();
    }
    assert!(
        values.len() >= MIN_FILTER_SAMPLES,
        "low pass needs {MIN_FILTER_SAMPLES} samples, got {}",
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
        _ => unreachable!("second-order sections were requested"),
    }
}

/// Ratio of the standard deviation of white noise at `rate_hz` after [`low_pass`] to that before.
///
/// The root of the sum of squares of the impulse response.
pub fn noise_gain(rate_hz: f64, cutoff_hz: f64) -> f64 {
    if cutoff_hz >= 0.5 * rate_hz {
        return 1.0;
    }
    // Long enough for the response to decay: its slowest pole decays over about a period of the
    // cutoff.
    let half = ((20.0 * rate_hz / cutoff_hz) as usize).clamp(200, 200_000);
    let mut impulse = vec![0.0; 2 * half + 1];
    impulse[half] = 1.0;
    let response = low_pass(&impulse, rate_hz, cutoff_hz);
    response.iter().map(|h| h * h).sum::<f64>().sqrt()
}

/// Ratio of the rates, rounded to a whole number if it is within a relative 1e-3 of one.
pub fn ratio(from_hz: f64, to_hz: f64) -> f64 {
    let ratio = from_hz / to_hz;
    let whole = ratio.round();
    if (ratio - whole).abs() < 1e-3 * ratio {
        whole
    } else {
        ratio
    }
}

/// Down-samples a signal: low pass at 0.4 of the new rate, then every k-th sample or, if the ratio
/// of the rates is not a whole number, cubic interpolation (Catmull-Rom) of the low-passed signal.
///
/// A signal with a rate at or below the new one is returned unchanged: there is no up-sampling.
pub fn resample(values: &[f64], from_hz: f64, to_hz: f64) -> Vec<f64> {
    resample_from(values, from_hz, to_hz, 0.0)
}

/// As [`resample`], with the first sample of the result `offset` samples after the first of
/// `values`.
pub fn resample_from(values: &[f64], from_hz: f64, to_hz: f64, offset: f64) -> Vec<f64> {
    // The rate may come from rounded times: 99.99 Hz is 100 Hz.
    if to_hz >= from_hz * (1.0 - 1e-3) {
        return values.to_vec();
    }
    let smooth = low_pass(values, from_hz, 0.4 * to_hz);
    let ratio = ratio(from_hz, to_hz);
    if ratio.fract() == 0.0 {
        let whole = smooth.into_iter().skip(offset.round() as usize);
        return whole.step_by(ratio as usize).collect();
    }
    let last = smooth.len() - 1;
    let at = |i: isize| smooth[i.clamp(0, last as isize) as usize];
    let count = ((last as f64 - offset) / ratio + 1e-9).floor() as usize + 1;
    let value = |k: usize| {
        let position = offset + k as f64 * ratio;
        let i = (position as usize).min(last);
        let t = position - i as f64;
        let i = i as isize;
        let (a, b, c, d) = (at(i - 1), at(i), at(i + 1), at(i + 2));
        let cubic = (2.0 * a - 5.0 * b + 4.0 * c - d) + t * (3.0 * (b - c) + d - a);
        b + 0.5 * t * ((c - a) + t * cubic)
    };
    (0..count).map(value).collect()
}

/// Down-samples a column with gaps: each stretch of finite values separately, as [`resample`]; NaN
/// in the gaps.
///
/// Sample k of the result is at the time of sample `k from_hz / to_hz` of the column. In a stretch
/// too short for the low pass the nearest recorded values are taken.
pub fn resample_stretches(column: &[f64], from_hz: f64, to_hz: f64) -> Vec<f64> {
    if to_hz >= from_hz * (1.0 - 1e-3) {
        return column.to_vec();
    }
    let ratio = ratio(from_hz, to_hz);
    let last_before = |end: usize| ((end - 1) as f64 / ratio + 1e-9).floor() as usize;
    if column.is_empty() {
        return Vec::new();
    }
    let mut result = vec![f64::NAN; last_before(column.len()) + 1];
    let mut start = 0;
    for stretch in column.split_inclusive(|x| !x.is_finite()) {
        let finite = stretch.iter().take_while(|x| x.is_finite()).count();
        let first = (start as f64 / ratio - 1e-9).ceil() as usize;
        let end = start + finite;
        if finite > 0 && first <= last_before(end) {
            let places = first..last_before(end) + 1;
            let values: Vec<f64> = if finite >= MIN_FILTER_SAMPLES {
                let offset = first as f64 * ratio - start as f64;
                resample_from(&column[start..end], from_hz, to_hz, offset)
            } else {
                let near = |k: usize| ((k as f64 * ratio).round() as usize).clamp(start, end - 1);
                places.clone().map(|k| column[near(k)]).collect()
            };
            result[places].copy_from_slice(&values);
        }
        start += stretch.len();
    }
    result
}

/// Number of samples on each side of the centre of the derivative's window.
pub const HALF_WIDTH: usize = 3;
/// Degree of the local polynomial.
pub const DEGREE: usize = 4;

const WIDTH: usize = 2 * HALF_WIDTH + 1;

/// Weights of the derivative at each place of a window of seven samples.
static WEIGHTS: LazyLock<[[f64; WIDTH]; WIDTH]> = LazyLock::new(|| {
    let abscissa = |i: usize| i as f64 - HALF_WIDTH as f64;
    let design = DMatrix::from_fn(WIDTH, DEGREE + 1, |i, k| abscissa(i).powi(k as i32));
    let normal = (design.transpose() * &design).try_inverse();
    let solve = normal.expect("seven points determine a quartic") * design.transpose();
    let slope_of_power = |x: f64, k: usize| match k {
        0 => 0.0,
        k => k as f64 * x.powi(k as i32 - 1),
    };
    std::array::from_fn(|place| {
        let x = abscissa(place);
        let slope = DVector::from_fn(DEGREE + 1, |k, _| slope_of_power(x, k));
        std::array::from_fn(|i| solve.column(i).dot(&slope))
    })
});

/// Running integral by the trapezoidal rule over uniform steps, from 0: distance from speed.
pub fn integral(values: &[f64], dt: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let mut out = vec![0.0; values.len()];
    for i in 1..values.len() {
        sum += 0.5 * dt * (values[i - 1] + values[i]);
        out[i] = sum;
    }
    out
}

/// Derivative of a uniformly sampled signal: a quartic through seven samples by least squares
/// (Savitzky and Golay).
///
/// ```text
/// y'_i = ( 22 (y_{i-3} - y_{i+3}) - 67 (y_{i-2} - y_{i+2}) - 58 (y_{i-1} - y_{i+1}) ) / (252 dt)
/// ```
///
/// Exact for polynomials up to degree 4; white noise of standard deviation sd gives a standard
/// deviation of 0.51 sd / dt. The three samples at each end take the slope of the first or last
/// window's quartic. Unit: that of `values` per second.
///
/// Source: A. Savitzky, M. Golay, Anal. Chem. 36 (1964) 1627, table of quartic first derivatives.
///
/// # Panics
/// Panics with fewer than seven samples.
pub fn derivative(values: &[f64], dt_s: f64) -> Vec<f64> {
    assert!(
        values.len() >= WIDTH,
        "a derivative needs {WIDTH} samples, got {}",
        values.len()
    );
    let last_start = values.len() - WIDTH;
    let slope = |i: usize| {
        let start = i.saturating_sub(HALF_WIDTH).min(last_start);
        let pairs = WEIGHTS[i - start].iter().zip(&values[start..start + WIDTH]);
        pairs.map(|(weight, value)| weight * value).sum::<f64>() / dt_s
    };
    (0..values.len()).map(slope).collect()
}

/// Standard deviation of white noise on a smooth signal in several stretches, from its third
/// differences.
///
/// ```text
/// var(y_{i+3} - 3 y_{i+2} + 3 y_{i+1} - y_i) = 20 sd^2   for white noise
/// ```
///
/// Third differences cancel most of the signal within four samples, and the median is insensitive
/// to the rest. 0 with fewer than four samples. Unit: that of the signal.
pub fn noise_sd_within<'a>(stretches: impl Iterator<Item = &'a [f64]>) -> f64 {
    let third = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs();
    let sizes = stretches.flat_map(|values| values.windows(4)).map(third);
    // The median magnitude of a normal variable is 0.6745 of its deviation.
    median(sizes).map_or(0.0, |median| median / 0.674_489_75 / 20.0_f64.sqrt())
}

/// The median, for an even number of values the upper of the two middle ones; `None` without
/// values.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The values, each once, in the order of their first appearance.
pub fn distinct<T: PartialEq>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut all: Vec<T> = Vec::new();
    for value in values {
        if !all.contains(&value) {
            all.push(value);
        }
    }
    all
}

/// The root mean square; NaN without values.
pub(crate) fn root_mean_square(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}

/// A column with its gaps interpolated linearly, and constant outside its ends; 0 without any
/// finite value.
///
/// For computations that need a number everywhere but do not use values near a gap, and for the
/// distance across a gap.
pub fn bridged(column: &[f64]) -> Vec<f64> {
    let mut filled = column.to_vec();
    let mut before: Option<usize> = None;
    for i in 0..column.len() {
        if !column[i].is_finite() {
            continue;
        }
        let from = before.map_or(0, |b| b + 1);
        for (k, filled) in filled.iter_mut().enumerate().take(i).skip(from) {
            *filled = match before {
                None => column[i],
                Some(b) => {
                    let share = (k - b) as f64 / (i - b) as f64;
                    column[b] + share * (column[i] - column[b])
                }
            };
        }
        before = Some(i);
    }
    let (from, end) = before.map_or((0, 0.0), |b| (b + 1, column[b]));
    filled[from..].fill(end);
    filled
}

#[cfg(test)]
mod filter_tests {
    use super::*;

    #[test]
    fn a_column_with_gaps_has_its_values_at_their_times_at_a_lower_rate() {
        for (from, to) in [(500.0, 100.0), (500.0, 83.0), (100.0, 100.0)] {
            let mut column = sine(1.0, from, 1003);
            for gap in [0..3, 200..260, 261..262, 270..300, 990..1003] {
                column[gap].fill(f64::NAN);
            }
            let found = resample_stretches(&column, from, to);
            let step = from / to;
            assert_eq!(found.len(), (1002.0 / step).floor() as usize + 1);
            for (k, value) in found.iter().enumerate() {
                let at = k as f64 * step;
                let near = [at.floor() as usize, (at.ceil() as usize).min(1002)];
                if near.iter().all(|i| column[*i].is_finite()) {
                    let expected = (std::f64::consts::TAU * at / from).sin();
                    // A short stretch has its nearest value: half a sample at most.
                    let bound = 2e-3 + std::f64::consts::PI / from;
                    assert!((value - expected).abs() < bound, "{at}: {value} {expected}");
                } else if near.iter().all(|i| column[*i].is_nan()) {
                    assert!(value.is_nan(), "{at}: {value}");
                }
            }
        }
        assert!(resample_stretches(&[], 500.0, 100.0).is_empty());
    }

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

#[cfg(test)]
mod derivative_tests {
    use super::*;

    #[test]
    fn quartics_are_differentiated_exactly_up_to_the_ends() {
        let dt = 0.01;
        let f = |t: f64| 1.0 + t * (2.0 - t * (3.0 - t * (4.0 - 5.0 * t)));
        let slope = |t: f64| 2.0 - 6.0 * t + 12.0 * t * t - 20.0 * t * t * t;
        let values: Vec<f64> = (0..40).map(|i| f(i as f64 * dt)).collect();
        for (i, d) in derivative(&values, dt).iter().enumerate() {
            let expected = slope(i as f64 * dt);
            assert!((d - expected).abs() < 1e-10, "{i}: {d} against {expected}");
        }
    }

    #[test]
    fn weights_are_those_of_the_published_table() {
        let table = [22.0, -67.0, -58.0, 0.0, 58.0, 67.0, -22.0];
        for (weight, published) in WEIGHTS[HALF_WIDTH].iter().zip(table) {
            assert!((weight - published / 252.0).abs() < 1e-13);
        }
        let gain: f64 = WEIGHTS[HALF_WIDTH]
            .iter()
            .map(|w| w * w)
            .sum::<f64>()
            .sqrt();
        assert!((gain - 0.5124).abs() < 1e-3, "noise gain {gain}");
    }
}
