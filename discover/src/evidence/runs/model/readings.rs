//! Changes of sensor readings and constants between models of installation errors and delays.

use kufe_sled::Sled;
use kufe_sled::effects::{SENSORS, Sensor};

use crate::evidence::runs::model::channels::Channels;
use crate::evidence::runs::model::installation::Part;
use crate::evidence::runs::model::residual_jacobian::ResidualJacobian;
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
        let channels = corrected(own, frame, &Sensor::ALL, &delays);
        let mut unmixed = corrected(own, frame, &UNIT, &delays);
        own.installation.correct_coupling(&mut unmixed);
        Self {
            own,
            frame,
            delays,
            channels,
            unmixed,
            sled: sled_of(own, frame),
        }
    }

    /// Differences from the readings by another model, which differs in delays by effects or in one
    /// installation error: of sensors or of constants.
    pub fn differences(&self, other: &ResidualModel) -> Differences {
        let Self { own, frame, .. } = self;
        let delays = other.effects.on_track(&frame.track).delays();
        let [sizes, others] = [own, &other].map(|model| &model.installation.sizes);
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
        let mut channels = corrected(other, frame, &sensors, &delays);
        if couples {
            other.installation.correct_coupling(&mut channels);
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
            sleds: [self.sled, sled_of(other, frame)],
        }
    }
}

/// Channels of a run, these corrected by a model's installation and delays.
fn corrected<'a>(
    model: &ResidualModel,
    frame: &'a Frame,
    sensors: &[Sensor],
    delays: &[f64; SENSORS],
) -> Channels<'a> {
    let mut channels = Channels::new(frame);
    for sensor in sensors {
        let delay = delays[*sensor as usize];
        model
            .installation
            .correct(*sensor, &frame.session, delay, &mut channels);
    }
    channels
}

/// The constants of a run's sled by a model.
fn sled_of(model: &ResidualModel, frame: &Frame) -> Sled {
    let sled = model.vehicle.sled;
    let mut sled = Sled {
        mass_kg: frame.mass_kg.unwrap_or(sled.mass_kg),
        ..sled
    };
    model.installation.correct_constants(&mut sled);
    sled
}

impl Differences {
    pub fn are_none(&self) -> bool {
        self.sensors.is_empty() && self.sleds[0] == self.sleds[1]
    }

    /// Change of the residuals of a sample, from their derivatives.
    pub fn residual_change(&self, i: usize, by: &ResidualJacobian) -> [f64; BALANCES] {
        let mut residual = match self.sensors.is_empty() {
            true => by.of_constants(&self.sleds[0], &self.sleds[1]),
            false => [0.0; BALANCES],
        };
        for (sensor, [value, rate]) in &self.sensors {
            let rate = rate.get(i).copied().unwrap_or(0.0);
            let more = by.of_sensor(*sensor, value[i], rate);
            residual.iter_mut().zip(more).for_each(|(sum, x)| *sum += x);
        }
        residual
    }
}
