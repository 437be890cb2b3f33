//! An effect: its description and the functions of its laws.

use serde::Deserialize;

use crate::column::Sensor;
use crate::effects::catalogue::{ON_FORCES, ON_FRICTION, ON_SLED, ON_SLOPE};
use crate::effects::{Forces, Info, OperatingPoint, Signals, State};
use crate::sled::Sled;

/// The friction coefficient with an effect, from the effect's parameters, the coefficient without
/// it, and the operating point.
pub type FrictionLaw = fn(&[f64], f64, &OperatingPoint) -> f64;

/// A law for the forces, from parameters and state.
pub type ForceLaw = fn(&[f64], &State, &mut Forces);

/// Changes the constants of the sled, from parameters.
pub type SledLaw = fn(&[f64], &mut Sled);

/// Addition to the track's slope [rad], from parameters and distance [m].
pub type SlopeLaw = fn(&[f64], f64) -> f64;

/// A switchable part of the model; parameters come in the order of [`Info::parameters`].
///
/// At default parameters it changes nothing. A law that an effect does not have is `None`.
pub struct Effect {
    /// Name, formula, parameters, required columns and the test that decides on it.
    pub info: Info,
    /// The friction coefficient with the effect.
    ///
    /// On a sled it acts on both runners, unless the effect has a law for forces or for the slope.
    pub on_friction: Option<FrictionLaw>,
    /// Changes the forces of the base law.
    pub on_forces: Option<ForceLaw>,
    /// Faults of sensors.
    pub on_sensors: &'static [Fault],
    /// Index of the parameter that is a relaxation length ([`Relaxed`](crate::effects::Relaxed)).
    pub relaxes: Option<usize>,
    /// Changes the stated constants of the sled to the true ones.
    pub on_sled: Option<SledLaw>,
    /// Addition to the track's slope at a distance [m], downhill positive [rad].
    pub on_slope: Option<SlopeLaw>,
}

impl Effect {
    /// The effect of an entry. Its laws are looked up by its name in the tables of the catalogue; a
    /// fault of several sensors and a relaxation length are recognised here by name.
    pub(crate) fn new(info: Info) -> Effect {
        fn law<T: Copy>(laws: &[(&str, T)], name: &str) -> Option<T> {
            let entry = laws.iter().find(|(known, _)| *known == name);
            entry.map(|(_, law)| *law)
        }
        Effect {
            info,
            on_friction: law(ON_FRICTION, info.name),
            on_forces: law(ON_FORCES, info.name),
            on_sensors: match info.name {
                "imu-misalignment" => [0, 1, 2].map(Fault::misaligned).concat().leak(),
                _ => info.faults,
            },
            relaxes: (info.name == "relaxation-length").then_some(0),
            on_sled: law(ON_SLED, info.name),
            on_slope: law(ON_SLOPE, info.name),
        }
    }

    /// Its description.
    pub fn info(&'static self) -> &'static Info {
        &self.info
    }

    /// The friction coefficient with the effect, from the coefficient `mu` without it.
    pub fn coefficient(&self, parameters: &[f64], mu: f64, at: &OperatingPoint) -> f64 {
        self.on_friction.map_or(mu, |law| law(parameters, mu, at))
    }

    /// Changes the forces of the base law.
    pub fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        if let Some(law) = self.on_forces {
            law(parameters, at, forces);
        } else if self.on_friction.is_some() && self.on_slope.is_none() {
            self.scale_along(parameters, at, forces);
        }
    }

    /// Replaces the coefficient of the force along each runner.
    fn scale_along(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        for runner in 0..2 {
            let load = at.load[runner];
            if load <= 0.0 {
                continue;
            }
            let point = OperatingPoint {
                fz: load,
                film: at.film[runner],
                ..at.point
            };
            let mu = -forces.along[runner] / load;
            forces.along[runner] = -load * self.coefficient(parameters, mu, &point);
        }
    }

    /// Whether it is a fault of sensors or changes a constant of the sled.
    pub fn moves_signals(&self) -> bool {
        !self.on_sensors.is_empty() || self.on_sled.is_some()
    }

    /// From readings to true values, and from the stated constants of the sled to the true ones.
    pub fn correct(&self, parameters: &[f64], signals: &mut Signals) {
        for fault in self.on_sensors.iter().rev() {
            fault.correct(parameters[fault.parameter], signals);
        }
        self.find_constants(parameters, &mut signals.sled);
    }

