//! Changes of sensor readings and constants by installation errors and delays.

use kufe_sled::Sled;
use kufe_sled::effects::{SENSORS, Sensor};

use crate::evidence::runs::model::channels::Channels;
use crate::evidence::runs::model::installation::{Installation, InstallationError};
use crate::evidence::runs::model::residual_jacobian::{ResidualJacobian, changed_constants};
use crate::evidence::runs::model::residual_model::{BALANCES, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;

/// Channels of the inertial unit.
const INERTIAL_UNIT: [Sensor; 6] = [
    Sensor::Ax,
    Sensor::Ay,
    Sensor::Az,
    Sensor::RollRate,
    Sensor::PitchRate,
    Sensor::YawRate,
];

/// Readings of a run corrected by a model.
pub struct Readings<'a> {
    model: &'a ResidualModel,
    frame: &'a Frame,
    delays: [f64; SENSORS],
    /// Each channel corrected for its own errors.
    channels: Channels<'a>,
    /// The channels of the inertial unit after correction of cross-sensitivity, too.
    unmixed: Channels<'a>,
    sled: Sled,
}

/// Changes of values, derivatives and constants between two models' corrections of a run.
pub struct ReadingChanges {
    sensors: Vec<(Sensor, [Vec<f64>; 2])>,
    /// The constants of the sled in both models.
    sleds: [Sled; 2],
}

impl<'a> Readings<'a> {
    /// Readings of a run corrected by a model.
    pub fn new(model: &'a ResidualModel, frame: &'a Frame) -> Self {
        let delays = model.effects.on_track(&frame.track).delays();
        let installation = &model.installation;
        let channels = installation.corrected_channels(frame, &Sensor::ALL, &delays);
        let mut unmixed = installation.corrected_channels(frame, &INERTIAL_UNIT, &delays);
        installation.correct_coupling(&mut unmixed);
        Self {
            model,
            frame,
            delays,
            channels,
            unmixed,
            sled: installation.corrected_constants(frame.sled(model.vehicle.sled)),
        }
    }

    /// Changes of the readings if one installation error changes by `deviations` standard
    /// deviations.
    pub fn with_error_changed(&self, error: usize, deviations: f64) -> ReadingChanges {
        let installation = self
            .model
            .installation
            .with_error_changed(error, deviations);
        self.differences(&installation, &self.delays)
    }

    /// Changes of the readings with other delays by effects [s].
    pub fn with_delays(&self, delays: &[f64; SENSORS]) -> ReadingChanges {
        self.differences(&self.model.installation, delays)
    }

    /// Changes of sensors or of constants.
    fn differences(&self, other: &Installation, delays: &[f64; SENSORS]) -> ReadingChanges {
        let Self { model, frame, .. } = self;
        let [sizes, others] = [&model.installation, other].map(|installation| &installation.sizes);
        let errors = model.installation.errors.iter();
        let changed: Vec<&InstallationError> = errors
            .zip(sizes.iter().zip(others))
            .filter(|(error, (a, b))| a != b && error.acts_in(&frame.session))
            .map(|(error, _)| error)
            .collect();
        // Cross-sensitivity changes all channels of the inertial unit.
        let couples = changed.iter().any(|error| error.couples());
        let is_changed = |sensor: &Sensor| {
            let k = *sensor as usize;
            let mut changed = changed.iter();
            self.delays[k] != delays[k] || changed.any(|error| error.sensor() == Some(*sensor))
        };
        let sensors = if couples {
            INERTIAL_UNIT.to_vec()
        } else {
            Sensor::ALL.into_iter().filter(is_changed).collect()
        };
        let mut channels = other.corrected_channels(frame, &sensors, delays);
        if couples {
            other.correct_coupling(&mut channels);
        }
        let before = if couples {
            &self.unmixed
        } else {
            &self.channels
        };
        let between = |sensor: Sensor| {
            let (before, after) = (before.series(sensor), channels.series(sensor));
            let differences = [0, 1].map(|k| {
                let both = after[k].iter().zip(before[k]);
                both.map(|(after, before)| after - before).collect()
            });
            (sensor, differences)
        };
        ReadingChanges {
            sensors: sensors.into_iter().map(between).collect(),
            sleds: [
                self.sled,
                other.corrected_constants(frame.sled(model.vehicle.sled)),
            ],
        }
    }
}

impl ReadingChanges {
    pub fn is_empty(&self) -> bool {
        self.sensors.is_empty() && self.sleds[0] == self.sleds[1]
    }

    /// Adds to `sums` the change of the balances' residuals times `factor`, to first order, from
    /// the Jacobian of each sample.
    pub fn add_change(
        &self,
        factor: f64,
        jacobians: &[ResidualJacobian],
        mut sums: [&mut [f64]; BALANCES],
    ) {
        let mut add = |i: usize, change: [f64; BALANCES]| {
            for (sums, change) in sums.iter_mut().zip(change) {
                if let Some(sum) = sums.get_mut(i) {
                    *sum += factor * change;
                }
            }
        };
        let [before, after] = self.sleds;
        let constants = changed_constants(before, after).into_iter().enumerate();
        for (constant, change) in constants.filter(|(_, change)| *change != 0.0) {
            for (i, jacobian) in jacobians.iter().enumerate() {
                add(i, jacobian.by_constant(constant).map(|by| change * by));
            }
        }
        for (sensor, [value, rate]) in &self.sensors {
            for (i, (jacobian, value)) in jacobians.iter().zip(value).enumerate() {
                let rate = rate.get(i).copied().unwrap_or(0.0);
                add(i, jacobian.of_sensor(*sensor, *value, rate));
            }
        }
    }
}
