//! Delays of loggers against the clock of the runs, found from what their channels share.

use std::collections::BTreeMap;

use kufe_sled::Saturation;
use serde::Serialize;

use crate::error::Error;
use crate::mapping::{ClockWord, Mapping, PlannedRun};
use crate::relation::{Kind, Pair, Place, Relation, Series, Sides, pairs};

/// A logger's clock relative to that of the runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LoggerClock {
    /// Whose it is: "the runs'", "shared", "stated" or "found".
    #[serde(rename = "clock")]
    pub source: &'static str,
    /// Its delay: an event is this much later in it than in the runs' clock [s].
    pub delay_s: f64,
    /// Standard error of that [s], where it was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_sd_s: Option<f64>,
    /// Further part of a delay that was found, which its error does not include.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_includes: Option<&'static str>,
    /// The relations that it was found from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub relations: Vec<Relation>,
}

/// The clock of every logger of a run, and remarks: no delay for the lead, the stated one, or the
/// one that is found.
///
/// A clock is found from the channels that its logger shares with loggers whose clocks are known:
/// the same column in both, and the motion of a rigid body, `dv/dt = a_x + g_x` with gravity's
/// share by the rates, `a_y = r v - d(alpha v)/dt + x dr/dt`, `a_z = g - q v - x dq/dt` with x from
/// the accelerometer's place. An unknown place (0.2 m over the speed) and unmeasured slip (0.03 s)
/// are part of the stated error.
///
/// # Errors
/// [`Error::Clock`] where a logger has a clock of its own and its delay cannot be found.
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
    // One that is related to no known logger may be related to one that is found meanwhile.
    while !open.is_empty() {
        let mut reasons = Vec::new();
        let before = open.len();
        let mut still = Vec::new();
        for name in open {
            let late: Vec<&Series> = series.iter().filter(|own| own.logger == name).collect();
            match delay(&late, &known, &place, mapping.logger[name].largest_delay_s) {
                Ok((clock, odd)) => {
                    add(name, clock.delay_s, &mut known);
                    let named = |text| format!("run {}: logger {name}: {text}", planned.name);
                    remarks.extend(odd.into_iter().map(named));
                    clocks.insert(name.to_string(), clock);
                }
                Err(reason) => {
                    reasons.push(reason);
                    still.push(name);
                }
            }
        }
        if still.len() == before {
            return Err(Error::Clock {
                run: planned.name.clone(),
                logger: still[0].to_string(),
                reason: format!(
                    "{}; expected a channel that another logger has too (logger.{}.also), its delay_s, or clock = \"shared\"",
                    reasons[0], still[0]
                ),
            });
        }
        open = still;
    }
    Ok((clocks, remarks))
}

/// Corner of the low pass at most [Hz]: a sled's own motion is below, its shaking above.
const CORNER_HZ: f64 = 10.0;

/// Samples compared [corners].
const SAMPLES: f64 = 5.0;

/// Corner of the low pass at most where the slope of the track is felt [Hz]: it is as long as
/// curves are.
const SLOPE_HZ: f64 = 2.0;

/// Least correlation that is a relation.
const LEAST: f64 = 0.5;

/// Least correlation with several columns, of which some combination always fits in part.
const LEAST_OF_SEVERAL: f64 = 0.85;

/// A series without the samples at an end stop of its sensor, which follow no motion.
fn without_saturation(series: &Series) -> Series {
    let mut series = series.clone();
    let values = &mut series.values;
    // Two ends.
    for _ in 0..2 {
        let Some(stop) = Saturation::of(values) else {
            break;
        };
        let mut begin = 0;
        while begin < values.len() {
            let rest = values[begin..].iter();
            let length = rest.take_while(|x| **x == stop.at).count();
            if length >= SATURATED {
                let end = (begin + length + 1).min(values.len());
                values[begin.saturating_sub(1)..end].fill(f64::NAN);
            }
            begin += length.max(1);
        }
    }
    series
}

/// Samples at one end of the range that are saturation.
const SATURATED: usize = 4;

