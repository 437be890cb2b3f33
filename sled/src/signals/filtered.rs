//! Readings of a run's sensors in one stretch without a gap, filtered and corrected for faults.

use std::ops::Range;

use crate::column::{COLUMNS, Column, Sensor};
use crate::conditions::Conditions;
use crate::effects::{Active, Effects, OperatingPoint, Signals, ahead};
use crate::error::Error;
use crate::friction::film::Patch;
use crate::model::vehicle::{Vehicle, refuse_effects};
use crate::record::needs::{Needs, refuse_drag_without_air};
use crate::record::run::Run;
use crate::series::{MIN_FILTER_SAMPLES, derivative, low_pass, noise_sd_within};
use crate::signals::prepare::{Distance, Resampling};
use crate::sled::{Noise, Sled};

/// The sensors of one stretch at the rate of the states, including states next to a gap.
pub(crate) struct FilteredSignals<'a> {
    run: &'a Run,
    first: usize,
    dt_s: f64,
    value: Vec<Vec<f64>>,
    rate: Vec<Vec<f64>>,
    distance: Vec<f64>,
    conditions: Vec<Conditions>,
}

/// The error for an effect that is NaN or infinite at a sample of a run.
pub(crate) fn no_number(run: &Run, effect: Option<&Active>, t_s: f64, s_m: f64) -> Error {
    let name = effect.map_or("", |effect| effect.name.as_str());
    let reason = format!(
        "[effects.{name}] gives NaN at t = {t_s:.3} s, s = {s_m:.1} m: expected a number at every sample"
    );
    Error::file(run.entry.file.display(), reason)
}

impl<'a> FilteredSignals<'a> {
    /// Every stretch that is long enough for the filters, with the range of its states that are
    /// used.
    ///
    /// # Errors
    /// [`Error::MissingColumn`], those of [`refuse_unstated`] and [`FilteredSignals::of`].
    pub(crate) fn stretches(
        run: &'a Run,
        vehicle: &Vehicle,
        effects: &Effects,
        needs: &Needs,
        base: &Resampling,
    ) -> Result<Vec<(FilteredSignals<'a>, Range<usize>)>, Error> {
        for name in needs.columns {
            run.column(name).map_err(|error| needs.explain(error))?;
        }
        refuse_unstated(run, vehicle, effects, needs)?;
        let stated = vehicle.conditions.complete(&run.entry.conditions);
        let recorded = BY_SAMPLE.map(|(column, _)| recorded(run, column));
        let mut distance = Distance::of(run)?;
        let mut all = Vec::new();
        let pieces = &run.gaps.pieces;
        for (number, piece) in pieces.iter().enumerate() {
            let count = base.samples(piece).len();
            if count >= MIN_FILTER_SAMPLES {
                let sensed = FilteredSignals::of(
                    run,
                    piece,
                    base,
                    effects,
                    stated,
                    &recorded,
                    &mut distance,
                )?;
                all.push((sensed, base.valid_range(number, pieces.len(), count)));
            }
        }
        Ok(all)
    }

