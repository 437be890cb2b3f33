//! Channels of runs whose values provably contradict their names.

use std::borrow::Borrow;

use rayon::prelude::*;

use crate::column::Sensor;
use crate::error::Error;
use crate::fault::{Fault, FaultKind};
use crate::record::check::remedies::{Mend, REMEDIES, Remedy, Unit};
use crate::record::check::response::response_faults;
use crate::record::check::rigid_body::{Agreement, Slow, factor};
use crate::record::check::rotation::{BoxRotation, is_complete};
use crate::record::check::single::{plain_faults, range_faults};
use crate::record::run::Run;
use crate::series::bridged;

/// Most faults of one run that are searched, one after the other.
const MOST: usize = 4;

/// All faults of these runs, run by run.
///
/// - Of single channels ([`plain_faults`], [`range_faults`]).
/// - By the relations of a rigid body: one remedy after the other as long as it lowers the
///   disagreement and the relations are then satisfied.
/// - By the motion that a turned sensor box measures ([`BoxRotation`]), over all runs together.
/// - By the response of a sled to steering ([`response_faults`]), over all runs together.
pub fn judge(runs: &[impl Borrow<Run> + Sync]) -> Vec<Fault> {
    judge_by(runs, &RelationRules::default())
}

/// The same by other thresholds.
pub fn judge_by(runs: &[impl Borrow<Run> + Sync], rules: &RelationRules) -> Vec<Fault> {
    let runs: Vec<&Run> = runs.iter().map(Borrow::borrow).collect();
    // Faults of a run and, while relations can judge it, its slow channels.
    let plain = |run: &Run| {
        let faults = plain_faults(run);
        // A channel that is constant or repeated cannot be mended by a unit.
        let slow = Slow::of(run).filter(|_| faults.is_empty());
        (faults, slow)
    };
    let mut judged: Vec<(Vec<Fault>, Option<Slow>)> = runs.par_iter().copied().map(plain).collect();
    let slow: Vec<&Slow> = judged
        .iter()
        .filter_map(|(_, slow)| slow.as_ref())
        .collect();
    let rotation = BoxRotation::of(&slow, rules);
    let judge_one = |(run, (faults, slow)): (&&Run, &mut (Vec<Fault>, Option<Slow>))| {
        if let (Some(rotation), Some(slow)) = (&rotation, &mut *slow)
            && is_complete(slow)
        {
            let turned = rotation.applied(slow);
            if rotation.reported {
                faults.push(rotation.fault(run, slow, &turned));
            }
            *slow = turned;
        }
        if let Some(slow) = slow {
            rules.mend_all(run, slow, faults);
        }
        let ranges = range_faults(run, faults);
        let distance = slow.as_ref().and_then(|slow| distance_fault(run, slow));
        // The response is not judged where channels do not agree yet.
        let agrees =
            |slow: &mut Slow| ranges.is_empty() && Agreement::of(slow).is_below(rules.holds);
        slow.take_if(|slow| !agrees(slow));
        faults.extend(ranges);
        faults.extend(distance);
    };
    runs.par_iter().zip(&mut judged).for_each(judge_one);
    withdraw_where_runs_disagree(&mut judged);
    let pairs = runs.iter().zip(&judged);
    let mended = pairs.filter_map(|(run, (_, slow))| Some((*run, slow.as_ref()?)));
    let by_response = response_faults(&mended.collect::<Vec<_>>(), rules);
    let own = judged.into_iter().flat_map(|(faults, _)| faults);
    own.chain(by_response).collect()
}

/// A fault by relations is proved where every run of the campaign shows it, except for units, which
/// differ by orders of magnitude.
fn withdraw_where_runs_disagree<T>(by_run: &mut [(Vec<Fault>, T)]) {
    use FaultKind::{Gravity, Sign, Swapped};
    let runs: Vec<Vec<Fault>> = by_run.iter().map(|(faults, _)| faults.clone()).collect();
    for fault in by_run.iter_mut().flat_map(|(faults, _)| faults) {
        let same = |own: &Fault| own.kind == fault.kind && own.columns == fault.columns;
        let shows = |run: &Vec<Fault>| run.iter().any(|own| own.proven && same(own));
        let by_relation = matches!(fault.kind, Sign | Swapped | Gravity);
        fault.proven &= !by_relation || runs.iter().all(shows);
    }
}

/// Refuses runs of which a fault is proved; suspected faults become one remark on the first run
/// concerned.
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
    let of = |run: &Run| suspected.iter().find(|fault| fault.run == run.entry.run);
    let count = runs.iter().filter(|run| of(run).is_some()).count();
    let mut concerned = runs.iter_mut().filter_map(|run| Some((of(run)?, run)));
    let Some((fault, first)) = concerned.next() else {
        return;
    };
    let more = match count {
        1 => String::new(),
        2 => ", and another run raises doubts".to_owned(),
        count => format!(", and {} other runs raise doubts", count - 1),
    };
    first.remarks.push(format!(
        "run {}: {} may be {}{more}; not proved, so nothing is refused (kufe runs check states the evidence)",
        fault.run,
        fault.columns.join(", "),
        fault.looks_like,
    ));
}

