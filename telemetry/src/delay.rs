//! Delays of loggers against the clock of the runs, estimated from relations between channels.

use std::collections::BTreeMap;

use kufe_sled::Saturation;
use serde::Serialize;

use crate::error::Error;
use crate::mapping::{ClockWord, Mapping, PlannedRun};
use crate::relation::{Kind, Pair, Place, Relation, Series, Sides, pairs};

/// A logger's clock relative to that of the runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LoggerClock {
    /// Source of the delay: "the runs'", "shared", "stated" or "found" (estimated).
    #[serde(rename = "clock")]
    pub source: &'static str,
    /// Delay: time of an event in this clock less that in the runs' clock [s].
    pub delay_s: f64,
    /// Standard error of an estimated delay [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_sd_s: Option<f64>,
    /// Further delays that an estimate includes and its standard error does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_includes: Option<&'static str>,
    /// The relations that the delay was estimated from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub relations: Vec<Relation>,
}

/// The clock of every logger of a run, and remarks. The delay is 0 for the lead, else stated or
/// estimated.
///
/// A delay is estimated from relations to loggers whose clocks are known: the same column in both,
/// and the motion of a rigid body:
///
/// ```text
/// dv/dt = a_x + g_x + x (q^2 + r^2) - z (dq/dt + p r)    g_x from the integrated rates, x and z fitted
/// a_y = r v - d(alpha v)/dt + x dr/dt         x the position of the accelerometer
/// a_z = g - q v - x dq/dt
/// ```
///
/// A rate or an acceleration in both may be of rotated sensors: the other axes are fitted too. The
/// stated error includes an unknown position (0.2 m divided by the speed) and unmeasured slip
/// (0.03 s).
///
/// # Errors
/// [`Error::Clock`] if a logger has its own clock and its delay cannot be estimated.
pub(crate) fn align(
    mapping: &Mapping,
    planned: &PlannedRun,
    series: &[&Series],
) -> Result<(BTreeMap<String, LoggerClock>, Vec<String>), Error> {
    let (mut clocks, mut remarks) = (BTreeMap::new(), Vec::new());
    let mut open: Vec<&str> = Vec::new();
    for (name, logger) in &mapping.logger {
        let stated = planned.delay_s.get(name).copied().or(logger.delay_s);
        let (source, delay_s) = match (stated, logger.clock) {
            (Some(delay), _) => ("stated", delay),
            (None, _) if name == mapping.lead() => ("the runs'", 0.0),
            (None, ClockWord::Shared) => ("shared", 0.0),
            (None, ClockWord::Own) => {
                open.push(name);
                continue;
            }
        };
        let clock = LoggerClock {
            source,
            delay_s,
            ..LoggerClock::default()
        };
        clocks.insert(name.clone(), clock);
    }
    if open.is_empty() {
        return Ok((clocks, remarks));
    }
    let series: Vec<Series> = series.iter().map(|own| without_saturation(own)).collect();
    let place = |column: &str| {
        let [x, ..] = mapping.channels.get(column)?.place_m?;
        Some(x)
    };
    let mut known: Vec<Series> = Vec::new();
    let add = |name: &str, delay_s: f64, known: &mut Vec<Series>| {
        let own = series.iter().filter(|own| own.logger == name);
        known.extend(own.cloned().map(|mut own| {
            own.time.iter_mut().for_each(|t| *t -= delay_s);
            own
        }));
    };
    for (name, clock) in &clocks {
        add(name, clock.delay_s, &mut known);
    }
    // The clock with the smallest error first: other loggers may have a closer relation to it than
    // to those that are known already.
    while !open.is_empty() {
        let estimate = |name: &&str| {
            let late: Vec<&Series> = series.iter().filter(|own| own.logger == **name).collect();
            delay(&late, &known, &place, mapping.logger[*name].largest_delay_s)
        };
        let (mut found, mut reasons) = (Vec::new(), Vec::new());
        for (at, estimate) in open.iter().map(estimate).enumerate() {
            match estimate {
                Ok((clock, odd)) => found.push((at, clock, odd)),
                Err(reason) => reasons.push(reason),
            }
        }
        let by_error = |a: &LoggerClock, b: &LoggerClock| {
            let error = |clock: &LoggerClock| clock.delay_sd_s.unwrap_or(f64::INFINITY);
            error(a).total_cmp(&error(b))
        };
        let best = found
            .into_iter()
            .min_by(|(_, a, _), (_, b, _)| by_error(a, b));
        let Some((at, clock, odd)) = best else {
            return Err(Error::Clock {
                run: planned.name.clone(),
                logger: open[0].to_string(),
                reason: format!(
                    "{}; expected a channel that another logger has too (logger.{}.also), its delay_s, or clock = \"shared\"",
                    reasons[0], open[0]
                ),
            });
        };
        let name = open.remove(at);
        add(name, clock.delay_s, &mut known);
        let named = |text| format!("run {}: logger {name}: {text}", planned.name);
        remarks.extend(odd.into_iter().map(named));
        clocks.insert(name.to_string(), clock);
    }
    Ok((clocks, remarks))
}

