//! Which channels of runs are provably not what their names say.

use rayon::prelude::*;

use crate::column::COLUMNS;
use crate::error::Error;
use crate::fault::{Fault, FaultKind};
use crate::friction::GRAVITY;
use crate::record::check::relations::channels::{plain_faults, range_faults};
use crate::record::check::relations::response::response_faults;
use crate::record::check::relations::rigid_body::{Agreement, Slow, factor};
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
    let mut by_run: Vec<Vec<Fault>> = by_run.into_iter().map(|(faults, _)| faults).collect();
    withdraw_where_runs_disagree(&mut by_run);
    let mut faults: Vec<Fault> = by_run.into_iter().flatten().collect();
    faults.extend(response_faults(&mended, rules));
    faults
}

/// A fault that relations show is proved where every run of the campaign shows it, but for units, which differ by orders.
fn withdraw_where_runs_disagree(by_run: &mut [Vec<Fault>]) {
    let alike = |a: &Fault, b: &Fault| a.kind == b.kind && a.columns == b.columns;
    let runs = by_run.to_vec();
    let in_all = |fault: &Fault| {
        let shows = |run: &Vec<Fault>| run.iter().any(|own| own.proven && alike(own, fault));
        runs.iter().all(shows)
    };
    for fault in by_run.iter_mut().flatten() {
        let by_relation = matches!(
            fault.kind,
            FaultKind::Sign | FaultKind::Swapped | FaultKind::Gravity
        );
        fault.proven &= !by_relation || in_all(fault);
    }
}

/// Refuses runs of which something is proved wrong; what is only suspected becomes one remark on the first run concerned.
///
/// # Errors
/// [`Error::Wrong`] with the first fault proved and how many more there are.
pub fn check_relations(runs: &mut [Run]) -> Result<(), Error> {
    let (proven, suspected): (Vec<Fault>, Vec<Fault>) =
        judge(runs).into_iter().partition(|fault| fault.proven);
    if let Some((first, more)) = proven.split_first() {
        return Err(Error::Wrong {
            fault: Box::new(first.clone()),
            more: more.len(),
        });
    }
    remark(runs, &suspected);
    Ok(())
}

/// Remarks on suspected faults: one line on the first run concerned.
pub(crate) fn remark(runs: &mut [Run], suspected: &[Fault]) {
    let concerned = |run: &Run| suspected.iter().any(|fault| fault.run == run.entry.run);
    let count = runs.iter().filter(|run| concerned(run)).count();
    let Some(first) = runs.iter_mut().find(|run| concerned(run)) else {
        return;
    };
    let Some(fault) = suspected.iter().find(|fault| fault.run == first.entry.run) else {
        return;
    };
    let more = match count {
        1 => String::new(),
        count => format!(", and {} other runs raise doubts", count - 1),
    };
    first.remarks.push(format!(
        "run {}: {} may be {}{more}; not proved, so nothing is refused (kufe runs check states the evidence)",
        fault.run,
        fault.columns.join(", "),
        fault.looks_like,
    ));
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
        let tell = |mend: &Mend, proven: bool, evidence: String| Fault {
            run: run.entry.run.clone(),
            file: run.entry.file.display().to_string(),
            columns: mend.columns(),
            kind: mend.kind,
            proven,
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
                    let proven = self.holds_once_mended(&before, &after);
                    for mend in [one, other] {
                        faults.push(tell(mend, proven, evidence(&before, &after)));
                        slow = mend.applied(&slow);
                    }
                }
                break;
            };
            let proven = self.holds_once_mended(&before, &after);
            faults.push(tell(mend, proven, evidence(&before, &after)));
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
                false,
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
                proven: false,
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

    /// Whether a relation holds within its noise once mended, and not before.
    fn holds_once_mended(&self, before: &Agreement, after: &Agreement) -> bool {
        let noise = self.rules.noise;
        let mut pairs = before.left.iter().zip(&after.left);
        pairs.any(|pair| matches!(pair, (Some(b), Some(a)) if *b >= noise && *a < noise))
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
        proven: true,
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

/// How channels are mended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Act {
    /// Times a factor.
    Scale(f64),
    /// Exchanged.
    Swap,
    /// Gravity added.
    Weigh,
    /// The clock, times a factor.
    Clock(f64),
}

/// One thing that may be wrong, undone.
#[derive(Clone, Debug, PartialEq)]
pub struct Mend {
    /// The channels, by their place in [`COLUMNS`].
    pub channels: Vec<usize>,
    /// What is wrong.
    pub kind: FaultKind,
    /// In words.
    pub looks_like: &'static str,
    /// What to write in the mapping.
    pub line: String,
    act: Act,
}

impl Mend {
    /// Names of the channels.
    pub fn columns(&self) -> Vec<String> {
        match self.kind {
            FaultKind::Clock => vec!["t_s".to_string()],
            _ => self
                .channels
                .iter()
                .map(|c| COLUMNS[*c].to_string())
                .collect(),
        }
    }

    /// The factor on its channels, where it is one.
    pub fn factor(&self) -> Option<f64> {
        match self.act {
            Act::Scale(factor) => Some(factor),
            _ => None,
        }
    }