impl RelationRules {
    /// Mends the faults that the relations show, and appends them to `faults`.
    fn mend_all(&self, run: &Run, slow: &mut Slow, faults: &mut Vec<Fault>) {
        let mut mend = |mend: &Remedy, slow: &mut Slow, proven: bool, evidence: String| {
            let fault = Fault::proven(run, &mend.columns(), mend.1, evidence);
            faults.push(fault.proven_if(proven));
            *slow = mend.applied(slow);
        };
        for _ in 0..MOST {
            let before = Agreement::of(slow);
            let single = self.one(slow, &before);
            let Some((mends, after)) = single.or_else(|| self.two_at_once(slow, &before)) else {
                break;
            };
            let proven = self.is_satisfied_once_mended(&before, &after);
            for one in &mends {
                mend(one, slow, proven, evidence(&before, &after));
            }
            if mends.len() > 1 {
                break;
            }
        }
        // The factor of `ay` is often too small to show in the residual of its relation, and known
        // well enough all the same. That of `ax` is not: gravity along the sled is far larger, and
        // where a record's pitch rate misses changes of slope, it has any sign.
        for one in REMEDIES.iter().filter(|mend| mend.0 == [Sensor::Ay]) {
            let axis = Sensor::Ay as usize;
            let (Some(wanted), Some((found, error))) = (one.factor(), factor(slow, axis)) else {
                continue;
            };
            // The factor means nothing where the relation is not satisfied.
            let residual = Agreement::of(slow).residual[axis];
            let near = residual.is_some_and(|residual| residual < self.holds)
                && (found - wanted).abs() < 0.5 * wanted.abs().max(1.0);
            let significant =
                error < 0.15 * wanted.abs() && (found - 1.0).abs() > self.least_t * error;
            if near && significant {
                let evidence = format!(
                    "the other channels' motion requires {found:.2} +- {error:.2} times its values"
                );
                mend(one, slow, false, evidence);
            }
        }
        // A constant roll rate shows in the residual across.
        let name = Sensor::RollRate.name();
        let constant = |x: &&Vec<f64>| x.iter().all(|y| *y == x[0]);
        if let Some(roll) = run.columns.get(name).filter(constant)
            && let Some(residual) = Agreement::of(slow).residual[1]
            && residual > self.holds
        {
            let value = roll[0];
            let evidence = format!("{value} in every row, while gravity turns across the sled");
            let fault = Fault::proven(run, &[name], Mend::Replace, evidence);
            faults.push(fault.proven_if(false));
        }
    }

    /// The best single remedy that is shown to be right.
    fn one(&self, slow: &Slow, before: &Agreement) -> Option<RemedyTrial> {
        let there = REMEDIES.iter().filter(|mend| mend.applies(slow));
        let mended = there.map(|mend| (vec![mend], Agreement::of(&mend.applied(slow))));
        let shown = mended.filter(|(_, after)| self.shows(before, after));
        shown.reduce(better)
    }

