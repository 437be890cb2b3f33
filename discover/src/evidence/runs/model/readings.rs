//! What the sensors of a run would say, and what its sled would be, were something else off a little.

use kufe_sled::Sled;
use kufe_sled::effects::{Sensor, Signals};

use crate::evidence::runs::model::channels::Channels;
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

/// By how much values, their derivatives and constants differ between two models' corrections of a run.
pub struct Differences {
    sensors: Vec<(Sensor, [Vec<f64>; 2])>,
    /// The constants of the sled by both models.
    sleds: [Sled; 2],
}

impl Differences {
    /// From a model's corrections of a run to those of another, which delays by effects or one part of the installation tell apart: sensors
    /// differ, or constants.
    pub fn new(own: &ResidualModel, other: &ResidualModel, frame: &Frame) -> Self {
        let models = [own, other];
        let delays = models.map(|model| model.effects.on_track(&frame.track).delays());
        let moved = |sensor: &Sensor| {
            let k = *sensor as usize;
            let [own, other] = models.map(|model| &model.installation);
            let mut parts = own.parts.iter().zip(own.sizes.iter().zip(&other.sizes));
            delays[0][k] != delays[1][k]
                || parts.any(|(part, (a, b))| {
                    a != b && part.sensor() == Some(*sensor) && part.acts_in(&frame.session)
                })
        };
        // What makes channels pick up others moves all of the inertial unit.
        let of_unit: Vec<usize> = (0..own.installation.parts.len())
            .filter(|k| own.installation.parts[*k].mixes())
            .collect();
        let sizes = models.map(|model| &model.installation.sizes);
        if of_unit.iter().any(|k| sizes[0][*k] != sizes[1][*k]) {
            return Self::of_unit(models, frame);
        }
        let between = |sensor: Sensor| {
            let k = sensor as usize;
            let [own, other] = [0, 1].map(|m| {
                let mut channels = Channels::new(frame);
                let installation = &models[m].installation;
                installation.correct(sensor, &frame.session, delays[m][k], &mut channels);
                channels
            });
            let (own, other) = (own.series(sensor), other.series(sensor));
            let by = [0, 1].map(|k| {
                let both = other[k].iter().zip(own[k]);
                both.map(|(other, own)| other - own).collect()
            });
            (sensor, by)
        };
        let sled = own.vehicle.sled;
        let sleds = models.map(|model| {
            let mut sled = Sled {
                mass_kg: frame.mass_kg.unwrap_or(sled.mass_kg),
                ..sled
            };
            model.installation.find_constants(&mut sled);
            sled
        });
        Self {
            sensors: Sensor::ALL.into_iter().filter(moved).map(between).collect(),
            sleds,
        }
    }

    /// The same where the inertial units of the two models pick up their channels by different sizes.
    fn of_unit(models: [&ResidualModel; 2], frame: &Frame) -> Self {
        let [own, other] = models.map(|model| {
            let mut channels = Channels::new(frame);
            let delays = model.effects.on_track(&frame.track).delays();
            for sensor in UNIT {
                let delay = delays[sensor as usize];
                let installation = &model.installation;
                installation.correct(sensor, &frame.session, delay, &mut channels);
            }
            model.installation.unmix(&mut channels);
            channels
        });
        let between = |sensor: Sensor| {
            let (own, other) = (own.series(sensor), other.series(sensor));
            let by = [0, 1].map(|k| {
                let both = other[k].iter().zip(own[k]);
                both.map(|(other, own)| other - own).collect()
            });
            (sensor, by)
        };
        Self {
            sensors: UNIT.into_iter().map(between).collect(),
            sleds: [models[0].vehicle.sled; 2],
        }
    }

    /// What the balances of a sample leave more, from their derivatives.
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

    /// Adds it to the signals of a sample.
    pub fn add(&self, i: usize, signals: &mut Signals) {
        for (sensor, [value, rate]) in &self.sensors {
            signals[*sensor] += value[i];
            if let Some(rate) = rate.get(i) {
                signals.rate[*sensor as usize] += rate;
            }
        }
        let (sled, [from, to]) = (&mut signals.sled, &self.sleds);
        sled.mass_kg += to.mass_kg - from.mass_kg;
        sled.j_yy_kgm2 += to.j_yy_kgm2 - from.j_yy_kgm2;
        sled.j_zz_kgm2 += to.j_zz_kgm2 - from.j_zz_kgm2;
        sled.l_f_m += to.l_f_m - from.l_f_m;
        sled.l_r_m += to.l_r_m - from.l_r_m;
        sled.accel_x_m += to.accel_x_m - from.accel_x_m;
        sled.accel_y_m += to.accel_y_m - from.accel_y_m;
        sled.accel_z_m += to.accel_z_m - from.accel_z_m;
        sled.slip_x_m += to.slip_x_m - from.slip_x_m;
    }
}
