//! Which channels of runs are provably not what their names say.

use rayon::prelude::*;

use crate::error::Error;
use crate::record::check::gaps::bridged;
use crate::record::check::relations::fault::{Fault, FaultKind};
use crate::record::check::relations::mend::{Mend, mends};
use crate::record::check::relations::plain::plain_faults;
use crate::record::check::relations::range::range_faults;
use crate::record::check::relations::response::response_faults;
use crate::record::check::relations::rigid_body::{Agreement, factor};
use crate::record::check::relations::slow::Slow;
use crate::record::run::Run;

/// By how much the disagreement must fall, a factor of e in the mean square that one relation leaves. In clean runs nothing that
/// is tried lowers it by more than 0.4; at half of this one simulated run in eleven with little slip would be told to be
/// in degrees, at twice negated slip angles are missed in one run of three.
const LEAST_GAIN: f64 = 1.0;
/// A relation that shows a fault must hold once it is mended: less than this is left of its terms, as a mean square.
const HOLDS: f64 = 0.25;
/// A fault shows in a relation that leaves more than this, as a mean square; clean runs leave up to a tenth (`rigid_body`), of which
/// gravity that a record's pitch rate does not carry can be lowered by a wrong sign.
const SHOWS: f64 = 0.1;
/// No relation may get worse by more than this when another is mended.
const WORSE: f64 = 0.1;
/// Standard errors from what is right of a factor that is told to be wrong: by chance once in 10^9.
const LEAST_T: f64 = 6.0;
/// Most faults of one run that are looked for, one after the other.
const MOST: usize = 4;

/// Place of `ay_mps2` among the channels.
const AY: usize = 1;

/// Everything that can be proved wrong in these runs, run by run.
///
/// Plainly, channel by channel ([`plain_faults`]); by the relations of a rigid body, one thing after the other mended as long as
/// that lowers the disagreement by [`LEAST_GAIN`] and the relations then hold; and by how a sled answers to steering
/// ([`response_faults`]), over all runs together.
pub fn judge(runs: &[Run]) -> Vec<Fault> {
    let tried = mends();
    let judged: Vec<(Vec<Fault>, Option<Slow>)> = runs
        .par_iter()
        .map(|run| {
            let mut faults = plain_faults(run);
            // What stands still or is held cannot be mended by a unit.
            let slow = Slow::of(run).filter(|_| faults.is_empty());
            let mended = slow.map(|slow| mend_all(run, slow, &tried, &mut faults));
            let beyond = range_faults(run, &faults);
            let answers = mended.as_ref().is_some_and(|slow| {
                let [_, y, z] = Agreement::of(slow).left;
                beyond.is_empty() && [y, z].into_iter().flatten().all(|left| left < HOLDS)
            });
            faults.extend(beyond);
            faults.extend(mended.iter().filter_map(|slow| distance_fault(run, slow)));
            // How it answers says nothing where channels do not agree yet.
            (faults, mended.filter(|_| answers))
        })
        .collect();
    let mended: Vec<(&Run, Slow)> = runs
        .iter()
        .zip(&judged)
        .filter_map(|(run, (_, slow))| Some((run, slow.clone()?)))
        .collect();
    let mut faults: Vec<Fault> = judged.into_iter().flat_map(|(faults, _)| faults).collect();
    faults.extend(response_faults(&mended));
    faults
}

/// Refuses runs of which something can be proved wrong.
///
/// # Errors
/// [`Error::Wrong`] with the first thing found and how many more there are.
pub fn refuse_faults(runs: &[Run]) -> Result<(), Error> {
    let faults = judge(runs);
    match faults.split_first() {
        None => Ok(()),
        Some((first, more)) => Err(Error::Wrong {
            fault: Box::new(first.clone()),
            more: more.len(),
        }),
    }
}

/// Mends what relations prove wrong and tells it.
fn mend_all(run: &Run, mut slow: Slow, tried: &[Mend], faults: &mut Vec<Fault>) -> Slow {
    let tell = |mend: &Mend, evidence: String| Fault {
        run: run.entry.run.clone(),
        file: run.entry.file.display().to_string(),
        columns: mend.columns(),
        kind: mend.kind,
        looks_like: mend.looks_like.to_string(),
        evidence,
        mend: mend.line.clone(),
    };
    for _ in 0..MOST {
        let before = Agreement::of(&slow);
        let best = tried
            .iter()
            .filter(|mend| mend.applies(&slow))
            .map(|mend| (mend, Agreement::of(&mend.applied(&slow))))
            .filter(|(_, after)| proves(&before, after))
            // The first of equals.
            .reduce(|a, b| {
                if b.1.score() < a.1.score() - 1e-9 {
                    b
                } else {
                    a
                }
            });
        let Some((mend, after)) = best else {
            if let Some((one, other, after)) = two_at_once(&slow, &before, tried) {
                for mend in [one, other] {
                    faults.push(tell(mend, evidence(&before, &after)));
                    slow = mend.applied(&slow);
                }
            }
            break;
        };
        faults.push(tell(mend, evidence(&before, &after)));
        slow = mend.applied(&slow);
    }
    // The share of `ay` is often too small to show in what is left of its relation, and known well enough all the same. That of `ax` is
    // not: gravity along the sled is far larger, and where a record's pitch rate does not carry every change of slope, it has any sign.
    for mend in tried.iter().filter(|mend| mend.channels == [AY]) {
        let (Some(wanted), Some((factor, error))) = (mend.factor(), factor(&slow, AY)) else {
            continue;
        };
        // Of a relation that does not hold its shares say nothing.
        let holds = Agreement::of(&slow).left[AY].is_some_and(|left| left < HOLDS);
        let near = holds && (factor - wanted).abs() < 0.5 * wanted.abs().max(1.0);
        if near && error < 0.15 * wanted.abs() && (factor - 1.0).abs() > LEAST_T * error {
            faults.push(tell(
                mend,
                format!(
                    "the other channels' motion asks for {factor:.2} +- {error:.2} times its values"
                ),
            ));
            slow = mend.applied(&slow);
        }
    }
    // A rate of exactly one value is silent; what it should say shows in what is left.
    let silent = |x: &[f64]| x.iter().all(|y| *y == x[0]);
    let roll = run.columns.get("roll_rate_radps").filter(|x| silent(x));
    if let (Some(roll), Some(left)) = (roll, Agreement::of(&slow).left[1])
        && left > HOLDS
    {
        faults.push(Fault {
            run: run.entry.run.clone(),
            file: run.entry.file.display().to_string(),
            columns: vec!["roll_rate_radps".to_string()],
            kind: FaultKind::Constant,
            looks_like: "one value throughout".to_string(),
            evidence: format!(
                "{} in every row, while gravity turns across the sled",
                roll[0]
            ),
            mend: "another source for roll_rate_radps: this one does not measure".to_string(),
        });
    }
    slow
}