    /// Two faults of which neither shows while the other is there; searched where the relations
    /// across or up are not satisfied.
    fn two_at_once(&self, slow: &Slow, before: &Agreement) -> Option<RemedyTrial> {
        if before.is_below(self.holds) {
            return None;
        }
        let there: Vec<&'static Remedy> =
            REMEDIES.iter().filter(|mend| mend.applies(slow)).collect();
        let with_later = |k: usize| there[k + 1..].iter().map(move |other| (k, *other));
        let pairs: Vec<(usize, &'static Remedy)> = (0..there.len()).flat_map(with_later).collect();
        let mend_both = |(k, other): (usize, &'static Remedy)| {
            let one = there[k];
            let after = Agreement::of(&other.applied(&one.applied(slow)));
            let gain = before.score() - after.score();
            let mends = after.is_below(self.holds) && gain >= 2.0 * self.least_gain;
            mends.then(|| (vec![one, other], after))
        };
        let judged: Vec<RemedyTrial> = pairs.into_par_iter().filter_map(mend_both).collect();
        judged.into_iter().reduce(better)
    }

    /// Whether a relation is satisfied within its noise once mended, and not before.
    fn is_satisfied_once_mended(&self, before: &Agreement, after: &Agreement) -> bool {
        let mut pairs = before
            .residual
            .iter()
            .zip(after.residual)
            .flat_map(|(b, a)| b.zip(a));
        pairs.any(|(b, a)| b >= self.noise && a < self.noise)
    }

    /// Whether a relation shows the fault and no other gets worse.
    fn shows(&self, before: &Agreement, after: &Agreement) -> bool {
        let pairs = || {
            let pairs = before.residual.iter().zip(after.residual);
            pairs.filter_map(|(b, a)| Some((*b, a?)))
        };
        let better = pairs()
            .any(|(b, a)| a < self.holds && b.is_some_and(|b| b > self.shows && a < 0.7 * b));
        let hold = pairs().all(|(b, a)| a < self.holds || b.is_some_and(|b| a < b + self.worse));
        before.score() - after.score() >= self.least_gain && better && hold
    }
}

/// Remedies and how well the channels then agree.
type RemedyTrial = (Vec<&'static Remedy>, Agreement);

/// The one with the lower score; the first of equals.
fn better(a: RemedyTrial, b: RemedyTrial) -> RemedyTrial {
    if b.1.score() < a.1.score() - 1e-9 {
        b
    } else {
        a
    }
}

/// Distance in another unit, by the integral of the mended speed.
fn distance_fault(run: &Run, slow: &Slow) -> Option<Fault> {
    // Runs follow the middle of the track within a few per cent; a circuit that starts anew is no
    // distance run.
    const CLOSE: f64 = 0.2;
    let s = run.columns.get("s_m")?;
    let (raw, mended) = (Slow::of(run)?, slow[Sensor::Speed].as_ref()?);
    let sum = |v: &[f64]| v.iter().sum::<f64>();
    let factor = sum(mended) / sum(raw[Sensor::Speed].as_ref()?) * slow.dt_s / raw.dt_s;
    let (first, last) = (s.first()?, s.last()?);
    let travelled = sum(&bridged(run.columns.get("v_mps")?)) * run.dt_s * factor;
    let share = (last - first) / travelled;
    let units = [
        ("kilometres", "km", 1e-3),
        ("millimetres", "mm", 1e3),
        ("centimetres", "cm", 100.0),
        ("feet", "ft", 1.0 / 0.3048),
        ("miles", "mi", 1.0 / 1609.344),
        ("a distance that runs backwards", "", -1.0),
    ];
    let is_close = |(.., per_metre): &Unit| (share / per_metre - 1.0).abs() < CLOSE;
    let unit = units.into_iter().find(is_close)?;
    let way = last - first;
    let evidence = format!("{way:.5} where the speed adds up to {travelled:.1} m");
    Some(Fault::proven(run, &["s_m"], Mend::Distance(unit), evidence))
}

/// Residuals of the relations before and after.
pub(super) fn evidence(before: &Agreement, after: &Agreement) -> String {
    let mut parts = Vec::new();
    let residuals = before.residual.iter().zip(after.residual);
    for (axis, (b, a)) in ["x", "y", "z"].iter().zip(residuals) {
        if let (Some(b), Some(a)) = (*b, a)
            && (b - a).abs() > 0.02
        {
            let [b, a] = [b, a].map(|residual| 100.0 * residual.sqrt());
            parts.push(format!("{b:.0} % along {axis}, mended {a:.0} %"));
        }
    }
    let mut text = format!(
        "residual of d(a - dv/dt - w x v)/dt + w x (...) = 0: {}",
        parts.join("; ")
    );
    if let (Some(b), Some(a)) = (before.lift, after.lift)
        && (b - a).abs() > 0.2
    {
        text += &format!("; lift against gravity {b:.1} m/s2, mended {a:.1}");
    }
    text
}

/// Thresholds of the relations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelationRules {
    /// Least decrease of the disagreement: a factor of e in the mean square residual of one
    /// relation. In clean runs no candidate lowers it by more than 0.4; at half, one run in eleven
    /// with little slip was taken to be in degrees.
    pub least_gain: f64,
    /// A relation is satisfied where its residual over its terms is below this, as a mean square.
    pub holds: f64,
    /// A relation is satisfied within its noise where its residual is below this, as a mean square:
    /// 15 % as a root mean square.
    pub noise: f64,
    /// A fault shows in a relation whose residual is above this, as a mean square; in clean runs it
    /// is up to a tenth (`rigid_body`), of which gravity that a record's pitch rate misses can be
    /// lowered by a wrong sign.
    pub shows: f64,
    /// No relation may get worse by more than this when another is mended.
    pub worse: f64,
    /// Standard errors between a wrong coefficient and the right one: by chance once in 10^9.
    pub least_t: f64,
    /// Share of the runs that must agree where all together prove it.
    pub agree: f64,
    /// Share of the runs' median response that a single run needs to be judged by its sign: a wrong
    /// sign does not change the size.
    pub alike: f64,
    /// Least drag area over mass of a sled or car [m2/kg]; a bobsled has 7e-4, an accelerometer in
    /// g would show a tenth of that.
    pub least_drag: f64,
    /// Standard deviation of a_x above which something drives or brakes [m/s2]: the air is not
    /// judged then.
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
