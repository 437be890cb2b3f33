//! Random numbers: white and coloured noise, and smooth random functions.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// The random source of a case; every stream comes from the case's seed and a label.
#[derive(Debug, Clone)]
pub struct Source(ChaCha8Rng);

impl Source {
    /// A stream for `label`, independent of the streams of other labels.
    pub fn new(seed: u64, label: &str) -> Self {
        // FNV-1a keeps the streams apart without any global state.
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        for byte in label.bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        Self(ChaCha8Rng::seed_from_u64(
            hash ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15),
        ))
    }

    /// A standard normal number.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A uniform number in `[low, high)`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// +1 or -1.
    pub fn sign(&mut self) -> f64 {
        if self.0.random::<bool>() { 1.0 } else { -1.0 }
    }

    /// Shuffles in place (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            let j = (self.uniform(0.0, 1.0) * (i as f64 + 1.0)) as usize;
            items.swap(i, j.min(i));
        }
    }
}

/// First-order autoregressive noise with standard deviation `sd`.
///
/// `x_k = rho x_(k-1) + sqrt(1 - rho^2) sd e_k`, started in its stationary distribution.
#[derive(Debug, Clone, Copy)]
pub struct Ar1 {
    rho: f64,
    sd: f64,
    state: f64,
}

impl Ar1 {
    /// Noise with correlation `rho` from one sample to the next; `rho = 0` is white.
    pub fn new(rho: f64, sd: f64, source: &mut Source) -> Self {
        Self {
            rho,
            sd,
            state: sd * source.normal(),
        }
    }

    /// The next value.
    pub fn next(&mut self, source: &mut Source) -> f64 {
        let value = self.state;
        self.state =
            self.rho * self.state + (1.0 - self.rho * self.rho).sqrt() * self.sd * source.normal();
        value
    }
}

/// A smooth random function: a sum of sines with random phases and frequencies in a band.
#[derive(Debug, Clone)]
pub struct Smooth {
    waves: Vec<(f64, f64, f64)>,
}

impl Smooth {
    /// `sd` its standard deviation, `low..high` the band in cycles per unit of its argument.
    pub fn new(sd: f64, low: f64, high: f64, source: &mut Source) -> Self {
        const WAVES: usize = 8;
        let amplitude = sd * (2.0 / WAVES as f64).sqrt();
        let waves = (0..WAVES)
            .map(|_| {
                let frequency = source.uniform(low, high);
                let phase = source.uniform(0.0, std::f64::consts::TAU);
                (amplitude, std::f64::consts::TAU * frequency, phase)
            })
            .collect();
        Self { waves }
    }

    /// Its value at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.waves
            .iter()
            .map(|(a, w, p)| a * (w * x + p).sin())
            .sum()
    }

    /// Its value and its derivative at `x`.
    pub fn with_slope_at(&self, x: f64) -> [f64; 2] {
        let mut both = [0.0; 2];
        for (a, w, p) in &self.waves {
            let (sine, cosine) = (w * x + p).sin_cos();
            both[0] += a * sine;
            both[1] += a * w * cosine;
        }
        both
    }

    /// Value and derivative at `x - by`, `x` and `x + by`, by one evaluation of each wave there and
    /// one of `by`.
    pub fn around(&self, x: f64, by: f64) -> [[f64; 2]; 3] {
        let mut all = [[0.0; 2]; 3];
        for (a, w, p) in &self.waves {
            let ((sine, cosine), (s, c)) = ((w * x + p).sin_cos(), (w * by).sin_cos());
            let sines = [sine * c - cosine * s, sine, sine * c + cosine * s];
            let cosines = [cosine * c + sine * s, cosine, cosine * c - sine * s];
            for (at, (sine, cosine)) in all.iter_mut().zip(sines.iter().zip(&cosines)) {
                at[0] += a * sine;
                at[1] += a * w * cosine;
            }
        }
        all
    }

    /// Its derivative at `x`.
    pub fn slope_at(&self, x: f64) -> f64 {
        self.waves
            .iter()
            .map(|(a, w, p)| a * w * (w * x + p).cos())
            .sum()
    }
}