/// Distance in another unit, beside the integral of the speed once that is mended.
fn distance_fault(run: &Run, slow: &Slow) -> Option<Fault> {
    // Runs follow the middle of the track within a few per cent; a circuit that starts anew is no distance run.
    const CLOSE: f64 = 0.2;
    let s = run.columns.get("s_m")?;
    let (raw, mended) = (Slow::of(run)?, slow.channels[6].as_ref()?);
    let sum = |v: &[f64]| v.iter().sum::<f64>();
    let factor = sum(mended) / sum(raw.channels[6].as_ref()?) * slow.dt_s / raw.dt_s;
    let (first, last) = (s.first()?, s.last()?);
    let travelled = sum(&bridged(run.columns.get("v_mps")?)) * run.dt_s * factor;
    let share = (last - first) / travelled;
    let units = [
        (1e-3, "kilometres", "unit = \"km\""),
        (1e3, "millimetres", "unit = \"mm\""),
        (100.0, "centimetres", "unit = \"cm\""),
        (1.0 / 0.3048, "feet", "unit = \"ft\""),
        (1.0 / 1609.344, "miles", "unit = \"mi\""),
        (-1.0, "a distance that runs backwards", "sign = -1"),
    ];
    let (_, looks_like, mend) = units
        .into_iter()
        .find(|(u, ..)| (share / u - 1.0).abs() < CLOSE)?;
    Some(Fault {
        run: run.entry.run.clone(),
        file: run.entry.file.display().to_string(),
        columns: vec!["s_m".to_string()],
        kind: FaultKind::Distance,
        looks_like: looks_like.to_string(),
        evidence: format!(
            "{:.5} where the speed adds up to {travelled:.1} m",
            last - first
        ),
        mend: format!("{mend} for s_m"),
    })
}

/// Two faults of which neither is proven while the other is there; looked for where sideways or vertically little agrees.
fn two_at_once<'a>(
    slow: &Slow,
    before: &Agreement,
    tried: &'a [Mend],
) -> Option<(&'a Mend, &'a Mend, Agreement)> {
    let [_, y, z] = before.left;
    if [y, z].into_iter().flatten().all(|left| left < HOLDS) {
        return None;
    }
    let there: Vec<&Mend> = tried.iter().filter(|mend| mend.applies(slow)).collect();
    let pairs: Vec<(&Mend, &Mend)> = there
        .iter()
        .enumerate()
        .flat_map(|(k, one)| there[k + 1..].iter().map(|other| (*one, *other)))
        .collect();
    let judged: Vec<(&Mend, &Mend, Agreement)> = pairs
        .into_par_iter()
        .map(|(one, other)| {
            let mended = other.applied(&one.applied(slow));
            (one, other, Agreement::of(&mended))
        })
        .collect();
    let holds = |after: &Agreement| after.left[1..].iter().flatten().all(|left| *left < HOLDS);
    judged
        .into_iter()
        .filter(|(.., after)| holds(after) && before.score() - after.score() >= 2.0 * LEAST_GAIN)
        .reduce(|a, b| {
            if b.2.score() < a.2.score() - 1e-9 {
                b
            } else {
                a
            }
        })
}

fn proves(before: &Agreement, after: &Agreement) -> bool {
    let pairs = || {
        before
            .left
            .iter()
            .zip(&after.left)
            .filter_map(|(b, a)| Some((*b, (*a)?)))
    };
    let better = pairs().any(|(b, a)| a < HOLDS && b.is_some_and(|b| b > SHOWS && a < 0.7 * b));
    let hold = pairs().all(|(b, a)| a < HOLDS || b.is_some_and(|b| a < b + WORSE));
    before.score() - after.score() >= LEAST_GAIN && better && hold
}

/// What is left of the relations before and after.
fn evidence(before: &Agreement, after: &Agreement) -> String {
    let mut parts = Vec::new();
    for ((axis, b), a) in ["x", "y", "z"].iter().zip(before.left).zip(after.left) {
        if let (Some(b), Some(a)) = (b, a)
            && (b - a).abs() > 0.02
        {
            let [b, a] = [b, a].map(|left| 100.0 * left.sqrt());
            parts.push(format!("{b:.0} % along {axis}, mended {a:.0} %"));
        }
    }
    let mut text = format!(
        "left of d(a - dv/dt - w x v)/dt + w x (...) = 0: {}",
        parts.join("; ")
    );
    if let (Some(b), Some(a)) = (before.lift, after.lift)
        && (b - a).abs() > 0.2
    {
        text += &format!("; lift against gravity {b:.1} m/s2, mended {a:.1}");
    }
    text
}
