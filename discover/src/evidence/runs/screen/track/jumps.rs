//! Jumps of the speed's reading at a threshold, detected against accelerometer and slope.
//!
//! With r the track channel's residual of a run and e its integral over time, the error of the
//! speed, a crossing of the threshold x at t gives
//!
//! ```text
//! e(t) = sum r dt       h = +- sum k_j e(t + j dt)       k odd, orthogonal to a linear trend
//! ```
//!
//! Survey errors that are constant or linear around a crossing do not enter h. Runs that cross at
//! the same place share the survey error there: the variance of a place's mean is `a + b / n`, both
//! pooled over all thresholds. Survey errors may be much larger at a few places (at the ends of
//! curves drivers leave their lines up the banks). The mean of K places has the tails of Student's
//! t with the excess kurtosis e / K and the degrees of freedom
//!
//! ```text
//! 4 + 6 K / e        e = (mean m^4 - 3 (mean m^2)^2) / a^2
//! ```

use std::collections::{BTreeMap, BTreeSet};

use kufe_sled::effects::{Channel, Custom, Sensor};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::laws::formulas::shapes::rounded;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::candidate::Candidate;
use crate::procedure::rules::RunRules;

/// A jump of the speed's reading.
pub struct Jump {
    /// Threshold [m/s].
    pub above: f64,
    /// Size [m/s].
    pub size: f64,
    /// Standard error [m/s].
    pub error: f64,
    /// Two-sided p-value, times the number of thresholds.
    pub p_value: f64,
}

/// Step of the thresholds [m/s].
const STEP: f64 = 0.1;
const MOST: usize = 2000;
/// Time on either side over which the low pass of the signals spreads a jump [s].
const SPREAD_S: f64 = 0.05;
/// Thresholds within this distance share crossings [m/s].
const NEAR: f64 = 1.5;
/// Fewest places of a threshold, and fewest crossings.
const LEAST_PLACES: usize = 3;
const LEAST_CROSSINGS: usize = 6;

/// Error of a run's speed, and the speed corrected for it in the middle of a window: it passes a
/// jump half way up and has no noise of its own.
struct OnRun<'a> {
    frame: &'a Frame,
    kernel: Kernel,
    gained: Vec<f64>,
    passed: Vec<f64>,
}

/// Crossings of one threshold, by track and place.
type Crossings<'a> = BTreeMap<(&'a str, i64), Vec<f64>>;

impl<'a> OnRun<'a> {
    fn new(model: &ResidualModel, frame: &'a Frame, reach_s: f64) -> Self {
        let ([residual, read], dt) = (model.track_and_speed(frame), frame.sample_s());
        let gained = residual.iter().scan(0.0, |sum, r| {
            *sum += r * dt;
            Some(*sum)
        });
        let (gained, kernel): (Vec<f64>, _) = (gained.collect(), Kernel::new(dt, reach_s));
        let reach = kernel.weights.len();
        let passed = read.iter().zip(&gained).enumerate().map(|(i, (v, own))| {
            let near = i.saturating_sub(reach)..(i + reach).min(gained.len());
            v - own + mean(&gained[near])
        });
        Self {
            passed: passed.collect(),
            gained,
            kernel,
            frame,
        }
    }

    /// Jumps at the crossings of `x`, with their places.
    fn crossings(&self, x: f64, width: f64) -> Vec<(i64, f64)> {
        let (v, taking) = (&self.passed, &self.frame.taking_part);
        let reach = self.kernel.weights.len();
        let mut out = Vec::new();
        for i in reach..v.len().saturating_sub(reach) {
            let up = v[i] > x;
            let both = || (1..reach).all(|j| (v[i + j] > x) == up && (v[i - 1 - j] > x) != up);
            let whole = || (i - reach..i + reach).all(|j| taking[j]);
            if (v[i - 1] > x) == up || !both() || !whole() {
                continue;
            }
            let weights = self.kernel.weights.iter().enumerate();
            let more: f64 = weights
                .map(|(j, k)| k * (self.gained[i + j] - self.gained[i - 1 - j]))
                .sum();
            let place = (self.frame.s[i] / width).floor() as i64;
            out.push((place, if up { more } else { -more }));
        }
        out
    }
}

