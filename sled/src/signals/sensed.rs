//! What the sensors of a run say in one stretch without a gap, filtered and their faults taken out.

use std::ops::Range;

use crate::effects::{Active, Conditions, Effects, Sensor, Signals, ahead};

use crate::error::Error;
use crate::record::run::Run;
use crate::signals::derivative::derivative;
use crate::signals::distance::Distance;
use crate::signals::filter::low_pass;
use crate::signals::further::Further;
use crate::signals::resampling::Resampling;

/// The sensors of one stretch at the rate of the states, those beside a gap included.
pub(crate) struct Sensed<'a> {
    run: &'a Run,
    first: usize,
    dt_s: f64,
    value: Vec<Vec<f64>>,
    rate: Vec<Vec<f64>>,
    distance: Vec<f64>,
    further: Further,
}

/// The error of an effect that gives no number at a sample of a run.
pub(crate) fn no_number(run: &Run, effect: Option<&Active>, t_s: f64, s_m: f64) -> Error {
    let name = effect.map_or("", |effect| effect.name.as_str());
    Error::Keys {
        file: run.entry.file.display().to_string(),
        reason: format!(
            "[effects.{name}] gives NaN at t = {t_s:.3} s, s = {s_m:.1} m: expected a number at every sample"
        ),
    }
}

impl<'a> Sensed<'a> {
    /// Low pass, down-sampling, delays and faults of the vehicle's `effects` taken out; a sensor without a column says 0.
    ///
    /// # Errors
    /// [`Error::Keys`] for an effect that gives no number.
    pub(crate) fn of(
        run: &'a Run,
        piece: &Range<usize>,
        base: &Resampling,
        effects: &Effects,
        further: &Further,
        distance: &mut Distance,
    ) -> Result<Sensed<'a>, Error> {
        let rate = base.rate_hz;
        let dt_s = 1.0 / rate;
        let samples = base.samples(piece);
        let value = Sensor::ALL.map(|sensor| match run.columns.get(sensor.name()) {
            Some(column) => low_pass(&base.resampled(column, piece), rate, base.cutoff_hz),
            None => vec![0.0; samples.len()],
        });
        let distance = distance.of_piece(base, piece, &value[Sensor::Speed as usize]);
        let mut sensed = Sensed {
            run,
            first: samples.start,
            dt_s,
            value: value.to_vec(),
            rate: Vec::new(),
            distance,
            further: further.piece(|column| base.resampled(column, piece)),
        };
        for (channel, delay) in sensed.value.iter_mut().zip(effects.delays()) {
            if delay != 0.0 {
                *channel = ahead(channel, delay / dt_s);
            }
        }
        let effects = effects.clone().in_time();
        sensed.rate = sensed.rates();
        if !effects.is_empty() {
            for i in 0..samples.len() {
                let mut signals = sensed.signals(i);
                let at = sensed.conditions(i);
                let before = signals;
                effects.correct(&at, &mut signals);
                if signals.value.iter().any(|value| !value.is_finite()) {
                    let alone = |effect: &&Active| {
                        let mut signals = before;
                        effect.correct(&at, &mut signals);
                        signals.value.iter().any(|value| !value.is_finite())
                    };
                    let effect = effects.active.iter().find(alone);
                    return Err(no_number(run, effect, at.t, at.s));
                }
                for (channel, value) in sensed.value.iter_mut().zip(signals.value) {
                    channel[i] = value;
                }
            }
            sensed.rate = sensed.rates();
        }
        Ok(sensed)
    }

    /// Number of states.
    pub(crate) fn len(&self) -> usize {
        self.distance.len()
    }

    /// All sensors at state `i` with their rates.
    pub(crate) fn signals(&self, i: usize) -> Signals {
        let mut signals = Signals::default();
        for sensor in Sensor::ALL {
            let k = sensor as usize;
            signals.set(sensor, self.value[k][i], self.rate[k][i]);
        }
        signals
    }

    /// Time, place, speed and weather at state `i`.
    pub(crate) fn conditions(&self, i: usize) -> Conditions {
        let t = self.run.t0_s + (self.first + i) as f64 * self.dt_s;
        let v = self.value[Sensor::Speed as usize][i];
        self.further.conditions(self.run, i, t, self.distance[i], v)
    }

    fn rates(&self) -> Vec<Vec<f64>> {
        let rate = |values: &Vec<f64>| derivative(values, self.dt_s);
        self.value.iter().map(rate).collect()
    }
}
