//! Alignment of runs to a common distance along the track, and the estimate of the track from them.

pub(crate) mod estimate;
pub(crate) mod signature;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;
use serde::Serialize;

use crate::align::estimate::{TrackEstimate, estimate, mean_profile, over_track};
use crate::align::signature::{DistanceWarp, Line, ReferenceProfile, TrackSignature, search};
use crate::error::Error;
use crate::model::vehicle::Vehicle;
use crate::record::run::Run;
use crate::series::{bridged, integral, median};
use crate::signals::prepare::Prepared;
use crate::sled::Tolerances;
use crate::track::table::TrackShape;

/// Largest unexplained share of the track's variance for a run on this track: half the share
/// between two different tracks.
const MAX_UNEXPLAINED: f64 = 0.5;
/// Smallest ratio of the misfit at the best other place to that at the best place; below it the
/// place is ambiguous.
const MIN_AMBIGUITY_RATIO: f64 = 1.5;
/// Rounds of alignment to the mean of the runs; the drift of the first reference run is gone after
/// two.
const ROUNDS: usize = 3;

/// Alignment of a run to its track.
#[derive(Clone, Debug, Serialize, schemars::JsonSchema)]
pub struct AlignedRun {
    /// Name of the run.
    pub run: String,
    /// Place of its first sample [m].
    pub start_m: f64,
    /// Mean ratio of increments of the distance along the track to those of the run's own distance.
    pub stretch: f64,
    /// Largest deviation of the alignment from a straight line [m].
    pub drift_m: f64,
    /// Largest standard error of the place along the run [m].
    pub sd_m: f64,
    /// Unexplained share of the track's variance of curvature and bank, with the straight line of
    /// the search.
    #[serde(rename = "left")]
    pub misfit: f64,
    /// The unexplained share at the best place more than 15 m away; `None` if no other place was
    /// tried.
    pub left_elsewhere: Option<f64>,
    /// Map from the run's own distance to the distance along the track.
    #[serde(skip)]
    pub warp: DistanceWarp,
}

/// The aligned runs of one track.
#[derive(Clone, Debug)]
pub struct Aligned {
    /// In the order given.
    pub runs: Vec<AlignedRun>,
    /// The mean track measured by the runs; `None` if no two runs overlap.
    pub estimate: Option<TrackEstimate>,
}

/// Aligns runs of one track to a common distance: that of the survey if there is one, else the mean
/// of the runs' distances, with 0 at the earliest start.
///
/// Curvature and bank are measured ([`TrackSignature::of`]). The place is found by a search on
/// straight lines and then refined by a warp with knots ([`refine`]).
///
/// # Errors
/// [`Error::File`] for a run that does not match its track, or matches two places of it.
pub fn align(
    runs: &[&Prepared],
    vehicle: &Vehicle,
    survey: Option<&TrackShape>,
    tolerances: &Tolerances,
) -> Result<Aligned, Error> {
    let signature = |run: &&Prepared| TrackSignature::of(run, &vehicle.sled);
    let measured: Vec<TrackSignature> = runs.par_iter().map(signature).collect();
    let place_all = |reference: &ReferenceProfile| -> Result<Vec<AlignedRun>, Error> {
        let pairs = runs.par_iter().zip(&measured);
        let placed: Vec<_> = pairs
            .map(|(run, measured)| place(run, measured, reference))
            .collect();
        placed.into_iter().collect()
    };
    let aligned = match survey {
        Some(shape) => place_all(&ReferenceProfile::of(shape))?,
        None => {
            let longest = measured.iter().max_by_key(|measured| measured.metres.len());
            let from_m = longest.map_or(0.0, |measured| measured.from_m);
            let metres = longest.into_iter().flat_map(|measured| &measured.metres);
            let metres = metres.map(|m| [m[0], m[1]]).collect();
            let mut aligned = place_all(&ReferenceProfile::new(from_m, metres))?;
            for _ in 1..ROUNDS {
                let (from_m, table) = over_track(&measured, &aligned);
                aligned = place_all(&mean_profile(from_m, &table))?;
            }
            to_mean_distance(&measured, &mut aligned);
            aligned
        }
    };
    let (from_m, table) = over_track(&measured, &aligned);
    let states = || runs.iter().flat_map(|run| &run.states);
    let speed_mps = states().map(|state| state.v_mps).sum::<f64>() / states().count().max(1) as f64;
    let name = runs.first().map_or("", |run| &run.entry.track);
    Ok(Aligned {
        estimate: estimate(name, from_m, &table, speed_mps, tolerances),
        runs: aligned,
    })
}

