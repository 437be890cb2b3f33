//! The delay of one logger beside those whose clocks are known.

use crate::clock::pair::{Pair, Sides, pairs};
use crate::clock::refine::{Refined, refine};
use crate::clock::search::{Found, first_rate, search};
use crate::clock::series::{LoggerSeries, Relation};

/// Corner of the low pass at most [Hz]: a sled's own motion is below, its shaking above.
const CORNER_HZ: f64 = 10.0;

/// Samples compared [corners].
const SAMPLES: f64 = 5.0;

/// Least correlation that is a relation.
const LEAST: f64 = 0.5;

/// A delay, and what it is from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Delay {
    pub delay_s: f64,
    pub sd_s: f64,
    pub relations: Vec<Relation>,
    pub remark: Option<String>,
}

/// Finds the delay of a logger: each relation's own within the best common fit, then their mean by their errors.
///
/// # Errors
/// Why none is found, in words.
pub(crate) fn delay(
    late: &[&LoggerSeries],
    known: &[LoggerSeries],
    place: &crate::clock::pair::Place,
    within: Option<f64>,
) -> Result<Delay, String> {
    let pairs = pairs(late, known, place);
    if pairs.is_empty() {
        return Err("no channels of it are related to those of the others".to_string());
    }
    // Each relation's band is that of its slower side.
    let corners: Vec<f64> = pairs
        .iter()
        .map(|pair| {
            pair.rate_hz()
                .map_or(0.0, |rate| (0.4 * rate).min(CORNER_HZ))
        })
        .collect();
    let (guess, first) = guess(&pairs, &corners, within)?;
    let mut found: Vec<(&Pair, Refined)> = Vec::new();
    let mut best = (0.0, "");
    for (pair, corner) in pairs.iter().zip(&corners) {
        let Some(refined) = sharpened(pair, guess, first, *corner) else {
            continue;
        };
        if refined.correlation > best.0 {
            best = (refined.correlation, &pair.name);
        }
        if refined.correlation >= LEAST {
            found.push((pair, refined));
        }
    }
    if found.is_empty() {
        return Err(format!(
            "the best relation, \"{}\", correlates by {:.2} only, expected {LEAST} or more",
            best.1, best.0
        ));
    }
    Ok(mean(&found))
}

/// One relation's delay, the band of its sides doubled from that of the first search up to their own; of these the one
/// with the least error: a wide band is sharper where the sides are clean, a narrow one where they are noisy.
fn sharpened(pair: &Pair, guess: f64, first_hz: f64, corner_hz: f64) -> Option<Refined> {
    let mut corner = first_hz.min(corner_hz);
    let mut best: Option<Refined> = None;
    loop {
        let from = best.map_or(guess, |best| best.delay_s);
        let refined = refine(&pair.sides(corner)?, from, SAMPLES * corner, 1.0 / corner);
        let better = |refined: &Refined| best.is_none_or(|best| refined.sd_s < best.sd_s);
        best = refined.filter(better).or(best);
        if best.is_none() || corner >= corner_hz {
            return best;
        }
        corner = (2.0 * corner).min(corner_hz);
    }
}

/// A first delay by all relations together, and the corner that they were searched with [Hz].
fn guess(pairs: &[Pair], corners: &[f64], within: Option<f64>) -> Result<(f64, f64), String> {
    let corner = corners.iter().copied().fold(0.0, f64::max);
    let spans = pairs
        .iter()
        .zip(corners)
        .filter_map(|(pair, corner)| Some(pair.sides(*corner)?.spans()));
    let longest = spans.max_by(|a, b| length(a).total_cmp(&length(b)));
    let Some(longest) = longest.filter(|_| corner > 0.0) else {
        return Err("its channels are too short".to_string());
    };
    let rate = first_rate(longest, 0.5 * SAMPLES * corner);
    let sides: Vec<Sides> = pairs
        .iter()
        .zip(corners)
        .filter_map(|(pair, corner)| pair.sides(corner.min(0.4 * rate)))
        .collect();
    match search(&sides, rate, within) {
        Found::Delay(delay) => Ok((delay, 0.4 * rate)),
        Found::Ambiguous(first, second) => Err(format!("{first:.2} s and {second:.2} s fit alike")),
        Found::Nothing => {
            Err("its channels do not move as those of the others do, at any delay".to_string())
        }
    }
}

fn length(spans: &[[f64; 2]; 2]) -> f64 {
    spans
        .iter()
        .map(|span| span[1] - span[0])
        .fold(0.0, f64::max)
}

/// The mean by errors, with what the relations themselves cannot know.
fn mean(found: &[(&Pair, Refined)]) -> Delay {
    let sd = |(pair, refined): &(&Pair, Refined)| f64::hypot(refined.sd_s, pair.doubt_s).max(1e-9);
    let weight: f64 = found.iter().map(|one| sd(one).powi(-2)).sum();
    let delay_s = found
        .iter()
        .map(|one| one.1.delay_s * sd(one).powi(-2))
        .sum::<f64>()
        / weight;
    let sd_s = weight.sqrt().recip();
    let apart = found
        .iter()
        .filter(|one| (one.1.delay_s - delay_s).abs() > 4.0 * f64::hypot(sd(one), sd_s));
    let apart: Vec<String> = apart
        .map(|one| format!("\"{}\" {:+.4} s", one.0.name, one.1.delay_s))
        .collect();
    Delay {
        delay_s,
        sd_s,
        remark: (!apart.is_empty()).then(|| {
            format!(
                "its delay of {delay_s:+.4} s is not that of {}",
                apart.join(", ")
            )
        }),
        relations: found
            .iter()
            .map(|one| Relation {
                relation: one.0.name.clone(),
                delay_s: one.1.delay_s,
                delay_sd_s: sd(one),
                correlation: one.1.correlation,
            })
            .collect(),
    }
}