/// Weights of the samples before a crossing; those after it have the opposite sign.
struct Kernel {
    weights: Vec<f64>,
}

impl Kernel {
    /// Least-squares weights of a jump on a linear trend; 0 within the spread of the low pass.
    fn new(sample_s: f64, reach_s: f64) -> Self {
        let count = |time: f64| (time / sample_s).round() as usize;
        let (reach, spread) = (count(reach_s).max(4), count(SPREAD_S));
        let u: Vec<f64> = (spread..reach).map(|j| j as f64 + 0.5).collect();
        let sum: f64 = u.iter().sum();
        let square: f64 = u.iter().map(|u| u * u).sum();
        let line_free: Vec<f64> = u.iter().map(|u| 1.0 - u * sum / square).collect();
        let whole: f64 = line_free.iter().sum();
        let near = (0..spread).map(|_| 0.0);
        Self {
            weights: near.chain(line_free.iter().map(|k| k / whole)).collect(),
        }
    }
}

/// The most significant jump, if any threshold is crossed often enough.
pub fn find(model: &ResidualModel, frames: &[Frame], rules: &RunRules) -> Option<Jump> {
    let runs: Vec<OnRun> = frames
        .par_iter()
        .map(|frame| OnRun::new(model, frame, rules.jump_reach_s))
        .collect();
    let mut speeds: Vec<f64> = runs.iter().flat_map(|run| run.passed.clone()).collect();
    speeds.retain(|v| v.is_finite());
    speeds.sort_by(f64::total_cmp);
    let [low, high] = [0.01, 0.99].map(|share| {
        let last = speeds.len().saturating_sub(1);
        speeds.get((share * last as f64) as usize).copied()
    });
    let (low, high) = (low?, high?);
    let count = ((high - low) / STEP).min(MOST as f64) as usize;
    let at = |x: f64| -> Crossings {
        let mut all = Crossings::new();
        for run in &runs {
            for (place, h) in run.crossings(x, rules.track_bin_m) {
                let key = (run.frame.track.as_str(), place);
                all.entry(key).or_default().push(h);
            }
        }
        all
    };
    let examined: Vec<(f64, Crossings)> = (0..=count)
        .into_par_iter()
        .map(|k| low + k as f64 * STEP.max((high - low) / MOST as f64))
        .map(|x| (x, at(x)))
        .filter(|(_, all)| {
            all.len() >= LEAST_PLACES
                && all.values().map(Vec::len).sum::<usize>() >= LEAST_CROSSINGS
        })
        .collect();
    let (first, _) = Scatter::of(&examined, None)?.strongest(&examined)?;
    // Thresholds near the jump are excluded from the scatter.
    let scatter = Scatter::of(&examined, Some(first.passed))?;
    let (best, crossed) = scatter.strongest(&examined)?;
    let window_m = 2.0 * rules.jump_reach_s * best.passed;
    let [error, freedom] = scatter.error_and_freedom(crossed, window_m / rules.track_bin_m);
    let law = StudentsT::new(0.0, 1.0, freedom).ok()?;
    let by_chance = 2.0 * law.cdf(-(best.size / error).abs());
    Some(Jump {
        above: best.passed - 0.5 * best.size,
        size: best.size,
        error,
        p_value: (by_chance * examined.len() as f64).min(1.0),
    })
}

/// Variances of crossings within a place and of places.
struct Scatter {
    within: f64,
    between: f64,
    /// Degrees of freedom of the first.
    crossings: f64,
    /// Degrees of freedom of the second, and the excess kurtosis over places.
    places: f64,
    excess: f64,
}

