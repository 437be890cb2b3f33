//! The film's equation integrated along the strip, with steps as short as the accuracy asks.

use super::conditions::{FilmConditions, FilmOptions};
use super::properties::Properties;
use super::radau;
use super::solution::{Film, FilmTotals};
use super::strip::Strip;
use super::track::Track;
use crate::friction::error::Error;

/// Most steps of one integration.
const MOST_STEPS: usize = 20_000;

/// Times that the steps are graded anew, each ten times as exactly.
const ROUNDS: usize = 6;

/// The melt film along `strip`: what melts, what freezes, what is squeezed out, and the drag of what stays.
///
/// With `xi` from the leading edge, thickness `h`, and the melting point of the pressure as the film's temperature:
///
/// ```text
/// rho_i L v_m = mu V^2/h - q_i - q_s                                 heat: friction melts what the walls do not take
/// (V/2) dh/dxi = (rho_i/rho_w) v_m - p h^3/(mu w^2)                  water: carried along at half the speed, squeezed out sideways
/// F_v = integral mu V/h w dxi                                        drag
/// ```
///
/// [`HeatIntoIce`](super::HeatIntoIce) states `q_i`, [`squeeze_out_rate`](super::squeeze_out_rate) the last term. The film starts at
/// 0 as [`self_similar_start`](super::self_similar_start). It never ends: where the walls take more heat than friction gives
/// (`melt_rate` negative) it freezes and thins until `mu V^2/h` is as much, so that thickness goes to nanometres and below for a
/// slow runner on cold ice, but not to 0. What the model then says is the heat that the ice can take, not that there is a film:
/// [`Film::thinnest`] belongs beside roughness and the size of a molecule.
///
/// Integrated by Radau IIA of order 5, from station to station of the strip; every total comes with the change that halving
/// all steps makes.
///
/// # Errors
/// [`Error::OutOfRange`] for conditions, properties or options that are; [`Error::NotConverged`] where the accuracy is not reached.
///
/// ```
/// use kufe_sled::friction::film::{FilmConditions, FilmOptions, Properties, Strip, film};
/// let strip = Strip::uniform(0.06, 1.0e-3, 17.7e6)?;
/// let slow = film(&strip, &FilmConditions::new(5.0, -5.0), &Properties::WATER_AND_ICE, &FilmOptions::default())?;
/// let fast = film(&strip, &FilmConditions::new(30.0, -5.0), &Properties::WATER_AND_ICE, &FilmOptions::default())?;
/// assert!(fast.totals.friction > slow.totals.friction);
/// assert!(fast.errors.friction < 1e-6 * fast.totals.friction);
/// # Ok::<(), kufe_sled::friction::Error>(())
/// ```
pub fn film(
    strip: &Strip,
    conditions: &FilmConditions,
    properties: &Properties,
    options: &FilmOptions,
) -> Result<Film, Error> {
    conditions.check()?;
    properties.check()?;
    options.check()?;
    let on = |strip: &Strip| {
        let outflow = strip.pressure().to_vec();
        along(&Track::new(strip, conditions, properties, outflow), options)
    };
    let mut film = on(strip)?;
    if let Some(coarser) = strip.every_second() {
        film.sampling = Some(film.totals.difference(&on(&coarser)?.totals));
    }
    Ok(film)
}

/// The film along `track`.
pub(crate) fn along(track: &Track<'_>, options: &FilmOptions) -> Result<Film, Error> {
    let mut tolerance = 0.1 * options.accuracy;
    let mut reached = f64::INFINITY;
    for _ in 0..ROUNDS {
        let steps = grade(track, tolerance)?;
        let coarse = sweep(track, &steps, 1)?;
        let fine = sweep(track, &steps, 2)?;
        let errors = fine.totals.difference(&coarse.totals);
        let [of_ice, of_water] = track.heats();
        reached = errors.largest_share(&fine.totals, of_ice, of_water);
        if reached <= options.accuracy {
            let ends = fine.ends.iter().zip(&coarse.ends).enumerate();
            return Ok(Film {
                stations: ends
                    .map(|(k, (h, other))| track.station(k + 1, *h, (h - other).abs()))
                    .collect(),
                totals: fine.totals,
                errors,
                sampling: None,
                steps: 2 * steps.len(),
            });
        }
        tolerance = (0.1 * tolerance).max(1e-13);
    }
    Err(Error::NotConverged {
        what: "melt film",
        iterations: ROUNDS,
        residual: reached,
        tolerance: options.accuracy,
    })
}

/// A step in segment `segment` of the strip, in `s = sqrt(xi)`.
struct Step {
    segment: usize,
    from: f64,
    length: f64,
}