/// Finds the clock of a logger, with remarks: each relation's own delay within the best common fit,
/// then their mean by their errors.
///
/// # Errors
/// Why none is found, in words.
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
    // Each relation's band is that of its slower side.
    let corner = |pair: &Pair| {
        let rate = pair.rate_hz();
        let most = match pair.kind {
            Kind::Longitudinal => SLOPE_HZ,
            _ => CORNER_HZ,
        };
        rate.map_or(0.0, |rate| (0.4 * rate).min(most))
    };
    let corners: Vec<f64> = pairs.iter().map(corner).collect();
    let (guess, first) = guess(&pairs, &corners, within)?;
    let mut found: Vec<Relation> = Vec::new();
    let mut poor = Vec::new();
    for (pair, corner) in pairs.iter().zip(&corners) {
        let Some(refined) = sharpened(pair, guess, first, *corner) else {
            continue;
        };
        let least = match pair.kind {
            Kind::Longitudinal => LEAST_OF_SEVERAL,
            _ => LEAST,
        };
        if refined.correlation < least {
            let (name, rho) = (&pair.name, refined.correlation);
            poor.push(format!(
                "\"{name}\" correlates by {rho:.2}, expected {least} or more"
            ));
        } else {
            found.push(Relation {
                relation: pair.name.clone(),
                delay_s: refined.delay_s,
                delay_sd_s: refined.sd_s.hypot(pair.doubt_s).max(1e-9),
                correlation: refined.correlation,
            });
        }
    }
    if found.is_empty() {
        let alike = format!("no relation fits best near {guess:+.2} s, where all together do");
        return Err(if poor.is_empty() {
            alike
        } else {
            poor.join(", ")
        });
    }
    let (clock, mut remarks) = mean(found);
    // A column of the other sign fits at no delay.
    let same = pairs.iter().zip(&corners);
    for (pair, corner) in same.filter(|(pair, _)| pair.kind == Kind::Same) {
        let sides = pair.sides(first.min(*corner));
        let rho = sides.and_then(|sides| matched(&sides, clock.delay_s, SAMPLES * first));
        if let Some(rho) = rho
            .map(|both| both.correlation())
            .filter(|rho| *rho < -OPPOSITE)
        {
            remarks.push(format!(
                "\"{}\" correlates by {rho:.2}: sign = -1 is missing in one of the two",
                pair.name
            ));
        }
    }
    Ok((clock, remarks))
}

/// Least correlation by which a column of both loggers has the other sign in one of them.
const OPPOSITE: f64 = 0.9;

/// One relation's delay, the band of its sides doubled from that of the first search up to their
/// own; of these the one with the least error: a wide band is sharper where the sides are clean, a
/// narrow one where they are noisy.
fn sharpened(pair: &Pair, guess: f64, first_hz: f64, corner_hz: f64) -> Option<DelayEstimate> {
    let mut corner = first_hz.min(corner_hz);
    let mut best: Option<DelayEstimate> = None;
    loop {
        let from = best.map_or(guess, |best| best.delay_s);
        let refined = refine(&pair.sides(corner)?, from, SAMPLES * corner, 1.0 / corner);
        let better = |refined: &DelayEstimate| best.is_none_or(|best| refined.sd_s < best.sd_s);
        best = refined.filter(better).or(best);
        if best.is_none() || corner >= corner_hz {
            return best;
        }
        corner = (2.0 * corner).min(corner_hz);
    }
}

/// A first delay by all relations together, and the corner of that search [Hz].
fn guess(pairs: &[Pair], corners: &[f64], within: Option<f64>) -> Result<(f64, f64), String> {
    let corner = corners.iter().copied().fold(0.0, f64::max);
    let both = || pairs.iter().zip(corners);
    let spans = both().filter_map(|(pair, corner)| Some(pair.sides(*corner)?.spans()));
    let longest = spans.max_by(|a, b| length(a).total_cmp(&length(b)));
    let Some(longest) = longest.filter(|_| corner > 0.0) else {
        return Err("its channels are too short".to_string());
    };
    // Sides are compared first at a rate at which that takes not too long.
    let rate = (0.5 * SAMPLES * corner).min(MOST / length(&longest).max(1e-3));
    let sides = both().filter_map(|(pair, corner)| pair.sides(corner.min(0.4 * rate)));
    let delay = search(&sides.collect::<Vec<Sides>>(), rate, within)?;
    Ok((delay, 0.4 * rate))
}

fn length(spans: &[[f64; 2]; 2]) -> f64 {
    let lengths = spans.map(|span| span[1] - span[0]);
    lengths.into_iter().fold(0.0, f64::max)
}

/// The mean weighted by errors, which include the doubt of each relation. Where relations disagree
/// the error of the mean grows by their scatter over their errors (Birge 1932).
fn mean(relations: Vec<Relation>) -> (LoggerClock, Vec<String>) {
    let weight = |one: &Relation| one.delay_sd_s.powi(-2);
    let sum: f64 = relations.iter().map(weight).sum();
    let weighted = relations.iter().map(|one| one.delay_s * weight(one));
    let delay_s = weighted.sum::<f64>() / sum;
    let sd_s = sum.sqrt().recip();
    let off = |one: &Relation| one.delay_s - delay_s;
    let far = |one: &&Relation| off(one).abs() > 4.0 * f64::hypot(one.delay_sd_s, sd_s);
    let apart = relations.iter().filter(far);
    let apart = apart.map(|one| format!("\"{}\" {:+.4} s", one.relation, one.delay_s));
    let apart: Vec<String> = apart.collect();
    let (mut grown, mut remarks) = (1.0, Vec::new());
    if !apart.is_empty() {
        let square = |one: &Relation| (off(one) / one.delay_sd_s).powi(2);
        let squares: f64 = relations.iter().map(square).sum();
        grown = (squares / (relations.len() as f64 - 1.0)).sqrt();
        let apart = apart.join(", ");
        remarks.push(format!(
            "its delay of {delay_s:+.4} s is not that of {apart}"
        ));
    }
    let clock = LoggerClock {
        source: "found",
        delay_s,
        delay_sd_s: Some(sd_s * grown),
        delay_includes: Some("the lag of the sensors that it was found from"),
        relations,
    };
    (clock, remarks)
}

