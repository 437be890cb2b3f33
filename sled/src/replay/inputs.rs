//! Input of a replay: start and steering of a run, and its speed, slip, yaw rate and roll split for
//! comparison.

use std::ops::Range;

use crate::column::Sensor;
use crate::error::Error;
use crate::model::vehicle::Vehicle;
use crate::record::check::MIN_RUN_SAMPLES;
use crate::record::check::faults::check_relations;
use crate::record::files::{read_run, read_run_of};
use crate::record::gaps::{OnGaps, SampleCoverage};
use crate::record::index::Entry;
use crate::record::needs::Needs;
use crate::record::run::Run;
use crate::series::{noise_gain, noise_sd_within};
use crate::signals::filtered::FilteredSignals;
use crate::signals::prepare::{PrepareOptions, Resampling, refuse_short};
use crate::track::spline::Spline;

/// Columns that a replay requires; conditions are checked by the simulation.
const NEEDS: Needs = Needs {
    by: "a replay",
    columns: &["v_mps", "delta_rad"],
    forces: false,
};
/// Optional columns: those that are compared, and the distance.
const COMPARED: [&str; 4] = ["alpha_rad", "yaw_rate_radps", "gamma_rad", "s_m"];
/// Spacing of the knots of the steering across a gap [m].
const BRIDGE_M: f64 = 1.0;

/// One moment of a measured run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Time [s].
    pub t_s: f64,
    /// Distance along the track [m].
    pub s_m: f64,
    /// Speed, slip angle, yaw rate and roll split at the sensors [m/s, rad, rad/s, rad]; 0 where
    /// not recorded.
    pub values: [f64; 4],
    /// Steering angle [rad].
    pub delta_rad: f64,
}

/// Sensors of [`Reading::values`].
pub const READ: [Sensor; 4] = [
    Sensor::Speed,
    Sensor::Slip,
    Sensor::YawRate,
    Sensor::RollSplit,
];

/// A measured run, prepared for a replay.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// Its row in the index.
    pub entry: Entry,
    /// Readings at uniform times, except for gaps.
    pub readings: Vec<Reading>,
    /// Stretches of `readings` without a gap.
    pub pieces: Vec<Range<usize>>,
    /// Which of [`READ`] were recorded.
    pub recorded: [bool; 4],
    /// Standard deviations of the noise of [`Reading::values`].
    pub noise_sd: [f64; 4],
    /// The part of the run that is used.
    pub taking_part: SampleCoverage,
}

/// Reads a run for a replay. Only `v_mps` and `delta_rad` are required, and only gaps of columns
/// that a replay uses count.
///
/// # Errors
/// Errors of the reader, and [`Error::Wrong`] if the channels prove that one contradicts its name.
pub fn read_for_replay(entry: &Entry, on_gaps: OnGaps) -> Result<Run, Error> {
    let mut run = read_run_of(entry.clone(), NEEDS.columns, &COMPARED, on_gaps)
        .map_err(|error| NEEDS.explain(error))?;
    // Relations are checked with all channels, including those that a replay does not use.
    if let Ok(whole) = read_run(entry.clone(), &["v_mps"], OnGaps::LeaveOut) {
        let known = whole.remarks.len();
        let mut whole = [whole];
        check_relations(&mut whole)?;
        run.remarks.extend(whole[0].remarks.drain(known..));
    }
    Ok(run)
}

impl Inputs {
    /// Filters a run and corrects the vehicle's faults of sensors.
    ///
    /// A run without `s_m` begins at `start_m` [m].
    ///
    /// # Errors
    /// [`Error::MissingColumn`], [`Error::TooFew`], [`Error::File`] for an effect that needs a
    /// quantity that is not stated.
    pub fn of(run: &Run, vehicle: &Vehicle, start_m: f64) -> Result<Inputs, Error> {
        let effects = vehicle.effects.on_track(&run.entry.track);
        let base = Resampling::of(run, &PrepareOptions::default());
        let recorded = run.columns.contains_key("s_m");
        let from = if recorded { 0.0 } else { start_m };
        let (mut readings, mut pieces) = (Vec::new(), Vec::new());
        for (sensed, valid) in FilteredSignals::stretches(run, vehicle, &effects, &NEEDS, &base)? {
            let start = readings.len();
            for i in valid {
                let (signals, at) = (sensed.signals(i), sensed.operating_point(i));
                readings.push(Reading {
                    t_s: at.t,
                    s_m: from + at.s,
                    values: READ.map(|sensor| signals[sensor]),
                    delta_rad: signals[Sensor::Steering],
                });
            }
            if start < readings.len() {
                pieces.push(start..readings.len());
            }
        }
        refuse_short(run, readings.len())?;
        let gain = noise_gain(base.from_hz, base.narrowest_hz);
        Ok(Inputs {
            entry: run.entry.clone(),
            recorded: READ.map(|sensor| run.columns.contains_key(sensor.name())),
            noise_sd: READ.map(|sensor| {
                let column = run.columns.get(sensor.name());
                column.map_or(0.0, |c| gain * noise_sd_within(run.gaps.within(c)))
            }),
            taking_part: run.coverage(pieces.len(), readings.len() as f64 / base.rate_hz),
            readings,
            pieces,
        })
    }

    /// The steering as a function of the distance, linear across each gap, and the total length of
    /// the gaps [m].
    ///
    /// # Errors
    /// [`Error::TooFew`] where the distance does not grow.
    pub(crate) fn steering(&self) -> Result<(Spline, f64), Error> {
        let (mut s, mut angle): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut bridged = 0.0;
        // Knots nearer than a quarter of the mean spacing would carry the noise of the distance.
        let last = self.readings.len() - 1;
        let spacing = (self.readings[last].s_m - self.readings[0].s_m) / last as f64;
        for piece in &self.pieces {
            for (number, reading) in self.readings[piece.clone()].iter().enumerate() {
                let Some((&last, &before)) = s.last().zip(angle.last()) else {
                    s.push(reading.s_m);
                    angle.push(reading.delta_rad);
                    continue;
                };
                let way = reading.s_m - last;
                if number == 0 && way > BRIDGE_M {
                    bridged += way;
                    let knots = (way / BRIDGE_M) as usize;
                    for share in (1..knots).map(|k| k as f64 / knots as f64) {
                        s.push(last + share * way);
                        angle.push(before + share * (reading.delta_rad - before));
                    }
                }
                if way > 0.25 * spacing.max(1e-6) {
                    s.push(reading.s_m);
                    angle.push(reading.delta_rad);
                }
            }
        }
        if s.len() < MIN_RUN_SAMPLES {
            let file = self.entry.file.display();
            let what = format!("{file}: samples along which the distance grows");
            return Err(Error::too_few(what, s.len(), MIN_RUN_SAMPLES));
        }
        Ok((Spline::natural(&s, &angle), bridged))
    }
}
