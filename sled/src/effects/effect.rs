//! An effect as a value: a plain description with plain functions, one static of it in each file of the catalogue.

use crate::effects::Info;
use crate::effects::description::Example;
use crate::effects::{Conditions, Constants, Forces, Sensor, Signals, State};

/// The friction coefficient from an effect's parameters, the coefficient without it, and the conditions.
pub type FrictionLaw = fn(&[f64], f64, &Conditions) -> f64;

/// A switchable part of the model; parameters come in the order of [`Info::parameters`].
///
/// At default parameters it changes nothing. A law that an effect does not have is `None`.
pub struct Effect {
    /// Name, formula, parameters, what it needs and how it is judged.
    pub info: Info,
    /// The friction coefficient with the effect, from parameters, the coefficient without it, and the conditions.
    ///
    /// On a sled it acts on both runners, unless the effect has a law for forces or for the slope.
    pub on_friction: Option<FrictionLaw>,
    /// Changes the forces of the base law.
    pub on_forces: Option<fn(&[f64], &State, &mut Forces)>,
    /// What sensors read.
    pub on_sensors: &'static [Fault],
    /// The parameter that is a distance after which forces follow the slip ([`Relaxed`](crate::effects::Relaxed)).
    pub relaxes: Option<usize>,
    /// Changes the stated constants of the sled to the true ones.
    pub on_sled: Option<fn(&[f64], &mut Constants)>,
    /// What is added to the track's slope at a distance [m], downhill positive [rad].
    pub on_slope: Option<fn(&[f64], f64) -> f64>,
    /// A number that it must give.
    pub example: Example,
}

impl Effect {
    /// An effect without a law, described by what its example must give: the base of an entry of a table.
    pub(crate) const fn example(
        parameters: &'static [f64],
        given: &'static [(&'static str, f64)],
        gives: (&'static str, f64),
    ) -> Effect {
        Effect {
            info: Info::NEW,
            on_friction: None,
            on_forces: None,
            on_sensors: &[],
            relaxes: None,
            on_sled: None,
            on_slope: None,
            example: Example {
                parameters,
                given,
                gives,
            },
        }
    }

    /// What is known of it.
    pub fn info(&'static self) -> &'static Info {
        &self.info
    }

    /// The coefficient with the effect, from the coefficient without it; the same where it does not act on it.
    pub fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
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

    /// The coefficient behind the force along each runner is replaced, and the force follows.
    fn scale_along(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        for runner in 0..2 {
            let load = at.load[runner];
            if load <= 0.0 {
                continue;
            }
            let mut conditions = at.conditions;
            conditions.fz = load;
            conditions.film = at.film[runner];
            let mu = -forces.along[runner] / load;
            forces.along[runner] = -load * self.coefficient(parameters, mu, &conditions);
        }
    }

    /// Whether it stands between a sensor and the truth or changes a constant of the sled.
    pub fn moves_signals(&self) -> bool {
        !self.on_sensors.is_empty() || self.on_sled.is_some()
    }

    /// From what the sensors say to what is true, and from the stated constants of the sled to the true ones.
    pub fn correct(&self, parameters: &[f64], signals: &mut Signals) {
        for fault in self.on_sensors.iter().rev() {
            fault.correct(parameters[fault.parameter], signals);
        }
        self.find_constants(parameters, &mut signals.sled);
    }

    /// From what is true to what the sensors say.
    pub fn disturb(&self, parameters: &[f64], signals: &mut Signals) {
        for fault in self.on_sensors {
            fault.disturb(parameters[fault.parameter], signals);
        }
    }

    /// From the stated constants of the sled to the true ones.
    pub fn find_constants(&self, parameters: &[f64], sled: &mut Constants) {
        if let Some(law) = self.on_sled {
            law(parameters, sled);
        }
    }

    /// What is added to the track's slope at `s` [m], downhill positive [rad].
    pub fn slope(&self, parameters: &[f64], s: f64) -> f64 {
        self.on_slope.map_or(0.0, |law| law(parameters, s))
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Effect").field(&self.info.name).finish()
    }
}

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

    /// The inertial unit turned by a small angle about x (left side up), y (nose down) and z (to the left): both of its
    /// sensors read their own axes. To second order the angle about each axis is a rotation.
    pub const MISALIGNED: [[Self; 4]; 3] = [
        [
            Self::picks_up(Sensor::Ay, Sensor::Az, 1.0, 0),
            Self::picks_up(Sensor::Az, Sensor::Ay, -1.0, 0),
            Self::picks_up(Sensor::PitchRate, Sensor::YawRate, 1.0, 0),
            Self::picks_up(Sensor::YawRate, Sensor::PitchRate, -1.0, 0),
        ],
        [
            Self::picks_up(Sensor::Ax, Sensor::Az, -1.0, 1),
            Self::picks_up(Sensor::Az, Sensor::Ax, 1.0, 1),
            Self::picks_up(Sensor::RollRate, Sensor::YawRate, -1.0, 1),
            Self::picks_up(Sensor::YawRate, Sensor::RollRate, 1.0, 1),
        ],
        [
            Self::picks_up(Sensor::Ax, Sensor::Ay, 1.0, 2),
            Self::picks_up(Sensor::Ay, Sensor::Ax, -1.0, 2),
            Self::picks_up(Sensor::RollRate, Sensor::PitchRate, 1.0, 2),
            Self::picks_up(Sensor::PitchRate, Sensor::RollRate, -1.0, 2),
        ],
    ];

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

