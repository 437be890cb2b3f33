//! Changes of sensor readings and constants by installation errors and delays.

use kufe_sled::effects::{SENSORS, Sensor};
use kufe_sled::{Sled, Vehicle};

use crate::evidence::runs::model::channels::Channels;
use crate::evidence::runs::model::installation::{Installation, Part};
use crate::evidence::runs::model::residual_jacobian::{ResidualJacobian, changed_constants};
use crate::evidence::runs::model::residual_model::{BALANCES, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;

/// Channels of the inertial unit.
const UNIT: [Sensor; 6] = [
    Sensor::Ax,
    Sensor::Ay,
    Sensor::Az,
    Sensor::RollRate,
    Sensor::PitchRate,
    Sensor::YawRate,
];

/// Readings of a run corrected by a model.
pub struct Readings<'a> {
    own: &'a ResidualModel,
    frame: &'a Frame,
    delays: [f64; SENSORS],
    /// Each channel corrected by itself.
    channels: Channels<'a>,
    /// The same after correction of cross-sensitivity.
    unmixed: Channels<'a>,
    sled: Sled,
}

/// Differences of values, derivatives and constants between two models' corrections of a run.
pub struct Differences {
    sensors: Vec<(Sensor, [Vec<f64>; 2])>,
    /// The constants of the sled by both models.
    sleds: [Sled; 2],
}

impl<'a> Readings<'a> {
    /// Readings of a run corrected by a model.
    pub fn new(own: &'a ResidualModel, frame: &'a Frame) -> Self {
        let delays = own.effects.on_track(&frame.track).delays();
        let installation = &own.installation;
        let channels = corrected(installation, frame, &Sensor::ALL, &delays);
        let mut unmixed = corrected(installation, frame, &UNIT, &delays);
        installation.correct_coupling(&mut unmixed);
        Self {
            own,
            frame,
            delays,
            channels,
            unmixed,
            sled: sled_of(&own.vehicle, installation, frame),
        }
    }

    /// Differences from the readings with one installation error changed by so many standard
    /// deviations.
    pub fn with_part_moved(&self, part: usize, by: f64) -> Differences {
        let installation = self.own.installation.moved(part, by);
        self.differences(&installation, &self.delays)
    }

    /// The same with other delays by effects [s].
    pub fn with_delays(&self, delays: &[f64; SENSORS]) -> Differences {
        self.differences(&self.own.installation, delays)
    }

    /// Differences of sensors or of constants.
    fn differences(&self, other: &Installation, delays: &[f64; SENSORS]) -> Differences {
        let Self { own, frame, .. } = self;
        let [sizes, others] = [&own.installation, other].map(|installation| &installation.sizes);
        let parts = own.installation.parts.iter();
        let moved: Vec<&Part> = parts
            .zip(sizes.iter().zip(others))
            .filter(|(part, (a, b))| a != b && part.acts_in(&frame.session))
            .map(|(part, _)| part)
            .collect();
        // Cross-sensitivity changes all channels of the inertial unit.
        let couples = moved.iter().any(|part| part.couples());
        let reads = |sensor: &Sensor| {
            let k = *sensor as usize;
            self.delays[k] != delays[k] || moved.iter().any(|part| part.sensor() == Some(*sensor))
        };
        let sensors = match couples {
            true => UNIT.to_vec(),
            false => Sensor::ALL.into_iter().filter(reads).collect(),
        };
        let mut channels = corrected(other, frame, &sensors, delays);
        if couples {
            other.correct_coupling(&mut channels);
        }
        let before = if couples {
            &self.unmixed
        } else {
            &self.channels
        };
        let between = |sensor: Sensor| {
            let (own, other) = (before.series(sensor), channels.series(sensor));
            let by = [0, 1].map(|k| {
                let both = other[k].iter().zip(own[k]);
                both.map(|(other, own)| other - own).collect()
            });
            (sensor, by)
        };
        Differences {
            sensors: sensors.into_iter().map(between).collect(),
            sleds: [self.sled, sled_of(&own.vehicle, other, frame)],
        }
    }
}

/// Channels of a run, these corrected for installation errors and delays.
fn corrected<'a>(
    installation: &Installation,
    frame: &'a Frame,
    sensors: &[Sensor],
    delays: &[f64; SENSORS],
) -> Channels<'a> {
    let mut channels = Channels::new(frame);
    for sensor in sensors {
        let delay = delays[*sensor as usize];
        installation.correct(*sensor, &frame.session, delay, &mut channels);
    }
    channels
}

/// The constants of a run's sled, corrected for installation errors.
fn sled_of(vehicle: &Vehicle, installation: &Installation, frame: &Frame) -> Sled {
    let sled = vehicle.sled;
    let mut sled = Sled {
        mass_kg: frame.mass_kg.unwrap_or(sled.mass_kg),
        ..sled
    };
    installation.correct_constants(&mut sled);
    sled
}

impl Differences {
    pub fn are_none(&self) -> bool {
        self.sensors.is_empty() && self.sleds[0] == self.sleds[1]
    }

    /// Adds the change of the balances' residuals times a factor, from their derivatives by sample.
    pub fn add_change(&self, by: f64, at: &[ResidualJacobian], mut to: [&mut [f64]; BALANCES]) {
        let mut add = |i: usize, change: [f64; BALANCES]| {
            for (to, change) in to.iter_mut().zip(change) {
                if let Some(to) = to.get_mut(i) {
                    *to += by * change;
                }
            }
        };
        let [before, after] = self.sleds;
        let constants = changed_constants(before, after).into_iter().enumerate();
        for (constant, change) in constants.filter(|(_, change)| *change != 0.0) {
            for (i, at) in at.iter().enumerate() {
                add(i, at.by_constant(constant).map(|by| change * by));
            }
        }
        for (sensor, [value, rate]) in &self.sensors {
            for (i, (at, value)) in at.iter().zip(value).enumerate() {
                let rate = rate.get(i).copied().unwrap_or(0.0);
                add(i, at.of_sensor(*sensor, *value, rate));
            }
        }
    }
}