/// Largest cutoff frequency of the low pass [Hz]: rigid motion of the sled is below, vibration
/// above.
const MAX_CUTOFF_HZ: f64 = 10.0;

/// Ratio of the rate of compared samples to the cutoff frequency.
const SAMPLES_PER_CUTOFF: f64 = 5.0;

/// Largest cutoff frequency for the longitudinal relation [Hz]: the slope of the track changes as
/// slowly as its curves.
const MAX_SLOPE_CUTOFF_HZ: f64 = 2.0;

/// Smallest correlation of a valid relation.
const MIN_CORRELATION: f64 = 0.5;

/// Smallest multiple correlation with several columns, some combination of which always fits in
/// part.
const MIN_MULTIPLE_CORRELATION: f64 = 0.85;

/// A series without saturated samples, which are at an end of the sensor's range.
fn without_saturation(series: &Series) -> Series {
    let mut series = series.clone();
    let values = &mut series.values;
    // A sensor has two end stops.
    for _ in 0..2 {
        let Some(stop) = Saturation::of(values) else {
            break;
        };
        let mut begin = 0;
        while begin < values.len() {
            let rest = values[begin..].iter();
            let length = rest.take_while(|x| **x == stop.at).count();
            if length >= MIN_SATURATED {
                let end = (begin + length + 1).min(values.len());
                values[begin.saturating_sub(1)..end].fill(f64::NAN);
            }
            begin += length.max(1);
        }
    }
    series
}

/// Smallest number of consecutive samples at an end of the range that count as saturated.
const MIN_SATURATED: usize = 4;