    /// Whether a run has what is to be mended.
    pub fn applies(&self, slow: &Slow) -> bool {
        self.channels.iter().all(|c| slow.channels[*c].is_some())
    }

    /// The channels mended.
    pub fn applied(&self, slow: &Slow) -> Slow {
        let mut mended = slow.clone();
        match self.act {
            Act::Swap => mended.channels.swap(self.channels[0], self.channels[1]),
            Act::Clock(factor) => mended.dt_s *= factor,
            Act::Scale(_) | Act::Weigh => {
                for c in &self.channels {
                    for x in mended.channels[*c].iter_mut().flatten() {
                        match self.act {
                            Act::Scale(factor) => *x *= factor,
                            _ => *x += GRAVITY,
                        }
                    }
                }
            }
        }
        mended
    }
}

/// Everything that is tried, the likelier of two that look alike first.
pub fn mends() -> Vec<Mend> {
    let mut all = Vec::new();
    let mut scaled = |channels: &[usize], kind, looks_like, word: &str, factor| {
        let names: Vec<&str> = channels.iter().map(|c| COLUMNS[*c]).collect();
        all.push(Mend {
            channels: channels.to_vec(),
            kind,
            looks_like,
            line: format!("{word} for {}", names.join(", ")),
            act: Act::Scale(factor),
        });
    };
    let (unit, sign) = (FaultKind::Unit, FaultKind::Sign);
    let degree = std::f64::consts::PI / 180.0;
    for channels in [&[0][..], &[1], &[2], &[0, 1], &[0, 1, 2]] {
        scaled(channels, unit, "multiples of g", "unit = \"g\"", GRAVITY);
    }
    for channels in [&[3][..], &[4], &[5], &[3, 4, 5]] {
        scaled(
            channels,
            unit,
            "degrees per second",
            "unit = \"deg/s\"",
            degree,
        );
    }
    scaled(&[6], unit, "km/h", "unit = \"km/h\"", 1.0 / 3.6);
    scaled(&[6], unit, "miles per hour", "unit = \"mph\"", 0.447_04);
    scaled(&[6], unit, "knots", "unit = \"kn\"", 1852.0 / 3600.0);
    scaled(&[7], unit, "degrees", "unit = \"deg\"", degree);
    for c in [0, 1, 2, 3, 4, 5, 7] {
        scaled(&[c], sign, "the other sign", "sign = -1", -1.0);
    }
    for (a, b) in [
        (0, 1),
        (0, 2),
        (1, 2),
        (3, 4),
        (3, 5),
        (4, 5),
        (7, 8),
        (7, 9),
    ] {
        all.push(Mend {
            channels: vec![a, b],
            kind: FaultKind::Swapped,
            looks_like: "one another",
            line: format!("exchange the names of {} and {}", COLUMNS[a], COLUMNS[b]),
            act: Act::Swap,
        });
    }
    all.push(Mend {
        channels: vec![2],
        kind: FaultKind::Gravity,
        looks_like: "an acceleration without gravity",
        line: "zero = -9.81 for az_mps2".to_string(),
        act: Act::Weigh,
    });
    all.push(Mend {
        channels: Vec::new(),
        kind: FaultKind::Clock,
        looks_like: "milliseconds",
        line: "unit = \"ms\" for the clock".to_string(),
        act: Act::Clock(1e-3),
    });
    all
}

/// Thresholds of the relations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelationRules {
    /// By how much the disagreement must fall, a factor of e in the mean square that one relation leaves. In clean runs nothing
    /// that is tried lowers it by more than 0.4; at half, one run in eleven with little slip was said to be in degrees.
    pub least_gain: f64,
    /// A relation that shows a fault must hold once it is mended: less than this is left of its terms, as a mean square.
    pub holds: f64,
    /// A relation holds within its noise where less than this is left of its terms, as a mean square: 15 % as a root mean square.
    pub noise: f64,
    /// A fault shows in a relation that leaves more than this, as a mean square; clean runs leave up to a tenth (`rigid_body`), of
    /// which gravity that a record's pitch rate does not carry can be lowered by a wrong sign.
    pub shows: f64,
    /// No relation may get worse by more than this when another is mended.
    pub worse: f64,
    /// Standard errors from what is right of a coefficient that is told to be wrong: by chance once in 10^9.
    pub least_t: f64,
    /// Share of the runs that must agree where all together prove it.
    pub agree: f64,
    /// Share of the runs' median answer that a single run must have to be told by its sign: a wrong sign leaves the size as it is.
    pub alike: f64,
    /// Least drag area over mass of a sled or car [m2/kg]; a bobsled has 7e-4, an accelerometer in g would show a tenth of that.
    pub least_drag: f64,
    /// What drives or brakes changes a_x by more than this [m/s2]: nothing is said of its air then.
    pub free: f64,
}

impl Default for RelationRules {
    fn default() -> Self {
        RelationRules {
            least_gain: 1.0,
            holds: 0.25,
            noise: 0.15 * 0.15,
            shows: 0.1,
            worse: 0.1,
            least_t: 6.0,
            agree: 0.8,
            alike: 0.5,
            least_drag: 2e-4,
            free: 1.0,
        }
    }
}