impl Step {
    /// The thickness behind the step, and what it adds to the totals.
    fn take(&self, track: &Track<'_>, before: f64) -> Option<(f64, FilmTotals)> {
        let at = radau::nodes().map(|node| self.from + node * self.length);
        let rates = at.map(|s| track.rate(self.segment, s));
        let h = radau::step(before, self.length, &rates)?;
        let mut added = FilmTotals::default();
        for (i, weight) in radau::weights().into_iter().enumerate() {
            let here = track.totals_rate(self.segment, at[i], h[i]);
            added = added.combined(&here, |sum, value| sum + weight * self.length * value);
        }
        Some((h[2], added))
    }

    /// As [`Step::take`], in `parts` equal parts.
    fn take_in(&self, track: &Track<'_>, before: f64, parts: usize) -> Option<(f64, FilmTotals)> {
        let length = self.length / parts as f64;
        let mut h = before;
        let mut added = FilmTotals::default();
        for part in 0..parts {
            let step = Step {
                segment: self.segment,
                from: self.from + part as f64 * length,
                length,
            };
            let (next, more) = step.take(track, h)?;
            h = next;
            added = added.combined(&more, |a, b| a + b);
        }
        Some((h, added))
    }
}

/// Steps whose halving changes neither the thickness nor any total so far by more than `tolerance`, each step by itself.
///
/// Every total counts: heat into the ice has a root's singularity behind each station where the pressure's slope changes, and melting
/// and freezing a kink where one goes over into the other, which thickness and drag do not feel.
fn grade(track: &Track<'_>, tolerance: f64) -> Result<Vec<Step>, Error> {
    let last = track.segment(track.segments() - 1)[1];
    let shortest = 1e-13 * last;
    let mut steps = Vec::new();
    let (mut h, mut wished) = (0.0, last);
    let mut totals = FilmTotals::default();
    let heats = track.heats();
    for segment in 0..track.segments() {
        let [mut from, to] = track.segment(segment);
        while from < to {
            let left = to - from;
            let whole = wished >= 0.999 * left;
            let length = if whole {
                left
            } else {
                wished.min(0.5 * left).max(shortest)
            };
            let step = Step {
                segment,
                from,
                length,
            };
            let (whole_step, halved) = (step.take(track, h), step.take_in(track, h, 2));
            let mut error = f64::INFINITY;
            if let (Some(one), Some(two)) = (&whole_step, &halved) {
                let so_far = totals.combined(&two.1, |a, b| a + b);
                let changed = one.1.difference(&two.1);
                let of_totals = changed.largest_share(&so_far, heats[0], heats[1]);
                let of_thickness = (one.0 - two.0).abs() / two.0;
                // What is no number is no small error.
                error = if of_totals >= of_thickness {
                    of_totals
                } else {
                    of_thickness
                };
            }
            let grown = 0.9 * (tolerance / error.max(1e-300)).powf(1.0 / 6.0);
            wished = length * grown.clamp(0.2, 5.0);
            match halved {
                Some((next, added)) if error <= tolerance || length <= shortest => {
                    h = next;
                    totals = totals.combined(&added, |a, b| a + b);
                    from = if whole { to } else { from + length };
                    steps.push(step);
                }
                _ if length <= shortest || !wished.is_finite() => {
                    return Err(stopped(steps.len(), error, tolerance));
                }
                _ => {}
            }
            if steps.len() > MOST_STEPS {
                return Err(stopped(steps.len(), error, tolerance));
            }
        }
    }
    Ok(steps)
}

/// The film on given steps: thickness at the end of each segment, and the totals.
struct Sweep {
    ends: Vec<f64>,
    totals: FilmTotals,
}

fn sweep(track: &Track<'_>, steps: &[Step], parts: usize) -> Result<Sweep, Error> {
    let mut ends = vec![0.0; track.segments()];
    let mut totals = FilmTotals::default();
    let mut h = 0.0;
    for (done, step) in steps.iter().enumerate() {
        let (next, added) = step
            .take_in(track, h, parts)
            .ok_or_else(|| stopped(done, f64::INFINITY, 0.0))?;
        h = next;
        ends[step.segment] = h;
        totals = totals.combined(&added, |a, b| a + b);
    }
    totals.friction = totals.viscous_drag / totals.load;
    totals.mean_thickness /= totals.area;
    Ok(Sweep { ends, totals })
}

fn stopped(iterations: usize, residual: f64, tolerance: f64) -> Error {
    Error::NotConverged {
        what: "step of the melt film",
        iterations,
        residual,
        tolerance,
    }
}