/// Estimates the clock of a logger, with remarks: first a common delay of all relations, then the
/// delay of each relation near it, then their mean, weighted by their errors.
///
/// # Errors
/// The reason why there is no estimate.
fn delay(
    late: &[&Series],
    known: &[Series],
    place: &Place,
    within: Option<f64>,
) -> Result<(LoggerClock, Vec<String>), String> {
    let pairs = pairs(late, known, place);
    if pairs.is_empty() {
        return Err("no channels of it are related to those of the others".to_string());
    }
    // The band of a relation is limited by its slower side.
    let cutoff = |pair: &Pair| {
        let rate = pair.rate_hz();
        let most = match pair.kind {
            Kind::Longitudinal => MAX_SLOPE_CUTOFF_HZ,
            _ => MAX_CUTOFF_HZ,
        };
        rate.map_or(0.0, |rate| (0.4 * rate).min(most))
    };
    let cutoffs: Vec<f64> = pairs.iter().map(cutoff).collect();
    let (guess, first) = common_delay(&pairs, &cutoffs, within)?;
    let mut relations: Vec<Relation> = Vec::new();
    let mut poor = Vec::new();
    for (pair, cutoff) in pairs.iter().zip(&cutoffs) {
        let Some(refined) = refine_in_bands(pair, guess, *cutoff) else {
            continue;
        };
        let least = match pair.kind {
            Kind::Longitudinal => MIN_MULTIPLE_CORRELATION,
            _ => MIN_CORRELATION,
        };
        if refined.correlation < least {
            let (name, rho) = (&pair.name, refined.correlation);
            poor.push(format!(
                "\"{name}\" correlates by {rho:.2}, expected {least} or more"
            ));
        } else {
            relations.push(Relation {
                relation: pair.name.clone(),
                delay_s: refined.delay_s,
                delay_sd_s: refined.sd_s.hypot(pair.doubt_s).max(1e-9),
                correlation: refined.correlation,
            });
        }
    }
    if relations.is_empty() {
        let alike = format!("no relation fits best near {guess:+.2} s, where all together do");
        return Err(if poor.is_empty() {
            alike
        } else {
            poor.join(", ")
        });
    }
    let (clock, mut remarks) = weighted_mean(relations);
    // A column with the opposite sign fits at no delay: it is reported.
    let same = pairs.iter().zip(&cutoffs);
    for (pair, cutoff) in same.filter(|(pair, _)| pair.kind == Kind::Same) {
        let rho = pair.sides(first.min(*cutoff)).and_then(|sides| {
            let both = matched(&sides, clock.delay_s, SAMPLES_PER_CUTOFF * first)?;
            Some(both.correlation(sides.counted()))
        });
        if let Some(rho) = rho.filter(|rho| *rho < -MIN_OPPOSITE_CORRELATION) {
            remarks.push(format!(
                "\"{}\" correlates by {rho:.2}: sign = -1 is missing in one of the two",
                pair.name
            ));
        }
    }
    Ok((clock, remarks))
}

/// Smallest negative correlation, in magnitude, at which a column has the opposite sign in one
/// logger.
const MIN_OPPOSITE_CORRELATION: f64 = 0.9;

/// Smallest cutoff frequency of the low pass [Hz].
const MIN_CUTOFF_HZ: f64 = 0.5;

/// The delay of one relation. The cutoff frequency is doubled from [`MIN_CUTOFF_HZ`] up to
/// `cutoff_hz`, and the estimate with the smallest error is kept: a wide band is more accurate for
/// clean signals, a narrow band for noisy ones.
fn refine_in_bands(pair: &Pair, guess: f64, cutoff_hz: f64) -> Option<DelayEstimate> {
    let mut cutoff = MIN_CUTOFF_HZ.min(cutoff_hz);
    let mut best: Option<DelayEstimate> = None;
    loop {
        let from = best.map_or(guess, |best| best.delay_s);
        let refined = refine(
            &pair.sides(cutoff)?,
            from,
            SAMPLES_PER_CUTOFF * cutoff,
            1.0 / cutoff,
        );
        let better = |refined: &DelayEstimate| best.is_none_or(|best| refined.sd_s < best.sd_s);
        best = refined.filter(better).or(best);
        if cutoff >= cutoff_hz {
            return best;
        }
        cutoff = (2.0 * cutoff).min(cutoff_hz);
    }
}

/// A first delay from all relations together [s], and the cutoff frequency of that search [Hz].
fn common_delay(
    pairs: &[Pair],
    cutoffs: &[f64],
    within: Option<f64>,
) -> Result<(f64, f64), String> {
    let cutoff = cutoffs.iter().copied().fold(0.0, f64::max);
    let both = || pairs.iter().zip(cutoffs);
    let spans = both().filter_map(|(pair, cutoff)| Some(pair.sides(*cutoff)?.spans()));
    let longest = spans.max_by(|a, b| length(a).total_cmp(&length(b)));
    let Some(longest) = longest.filter(|_| cutoff > 0.0) else {
        return Err("its channels are too short".to_string());
    };
    // The rate of the first search is limited by its cost.
    let rate = (0.5 * SAMPLES_PER_CUTOFF * cutoff).min(MAX_SAMPLES / length(&longest).max(1e-3));
    let sides = both().filter_map(|(pair, cutoff)| pair.sides(cutoff.min(0.4 * rate)));
    let delay = search(&sides.collect::<Vec<Sides>>(), rate, within)?;
    Ok((delay, 0.4 * rate))
}