/// Most samples of a side in the first search: its cost grows with their square.
const MOST: f64 = 1200.0;

/// Fewest pairs of samples that a delay is judged by.
const LEAST_PAIRS: usize = 60;

/// Least share of the shorter side that both have in common.
const LEAST_SHARE: f64 = 0.3;

/// A second best fit of more than this share of the best makes the delay ambiguous.
const AMBIGUOUS: f64 = 0.8;

/// The delay at which all sides together fit best: the largest sum of `-n ln(1 - rho^2)` over
/// relations with a positive correlation rho of n samples. Channels with the right sign correlate
/// positively.
///
/// `within` bounds the delay [s]. The delay is right within a step of the search.
///
/// # Errors
/// Why none is found, in words.
fn search(sides: &[Sides], rate_hz: f64, within: Option<f64>) -> Result<f64, String> {
    let nothing = "its channels do not move as those of the others do, at any delay (one of the other sign needs sign = -1)";
    let step = 1.0 / rate_hz;
    // Delays by which any two sides overlap.
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
    // The best fit's own hill: down to half of it, or to where it rises again.
    let below = |lag: &usize| scores[*lag] < 0.5 * scores[best];
    let from = (0..best).rev().find(below).unwrap_or(0);
    let to = (best..scores.len()).find(below).unwrap_or(scores.len());
    let others = (0..from).chain(to..scores.len());
    match others.max_by(by_score) {
        Some(second) if scores[second] > AMBIGUOUS * scores[best] => {
            let (first, second) = (delay(best), delay(second));
            Err(format!("{first:.2} s and {second:.2} s fit alike"))
        }
        _ => Ok(delay(best)),
    }
}

/// Both sides at uniform times of their own clocks; NaN where there is none.
struct Sampled {
    lhs: Vec<Vec<f64>>,
    rhs: Vec<f64>,
    /// From the first time of the right side to the first of the left one [s].
    apart: f64,
    step: f64,
}

impl Sampled {
    fn of(side: &Sides, step: f64) -> Sampled {
        let [lhs, rhs] = side.spans();
        let apart = lhs[0] - rhs[0];
        let times = |span: [f64; 2]| {
            let count = ((span[1] - span[0]) / step) as usize + 1;
            (0..count).map(move |i| span[0] + i as f64 * step)
        };
        let mut columns = vec![Vec::new(); side.columns()];
        for t in times(lhs) {
            let values = side.lhs(t);
            for (k, column) in columns.iter_mut().enumerate() {
                column.push(values.as_ref().map_or(f64::NAN, |values| values[k][0]));
            }
        }
        // The speed of the other clock varies slowly; it is brought into place when the delay is
        // refined.
        let value = |t| side.rhs(t, apart).map_or(f64::NAN, |[x, _]| x);
        Sampled {
            lhs: columns,
            rhs: times(rhs).map(value).collect(),
            apart,
            step,
        }
    }