    /// From true values to readings.
    pub fn disturb(&self, parameters: &[f64], signals: &mut Signals) {
        for fault in self.on_sensors {
            fault.disturb(parameters[fault.parameter], signals);
        }
    }

    /// From the stated constants of the sled to the true ones.
    pub fn find_constants(&self, parameters: &[f64], sled: &mut Sled) {
        if let Some(law) = self.on_sled {
            law(parameters, sled);
        }
    }

    /// Addition to the track's slope at `s` [m], downhill positive [rad].
    pub fn slope(&self, parameters: &[f64], s: f64) -> f64 {
        self.on_slope.map_or(0.0, |law| law(parameters, s))
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Effect").field(&self.info.name).finish()
    }
}

/// Law of a reading with a fault of size k.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reading {
    /// `read = true + k`.
    Biased,
    /// `read = (1 + k) true`.
    Scaled,
    /// `read(t) = true(t - k)`: late by k [s]. At a single instant to first order:
    /// `true - k dtrue/dt`.
    Late,
    /// `read = true + factor k other`: the sensor picks up another quantity.
    PicksUp {
        /// Sensor of the other quantity.
        other: Sensor,
        /// Sign and size at k = 1.
        factor: f64,
    },
}

/// A fault of one sensor. Its size is a parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fault {
    /// The sensor.
    pub of: Sensor,
    /// Its law.
    pub reading: Reading,
    /// Index of the size among the parameters of the effect.
    #[serde(default)]
    pub parameter: usize,
}

impl Fault {
    /// `read = true + factor k other`.
    pub fn picks_up(of: Sensor, other: Sensor, factor: f64, parameter: usize) -> Self {
        Self {
            of,
            reading: Reading::PicksUp { other, factor },
            parameter,
        }
    }

    /// The inertial unit turned by a small angle about x (left side up), y (nose down) or z (to the
    /// left): accelerometer and gyroscope read their own turned axes. The readings are those of a
    /// rotation up to the second order in the angle.
    pub fn misaligned(axis: usize) -> [Self; 4] {
        let (a, b, sign) = [(1, 2, 1.0), (0, 2, -1.0), (0, 1, 1.0)][axis];
        let [force, rate] = [Sensor::ACCELEROMETER, Sensor::GYROSCOPE];
        [
            Self::picks_up(force[a], force[b], sign, axis),
            Self::picks_up(force[b], force[a], -sign, axis),
            Self::picks_up(rate[a], rate[b], sign, axis),
            Self::picks_up(rate[b], rate[a], -sign, axis),
        ]
    }

    /// From the true values of one instant to the readings.
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

    /// From readings to true values: the inverse of [`Fault::disturb`].
    pub fn correct(&self, size: f64, signals: &mut Signals) {
        match self.reading {
            Reading::Scaled => {
                let at = self.of as usize;
                signals.value[at] /= 1.0 + size;
                signals.rate[at] /= 1.0 + size;
            }
            _ => self.disturb(-size, signals),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Length and angle of the accelerations are those of a turned unit up to the square of the
    /// angle, and corrected readings are the true values.
    #[test]
    fn a_misaligned_unit_reads_rotated_axes_and_is_corrected_exactly() {
        let angle = 0.01;
        for faults in [0, 1, 2].map(Fault::misaligned) {
            let mut signals = Signals::default();
            for (k, value) in [1.0, -2.0, 15.0, 0.3, 0.1, -0.8].into_iter().enumerate() {
                signals.value[k] = value;
            }
            let truth = signals;
            for fault in &faults {
                fault.disturb(angle, &mut signals);
            }
            for [a, b, c] in [[0, 1, 2], [3, 4, 5]] {
                let square =
                    |s: &Signals| [a, b, c].map(|k| s.value[k].powi(2)).iter().sum::<f64>();
                let (turned, own) = (square(&signals), square(&truth));
                assert!(
                    (turned / own - 1.0).abs() < 2.0 * angle * angle,
                    "{turned} {own}"
                );
            }
            for fault in faults.iter().rev() {
                fault.correct(angle, &mut signals);
            }
            for (a, b) in signals.value.iter().zip(&truth.value) {
                assert!((a - b).abs() < 1e-14);
            }
        }
    }
}
