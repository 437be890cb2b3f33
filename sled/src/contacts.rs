//! Contacts with walls that differ from run to run: hit or missed, with any force.

use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::effects::Active;
use crate::model::vehicle::Vehicle;
use crate::motion::balance::Balance;
use crate::motion::one_track::{forward, resultant};
use crate::motion::state::{Motion, State};
use crate::series::median;
use crate::signals::prepare::Prepared;
use crate::simulate::dynamics::WallContact;

/// Trial lengths of contacts \[m\].
const LENGTHS_M: [f64; 9] = [4.0, 6.0, 8.0, 10.0, 13.0, 16.0, 20.0, 25.0, 32.0];
/// False alarm rate: share of the runs that miss a place and are taken for hits by chance. Chosen.
const FALSE_ALARM_RATE: f64 = 0.05;
/// Number of independent half waves per metre of a stretch beyond the shortest length. With it the
/// 95 % quantile of the largest force on white noise is right to 0.1 standard errors on stretches
/// of 10 m to 80 m.
const TRIALS_PER_M: f64 = 4.0 / 3.0;
/// Ratio of a push to the force of a hit above which it is not a hit: hits scatter by a factor of
/// two or three. Chosen.
pub const HARDEST: f64 = 5.0;
/// Number of parameters of a half wave that are fitted to noise: force, place and length.
const FITTED_PARAMETERS: f64 = 3.0;
/// Relative standard deviation of the force of hits. Chosen: factors of 1/2 and 2 are within two
/// standard deviations.
pub const HITS_DIFFER: f64 = 0.5;
/// Number of samples over which the noise is correlated by the low pass before the balances.
const CORRELATED_SAMPLES: f64 = 2.0;

/// A force from outside on a run within a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// The half wave of force, with a lever of 0.
    pub contact: WallContact,
    /// Standard error of its force \[N\].
    pub error_n: f64,
    /// Whether it is a hit of the place: not more than [`HARDEST`] times as hard as the known hits.
    pub is_hit: bool,
}

/// Posterior mean of a contact from the estimated force F and the prior `hit +- hit/2` of the force
/// of hits. The variance V of the estimate contains the fit of place and length to noise:
///
/// ```text
/// (F / V + hit / (hit / 2)^2) / (1 / V + 1 / (hit / 2)^2)        V = 3 error^2
/// ```
pub fn as_expected(found: WallContact, error_n: f64, hit_n: f64) -> WallContact {
    if hit_n == 0.0 {
        return found;
    }
    let (push_variance, hit_variance) = (
        FITTED_PARAMETERS * error_n.powi(2),
        (HITS_DIFFER * hit_n).powi(2),
    );
    WallContact {
        force_n: (found.force_n * hit_variance + hit_n * push_variance)
            / (hit_variance + push_variance),
        ..found
    }
}

