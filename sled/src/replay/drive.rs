//! The model driven with a run's own start and steering.

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
use crate::simulate::dynamics::{COUNT, TIME, Unknowns, World};
use crate::track::table::TrackShape;

/// A run and what the model makes of its start and its steering.
#[derive(Clone, Debug, Serialize, schemars::JsonSchema)]
pub struct Replay {
    /// Name of the run.
    pub run: String,
    /// Track.
    pub track: String,
    /// Where the comparison begins and ends [m].
    pub from_m: f64,
    /// See `from_m`.
    pub to_m: f64,
    /// Why the model did not come to the run's end, where it did not.
    pub stopped: Option<String>,
    /// Way on which the steering is a straight line across a gap [m].
    pub bridged_m: f64,
    /// What of the run takes part.
    pub taking_part: SampleCoverage,
    /// Force along the sled missing in the model in the mean [N]: the growth of the difference of
    /// kinetic energies over the way.
    pub mean_force_n: f64,
    /// How far both are apart, by column.
    pub differences: Vec<Difference>,
    /// Where they part.
    pub sections: Vec<Section>,
    /// Both next to each other; not part of the report.
    #[serde(skip)]
    pub compared: Vec<Compared>,
    /// Stretches of `compared` without a gap.
    #[serde(skip)]
    pub pieces: Vec<Range<usize>>,
    /// What the model did.
    #[serde(skip)]
    pub simulated: Simulated,
}

/// Readings that tell the speed at the start [s]. The sensor's usual noise of 0.03 m/s moves it by
/// 0.002 m/s, a force of 10 N that the model is short of by 0.006; at half of this 0.003 and 0.003,
/// at twice 0.0013 and 0.013.
const START_S: f64 = 0.5;

/// How far before the first place of its track a run may begin [m]: tracks of `runs align` have
/// their first place in the middle of a cell of 2 m, and runs begin at 0 within rounding.
const BEFORE_M: f64 = 1.5;

/// Drives the model down the track with the start and the steering of a run, and compares both.
///
/// The start is the first reading's place, time, slip angle and yaw rate, moving along the line, at
/// the speed with which the model has the run's mean energy over the first half second: a single
/// reading's noise would stay in the speed down to the finish, where slip angle and yaw rate come
/// to what the steering asks for by themselves. The steering angle is that measured at the
/// same *place*, so that a curve is steered in where it is also when the model comes late. What the
/// model does not know (where across the track the sled was, walls) it does not get.
///
/// Of `options`, the start speed, the seed and contacts are not read; steps and their order as in
/// [`crate::simulate()`].
///
/// # Errors
/// [`Error::File`] for a run that begins off the track, [`Error::TooFew`], those of options and
/// effects.
pub fn replay(
    inputs: &Inputs,
    vehicle: &Vehicle,
    track: &TrackShape,
    options: &SimulateOptions,
) -> Result<Replay, Error> {
    let vehicle = &vehicle.on_run(&track.name, &options.conditions);
    let conditions = vehicle.conditions.complete(&options.conditions);
    let own = &inputs.entry.ice_along;
    let stated = !own.points().is_empty();
    let ice = if stated { own } else { &track.ice };
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
    let [speed, alpha, yaw, _] = first.values;
    let from = |speed: f64| -> Unknowns {
        let vx = speed * alpha.cos();
        let vy = -speed * alpha.sin() - vehicle.sled.slip_x_m * yaw;
        let mut start: Unknowns = [0.0; COUNT];
        start[0] = first.s_m;
        start[2] = -vy.atan2(vx);
        start[3..6].copy_from_slice(&[vx, vy, yaw]);
        start[TIME] = first.t_s;
        start
    };
    let finish_m = last.s_m.min(track.finish_m);
    let early = |reading: &&Reading| reading.t_s <= first.t_s + START_S;
    let first_piece = inputs.readings[inputs.pieces[0].clone()].iter();
    let early = first_piece.take_while(early);
    let early_m = early.last().map_or(first.s_m, |reading| reading.s_m);
    let (begun, _) = integrate(&world, from(speed), early_m.min(finish_m), options)?;
    let (near, _) = compare(inputs, &begun);
    let squares = near.iter().map(|at| at.values[0].map(|v| v.powi(2)));
    let gap = squares
        .map(|[measured, model]| measured - model)
        .sum::<f64>();
    let gap = gap / near.len().max(1) as f64;
    let speed = (speed * speed + gap).max(0.0).sqrt();
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

/// A value of a reading.
type Of = fn(&Reading) -> f64;

/// Columns written next to the model's, and their values.
const MEASURED: [(&str, Of); 5] = [
    ("t_measured_s", |reading| reading.t_s),
    ("v_measured_mps", |reading| reading.values[0]),
    ("alpha_measured_rad", |reading| reading.values[1]),
    ("yaw_rate_measured_radps", |reading| reading.values[2]),
    ("gamma_measured_rad", |reading| reading.values[3]),
];

/// Puts what was measured at the same places into a simulated run, as further columns; NaN in gaps
/// and outside the ends.
///
/// Between readings on a straight line; only what was recorded. The run must have `s_m`.
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
