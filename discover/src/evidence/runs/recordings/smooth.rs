//! Zero-phase low pass, derivative and decimation in one pass.
//!
//! Every channel is convolved with the same Gaussian kernel, so that linear relations between
//! channels are preserved; the derivative is the convolution with the kernel's derivative. The
//! amplitude at the cutoff frequency is 1/sqrt(2).

use crate::regression::gram::dot;

/// A Gaussian kernel on a uniform grid.
#[derive(Clone, Debug, Default)]
pub struct Kernel {
    weights: Vec<f64>,
    slopes: Vec<f64>,
    /// Samples per output.
    pub stride: usize,
}

impl Kernel {
    /// A kernel for `dt` [s] between samples, cutoff frequency `cutoff` [Hz], output at about
    /// `rate` [Hz].
    pub fn new(dt: f64, cutoff: f64, rate: f64) -> Self {
        // |H(f)| = exp(-2 pi^2 f^2 sigma^2) = 2^-1/2 at the cutoff.
        let sigma = (0.5_f64.ln().abs() / 4.0).sqrt() / (std::f64::consts::PI * cutoff);
        let half = (4.0 * sigma / dt).ceil().max(1.0) as usize;
        let at = |k: usize| (k as f64 - half as f64) * dt;
        let mut weights: Vec<f64> = (0..=2 * half)
            .map(|k| (-0.5 * (at(k) / sigma).powi(2)).exp())
            .collect();
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= sum);
        // Normalised so that a ramp has its exact slope.
        let mut slopes: Vec<f64> = (0..=2 * half).map(|k| at(k) * weights[k]).collect();
        let norm: f64 = (0..=2 * half).map(|k| at(k) * slopes[k]).sum();
        slopes.iter_mut().for_each(|s| *s /= norm);
        Self {
            weights,
            slopes,
            stride: (1.0 / (rate * dt)).round().max(1.0) as usize,
        }
    }

    /// Samples at each end without a full kernel around them.
    pub fn margin(&self) -> usize {
        self.weights.len() / 2
    }

    /// Indices of the samples around which outputs are centred.
    pub fn centres(&self, len: usize) -> impl Iterator<Item = usize> + use<> {
        let half = self.margin();
        (half..len.saturating_sub(half)).step_by(self.stride)
    }

    /// The smoothed signal at [`Kernel::centres`].
    pub fn smooth(&self, x: &[f64]) -> Vec<f64> {
        self.convolve(x, self.centres(x.len()), &self.weights)
    }

    /// The derivative [1/s] of the smoothed signal at [`Kernel::centres`].
    pub fn slope(&self, x: &[f64]) -> Vec<f64> {
        self.convolve(x, self.centres(x.len()), &self.slopes)
    }

    /// The smoothed signal at some of [`Kernel::centres`].
    pub fn smooth_at(&self, x: &[f64], centres: &[usize]) -> Vec<f64> {
        self.convolve(x, centres.iter().copied(), &self.weights)
    }

    /// The [`Kernel::centres`] whose whole window is used.
    pub fn clear_centres(&self, is_used: &[bool]) -> Vec<usize> {
        let half = self.margin();
        let clear = |i: &usize| is_used[i - half..=i + half].iter().all(|t| *t);
        self.centres(is_used.len()).filter(clear).collect()
    }

    fn convolve(
        &self,
        x: &[f64],
        centres: impl Iterator<Item = usize>,
        kernel: &[f64],
    ) -> Vec<f64> {
        let half = self.margin();
        let at = |i: usize| dot(&x[i - half..=i + half], kernel);
        centres.map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_keeps_its_value_and_slope() {
        let kernel = Kernel::new(0.01, 8.0, 25.0);
        let x: Vec<f64> = (0..200).map(|i| 3.0 + 0.02 * f64::from(i)).collect();
        let centres: Vec<usize> = kernel.centres(x.len()).collect();
        for ((y, d), i) in kernel.smooth(&x).iter().zip(kernel.slope(&x)).zip(centres) {
            assert!((y - x[i]).abs() < 1e-12 && (d - 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_corner_is_at_half_power() {
        let kernel = Kernel::new(0.001, 8.0, 1000.0);
        let x: Vec<f64> = (0..4000)
            .map(|i| (2.0 * std::f64::consts::PI * 8.0 * 0.001 * f64::from(i)).sin())
            .collect();
        let peak = kernel
            .smooth(&x)
            .iter()
            .fold(0.0_f64, |m, y| m.max(y.abs()));
        assert!((peak - 0.5_f64.sqrt()).abs() < 1e-3, "{peak}");
    }
}