/// The half wave that best fits the residual side force `side_n` within a stretch \[m\]; `None` if
/// none is significant. `scatter_n` is the standard deviation of a sample \[N\]. `hit_n` is the
/// force of a hit, positive to the left, and states the side; 0 if it is not known.
///
/// ```text
/// F = sum w y / sum w^2        w = sin^2(pi (s - s_0) / length)        error = scatter sqrt(2 / sum w^2)
/// ```
///
/// Place (on a grid of 1 m) and length maximise `F sum w y`.
pub fn push_within(
    s_m: &[f64],
    side_n: &[f64],
    stretch_m: [f64; 2],
    hit_n: f64,
    scatter_n: f64,
) -> Option<Push> {
    let is_within = |s: f64| (stretch_m[0]..=stretch_m[1]).contains(&s);
    let samples = s_m.iter().copied().zip(side_n.iter().copied());
    let samples: Vec<(f64, f64)> = samples
        .filter(|(s, y)| is_within(*s) && y.is_finite())
        .collect();
    let mut best: Option<(f64, WallContact, f64)> = None;
    for one in half_waves(stretch_m) {
        let (mut wy, mut ww) = (0.0, 0.0);
        for (s, y) in &samples {
            let w = one.force_at(*s);
            (wy, ww) = (wy + w * y, ww + w * w);
        }
        // Too few samples within the half wave.
        if ww < 1.0 || wy * hit_n < 0.0 {
            continue;
        }
        let (force_n, gain) = (wy / ww, wy * wy / ww);
        if best.as_ref().is_none_or(|(most, ..)| gain > *most) {
            let error = scatter_n * (CORRELATED_SAMPLES / ww).sqrt();
            best = Some((gain, WallContact { force_n, ..one }, error));
        }
    }
    let trials = independent_trials(stretch_m, hit_n != 0.0);
    let (_, contact, error_n) = best?;
    let push_n = contact.force_n.abs();
    // A hit must be likelier than noise in all independent half waves: next to strong hits a weak
    // push is noise.
    let variance = error_n * error_n;
    let as_hit = || likelier(contact.force_n, variance, hit_n, HITS_DIFFER * hit_n);
    let significant =
        push_n > critical_force(trials) * error_n && (hit_n == 0.0 || as_hit() > trials.ln());
    significant.then(|| Push {
        contact,
        error_n,
        is_hit: hit_n == 0.0 || push_n <= HARDEST * hit_n.abs(),
    })
}

/// The share pi of runs that hit a place, and the force F of a hit \[N\], from mean m and standard
/// deviation s over runs of a two-point distribution (0 and F):
///
/// ```text
/// pi = m^2 / (m^2 + s^2)        F = m / pi
/// ```
///
/// Both are 0 if `s >= 5 m`: the side is then unknown.
pub fn hits_of(effect: &Active) -> (f64, f64) {
    let (mean, spread) = (effect.values[0], effect.values[5]);
    let hits = mean * mean / (mean * mean + spread * spread);
    if hits > 0.04 {
        (hits, mean / hits)
    } else {
        (0.0, 0.0)
    }
}

/// Number of independent half waves within a stretch, to one side or to both.
fn independent_trials(stretch_m: [f64; 2], one_side: bool) -> f64 {
    let spare_m = stretch_m[1] - stretch_m[0] - LENGTHS_M[0];
    (TRIALS_PER_M * spare_m).max(1.0) * if one_side { 1.0 } else { 2.0 }
}

/// Number of standard errors that the largest force of a run without a hit exceeds with the
/// probability [`FALSE_ALARM_RATE`].
fn critical_force(trials: f64) -> f64 {
    let least = Normal::standard().inverse_cdf(1.0 - FALSE_ALARM_RATE / trials);
    if least.is_finite() {
        least
    } else {
        f64::INFINITY
    }
}

/// Log-likelihood ratio of a force F with the variance V between a normal distribution of mean A
/// and standard deviation T and noise of mean 0:
///
/// ```text
/// (F^2 / V - (F - A)^2 / (V + T^2) - ln(1 + T^2 / V)) / 2
/// ```
pub fn likelier(force_n: f64, variance: f64, about_n: f64, differ_n: f64) -> f64 {
    let spread = differ_n * differ_n;
    let away = (force_n - about_n).powi(2) / (variance + spread);
    0.5 * (force_n * force_n / variance - away - (spread / variance).ln_1p())
}

/// Half waves of 1 N within a stretch \[m\] with a lever of 0, on a grid of 1 m, of lengths from 4
/// m to 32 m.
pub fn half_waves(stretch_m: [f64; 2]) -> impl Iterator<Item = WallContact> {
    let [from_m, to_m] = stretch_m;
    let fitting = LENGTHS_M
        .into_iter()
        .filter(move |length_m| to_m - from_m >= *length_m);
    fitting.flat_map(move |length_m| {
        let starts = ((to_m - from_m - length_m).floor() as usize + 1).min(1000);
        (0..starts).map(move |start| WallContact {
            s_m: from_m + start as f64,
            length_m,
            force_n: 1.0,
            x_m: 0.0,
        })
    })
}