fn place(
    run: &Prepared,
    measured: &TrackSignature,
    reference: &ReferenceProfile,
) -> Result<AlignedRun, Error> {
    let unplaced = |misfit: f64, elsewhere: f64| {
        let reason = format!(
            "its place on track {} is not determined: {misfit:.2} of the variance of curvature and bank is unexplained at the best place and {elsewhere:.2} at another, expected below 0.5 and at least 1.5 times as much elsewhere",
            run.entry.track
        );
        Error::file(run.entry.file.display(), reason)
    };
    let found = search(measured, reference);
    let (line, elsewhere) = found.ok_or_else(|| unplaced(f64::NAN, f64::NAN))?;
    if line.misfit > MAX_UNEXPLAINED || elsewhere < MIN_AMBIGUITY_RATIO * line.misfit {
        return Err(unplaced(line.misfit, elsewhere));
    }
    let warp = refine(measured, reference, &line);
    let (own, stretch) = (&warp.own_m, warp.stretch());
    let straight = |j: usize| warp.shift_m[0] + (stretch - 1.0) * (own[j] - own[0]);
    let drift = (0..own.len()).map(|j| (warp.shift_m[j] - straight(j)).abs());
    Ok(AlignedRun {
        run: run.entry.run.clone(),
        start_m: warp.at(run.states[0].s_m),
        stretch,
        drift_m: drift.fold(0.0, f64::max),
        sd_m: warp.sd_m.iter().copied().fold(0.0, f64::max),
        misfit: line.misfit,
        left_elsewhere: Some(elsewhere).filter(|misfit| misfit.is_finite()),
        warp,
    })
}

/// Replaces the common distance by the mean of the runs' own distances: their increments are
/// averaged at every metre. The earliest start is 0.
fn to_mean_distance(measured: &[TrackSignature], aligned: &mut [AlignedRun]) {
    let start = |run: &AlignedRun| run.warp.at(run.warp.own_m[0]);
    let end = |run: &AlignedRun| run.warp.at(run.warp.own_m[run.warp.own_m.len() - 1]);
    let from = aligned.iter().map(start).fold(f64::INFINITY, f64::min);
    let to = aligned.iter().map(end).fold(f64::NEG_INFINITY, f64::max);
    let count = (to - from).max(0.0) as usize + 2;
    // In each metre: sum of the increments of own distance, and of common distance.
    let mut ways = vec![(0.0, 0.0); count];
    for (measured, run) in measured.iter().zip(aligned.iter()) {
        for i in 1..measured.metres.len() {
            let (a, b) = (
                run.warp.at(measured.place(i - 1)),
                run.warp.at(measured.place(i)),
            );
            if b > a {
                let metre = &mut ways[((0.5 * (a + b) - from) as usize).min(count - 1)];
                metre.0 += 1.0;
                metre.1 += b - a;
            }
        }
    }
    let mut mean = vec![0.0; count + 1];
    for (i, (own, common)) in ways.iter().enumerate() {
        mean[i + 1] = mean[i] + if *common > 0.0 { own / common } else { 1.0 };
    }
    let to_mean = |s: f64| {
        let along = (s - from).clamp(0.0, count as f64 - 1e-9);
        let i = along as usize;
        mean[i] + (along - i as f64) * (mean[i + 1] - mean[i])
    };
    for run in aligned {
        let warp = &mut run.warp;
        for (own, shift) in warp.own_m.iter().zip(&mut warp.shift_m) {
            *shift = to_mean(own + *shift) - own;
        }
        run.stretch = warp.stretch();
        run.start_m = warp.at(warp.own_m[0]);
    }
}

/// Writes the distance along the track to `s_m` of a run. The own distance is the recorded `s_m`,
/// else the integral of the speed.
pub fn state_places(run: &mut Run, warp: &DistanceWarp) -> Result<(), Error> {
    let own = match run.columns.get("s_m") {
        Some(recorded) => recorded.clone(),
        None => integral(&bridged(run.column("v_mps")?), run.dt_s),
    };
    let places = own.iter().map(|own| warp.at(*own)).collect();
    run.columns.insert("s_m".to_string(), places);
    Ok(())
}

/// Distance of the knots [m]: a curve and the straight before it are one landmark.
const KNOTS_M: f64 = 100.0;
/// Standard deviation of the change in drift of an integrated distance from one knot interval to
/// the next [m]: 0.5 %, of a speed with a wandering scale.
const DRIFT_M: f64 = 0.5;
/// Gauss-Newton iterations; the last ones move by less than a millimetre.
const MAX_ITERATIONS: usize = 12;
/// Largest step of a knot in one iteration [m].
const MAX_STEP_M: f64 = 5.0;
/// Huber's limit in standard deviations: larger residuals count less, e.g. of a wall, a bump, a
/// high line.
const HUBER_LIMIT: f64 = 2.0;
/// Standard deviation of the apparent shift of a curve by the driven line, at every knot [m]: at an
/// angle psi to the track's line a sled measures the curvature `k + psi dphi/ds`, which is the
/// curvature at a distance `psi dphi/dk` further on. 0.9 m for psi = 0.03 and a bank of 1.2 rad at
/// 0.04 /m.
const LINE_M: f64 = 1.0;