/// The mean jump at a threshold, with its standard error for independent places.
struct Mean {
    passed: f64,
    size: f64,
    error: f64,
}

impl Scatter {
    /// Pooled over all thresholds that are not near `near`.
    fn of(examined: &[(f64, Crossings)], near: Option<f64>) -> Option<Self> {
        let apart = |x: f64| near.is_none_or(|near| (x - near).abs() > NEAR);
        let apart = || examined.iter().filter(|(x, _)| apart(*x));
        let [mut squares, mut crossings, mut means, mut fourth, mut count] = [0.0; 5];
        let mut places = BTreeSet::new();
        for (place, values) in apart().flat_map(|(_, all)| all) {
            let m = mean(values);
            squares += values.iter().map(|h| (h - m).powi(2)).sum::<f64>();
            crossings += values.len() as f64 - 1.0;
            means += m * m;
            fourth += m.powi(4);
            count += 1.0;
            // Places within a window are one.
            places.insert((place.0, place.1 / 2));
        }
        if crossings < LEAST_CROSSINGS as f64 {
            return None;
        }
        let within = squares / crossings;
        let shared = apart().flat_map(|(_, all)| all.values());
        let noise: f64 = shared.map(|values| within / values.len() as f64).sum();
        let between = ((means - noise) / count).max(0.0);
        let excess = fourth / count - 3.0 * (means / count).powi(2);
        Some(Self {
            within,
            between,
            crossings,
            places: places.len() as f64,
            excess: excess.max(0.0) / between.powi(2).max(1e-300),
        })
    }