    /// Low-passes and down-samples one stretch, and corrects delays and faults of the vehicle's
    /// `effects`. A sensor without a column reads 0.
    ///
    /// # Errors
    /// [`Error::File`] for an effect that is not finite.
    fn of(
        run: &'a Run,
        piece: &Range<usize>,
        base: &Resampling,
        effects: &Effects,
        stated: Conditions,
        recorded: &[Option<&Vec<f64>>; 3],
        distance: &mut Distance,
    ) -> Result<FilteredSignals<'a>, Error> {
        let rate = base.rate_hz;
        let dt_s = 1.0 / rate;
        let samples = base.samples(piece);
        let value = Sensor::ALL.map(|sensor| match run.columns.get(sensor.name()) {
            Some(column) => low_pass(&base.resampled(column, piece), rate, base.cutoff_hz),
            None => vec![0.0; samples.len()],
        });
        let distance = distance.of_piece(base, piece, &value[Sensor::Speed as usize]);
        let at_place = |s: &f64| Conditions {
            ice_c: run.entry.ice_at(*s).unwrap_or(stated.ice_c),
            ..stated
        };
        let mut conditions: Vec<Conditions> = distance.iter().map(at_place).collect();
        for ((_, quantity), column) in BY_SAMPLE.iter().zip(recorded) {
            let values = column.map(|values| base.resampled(values, piece));
            for (conditions, value) in conditions.iter_mut().zip(values.unwrap_or_default()) {
                *quantity(conditions) = value;
            }
        }
        let mut sensed = FilteredSignals {
            run,
            first: samples.start,
            dt_s,
            value: value.to_vec(),
            rate: Vec::new(),
            distance,
            conditions,
        };
        for (channel, delay) in sensed.value.iter_mut().zip(effects.delays()) {
            if delay != 0.0 {
                *channel = ahead(channel, delay / dt_s);
            }
        }
        let effects = effects.clone().in_time();
        sensed.rate = sensed.rates();
        if !effects.is_empty() {
            let bad = |signals: &Signals| signals.value.iter().any(|value| !value.is_finite());
            for i in 0..samples.len() {
                let mut signals = sensed.signals(i);
                let at = sensed.operating_point(i);
                let before = signals;
                effects.correct(&at, &mut signals);
                if bad(&signals) {
                    let alone = |effect: &&Active| {
                        let mut signals = before;
                        effect.correct(&at, &mut signals);
                        bad(&signals)
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
    pub(crate) fn operating_point(&self, i: usize) -> OperatingPoint {
        OperatingPoint {
            t: self.run.t0_s + (self.first + i) as f64 * self.dt_s,
            s: self.distance[i],
            v: self.value[Sensor::Speed as usize][i],
            fz: f64::NAN,
            conditions: self.conditions[i],
            air_density: self.run.entry.conditions.air_density(),
            drag_area: f64::NAN,
            film: f64::NAN,
            patch: Patch::UNKNOWN,
        }
    }

    fn rates(&self) -> Vec<Vec<f64>> {
        let rate = |values: &Vec<f64>| derivative(values, self.dt_s);
        self.value.iter().map(rate).collect()
    }
}

/// A quantity of [`Conditions`].
type Quantity = fn(&mut Conditions) -> &mut f64;

/// Conditions that a run's file may state sample by sample, in place of `runs.csv` or the model's
/// `[conditions]`.
const BY_SAMPLE: [(Column, Quantity); 3] = [
    (Column::Humidity, |c| &mut c.humidity_pct),
    (Column::Wear, |c| &mut c.distance_m),
    (Column::IceTemperature, |c| &mut c.ice_c),
];

/// The column of a run's file, if it states the quantity at every used sample.
fn recorded(run: &Run, column: Column) -> Option<&Vec<f64>> {
    let values = run.columns.get(column.name())?;
    let mut used = run.gaps.within(values).flatten();
    used.all(|x| x.is_finite()).then_some(values)
}

/// Refuses effects and computations that need a quantity of ice or air which is not stated.
///
/// # Errors
/// [`Error::File`] with the run's file, the effect and the column.
fn refuse_unstated(
    run: &Run,
    vehicle: &Vehicle,
    effects: &Effects,
    needs: &Needs,
) -> Result<(), Error> {
    let of_run = &run.entry.conditions;
    let mut stated = vehicle.conditions.complete(of_run);
    stated.ice_c = run.entry.ice_at(0.0).unwrap_or(stated.ice_c);
    for (column, quantity) in BY_SAMPLE {
        if recorded(run, column).is_some() {
            *quantity(&mut stated) = 0.0;
        }
    }
    let mut absent = stated.absent();
    // A run that does not state its mass has the mass of the model.
    absent.retain(|name| *name != "mass_kg");
    // Balances of forces do not contain the track's slope; replays take it from its table.
    let is_recorded = |name: &&str| run.columns.contains_key(*name);
    absent.extend(COLUMNS.into_iter().filter(|name| !is_recorded(name)));
    let file = run.entry.file.display().to_string();
    refuse_effects(effects, &absent, &file)?;
    if needs.forces {
        vehicle.refuse_unstated_ice(!absent.contains(&"ice_c"), &file)?;
        refuse_drag_without_air(&vehicle.sled, of_run, &file)?;
    }
    Ok(())
}

/// Noise of every sensor of a run at its own rate, from third differences; 0 for those that
/// are not recorded.
pub fn estimate_noise(run: &Run) -> Noise {
    let sd = |name: &str| {
        let column = run.columns.get(name);
        column.map_or(0.0, |column| noise_sd_within(run.gaps.within(column)))
    };
    let largest = |axes: [Sensor; 3]| {
        axes.map(|axis| sd(axis.name()))
            .into_iter()
            .fold(0.0, f64::max)
    };
    Noise {
        accel_mps2: largest(Sensor::ACCELEROMETER),
        rate_radps: largest(Sensor::GYROSCOPE),
        speed_mps: sd("v_mps"),
        slip_rad: sd("alpha_rad"),
        steer_rad: sd("delta_rad"),
        roll_split_rad: sd("gamma_rad"),
    }
}

/// Standard deviations of the slip angles at the front and the rear runner [rad], before any
/// filter.
///
/// ```text
/// var(alpha_P) = var(alpha) + ((x_P - x_s) / v)^2 var(yaw_rate) (+ var(delta) at the front)
/// ```
pub fn slip_noise(sled: &Sled, noise: &Noise, v: f64) -> (f64, f64) {
    let at = |x: f64| {
        let lever = (x - sled.slip_x_m) / v;
        noise.slip_rad.powi(2) + (lever * noise.rate_radps).powi(2)
    };
    let front = at(sled.l_f_m) + noise.steer_rad.powi(2);
    (front.sqrt(), at(-sled.l_r_m).sqrt())
}
