//! Simulation of a measured run from its start and steering.

use std::ops::Range;

use serde::Serialize;

use crate::error::Error;
use crate::model::vehicle::Vehicle;
use crate::record::gaps::SampleCoverage;
use crate::record::run::Run;
use crate::replay::compared::{Compared, Difference, Section, compare, differences, sections};
use crate::replay::inputs::{Inputs, Reading};
use crate::simulate::drive::{SimulateOptions, Simulated, integrate, refuse_unstated};
use crate::simulate::driver::Steering;
use crate::simulate::dynamics::{CHI, COUNT, S, TIME, Unknowns, VX, World};
use crate::track::table::TrackShape;

/// A measured run and its simulation from the run's start and steering.
#[derive(Clone, Debug, Serialize, schemars::JsonSchema)]
pub struct Replay {
    /// Name of the run.
    pub run: String,
    /// Track.
    pub track: String,
    /// Start of the comparison [m].
    pub from_m: f64,
    /// End of the comparison [m].
    pub to_m: f64,
    /// The reason if the model did not reach the end of the run.
    pub stopped: Option<String>,
    /// Total length of gaps across which the steering is interpolated linearly [m].
    pub bridged_m: f64,
    /// The part of the run that is used.
    pub taking_part: SampleCoverage,
    /// Mean force along the sled missing in the model [N]: ratio of the increase in the difference
    /// of kinetic energies to the distance.
    pub mean_force_n: f64,
    /// Differences between run and model, by column.
    pub differences: Vec<Difference>,
    /// Sections with exceptional differences.
    pub sections: Vec<Section>,
    /// Run and model, place by place; not part of the report.
    #[serde(skip)]
    pub compared: Vec<Compared>,
    /// Stretches of `compared` without a gap.
    #[serde(skip)]
    pub pieces: Vec<Range<usize>>,
    /// The simulated run.
    #[serde(skip)]
    pub simulated: Simulated,
}

/// Duration of the readings that determine the speed at the start [s]. The usual sensor noise of
/// 0.03 m/s changes it by 0.002 m/s, a missing force of 10 N by 0.006 m/s. With half the duration
/// these are 0.003 and 0.003 m/s, with twice the duration 0.0013 and 0.013 m/s.
const START_S: f64 = 0.5;

/// Largest distance of a run's start before the first place of its track [m]: tracks of
/// `runs align` have their first place in the middle of a cell of 2 m, and runs begin at 0 within
/// rounding.
const BEFORE_M: f64 = 1.5;

/// Simulates a run with its start and its steering, and compares both.
///
/// The model starts at the first reading's place, time, slip angle and yaw rate, moving along the
/// line. Its initial speed is such that the model has the run's mean kinetic energy over the first
/// half second: the noise of a single speed reading would persist to the finish, whereas slip angle
/// and yaw rate soon follow the steering. The steering angle is the one measured at the same
/// *place*, so that a late model steers at the right place in a curve. The sled's position across
/// the track and walls are not known to the model.
///
/// The start speed, the seed and the contacts of `options` are not used. The integration is that of
/// [`crate::simulate()`].
///
/// # Errors
/// [`Error::File`] for a run that begins outside the track, [`Error::TooFew`], errors of options
/// and effects.
pub fn replay(
    inputs: &Inputs,
    vehicle: &Vehicle,
    track: &TrackShape,
    options: &SimulateOptions,
) -> Result<Replay, Error> {
    let vehicle = &vehicle.on_run(&track.name, &options.conditions);
    let conditions = vehicle.conditions.complete(&options.conditions);
    let of_run = &inputs.entry.ice_along;
    let stated = !of_run.points().is_empty();
    let ice = if stated { of_run } else { &track.ice };
    refuse_unstated(vehicle, &conditions, ice, "replay")?;
    let first = inputs.readings[0];
    let last = inputs.readings[inputs.readings.len() - 1];
    if !(track.start_m - BEFORE_M..track.finish_m).contains(&first.s_m) {
        let (name, from, to) = (&track.name, track.start_m, track.finish_m);
        let reason = format!(
            "begins at s_m = {:.1}, expected a place of track {name}, from {from:.1} to {to:.1} m",
            first.s_m + 0.0
        );
        return Err(Error::file(inputs.entry.file.display(), reason));
    }
    let (steering, bridged_m) = inputs.steering()?;
    let world = World {
        vehicle,
        shape: track,
        conditions,
        ice,
        density: conditions.air_density(),
        steering: Steering::Recorded(steering),
        contacts: &[],
        cross_curvature: options.cross_curvature_1pm,
    };
    let [_, alpha, yaw, _] = first.values;
    let from = |speed: f64| -> Unknowns {
        let vx = speed * alpha.cos();
        let vy = -speed * alpha.sin() - vehicle.sled.slip_x_m * yaw;
        let mut start: Unknowns = [0.0; COUNT];
        start[S] = first.s_m;
        start[CHI] = -vy.atan2(vx);
        start[VX..VX + 3].copy_from_slice(&[vx, vy, yaw]);
        start[TIME] = first.t_s;
        start
    };
    let finish_m = last.s_m.min(track.finish_m);
    let speed = start_speed(&world, inputs, from, finish_m, options)?;
    let (simulated, trouble) = integrate(&world, from(speed), finish_m, options)?;
    let (compared, pieces) = compare(inputs, &simulated);
    let (Some(begin), Some(end)) = (compared.first(), compared.last()) else {
        let what = format!("run {}: samples to compare", inputs.entry.run);
        return Err(trouble.unwrap_or_else(|| Error::too_few(what, 0, 1)));
    };
    let mass = vehicle.sled.mass_kg;
    let way = (end.s_m - begin.s_m).max(1e-9);
    Ok(Replay {
        run: inputs.entry.run.clone(),
        track: track.name.clone(),
        from_m: begin.s_m,
        to_m: end.s_m,
        stopped: trouble.map(|error| error.to_string()),
        bridged_m,
        taking_part: inputs.taking_part.clone(),
        mean_force_n: (end.energy_gap(mass) - begin.energy_gap(mass)) / way,
        differences: differences(&compared, inputs.recorded),
        sections: sections(&compared, &pieces, inputs, mass),
        compared,
        pieces,
        simulated,
    })
}

