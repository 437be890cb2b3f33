//! From a recorded run to states: filter, down-sample, transfer, differentiate.

use std::ops::Range;

use crate::effects::{Active, Effects, Relaxed};
use rayon::prelude::*;

use crate::error::Error;
use crate::model::sled::Noise;
use crate::model::vehicle::Vehicle;
use crate::motion::measured::from_sensors;
use crate::motion::one_track::{forward, inverse};
use crate::motion::state::{AxleForces, Motion, State};
use crate::record::check::LEAST_SAMPLES;
use crate::record::check::taking_part::TakingPart;
use crate::record::index::Entry;
use crate::record::run::Run;
use crate::signals::distance::Distance;
use crate::signals::filter::{self, noise_gain};
use crate::signals::further::Further;
use crate::signals::noise::{estimate_noise, slip_noise};
use crate::signals::resampling::{PrepareOptions, Resampling};
use crate::signals::sensed::{Sensed, no_number};

/// A run as a series of states with the motion measured at each.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Its row in the index.
    pub entry: Entry,
    /// Time between states [s].
    pub dt_s: f64,
    /// States, normal forces included.
    pub states: Vec<State>,
    /// Measured motion at the centre of gravity, beside `states`.
    pub motions: Vec<Motion>,
    /// Stretches of `states` without a gap: within one they are `dt_s` apart, together they are all states.
    pub pieces: Vec<Range<usize>>,
    /// What of the run takes part.
    pub taking_part: TakingPart,
    /// Standard deviations of the filtered slip angles, front and rear [rad].
    pub slip_sd_rad: [f64; 2],
}

impl Prepared {
    /// The time that takes part, a step a state [s].
    pub fn used_s(&self) -> f64 {
        self.states.len() as f64 * self.dt_s
    }

    /// The time from the first state to the last, gaps included [s].
    pub fn span_s(&self) -> f64 {
        match self.states.as_slice() {
            [first, .., last] if self.pieces.len() > 1 => last.t_s - first.t_s + self.dt_s,
            _ => self.used_s(),
        }
    }

    /// Forces on the runners as the motion demands them, one a state.
    pub fn measured_forces(&self, vehicle: &Vehicle) -> Vec<AxleForces> {
        self.states
            .iter()
            .zip(&self.motions)
            .map(|(state, motion)| inverse(vehicle, state, motion))
            .collect()
    }
}