/// Shifts at knots that align the measured signature to the reference, by robust least squares:
///
/// ```text
/// sum over metres and both quantities of  huber( (measured - reference(s + shift(s))) / sd )
///   + sum over knots of ( (shift_{j+1} - 2 shift_j + shift_{j-1}) / 0.5 m )^2
/// ```
///
/// with the standard deviations sd of the residuals. A second, unknown shift at every knot for the
/// driven line, independent with the standard deviation [`LINE_M`], is eliminated. Standard errors
/// are those of the linearised fit.
fn refine(measured: &TrackSignature, reference: &ReferenceProfile, from: &Line) -> DistanceWarp {
    let length = (measured.metres.len() - 1).max(1) as f64;
    let pieces = (length / KNOTS_M).round().max(1.0) as usize;
    let knot = |j: usize| measured.from_m + length * j as f64 / pieces as f64;
    let own_m: Vec<f64> = (0..=pieces).map(knot).collect();
    let shift = |own: f64| from.shift_m + (from.stretch - 1.0) * (own - measured.from_m);
    let mut warp = DistanceWarp {
        shift_m: own_m.iter().map(|own| shift(*own)).collect(),
        sd_m: vec![0.0; own_m.len()],
        own_m,
    };
    for _ in 0..MAX_ITERATIONS {
        let Some((factor, right)) = posterior(measured, reference, &warp) else {
            break;
        };
        let step = factor.solve(&right);
        for (shift, step) in warp.shift_m.iter_mut().zip(step.iter()) {
            *shift += step.clamp(-MAX_STEP_M, MAX_STEP_M);
        }
    }
    if let Some((factor, _)) = posterior(measured, reference, &warp) {
        let variance = factor.inverse().diagonal();
        warp.sd_m = variance.iter().map(|x| x.sqrt()).collect();
    }
    warp
}

/// Cholesky factor of the normal matrix and right-hand side, of data and prior together.
fn posterior(
    measured: &TrackSignature,
    reference: &ReferenceProfile,
    warp: &DistanceWarp,
) -> Option<(Cholesky<f64, Dyn>, DVector<f64>)> {
    let (normal, right) = normal_equations(measured, reference, warp);
    let (drift, towards) = prior(&warp.shift_m);
    Some(((normal + drift).cholesky()?, right + towards))
}

/// Normal matrix and right-hand side of the prior: a drift that is linear in the distance.
fn prior(shift: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let n = shift.len();
    let (mut normal, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
    for j in 1..n.saturating_sub(1) {
        let bend = [(j - 1, 1.0), (j, -2.0), (j + 1, 1.0)];
        let value: f64 = bend.iter().map(|(k, w)| w * shift[*k]).sum();
        for (a, wa) in bend {
            right[a] -= wa * value / (DRIFT_M * DRIFT_M);
            for (b, wb) in bend {
                normal[(a, b)] += wa * wb / (DRIFT_M * DRIFT_M);
            }
        }
    }
    // A run without landmarks keeps the place of the search.
    for j in 0..n {
        normal[(j, j)] += 1e-6;
    }
    (normal, right)
}

/// Normal matrix D and right-hand side r of the shifts from the differences between run and
/// reference, with the shifts by the driven line eliminated: both multiplied by
/// `inv(1 + LINE_M^2 D)`. The derivative of the warp is near 1 and neglected in the slopes.
fn normal_equations(
    measured: &TrackSignature,
    reference: &ReferenceProfile,
    warp: &DistanceWarp,
) -> (DMatrix<f64>, DVector<f64>) {
    // Per metre: knot before and weight of the next one, differences, and slopes of the reference.
    let row = |(i, metre): (usize, &[f64; 3])| {
        let own = measured.place(i);
        let known = reference.at(warp.at(own));
        let (at, slope) = known.filter(|_| metre[0].is_finite())?;
        let differences = [metre[0] - at[0], metre[1] - at[1]];
        Some((warp.between(own), differences, slope))
    };
    let metres = measured.metres.iter().enumerate();
    let rows: Vec<_> = metres.filter_map(row).collect();
    let sd = [0, 1].map(|k: usize| {
        let median = median(rows.iter().map(|(_, differences, _)| differences[k].abs()));
        // The median magnitude of a normal variable is 0.6745 of its deviation; at least a
        // hundredth of the reference's own variation.
        let least = 0.01 * reference.spread[k];
        median.map_or(1.0, |median| (median / 0.674_489_75).max(least))
    });
    let knots = warp.own_m.len();
    let mut normal = DMatrix::zeros(knots, knots);
    let mut right = DVector::zeros(knots);
    for ((knot, share), differences, slopes) in rows {
        let next = (knot + 1).min(knots - 1);
        let hats = [(knot, 1.0 - share), (next, share)];
        for k in 0..2 {
            let size = (differences[k] / sd[k]).abs();
            let weight = (HUBER_LIMIT / size.max(HUBER_LIMIT)) / (sd[k] * sd[k]);
            for (a, wa) in hats {
                right[a] += weight * wa * slopes[k] * differences[k];
                for (b, wb) in hats {
                    normal[(a, b)] += weight * wa * wb * slopes[k] * slopes[k];
                }
            }
        }
    }
    let noise = DMatrix::identity(knots, knots) + &normal * (LINE_M * LINE_M);
    match noise.cholesky() {
        Some(noise) => (noise.solve(&normal), noise.solve(&right)),
        None => (normal, right),
    }
}