    /// The threshold with the most significant jump.
    fn strongest<'c, 'f>(
        &self,
        examined: &'c [(f64, Crossings<'f>)],
    ) -> Option<(Mean, &'c Crossings<'f>)> {
        let all = examined.iter().map(|(x, all)| (self.mean(*x, all), all));
        all.max_by(|(x, _), (y, _)| {
            (x.size / x.error)
                .abs()
                .total_cmp(&(y.size / y.error).abs())
        })
    }

    /// Standard error and degrees of freedom of a mean, with places within so many bins sharing
    /// their survey error, as those within one window do.
    ///
    /// The degrees of freedom are those of a sum of two variances (Welch 1947), with the tails of
    /// that of places.
    fn error_and_freedom(&self, all: &Crossings, bins: f64) -> [f64; 2] {
        let [mut weight, mut own] = [0.0; 2];
        // Joint weight of shared places, with the first of them.
        let mut shared: Vec<((&str, i64), f64)> = Vec::new();
        for ((track, place), values) in all {
            let noise = self.within / values.len() as f64;
            let w = 1.0 / (self.between + noise);
            own += w * w * noise;
            weight += w;
            match shared.last_mut() {
                Some(((other, first), sum))
                    if other == track && ((place - *first) as f64) < bins =>
                {
                    *sum += w;
                }
                _ => shared.push(((track, *place), w)),
            }
        }
        let squares: f64 = shared.iter().map(|(_, w)| w * w).sum();
        let of_places = self.between * squares;
        let tails = 4.0 + 6.0 * shared.len() as f64 / self.excess.max(1e-300);
        let of_places_alone = of_places.powi(2) / tails.min(self.places);
        let freedom = (of_places + own).powi(2) / (of_places_alone + own.powi(2) / self.crossings);
        [(of_places + own).sqrt() / weight, freedom]
    }

    /// The mean jump of one threshold over its places.
    fn mean(&self, passed: f64, all: &Crossings) -> Mean {
        let [mut sum, mut weight] = [0.0; 2];
        for values in all.values() {
            let w = 1.0 / (self.between + self.within / values.len() as f64);
            sum += w * mean(values);
            weight += w;
        }
        Mean {
            passed,
            size: sum / weight,
            error: 1.0 / weight.sqrt(),
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The effect of a jump: a speed sensor that reads more above a threshold. It rises over a third of
/// itself, so that the reading remains monotonic, and over the spread of the low pass.
pub fn law(jump: &Jump) -> Option<Candidate<Amplitude>> {
    const SHARP: f64 = 0.05;
    let width = rounded((jump.size.abs() / 3.0).max(SHARP), 2);
    let above = rounded(jump.above, 4);
    let text = format!("1 / (1 + exp(({above} - v_mps) / {width}))");
    let custom = Custom::new(Channel::Sensor(Sensor::Speed), &text, None)?;
    let limit = rounded(100.0 * jump.size.abs(), 1);
    let sizes = [jump.size.abs(), limit];
    Some(Candidate::law(&["v_mps"], custom, None, "m/s", sizes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_measures_a_jump_on_a_linear_trend() {
        let kernel = Kernel::new(0.02, 0.8);
        let (hidden, spread) = (0.03, 2);
        // The edge of the jump, spread by the low pass, is excluded.
        let gained = |j: i32| {
            let edge = if j < -spread {
                0.0
            } else if j > spread {
                1.0
            } else {
                0.7
            };
            4.0 - 0.002 * f64::from(j) + hidden * edge
        };
        let more = kernel.weights.iter().zip(0..);
        let more: f64 = more.map(|(k, j)| k * (gained(j + 1) - gained(-j))).sum();
        assert!((more - hidden).abs() < 1e-12, "{more}");
    }

    #[test]
    fn degrees_of_freedom_follow_the_source_of_the_scatter() {
        let at = |places: &[&[f64]]| -> Crossings {
            let all = places.iter().zip(0..);
            all.map(|(values, k)| (("a", 10 * k), values.to_vec()))
                .collect()
        };
        let scatter = |within, between| Scatter {
            within,
            between,
            crossings: 400.0,
            places: 20.0,
            excess: 0.0,
        };
        let three = at(&[&[1.0, 3.0], &[2.0], &[4.0]]);
        let near =
            |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).abs() < 1e-12 && (b - d).abs() < 1e-9;
        // Crossings of their own: the mean of four, and all that was pooled.
        let own = scatter(0.25, 0.0);
        assert!((own.mean(21.0, &three).size - 2.5).abs() < 1e-12);
        assert!(near(own.error_and_freedom(&three, 1.0), [0.25, 400.0]));
        // Places of their own: the mean of three; the degrees of freedom are those of the places.
        let mut shared = scatter(0.0, 0.75);
        assert!((shared.mean(21.0, &three).size - 8.0 / 3.0).abs() < 1e-12);
        assert!(near(shared.error_and_freedom(&three, 1.0), [0.5, 20.0]));
        // Two of the three within one window: five ninths of a variance in place of three.
        let shared_error = (0.75 * 5.0 / 9.0_f64).sqrt();
        assert!(near(
            shared.error_and_freedom(&three, 11.0),
            [shared_error, 20.0]
        ));
        // Student's t of 10 degrees has an excess of 1: the mean of two has half of it.
        shared.excess = 1.0;
        assert!(near(
            shared.error_and_freedom(&three, 11.0),
            [shared_error, 16.0]
        ));
    }

    #[test]
    fn variances_within_and_between_places_are_separated() {
        // Places at -2 and 2 with crossings of 1 to either side: a variance of 2 within, and of 4
        // less half of that between.
        let examined: Vec<(f64, Crossings)> = (0..40)
            .map(|k| {
                let middle = if k % 2 == 0 { 2.0 } else { -2.0 };
                let place = (("a", k), vec![middle - 1.0, middle + 1.0]);
                (10.0 + 0.1 * k as f64, Crossings::from([place]))
            })
            .collect();
        let scatter = Scatter::of(&examined, None).expect("crossings");
        assert!((scatter.within - 2.0).abs() < 1e-12 && (scatter.between - 3.0).abs() < 1e-12);
        assert_eq!((scatter.crossings, scatter.places), (40.0, 20.0));
        // Two values have no excess.
        assert_eq!(scatter.excess, 0.0);
    }
}
