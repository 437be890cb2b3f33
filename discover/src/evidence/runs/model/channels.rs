//! Sensor channels of a run, corrected for sensor errors.

use std::borrow::Cow;

use kufe_sled::Sled;
use kufe_sled::effects::{Fault, Reading, SENSORS, Sensor, Signals, ahead};

use crate::evidence::runs::recordings::frame::Frame;

/// Channels of a run; only corrected ones are copied.
pub struct Channels<'a> {
    /// Time between samples [s].
    sample_s: f64,
    /// Scale of each reading.
    scales: [f64; SENSORS],
    /// Values and derivatives, in the order of the sensors.
    values: [Channel<'a>; SENSORS],
}

type Channel<'a> = (Cow<'a, [f64]>, Option<Cow<'a, [f64]>>);

impl<'a> Channels<'a> {
    /// Uncorrected channels.
    pub fn new(frame: &'a Frame) -> Self {
        Self {
            sample_s: frame.sample_s(),
            scales: [1.0; SENSORS],
            values: Sensor::ALL.map(|sensor| {
                let (value, slope) = frame.series(sensor);
                let slope = slope.map(|x| Cow::Borrowed(x.as_slice()));
                (Cow::Borrowed(value.as_slice()), slope)
            }),
        }
    }

    /// The values of a sensor.
    pub fn value(&self, sensor: Sensor) -> &[f64] {
        &self.values[sensor as usize].0
    }

    /// A sensor's values, and their derivatives if it has any.
    pub fn series(&self, sensor: Sensor) -> [&[f64]; 2] {
        let (value, slope) = &self.values[sensor as usize];
        [value, slope.as_deref().unwrap_or_default()]
    }

    /// A sensor's values, and their derivatives if it has any, to be changed.
    fn value_and_slope(&mut self, sensor: Sensor) -> impl Iterator<Item = &mut Cow<'a, [f64]>> {
        let (value, slope) = &mut self.values[sensor as usize];
        std::iter::once(value).chain(slope)
    }

    /// Corrects a delay [s].
    pub fn correct_delay(&mut self, sensor: Sensor, delay_s: f64) {
        let samples = delay_s / self.sample_s;
        for x in self.value_and_slope(sensor) {
            *x = Cow::Owned(ahead(x, samples));
        }
    }

    /// Corrects a bias, in the channel's unit.
    pub fn correct_bias(&mut self, sensor: Sensor, bias: f64) {
        let (value, _) = &mut self.values[sensor as usize];
        value.to_mut().iter_mut().for_each(|x| *x -= bias);
    }

    /// Corrects a scale.
    pub fn correct_scale(&mut self, sensor: Sensor, scale: f64) {
        self.scales[sensor as usize] *= scale;
        for x in self.value_and_slope(sensor) {
            x.to_mut().iter_mut().for_each(|x| *x /= scale);
        }
    }

    /// Corrects cross-sensitivity to another channel.
    pub fn correct_cross_sensitivity(&mut self, fault: &Fault, size: f64) {
        let Reading::PicksUp { other, factor } = fault.reading else {
            return;
        };
        let (value, slope) = self.values[other as usize].clone();
        let gain = factor * size;
        let (to_value, to_slope) = &mut self.values[fault.of as usize];
        let subtract = |to: &mut [f64], other: &[f64]| {
            to.iter_mut().zip(other).for_each(|(to, x)| *to -= gain * x);
        };
        subtract(to_value.to_mut(), &value);
        // An accelerometer has no derivative here; its part in a gyroscope's reading is slow.
        if let (Some(to), Some(slope)) = (to_slope, slope) {
            subtract(to.to_mut(), &slope);
        }
    }

    /// Scale of a sensor's reading.
    pub fn scale(&self, sensor: Sensor) -> f64 {
        self.scales[sensor as usize]
    }

    /// The signals of a sample.
    pub fn signals(&self, i: usize, sled: Sled) -> Signals {
        let mut signals = Signals {
            sled,
            ..Signals::default()
        };
        for (sensor, (value, slope)) in Sensor::ALL.into_iter().zip(&self.values) {
            match slope {
                Some(slope) => signals.set(sensor, value[i], slope[i]),
                None => signals[sensor] = value[i],
            }
        }
        signals
    }
}