/// Robust standard deviation of a sample: 1.4826 times the median magnitude; 0 without finite
/// values.
pub fn scatter(values: &[f64]) -> f64 {
    let known = values.iter().filter(|x| x.is_finite());
    median(known.map(|x| x.abs())).map_or(0.0, |median| 1.4826 * median)
}

/// An effect that varies from run to run, with force and place of the contact of one run; an
/// amplitude of 0 if the run missed.
pub fn as_of_run(effect: &Active, contact: Option<&WallContact>) -> Active {
    let mut of_run = effect.clone();
    of_run.values[0] = contact.map_or(0.0, |c| c.force_n);
    if let Some(c) = contact {
        (of_run.values[1], of_run.values[2]) = (c.s_m, c.s_m + c.length_m);
    }
    of_run
}

/// The stretch in which the contact of a single run is searched for \[m\].
pub fn stretch_of(effect: &Active) -> [f64; 2] {
    let v = &effect.values;
    [v[1] - v[6], v[2] + v[6]]
}

/// The vehicle on a run. Each effect that varies from run to run has the force and the stretch of
/// this run.
///
/// Force and stretch come from the balance of side forces ([`push_within`]).
pub fn with_own_contacts(run: &Prepared, vehicle: &Vehicle) -> Vehicle {
    let mut adapted = vehicle.on_run(&run.entry.track, &run.entry.conditions);
    if !adapted.effects.active.iter().any(Active::varies) {
        return adapted;
    }
    let mut without = adapted.clone();
    without.effects.active.retain(|effect| !effect.varies());
    let remainder = |(state, motion): (&State, &Motion)| {
        let at = Balance::new(&without.sled, state, motion);
        let remainder = at.residual(&at.forces(&without, &at.laws(&without)));
        (state.s_m, remainder.side_n)
    };
    let instants = run.states.iter().zip(&run.motions);
    let (s_m, side_n): (Vec<f64>, Vec<f64>) = instants.map(remainder).unzip();
    let scatter_n = scatter(&side_n);
    for effect in adapted.effects.active.iter_mut().filter(|e| e.varies()) {
        let (_, hit_n) = hits_of(effect);
        let push = push_within(&s_m, &side_n, stretch_of(effect), hit_n, scatter_n);
        let hit = push.filter(|push| push.is_hit);
        let expected = hit.map(|push| as_expected(push.contact, push.error_n, hit_n));
        *effect = as_of_run(effect, expected.as_ref());
    }
    adapted
}

/// Samples with a force from other than ice and air: one flag per sample, run by run.
///
/// The residual of the lateral force at the centre of gravity, model against measurement, above six
/// robust standard deviations (1.4826 times its median magnitude over all runs), and 0.2 s around
/// it. Sensor noise exceeds six standard deviations less than once in 10^8 samples; a wall contact
/// of a few hundred newtons always does.
pub fn find_contacts(runs: &[Prepared], vehicle: &Vehicle) -> Vec<Vec<bool>> {
    let residuals = |run: &Prepared| -> Vec<f64> {
        let vehicle = &vehicle.on_run(&run.entry.track, &run.entry.conditions);
        let residual = |(state, motion): (&State, &Motion)| {
            let model = resultant(&vehicle.sled, state, &forward(vehicle, state)).fy_n;
            (vehicle.sled.mass_kg * motion.accel_mps2[1] - model).abs()
        };
        let instants = run.states.iter().zip(&run.motions);
        instants.map(residual).collect()
    };
    let residuals: Vec<Vec<f64>> = runs.par_iter().map(residuals).collect();
    let Some(median) = median(residuals.iter().flatten().copied()) else {
        return Vec::new();
    };
    let limit = 6.0 * 1.4826 * median;
    let mark = |(residual, run): (&Vec<f64>, &Prepared)| {
        let around = (0.2 / run.dt_s).round() as usize;
        let mut marked = vec![false; residual.len()];
        for piece in &run.pieces {
            for i in piece.clone().filter(|i| residual[*i] > limit) {
                let end = (i + around + 1).min(piece.end);
                marked[i.saturating_sub(around).max(piece.start)..end].fill(true);
            }
        }
        marked
    };
    residuals.iter().zip(runs).map(mark).collect()
}