    /// Pairs and correlation with the right side brought ahead by so much [s].
    fn fit(&self, ahead: f64) -> Option<(f64, f64)> {
        // Sample j of the right side belongs to sample j + shift of the other.
        let shift = ((ahead - self.apart) / self.step).round() as i64;
        let from = (-shift).max(0);
        let to = (self.lhs[0].len() as i64 - shift).min(self.rhs.len() as i64);
        let at = |j: &i64| (j + shift) as usize;
        let both = |j: &i64| !(self.lhs[0][at(j)].is_nan() || self.rhs[*j as usize].is_nan());
        let shared: Vec<i64> = (from..to).filter(both).collect();
        let shorter = self.lhs[0].len().min(self.rhs.len()) as f64;
        let n = shared.len() as f64;
        if n < LEAST_PAIRS as f64 || n < LEAST_SHARE * shorter {
            return None;
        }
        let column = |column: &Vec<f64>| [shared.iter().map(|j| column[at(j)]).collect(), vec![]];
        let rhs = shared.iter().map(|j| self.rhs[*j as usize]).collect();
        let rho = Matched::new(self.lhs.iter().map(column).collect(), [rhs, vec![]]).correlation();
        rho.is_finite().then_some((n, rho))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Both sides with their derivatives at the same times, less their means; the columns of the left
/// one are orthonormal.
struct Matched {
    lhs: Vec<[Vec<f64>; 2]>,
    rhs: [Vec<f64>; 2],
}

/// Share of a column that is rounding.
const ROUNDING: f64 = 1e-6;

impl Matched {
    fn new(mut lhs: Vec<[Vec<f64>; 2]>, mut rhs: [Vec<f64>; 2]) -> Matched {
        let sizes: Vec<f64> = lhs.iter().map(|[x, _]| dot(x, x)).collect();
        for x in lhs.iter_mut().chain([&mut rhs]).flatten() {
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            x.iter_mut().for_each(|x| *x -= mean);
        }
        // Gram and Schmidt.
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
            let factor = match square > ROUNDING.powi(2) * size {
                true => square.sqrt().recip(),
                false => 0.0,
            };
            own.iter_mut().flatten().for_each(|x| *x *= factor);
        }
        Matched { lhs, rhs }
    }

    /// The combination of the left side that is closest to `y`, and its derivative.
    fn closest(&self, y: &[f64]) -> [Vec<f64>; 2] {
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

    /// Correlation of the right side with that combination; with one column it has a sign.
    fn correlation(&self) -> f64 {
        let rhs = &self.rhs[0];
        let shares = self.lhs.iter().map(|[x, _]| dot(x, rhs));
        let shares: Vec<f64> = shares.collect();
        let size = match shares[..] {
            [share] => share,
            _ => dot(&shares, &shares).sqrt(),
        };
        size / dot(rhs, rhs).sqrt()
    }
}

/// Most steps of Gauss and Newton; they double their digits near the end.
const STEPS: usize = 30;

/// Over which time residuals are taken to remember [s].
const MEMORY_S: f64 = 2.0;

/// A delay by one relation.
#[derive(Clone, Copy)]
struct DelayEstimate {
    delay_s: f64,
    sd_s: f64,
    correlation: f64,
}

/// Fits `lhs(t) = a + b rhs(t - ahead)` over a, b and the delay from a first guess.
///
/// Standard error by the residuals' own covariance (Newey and West 1987, Bartlett's weights over 2
/// s), since they are no white noise. `None` where the fit departs from the guess by more than
/// `reach_s` or too few samples overlap.
fn refine(sides: &Sides, guess_s: f64, rate_hz: f64, reach_s: f64) -> Option<DelayEstimate> {
    let mut delay = guess_s;
    let mut last = None;
    for _ in 0..STEPS {
        let next = linear(sides, delay, rate_hz)?;
        let step = next.delay_s - delay;
        // Far from the best fit a step of Newton's is too long.
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

/// One step of Newton's method. With `a` the combination of `lhs` closest to `rhs`, their product
/// is largest at the delay, so that of `a` with the derivative of `rhs` sums to zero. Its change
/// with the delay is, by parts, the product of both derivatives, less that of the combination:
/// independent noise of the sides adds nothing to that.
fn linear(sides: &Sides, delay: f64, rate_hz: f64) -> Option<DelayEstimate> {
    let sums = matched(sides, delay, rate_hz)?;
    let [rhs, slope] = &sums.rhs;
    let [near, near_slope] = sums.closest(rhs);
    let [followed, _] = sums.closest(slope);
    let correlation = sums.correlation();
    let change = dot(&near_slope, slope) - dot(&followed, &followed);
    if !(correlation > 0.0 && change > 0.0) {
        return None;
    }
    let b = dot(&near, rhs) / dot(rhs, rhs);
    let residual: Vec<f64> = near.iter().zip(rhs).map(|(a, rhs)| a - b * rhs).collect();
    let slopes = slope
        .iter()
        .zip(&followed)
        .map(|(d, followed)| d - followed);
    let scores: Vec<f64> = slopes.zip(&residual).map(|(d, e)| d * e).collect();
    let memory = (MEMORY_S * rate_hz) as usize;
    let mut variance = 0.0;
    for lag in 0..=memory.min(scores.len() - 1) {
        let bartlett = 1.0 - lag as f64 / (memory + 1) as f64;
        let product = dot(&scores, &scores[lag..]);
        variance += if lag == 0 { 1.0 } else { 2.0 * bartlett } * product;
    }
    let shift = -dot(&residual, slope) / change;
    Some(DelayEstimate {
        // The shift moves `rhs`, which is early where the clock of `lhs` is late.
        delay_s: delay + sides.ahead(shift),
        sd_s: variance.max(0.0).sqrt() / change,
        correlation,
    })
}

/// Both sides at the times that they share; `None` where these are too few.
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