/// The initial speed [m/s] with which the model, started by `from`, has the run's mean kinetic energy
/// over [`START_S`].
fn start_speed(
    world: &World,
    inputs: &Inputs,
    from: impl Fn(f64) -> Unknowns,
    finish_m: f64,
    options: &SimulateOptions,
) -> Result<f64, Error> {
    let first = inputs.readings[0];
    let speed = first.values[0];
    let early = |reading: &&Reading| reading.t_s <= first.t_s + START_S;
    let early = inputs.readings[inputs.pieces[0].clone()]
        .iter()
        .take_while(early);
    let early_m = early.last().map_or(first.s_m, |reading| reading.s_m);
    let (start, _) = integrate(world, from(speed), early_m.min(finish_m), options)?;
    let (compared, _) = compare(inputs, &start);
    let squares = compared.iter().map(|at| at.values[0].map(|v| v.powi(2)));
    let gap = squares
        .map(|[measured, model]| measured - model)
        .sum::<f64>();
    let gap = gap / compared.len().max(1) as f64;
    Ok((speed * speed + gap).max(0.0).sqrt())
}

/// A value of a reading.
type ReadingValue = fn(&Reading) -> f64;

/// Columns written next to the model's, and their values.
const MEASURED: [(&str, ReadingValue); 5] = [
    ("t_measured_s", |reading| reading.t_s),
    ("v_measured_mps", |reading| reading.values[0]),
    ("alpha_measured_rad", |reading| reading.values[1]),
    ("yaw_rate_measured_radps", |reading| reading.values[2]),
    ("gamma_measured_rad", |reading| reading.values[3]),
];

/// Adds measured columns at the same places to a simulated run; NaN in gaps and outside the ends.
///
/// Values are linear between readings. Columns that were not recorded are omitted. Without `s_m`
/// in `run` nothing is added.
pub fn add_measured_columns(run: &mut Run, inputs: &Inputs) {
    let Some(places) = run.columns.get("s_m").cloned() else {
        return;
    };
    let recorded = std::iter::once(true).chain(inputs.recorded);
    for ((name, of), _) in MEASURED.iter().zip(recorded).filter(|(_, there)| *there) {
        let mut column = vec![f64::NAN; places.len()];
        for piece in &inputs.pieces {
            let mut at = 0;
            for pair in inputs.readings[piece.clone()].windows(2) {
                let (a, b) = (&pair[0], &pair[1]);
                at += places[at..]
                    .iter()
                    .take_while(|place| **place < a.s_m)
                    .count();
                while at < places.len() && places[at] <= b.s_m {
                    let share = (places[at] - a.s_m) / (b.s_m - a.s_m).max(f64::MIN_POSITIVE);
                    column[at] = of(a) + share * (of(b) - of(a));
                    at += 1;
                }
            }
        }
        run.columns.insert((*name).to_string(), column);
    }
}