impl Effect {
    /// The number that its example gives; NaN where a name in it is none that an effect knows.
    pub fn example_outcome(&self) -> f64 {
        let example = &self.example;
        let (mut mu, mut slope) = (0.0, 0.0);
        let (mut state, mut forces) = (State::default(), Forces::default());
        let mut signals = Signals::default();
        for (name, value) in example.given {
            let mut known = false;
            let mut set = |place: Option<&mut f64>| {
                if let Some(place) = place {
                    *place = *value;
                    known = true;
                }
            };
            set((*name == "mu").then_some(&mut mu));
            set((*name == "slope_rad").then_some(&mut slope));
            set(condition(&mut state.conditions, name));
            set(instant(&mut state, name));
            set(force(&mut forces, name));
            set(signal(&mut signals, name));
            set(constant(&mut signals.sled, name));
            if !known {
                return f64::NAN;
            }
        }
        let wanted = example.gives.0;
        if wanted == "mu" {
            return self.coefficient(example.parameters, mu, &state.conditions);
        }
        if wanted == "slope_rad" {
            return slope + self.slope(example.parameters, state.conditions.s);
        }
        self.act(example.parameters, &state, &mut forces);
        self.disturb(example.parameters, &mut signals);
        self.find_constants(example.parameters, &mut signals.sled);
        force(&mut forces, wanted)
            .copied()
            .or_else(|| constant(&mut signals.sled, wanted).copied())
            .or_else(|| signal(&mut signals, wanted).copied())
            .unwrap_or(f64::NAN)
    }
}

fn condition<'a>(c: &'a mut Conditions, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "t_s" => &mut c.t,
        "s_m" => &mut c.s,
        "v_mps" => &mut c.v,
        "fz_n" => &mut c.fz,
        "ice_c" => &mut c.ice_c,
        "air_c" => &mut c.air_c,
        "air_pa" => &mut c.air_pa,
        "humidity_pct" => &mut c.humidity_pct,
        "distance_m" => &mut c.distance,
        "air_density_kgpm3" => &mut c.air_density,
        "cda_m2" => &mut c.drag_area,
        "film" => &mut c.film,
        _ => return None,
    })
}

fn instant<'a>(state: &'a mut State, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "fz_f_n" => &mut state.load[0],
        "fz_r_n" => &mut state.load[1],
        "alpha_rad" => &mut state.chassis_slip,
        "alpha_f_rad" => &mut state.slip[0],
        "alpha_r_rad" => &mut state.slip[1],
        "alpha_f_rad_rate" => &mut state.slip_rate[0],
        "alpha_r_rad_rate" => &mut state.slip_rate[1],
        "delta_rad" => &mut state.steering,
        "gamma_rad" => &mut state.roll_split,
        "roll_rate_radps_rate" => &mut state.roll_acceleration,
        "ax_mps2" => &mut state.acceleration[0],
        "az_mps2" => &mut state.acceleration[2],
        _ => return None,
    })
}

fn force<'a>(forces: &'a mut Forces, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "fx_f_n" => &mut forces.along[0],
        "fx_r_n" => &mut forces.along[1],
        "fy_f_n" => &mut forces.across[0],
        "fy_r_n" => &mut forces.across[1],
        "fy_f_n_per_rad" => &mut forces.stiffness[0],
        "fy_r_n_per_rad" => &mut forces.stiffness[1],
        "fx_n" => &mut forces.body_along,
        "fy_n" => &mut forces.body_across,
        "mz_nm" => &mut forces.body_yaw,
        _ => return None,
    })
}

fn signal<'a>(signals: &'a mut Signals, name: &str) -> Option<&'a mut f64> {
    if let Some(of) = Sensor::named(name) {
        return Some(&mut signals.value[of as usize]);
    }
    let of = Sensor::named(name.strip_suffix("_rate")?)?;
    Some(&mut signals.rate[of as usize])
}

fn constant<'a>(sled: &'a mut Constants, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "mass_kg" => &mut sled.mass,
        "j_yy_kgm2" => &mut sled.pitch_inertia,
        "j_zz_kgm2" => &mut sled.yaw_inertia,
        "l_f_m" => &mut sled.axles[0],
        "l_r_m" => &mut sled.axles[1],
        "accel_x_m" => &mut sled.accelerometer[0],
        "accel_y_m" => &mut sled.accelerometer[1],
        "accel_z_m" => &mut sled.accelerometer[2],
        "slip_x_m" => &mut sled.slip_sensor,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Length and angle of the accelerations are those of a turned unit but for the square of the angle, and what is corrected is
    /// what was true.
    #[test]
    fn a_misaligned_unit_reads_rotated_axes_and_is_corrected_exactly() {
        let angle = 0.01;
        for faults in Fault::MISALIGNED {
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
