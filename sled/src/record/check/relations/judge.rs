//! Which channels of runs are provably not what their names say.

use rayon::prelude::*;

use crate::error::Error;
use crate::record::check::relations::fault::{Fault, FaultKind};
use crate::record::check::relations::mend::{Mend, mends};
use crate::record::check::relations::plain::plain_faults;
use crate::record::check::relations::range::range_faults;
use crate::record::check::relations::response::response_faults;
use crate::record::check::relations::rigid_body::{Agreement, factor};
use crate::record::check::relations::rules::RelationRules;
use crate::record::check::relations::slow::Slow;
use crate::record::run::Run;
use crate::series::bridged;

/// Most faults of one run that are looked for, one after the other.
const MOST: usize = 4;

/// Place of `ay_mps2` among the channels.
const AY: usize = 1;

/// Everything that can be proved wrong in these runs, run by run.
///
/// Plainly, channel by channel ([`plain_faults`]); by the relations of a rigid body, one thing after the other mended as long as
/// that lowers the disagreement and the relations then hold; and by how a sled answers to steering
/// ([`response_faults`]), over all runs together.
pub fn judge(runs: &[Run]) -> Vec<Fault> {
    judge_by(runs, &RelationRules::default())
}

/// The same by other thresholds.
pub fn judge_by(runs: &[Run], rules: &RelationRules) -> Vec<Fault> {
    let judged = Judged {
        tried: mends(),
        rules,
    };
    let by_run: Vec<(Vec<Fault>, Option<Slow>)> = runs
        .par_iter()
        .map(|run| {
            let mut faults = plain_faults(run);
            // What stands still or is held cannot be mended by a unit.
            let slow = Slow::of(run).filter(|_| faults.is_empty());
            let mended = slow.map(|slow| judged.mend_all(run, slow, &mut faults));
            let beyond = range_faults(run, &faults);
            let answers = mended.as_ref().is_some_and(|slow| {
                let [_, y, z] = Agreement::of(slow).left;
                beyond.is_empty() && [y, z].into_iter().flatten().all(|left| left < rules.holds)
            });
            faults.extend(beyond);
            faults.extend(mended.iter().filter_map(|slow| distance_fault(run, slow)));
            // How it answers says nothing where channels do not agree yet.
            (faults, mended.filter(|_| answers))
        })
        .collect();
    let mended: Vec<(&Run, Slow)> = runs
        .iter()
        .zip(&by_run)
        .filter_map(|(run, (_, slow))| Some((run, slow.clone()?)))
        .collect();
    let mut faults: Vec<Fault> = by_run.into_iter().flat_map(|(faults, _)| faults).collect();
    faults.extend(response_faults(&mended, rules));
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

/// What is tried, and from where on it proves something.
struct Judged<'a> {
    tried: Vec<Mend>,
    rules: &'a RelationRules,
}

impl Judged<'_> {
    /// Mends what relations prove wrong and tells it.
    fn mend_all(&self, run: &Run, mut slow: Slow, faults: &mut Vec<Fault>) -> Slow {
        let (tried, rules) = (&self.tried, self.rules);
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
                .filter(|(_, after)| self.proves(&before, after))
                // The first of equals.
                .reduce(|a, b| {
                    if b.1.score() < a.1.score() - 1e-9 {
                        b
                    } else {
                        a
                    }
                });
            let Some((mend, after)) = best else {
                if let Some((one, other, after)) = self.two_at_once(&slow, &before) {
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
            let holds = Agreement::of(&slow).left[AY].is_some_and(|left| left < rules.holds);
            let near = holds && (factor - wanted).abs() < 0.5 * wanted.abs().max(1.0);
            if near && error < 0.15 * wanted.abs() && (factor - 1.0).abs() > rules.least_t * error {
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
            && left > rules.holds
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

    /// Two faults of which neither is proven while the other is there; looked for where sideways or vertically little agrees.
    fn two_at_once(&self, slow: &Slow, before: &Agreement) -> Option<(&Mend, &Mend, Agreement)> {
        let (tried, rules) = (&self.tried, self.rules);
        let [_, y, z] = before.left;
        if [y, z].into_iter().flatten().all(|left| left < rules.holds) {
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
        let holds = |after: &Agreement| {
            after.left[1..]
                .iter()
                .flatten()
                .all(|left| *left < rules.holds)
        };
        judged
            .into_iter()
            .filter(|(.., after)| {
                holds(after) && before.score() - after.score() >= 2.0 * rules.least_gain
            })
            .reduce(|a, b| {
                if b.2.score() < a.2.score() - 1e-9 {
                    b
                } else {
                    a
                }
            })
    }

    fn proves(&self, before: &Agreement, after: &Agreement) -> bool {
        let rules = self.rules;
        let pairs = || {
            before
                .left
                .iter()
                .zip(&after.left)
                .filter_map(|(b, a)| Some((*b, (*a)?)))
        };
        let better = pairs()
            .any(|(b, a)| a < rules.holds && b.is_some_and(|b| b > rules.shows && a < 0.7 * b));
        let hold = pairs().all(|(b, a)| a < rules.holds || b.is_some_and(|b| a < b + rules.worse));
        before.score() - after.score() >= rules.least_gain && better && hold
    }
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