#[cfg(test)]
mod tests {
    use crate::effects::{CATALOGUE, Kind};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn a_half_wave_in_noise_is_found_where_it_is_and_noise_alone_is_none() {
        let s: Vec<f64> = (0..300).map(|i| 0.5 * f64::from(i)).collect();
        // Golden-ratio noise of a unit's standard deviation, evenly spread.
        let noise: Vec<f64> = (0..300)
            .map(|i| ((f64::from(i) * 0.618_034).fract() - 0.5) * 12.0_f64.sqrt())
            .collect();
        assert!(push_within(&s, &noise, [40.0, 90.0], 0.0, 1.0).is_none());
        let truth = WallContact {
            s_m: 57.0,
            length_m: 16.0,
            force_n: -40.0,
            x_m: 0.0,
        };
        let side: Vec<f64> = s
            .iter()
            .zip(&noise)
            .map(|(s, e)| truth.force_at(*s) + e)
            .collect();
        let push = push_within(&s, &side, [40.0, 90.0], 0.0, 1.0).expect("a contact");
        let (found, error) = (push.contact, push.error_n);
        assert!(
            (found.s_m - 57.0).abs() <= 1.0 && (found.length_m - 16.0).abs() <= 4.0,
            "{found:?}"
        );
        assert!(
            (found.force_n + 40.0).abs() < 4.0 * error,
            "{found:?} {error}"
        );
    }

    #[test]
    fn one_run_in_twenty_that_misses_is_taken_for_a_hit() {
        let s: Vec<f64> = (0..600).map(|i| 0.25 * f64::from(i)).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        for (stretch_m, hit_n) in [
            ([40.0, 60.0], 0.0),
            ([40.0, 60.0], 5.0),
            ([20.0, 90.0], 0.0),
        ] {
            let taken = (0..1000).filter(|_| {
                // Noise that two neighbouring samples share.
                let white: Vec<f64> = (0..601).map(|_| StandardNormal.sample(&mut rng)).collect();
                let side: Vec<f64> = white
                    .windows(2)
                    .map(|w| (w[0] + w[1]) / 2.0_f64.sqrt())
                    .collect();
                push_within(&s, &side, stretch_m, hit_n, scatter(&side)).is_some()
            });
            let taken = taken.count();
            // Beside a hit of five deviations noise must look like one, too.
            let least = if hit_n == 0.0 { 20 } else { 0 };
            assert!(
                (least..=80).contains(&taken),
                "{stretch_m:?} {hit_n}: {taken} of 1000"
            );
        }
    }

    #[test]
    fn hits_are_the_two_points_that_have_a_mean_and_a_spread() {
        let wall = CATALOGUE.iter().find(|e| e.info.name == "wall-contact");
        let mut values = vec![0.0; 7];
        // One run in four with 400 N.
        (values[0], values[5]) = (100.0, 400.0 * (0.25_f64 * 0.75).sqrt());
        let effect = Active {
            name: "wall-contact".to_owned(),
            kind: Kind::Catalogue(wall.expect("in the catalogue")),
            values,
            track: None,
        };
        let (hits, hit_n) = hits_of(&effect);
        assert!((hits - 0.25).abs() < 1e-12 && (hit_n - 400.0).abs() < 1e-9);
        let found = WallContact {
            s_m: 0.0,
            length_m: 10.0,
            force_n: 700.0,
            x_m: 0.0,
        };
        // With equal variances of estimate and prior, halfway.
        let error_n = 200.0 / FITTED_PARAMETERS.sqrt();
        assert!((as_expected(found, error_n, 400.0).force_n - 550.0).abs() < 1e-9);
        assert_eq!(as_expected(found, error_n, 0.0).force_n, 700.0);
    }
}