/// Prepares one run.
///
/// In this order: low pass and down-sampling to `rate_hz`, low pass at `cutoff_hz`, angular accelerations by
/// [`derivative`], accelerations to the centre of gravity, slips at the axles, normal forces. `s_m` is taken from the
/// recording where it has one, else integrated from the speed, across a gap of the speed as if it changed evenly there.
/// Effects of the vehicle that stand between the truth and its sensors are taken out. Of the columns that `options.needs` does not
/// name, `ax_mps2` is NaN where it is not recorded, others are 0. `noise` states the sensors' noise;
/// where absent it is estimated from the recording.
///
/// Every stretch without a gap is filtered by itself. Beside a gap two periods of the corner and the derivative's three
/// samples take no part: the slowest pole of the filter, `sin(pi/8) 2 pi f`, has decayed to 1 % there.
///
/// # Errors
/// [`Error::MissingColumn`], [`Error::TooShort`] where too little is left at the lower rate, [`Error::Keys`] for an effect
/// that needs what neither the run's file nor `runs.csv` nor the model states.
pub fn prepare(
    run: &Run,
    vehicle: &Vehicle,
    noise: Option<&Noise>,
    options: &PrepareOptions,
) -> Result<Prepared, Error> {
    for name in options.needs.columns {
        run.column(name)
            .map_err(|error| options.needs.told(error))?;
    }
    let vehicle = &vehicle.on_run(&run.entry.track, &run.entry.conditions);
    let (sled, effects) = (&vehicle.sled, &vehicle.effects);
    let base = Resampling::of(run, options);
    let further = Further::of(run, vehicle, effects, &options.needs)?;
    let (mut states, mut motions, mut pieces) = (Vec::new(), Vec::new(), Vec::new());
    let mut speeds: (f64, usize) = (0.0, 0);
    let mut distance = Distance::of(run)?;
    let along = run.columns.contains_key("ax_mps2");
    for (number, piece) in run.gaps.pieces.iter().enumerate() {
        let count = base.samples(piece).len();
        if count < filter::LEAST_SAMPLES {
            continue;
        }
        let sensed = Sensed::of(run, piece, &base, effects, &further, &mut distance)?;
        speeds.0 += (0..count).map(|i| sensed.conditions(i).v).sum::<f64>();
        speeds.1 += count;
        let start = states.len();
        let relaxation = effects.relaxation();
        let mut relaxed = Relaxed::default();
        for i in base.kept(number, run.gaps.pieces.len(), count) {
            let (mut state, mut motion) =
                from_sensors(sled, &sensed.signals(i), &sensed.conditions(i));
            if !along {
                // What is not measured is no number, so that nothing rests on it.
                (motion.accel_mps2[0], state.accel_mps2[0]) = (f64::NAN, f64::NAN);
            }
            if let Some(distance) = relaxation {
                state.slip_rate_radps =
                    state.followed_rates(&mut relaxed, 1.0 / base.rate_hz, distance);
            }
            states.push(state);
            motions.push(motion);
        }
        if start < states.len() {
            pieces.push(start..states.len());
        }
    }
    if options.needs.forces {
        refuse_no_number(run, vehicle, &states)?;
    }
    if states.len() < LEAST_SAMPLES {
        return Err(Error::TooShort {
            file: run.entry.file.display().to_string(),
            samples: states.len(),
            needed: LEAST_SAMPLES,
        });
    }
    let noise = match noise {
        Some(noise) => *noise,
        None => estimate_noise(run),
    };
    let mean_speed = speeds.0 / speeds.1 as f64;
    let (front, rear) = slip_noise(sled, &noise, mean_speed);
    // Both filters act on the noise at the recording's own rate; the narrower one decides.
    let gain = noise_gain(base.from_hz, base.narrowest_hz);
    let mut prepared = Prepared {
        entry: run.entry.clone(),
        dt_s: 1.0 / base.rate_hz,
        taking_part: TakingPart {
            run: run.entry.run.clone(),
            gaps: run.gaps.clone(),
            stretches: pieces.len(),
            used_s: 0.0,
            of_s: 0.0,
        },
        states,
        motions,
        pieces,
        slip_sd_rad: [gain * front, gain * rear],
    };
    let (used_s, of_s) = (prepared.used_s(), run.len() as f64 * run.dt_s);
    (prepared.taking_part.used_s, prepared.taking_part.of_s) = (used_s, of_s);
    Ok(prepared)
}

/// Refuses effects whose forces are no numbers at a state: they would disable what compares with them, without a word.
fn refuse_no_number(run: &Run, vehicle: &Vehicle, states: &[State]) -> Result<(), Error> {
    if vehicle.effects.is_empty() {
        return Ok(());
    }
    let bad = |vehicle: &Vehicle, state: &State| {
        let forces = forward(vehicle, state);
        let all = forces.front.iter().chain(&forces.rear).chain(&forces.body);
        all.copied().any(|force| !force.is_finite())
    };
    let Some(state) = states.iter().find(|state| bad(vehicle, state)) else {
        return Ok(());
    };
    let alone = |effect: &&Active| {
        let one = Vehicle {
            effects: Effects {
                active: vec![(*effect).clone()],
            },
            ..vehicle.clone()
        };
        bad(&one, state)
    };
    match vehicle.effects.active.iter().find(alone) {
        None => Ok(()),
        effect => Err(no_number(run, effect, state.t_s, state.s_m)),
    }
}

/// Prepares every run, in parallel and in order.
///
/// # Errors
/// The first run's error in order.
pub fn prepare_all(
    runs: &[Run],
    vehicle: &Vehicle,
    noise: Option<&Noise>,
    options: &PrepareOptions,
) -> Result<Vec<Prepared>, Error> {
    runs.par_iter()
        .map(|run| prepare(run, vehicle, noise, options))
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}