fn length(spans: &[[f64; 2]; 2]) -> f64 {
    let lengths = spans.map(|span| span[1] - span[0]);
    lengths.into_iter().fold(0.0, f64::max)
}

/// The mean of the relations' delays, weighted by inverse variance. Where relations disagree, the
/// error of the mean is multiplied by the ratio of their scatter to their errors (Birge 1932).
fn weighted_mean(relations: Vec<Relation>) -> (LoggerClock, Vec<String>) {
    let weight = |one: &Relation| one.delay_sd_s.powi(-2);
    let sum: f64 = relations.iter().map(weight).sum();
    let weighted = relations.iter().map(|one| one.delay_s * weight(one));
    let delay_s = weighted.sum::<f64>() / sum;
    let sd_s = sum.sqrt().recip();
    let deviation = |one: &Relation| one.delay_s - delay_s;
    let far = |one: &&Relation| deviation(one).abs() > 4.0 * f64::hypot(one.delay_sd_s, sd_s);
    let outliers = relations.iter().filter(far);
    let outliers = outliers.map(|one| format!("\"{}\" {:+.4} s", one.relation, one.delay_s));
    let outliers: Vec<String> = outliers.collect();
    let (mut birge_ratio, mut remarks) = (1.0, Vec::new());
    if !outliers.is_empty() {
        let square = |one: &Relation| (deviation(one) / one.delay_sd_s).powi(2);
        let squares: f64 = relations.iter().map(square).sum();
        birge_ratio = (squares / (relations.len() as f64 - 1.0)).sqrt();
        let outliers = outliers.join(", ");
        remarks.push(format!(
            "its delay of {delay_s:+.4} s is not that of {outliers}"
        ));
    }
    let clock = LoggerClock {
        source: "found",
        delay_s,
        delay_sd_s: Some(sd_s * birge_ratio),
        delay_includes: Some("the lag of the sensors that it was found from"),
        relations,
    };
    (clock, remarks)
}

/// Largest number of samples of a side in the first search; its cost is quadratic in this number.
const MAX_SAMPLES: f64 = 1200.0;

/// Smallest number of pairs of samples at a delay.
const MIN_PAIRS: usize = 60;

/// Smallest ratio of the overlap of both sides to the shorter side.
const MIN_OVERLAP: f64 = 0.3;

/// Ratio of the second best score to the best above which the delay is ambiguous.
const MAX_SECOND_SCORE: f64 = 0.8;

/// The delay with the largest score: the sum of `-n ln(1 - rho^2)` over relations with a positive
/// correlation rho of n samples. Channels with the right sign correlate positively.
///
/// `within` bounds the delay [s]. The result is accurate to one step of the search.
///
/// # Errors
/// The reason why there is no estimate.
fn search(sides: &[Sides], rate_hz: f64, within: Option<f64>) -> Result<f64, String> {
    let nothing = "its channels do not move as those of the others do, at any delay (one of the other sign needs sign = -1)";
    let step = 1.0 / rate_hz;
    // Range of delays for which any two sides overlap.
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for side in sides {
        let [mut late, mut known] = side.spans();
        if side.ahead(1.0) < 0.0 {
            std::mem::swap(&mut late, &mut known);
        }
        let [first, last] = [late[0] - known[1], late[1] - known[0]];
        range = [range[0].min(first), range[1].max(last)];
    }
    if let Some(most) = within {
        range = [range[0].max(-most), range[1].min(most)];
    }
    let lags = ((range[1] - range[0]) / step).floor();
    if !(0.0..1e6).contains(&lags) {
        return Err(nothing.to_string());
    }
    let delay = |lag: usize| range[0] + lag as f64 * step;
    let tables: Vec<Sampled> = sides.iter().map(|side| Sampled::of(side, step)).collect();
    let score = |lag: usize| -> f64 {
        let both = sides.iter().zip(&tables);
        let fits = both.filter_map(|(side, table)| table.fit(side.ahead(delay(lag))));
        fits.map(|(pairs, rho)| -pairs * (1.0 - rho.clamp(0.0, 0.999_999).powi(2)).ln())
            .sum()
    };
    let scores: Vec<f64> = (0..=lags as usize).map(score).collect();
    let by_score = |a: &usize, b: &usize| scores[*a].total_cmp(&scores[*b]);
    let best = (0..scores.len()).max_by(by_score);
    let best = best.filter(|best| scores[*best] > 0.0).ok_or(nothing)?;
    // The peak around the best score, down to half of it.
    let below = |lag: &usize| scores[*lag] < 0.5 * scores[best];
    let from = (0..best).rev().find(below).unwrap_or(0);
    let to = (best..scores.len()).find(below).unwrap_or(scores.len());
    let others = (0..from).chain(to..scores.len());
    match others.max_by(by_score) {
        Some(second) if scores[second] > MAX_SECOND_SCORE * scores[best] => {
            let (first, second) = (delay(best), delay(second));
            Err(format!("{first:.2} s and {second:.2} s fit alike"))
        }
        _ => Ok(delay(best)),
    }
}

