//! Faults of sensors: a law between what is true and what is read, and its inverse.

use crate::effects::motion::{Sensor, Signals};

/// How a reading departs from the truth by a size k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// `read = true + k`.
    Biased,
    /// `read = (1 + k) true`.
    Scaled,
    /// `read(t) = true(t - k)`: late by k [s]. Of one instant, whose rate alone is known, to first order: `true - k dtrue/dt`.
    Late,
    /// `read = true + factor k other`: the sensor picks up another one.
    PicksUp {
        /// What it picks up.
        other: Sensor,
        /// Sign and size at k = 1.
        factor: f64,
    },
}

/// A fault of one sensor with one parameter of an effect as its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// The sensor.
    pub of: Sensor,
    /// Its law.
    pub reading: Reading,
    /// Place of the size among the effect's parameters.
    pub parameter: usize,
}

impl Fault {
    /// `read = true + k`.
    pub const fn bias(of: Sensor, parameter: usize) -> Self {
        let reading = Reading::Biased;
        Self {
            of,
            reading,
            parameter,
        }
    }

    /// `read = (1 + k) true`.
    pub const fn scale(of: Sensor, parameter: usize) -> Self {
        let reading = Reading::Scaled;
        Self {
            of,
            reading,
            parameter,
        }
    }

    /// `read(t) = true(t - k)`.
    pub const fn lag(of: Sensor, parameter: usize) -> Self {
        let reading = Reading::Late;
        Self {
            of,
            reading,
            parameter,
        }
    }

    /// `read = true + factor k other`.
    pub const fn picks_up(of: Sensor, other: Sensor, factor: f64, parameter: usize) -> Self {
        let reading = Reading::PicksUp { other, factor };
        Self {
            of,
            reading,
            parameter,
        }
    }

    /// From what is true to what is read at one instant.
    pub fn disturb(&self, size: f64, signals: &mut Signals) {
        let at = self.of as usize;
        match self.reading {
            Reading::Biased => signals.value[at] += size,
            Reading::Scaled => {
                signals.value[at] *= 1.0 + size;
                signals.rate[at] *= 1.0 + size;
            }
            Reading::Late => signals.value[at] -= size * signals.rate[at],
            Reading::PicksUp { other, factor } => {
                signals.value[at] += factor * size * signals.value[other as usize];
                signals.rate[at] += factor * size * signals.rate[other as usize];
            }
        }
    }

    /// From what is read to what is true: the inverse of [`Fault::disturb`].
    pub fn correct(&self, size: f64, signals: &mut Signals) {
        let at = self.of as usize;
        match self.reading {
            Reading::Biased => signals.value[at] -= size,
            Reading::Scaled => {
                signals.value[at] /= 1.0 + size;
                signals.rate[at] /= 1.0 + size;
            }
            Reading::Late => signals.value[at] += size * signals.rate[at],
            Reading::PicksUp { other, factor } => {
                signals.value[at] -= factor * size * signals.value[other as usize];
                signals.rate[at] -= factor * size * signals.rate[other as usize];
            }
        }
    }
}