/// Both sides, each sampled at uniform times of its clock; NaN in gaps.
struct Sampled {
    lhs: Vec<Vec<f64>>,
    rhs: Vec<f64>,
    /// First time of the left side less that of the right side [s].
    offset: f64,
    step: f64,
}

impl Sampled {
    fn of(side: &Sides, step: f64) -> Sampled {
        let [lhs, rhs] = side.spans();
        let offset = lhs[0] - rhs[0];
        let times = |span: [f64; 2]| {
            let count = ((span[1] - span[0]) / step) as usize + 1;
            (0..count).map(move |i| span[0] + i as f64 * step)
        };
        let mut columns = vec![Vec::new(); side.counted()];
        for t in times(lhs) {
            let values = side.lhs(t);
            for (k, column) in columns.iter_mut().enumerate() {
                column.push(values.as_ref().map_or(f64::NAN, |values| values[k][0]));
            }
        }
        // A speed in the other clock varies slowly: here its delay is ignored, `refine` uses it.
        let value = |t| side.rhs(t, offset).map_or(f64::NAN, |[x, _]| x);
        Sampled {
            lhs: columns,
            rhs: times(rhs).map(value).collect(),
            offset,
            step,
        }
    }

    /// Number of pairs and correlation with the right side shifted by `ahead` [s].
    fn fit(&self, ahead: f64) -> Option<(f64, f64)> {
        // Sample j of the right side belongs to sample j + shift of the other.
        let shift = ((ahead - self.offset) / self.step).round() as i64;
        let from = (-shift).max(0);
        let to = (self.lhs[0].len() as i64 - shift).min(self.rhs.len() as i64);
        let at = |j: &i64| (j + shift) as usize;
        let both = |j: &i64| !(self.lhs[0][at(j)].is_nan() || self.rhs[*j as usize].is_nan());
        let shared: Vec<i64> = (from..to).filter(both).collect();
        let shorter = self.lhs[0].len().min(self.rhs.len()) as f64;
        let n = shared.len() as f64;
        if n < MIN_PAIRS as f64 || n < MIN_OVERLAP * shorter {
            return None;
        }
        let column = |column: &Vec<f64>| [shared.iter().map(|j| column[at(j)]).collect(), vec![]];
        let rhs = shared.iter().map(|j| self.rhs[*j as usize]).collect();
        let lhs: Vec<_> = self.lhs.iter().map(column).collect();
        let rho = Matched::new(lhs, [rhs, vec![]]).correlation(self.lhs.len());
        rho.is_finite().then_some((n, rho))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Both sides with their derivatives at common times, less their means. The columns of the left
/// side are orthonormal.
struct Matched {
    lhs: Vec<[Vec<f64>; 2]>,
    rhs: [Vec<f64>; 2],
}

/// Ratio of the remaining norm of a column to its norm below which it is rounding.
const ROUNDING: f64 = 1e-6;

impl Matched {
    fn new(mut lhs: Vec<[Vec<f64>; 2]>, mut rhs: [Vec<f64>; 2]) -> Matched {
        let sizes: Vec<f64> = lhs.iter().map(|[x, _]| dot(x, x)).collect();
        for x in lhs.iter_mut().chain([&mut rhs]).flatten() {
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            x.iter_mut().for_each(|x| *x -= mean);
        }
        // Gram-Schmidt orthogonalisation.
        for (k, size) in sizes.into_iter().enumerate() {
            let (before, rest) = lhs.split_at_mut(k);
            let own = &mut rest[0];
            for other in before {
                let share = dot(&other[0], &own[0]);
                for (own, other) in own.iter_mut().zip(other) {
                    own.iter_mut()
                        .zip(other)
                        .for_each(|(x, y)| *x -= share * *y);
                }
            }
            let square = dot(&own[0], &own[0]);
            let factor = if square > ROUNDING.powi(2) * size {
                square.sqrt().recip()
            } else {
                0.0
            };
            own.iter_mut().flatten().for_each(|x| *x *= factor);
        }
        Matched { lhs, rhs }
    }

    /// Projection of `y` onto the columns of the left side, and its derivative.
    fn project(&self, y: &[f64]) -> [Vec<f64>; 2] {
        let mut sum = [vec![0.0; y.len()], vec![0.0; y.len()]];
        for column in &self.lhs {
            let share = dot(&column[0], y);
            for (sum, column) in sum.iter_mut().zip(column) {
                sum.iter_mut()
                    .zip(column)
                    .for_each(|(sum, x)| *sum += share * x);
            }
        }
        sum
    }

    /// Correlation of the right side with its projection onto the first `counted` columns; signed
    /// with a single column.
    fn correlation(&self, counted: usize) -> f64 {
        let rhs = &self.rhs[0];
        let shares = self.lhs[..counted].iter().map(|[x, _]| dot(x, rhs));
        let shares: Vec<f64> = shares.collect();
        let size = match shares[..] {
            [share] => share,
            _ => dot(&shares, &shares).sqrt(),
        };
        size / dot(rhs, rhs).sqrt()
    }
}

/// Largest number of Newton steps, which converge quadratically.
const MAX_STEPS: usize = 30;

/// Longest time over which residuals are assumed to be correlated [s].
const CORRELATION_TIME_S: f64 = 2.0;

/// The estimated delay of one relation.
#[derive(Clone, Copy)]
struct DelayEstimate {
    delay_s: f64,
    sd_s: f64,
    correlation: f64,
}

/// Fits `lhs(t) = a + b rhs(t - ahead)` over a, b and the delay from an initial guess.
///
/// The standard error accounts for the autocorrelation of the residuals (Newey and West 1987,
/// Bartlett weights over 2 s or, where that error is larger, over a period of the cutoff
/// frequency). `None` if the fit departs from the guess by more than `reach_s`,
/// or too few samples overlap.
fn refine(sides: &Sides, guess_s: f64, rate_hz: f64, reach_s: f64) -> Option<DelayEstimate> {
    let mut delay = guess_s;
    let mut last = None;
    for _ in 0..MAX_STEPS {
        let next = newton_step(sides, delay, rate_hz)?;
        let step = next.delay_s - delay;
        // Far from the best fit a Newton step is too long.
        delay += step.clamp(-0.25 * reach_s, 0.25 * reach_s);
        if (delay - guess_s).abs() > reach_s {
            return None;
        }
        last = Some(DelayEstimate {
            delay_s: delay,
            ..next
        });
        if step.abs() < 1e-9 {
            break;
        }
    }
    last
}

/// One Newton step. Let `a` be the projection of `rhs` onto the columns of `lhs`. The product of
/// `a` and `rhs` is largest at the delay, where the product of `a` and the derivative of `rhs` is
/// 0. The derivative of the latter with respect to the delay is, by integration by parts, the
/// product of the derivatives of `a` and `rhs`, less the squared norm of the projected derivative
/// of `rhs`. Independent noise of the two sides does not contribute to its mean:
///
/// ```text
/// change = a' . rhs' - |P rhs'|^2,   var(delay) = sum over lags of w(lag) u(t) u(t + lag) / change^2
/// u = (rhs' - P rhs') (a - b rhs),   w = 1 - lag / memory (Bartlett)
/// ```
///
/// The Newton steps end at a maximum of the product, where noise has increased `change`. Where
/// noise dominates the derivatives, this maximum is one of the noise, and its error would be
/// understated. `None` if `a'` and `rhs'` correlate by less than [`MIN_CORRELATION`].
fn newton_step(sides: &Sides, delay: f64, rate_hz: f64) -> Option<DelayEstimate> {
    let sums = matched(sides, delay, rate_hz)?;
    let [rhs, slope] = &sums.rhs;
    let [near, near_slope] = sums.project(rhs);
    let [projected_slope, _] = sums.project(slope);
    let correlation = sums.correlation(sides.counted());
    let change = dot(&near_slope, slope) - dot(&projected_slope, &projected_slope);
    let slope_correlation =
        dot(&near_slope, slope) / (dot(&near_slope, &near_slope) * dot(slope, slope)).sqrt();
    if !(correlation > 0.0 && change > 0.0 && slope_correlation > MIN_CORRELATION) {
        return None;
    }
    let b = dot(&near, rhs) / dot(rhs, rhs);
    let residual: Vec<f64> = near.iter().zip(rhs).map(|(a, rhs)| a - b * rhs).collect();
    let slopes = slope
        .iter()
        .zip(&projected_slope)
        .map(|(d, projected)| d - projected);
    let scores: Vec<f64> = slopes.zip(&residual).map(|(d, e)| d * e).collect();
    let of_memory = |memory: usize| -> f64 {
        let lags = 1..=memory.min(scores.len() - 1);
        let bartlett = |lag: usize| 1.0 - lag as f64 / (memory + 1) as f64;
        let products = lags.map(|lag| 2.0 * bartlett(lag) * dot(&scores, &scores[lag..]));
        dot(&scores, &scores) + products.sum::<f64>()
    };
    // Estimates over a long time are small by chance in short runs.
    let long = (CORRELATION_TIME_S * rate_hz) as usize;
    let variance = of_memory(long).max(of_memory(SAMPLES_PER_CUTOFF as usize));
    let shift = -dot(&residual, slope) / change;
    Some(DelayEstimate {
        // The shift moves `rhs`, which is early where the clock of `lhs` is late.
        delay_s: delay + sides.ahead(shift),
        sd_s: variance.max(0.0).sqrt() / change,
        correlation,
    })
}

/// Both sides at their common times; `None` if these are too few.
fn matched(sides: &Sides, delay: f64, rate_hz: f64) -> Option<Matched> {
    let ahead = sides.ahead(delay);
    let [lhs, rhs] = sides.spans();
    let from = lhs[0].max(rhs[0] + ahead);
    let to = lhs[1].min(rhs[1] + ahead);
    let count = ((to - from) * rate_hz).floor();
    if !(20.0..1e7).contains(&count) {
        return None;
    }
    let mut columns = vec![[Vec::new(), Vec::new()]; sides.columns() + 1];
    for i in 0..=count as usize {
        let t = from + i as f64 / rate_hz;
        if let (Some(lhs), Some(rhs)) = (sides.lhs(t), sides.rhs(t - ahead, ahead)) {
            for (column, both) in columns.iter_mut().zip(lhs.into_iter().chain([rhs])) {
                column
                    .iter_mut()
                    .zip(both)
                    .for_each(|(x, value)| x.push(value));
            }
        }
    }
    let rhs = columns.pop()?;
    (rhs[0].len() >= 20).then(|| Matched::new(columns, rhs))
}
