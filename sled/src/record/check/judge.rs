//! Channels of runs whose values provably contradict their names.

use std::borrow::Borrow;

use rayon::prelude::*;

use crate::column::{COLUMNS, Sensor};
use crate::error::Error;
use crate::fault::{Fault, FaultKind};
use crate::record::check::corrections::{Correction, DISTANCES, G, OTHER_SIGN};
use crate::record::check::profile::{Odd, OddKind, Profile, odd_words};
use crate::record::check::relations::{Agreement, Slow, required_change};
use crate::record::check::response::response_faults;
use crate::record::check::rotation::BoxRotation;
use crate::record::check::single::{plain_faults, range_faults};
use crate::record::run::Run;

/// Largest number of successive corrections of one run.
const MAX_CORRECTIONS: usize = 4;

/// All faults of these runs, run by run.
///
/// - Of single channels ([`plain_faults`], [`range_faults`]).
/// - By the motion that a turned sensor box measures ([`BoxRotation`]), over all runs together.
/// - By the relations of a rigid body: one correction after the other as long as it lowers the
///   disagreement. They are proved where all relations are satisfied in the end.
/// - By the response of a sled to steering ([`response_faults`]), over all runs together.
pub fn judge(runs: &[impl Borrow<Run> + Sync]) -> Vec<Fault> {
    judge_by(runs, &RelationRules::default())
}

/// As [`judge`], with the thresholds `rules`.
pub fn judge_by(runs: &[impl Borrow<Run> + Sync], rules: &RelationRules) -> Vec<Fault> {
    let runs: Vec<&Run> = runs.iter().map(Borrow::borrow).collect();
    let single = |run| {
        let faults = plain_faults(run);
        // A channel that is constant or repeated cannot be corrected by a unit.
        let slow = Slow::of(run).filter(|_| faults.is_empty());
        Judged { run, faults, slow }
    };
    let mut judged: Vec<Judged> = runs.into_par_iter().map(single).collect();
    let slow: Vec<&Slow> = judged.iter().filter_map(|one| one.slow.as_ref()).collect();
    let rotation = BoxRotation::of(&slow, rules);
    judged
        .par_iter_mut()
        .for_each(|one| one.judge(rotation.as_ref(), rules));
    withdraw_where_runs_disagree(&mut judged);
    let agreeing = judged
        .iter()
        .filter_map(|one| Some((one.run, one.slow.as_ref()?)));
    let by_response = response_faults(&agreeing.collect::<Vec<_>>(), rules);
    let own = judged.into_iter().flat_map(|one| one.faults);
    own.chain(by_response).collect()
}

/// A run with its faults and, if relations can be checked, its low-passed, corrected channels.
struct Judged<'a> {
    run: &'a Run,
    faults: Vec<Fault>,
    slow: Option<Slow>,
}

impl Judged<'_> {
    /// Checks relations, ranges and distance. Keeps the low-passed channels only if they are
    /// consistent after correction.
    fn judge(&mut self, rotation: Option<&BoxRotation>, rules: &RelationRules) {
        if let Some(mut slow) = self.slow.take() {
            if let Some(rotation) = rotation {
                self.faults.extend(rotation.correct(self.run, &mut slow));
            }
            rules.correct(self.run, &mut slow, &mut self.faults);
            self.slow = Some(slow);
        }
        let ranges = range_faults(self.run, &self.faults);
        let agrees = |slow: &Slow| ranges.is_empty() && Agreement::of(slow).is_below(rules.holds);
        let distance = self
            .slow
            .as_ref()
            .and_then(|slow| distance_fault(self.run, slow));
        self.slow = self.slow.take().filter(agrees);
        self.faults.extend(ranges);
        self.faults.extend(distance);
    }
}

/// Sign, swap and gravity faults count as proved only if every run shows them. A wrong unit is
/// proved by one run, since it is off by orders of magnitude.
fn withdraw_where_runs_disagree(judged: &mut [Judged]) {
    use FaultKind::{Gravity, Sign, Swapped};
    let runs: Vec<Vec<Fault>> = judged.iter().map(|one| one.faults.clone()).collect();
    for fault in judged.iter_mut().flat_map(|one| &mut one.faults) {
        let same = |own: &Fault| own.kind == fault.kind && own.columns == fault.columns;
        let shows = |run: &Vec<Fault>| run.iter().any(|own| own.proven && same(own));
        let by_relation = matches!(fault.kind, Sign | Swapped | Gravity);
        fault.proven &= !by_relation || runs.iter().all(shows);
    }
}

/// Refuses runs with a proved fault. Suspected faults become one remark on the first run concerned.
///
/// # Errors
/// [`Error::Wrong`] with the first proved fault and the number of further ones.
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

/// Remarks on where channels leap or have one value for long, and on suspected faults: these in one
/// line on the first run concerned.
pub(crate) fn remark(runs: &mut [Run], suspected: &[Fault]) {
    runs.par_iter_mut().for_each(remark_on_odd_stretches);
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

fn remark_on_odd_stretches(run: &mut Run) {
    let mut remarks = Vec::new();
    for name in COLUMNS {
        let Some(column) = run.columns.get(name) else {
            continue;
        };
        let (_, odd) = Profile::of(column, &run.gaps.pieces, run.rate_hz());
        // A stretch at an end stop has its own remark.
        let stop = run.saturated.get(name).map(|stop| stop.at);
        let is_stop = |one: &Odd| one.kind == OddKind::Still && Some(column[one.at.start]) == stop;
        let odd: Vec<Odd> = odd.into_iter().filter(|one| !is_stop(one)).collect();
        let words = odd_words(run, column, &odd);
        let file = run.entry.file.display();
        let remark = |(_, what): &(_, String)| format!("{file}: column {name}: {what}");
        remarks.extend(words.iter().map(remark));
    }
    run.remarks.extend(remarks);
}

/// A set of corrections, and the agreement of the channels after them.
struct Trial {
    corrections: Vec<Correction>,
    slow: Slow,
    after: Agreement,
}

impl Trial {
    fn of(corrections: Vec<Correction>, slow: &Slow) -> Trial {
        let apply = |slow: Slow, one: &Correction| one.applied(&slow);
        let slow = corrections.iter().fold(slow.clone(), apply);
        let after = Agreement::of(&slow);
        Trial {
            corrections,
            slow,
            after,
        }
    }
}

impl RelationRules {
    /// Corrects the channels by the relations, and appends the faults.
    ///
    /// If the relations are not satisfied and no single correction is accepted, pairs of
    /// corrections are tried: one fault may hide another.
    fn correct(&self, run: &Run, slow: &mut Slow, faults: &mut Vec<Fault>) {
        let all = Correction::all(slow);
        let singles: Vec<Vec<Correction>> = all.iter().map(|one| vec![*one]).collect();
        let second = |k: usize| all[k + 1..].iter().map(move |other| (k, *other));
        let pairs = (0..all.len())
            .flat_map(second)
            .map(|(k, other)| vec![all[k], other]);
        let pairs: Vec<Vec<Correction>> = pairs.collect();
        let mut found = Vec::new();
        for _ in 0..MAX_CORRECTIONS {
            let before = Agreement::of(slow);
            let best = self.best(slow, &before, &singles);
            let best = best.or_else(|| {
                let pairs = pairs.as_slice();
                let tried = if before.is_below(self.holds) {
                    &[]
                } else {
                    pairs
                };
                self.best(slow, &before, tried)
            });
            let Some(best) = best else { break };
            // Proved if a relation is satisfied within its noise after the correction and was not
            // before.
            let mut changes = before.changes(&best.after);
            let proven = changes.any(|(_, b, a)| b >= self.noise && a < self.noise);
            for one in &best.corrections {
                let fault = one.fault(run, before.compared(&best.after));
                found.push(fault.proven_if(proven));
            }
            *slow = best.slow;
        }
        // A correction is not proved if a relation still shows another fault.
        let mut residuals = Agreement::of(slow).residual.into_iter().flatten();
        if residuals.any(|residual| residual > self.shows) {
            found.iter_mut().for_each(|fault| fault.proven = false);
        }
        faults.append(&mut found);
        if let Some((one, evidence)) = self.lateral_scale(slow) {
            faults.push(one.fault(run, evidence).proven_if(false));
            *slow = one.applied(slow);
        }
    }

    /// The best accepted set of corrections; `None` if none is accepted.
    fn best(&self, slow: &Slow, before: &Agreement, sets: &[Vec<Correction>]) -> Option<Trial> {
        let trials = sets.par_iter().map(|set| Trial::of(set.clone(), slow));
        let shown = trials.filter(|trial| self.shows(before, trial));
        let shown: Vec<Trial> = shown.collect();
        // The first of equals.
        shown.into_iter().reduce(|a, b| {
            let better = b.after.score() < a.after.score() - 1e-9;
            if better { b } else { a }
        })
    }

    /// Whether a set of corrections is accepted: a relation shows the faults, and no other gets
    /// worse.
    fn shows(&self, before: &Agreement, trial: &Trial) -> bool {
        let changes = || before.changes(&trial.after);
        let better = changes().any(|(_, b, a)| a < self.holds && b > self.shows && a < 0.7 * b);
        let hold = changes().all(|(_, b, a)| a < self.holds || a < b + self.worse);
        let gain = self.least_gain * trial.corrections.len() as f64;
        before.score() - trial.after.score() >= gain && better && hold
    }

    /// A wrong unit or sign of the lateral acceleration, found by regression on the motion of the
    /// other channels. Its effect on the residual of a relation is often too small to show, but the
    /// scale is still determined well.
    ///
    /// The scale of the longitudinal acceleration is not: gravity along the sled is far larger, and
    /// if a record's pitch rate misses changes of slope, the estimate may have any sign.
    fn lateral_scale(&self, slow: &Slow) -> Option<(Correction, String)> {
        const AXIS: [Sensor; 1] = [Sensor::Ay];
        // The scale is meaningless if the relation is not satisfied.
        let residual = Agreement::of(slow).residual[AXIS[0] as usize]?;
        let found = [G, OTHER_SIGN].map(|scale| {
            let one = Correction::Scale(scale, &AXIS);
            let (steps, error) = required_change(slow, &one.applied(slow))?;
            // One step changes the factor from 1 to that of the scale.
            let (found, error) = (
                1.0 + steps * (scale.factor - 1.0),
                error * (scale.factor - 1.0).abs(),
            );
            let near = (found - scale.factor).abs() < 0.5 * scale.factor.abs().max(1.0);
            let significant =
                error < 0.15 * scale.factor.abs() && (found - 1.0).abs() > self.least_t * error;
            let evidence = format!(
                "the other channels' motion requires {found:.2} +- {error:.2} times its values"
            );
            (near && significant).then_some((one, evidence))
        });
        found
            .into_iter()
            .flatten()
            .next()
            .filter(|_| residual < self.holds)
    }
}

/// Distance in another unit, compared with the integral of the corrected speed.
fn distance_fault(run: &Run, slow: &Slow) -> Option<Fault> {
    // Runs follow the middle of the track within a few per cent. A speed divided by 3.6 once too
    // often would match a distance in feet within 10 %. A distance that restarts on a circuit
    // matches no unit.
    const CLOSE: f64 = 0.06;
    let s = run.columns.get("s_m")?;
    let v = slow[Sensor::Speed].as_ref()?;
    let mean_speed = v.iter().sum::<f64>() / v.len() as f64;
    let travelled = mean_speed * run.len() as f64 * run.dt_s;
    let way = s.last()? - s.first()?;
    let unit = DISTANCES
        .iter()
        .find(|unit| (way * unit.factor / travelled - 1.0).abs() < CLOSE)?;
    let evidence = format!("{way:.5} where the speed adds up to {travelled:.1} m");
    Some(unit.fault(run, &["s_m"], evidence))
}

/// Thresholds of the relations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelationRules {
    /// Smallest decrease of the disagreement per correction; 1 is a factor of e in the mean square
    /// residual of one relation. In clean runs no candidate lowers it by more than 0.4. With half
    /// this threshold, 1 of 11 runs with little slip was falsely reported as in degrees.
    pub least_gain: f64,
    /// A relation is satisfied after a correction if its residual is below this. Residuals are mean
    /// squares relative to the relation's terms.
    pub holds: f64,
    /// A relation is satisfied within its noise if its residual is below this: 15 % as a root mean
    /// square.
    pub noise: f64,
    /// A relation may show a fault if its residual before a correction is above this. In clean runs
    /// it is up to 0.1 (`relations`); the part due to gravity that a record's pitch rate misses can
    /// be lowered by a wrong sign. A residual between `shows` and `holds` is tolerated after a
    /// correction, but makes it suspected instead of proved.
    pub shows: f64,
    /// Largest increase of the residual of another relation by a correction.
    pub worse: f64,
    /// Smallest distance of a wrong coefficient from the right one in standard errors: by chance
    /// once in 10^9.
    pub least_t: f64,
    /// Smallest share of runs that must agree on a fault that all runs prove together.
    pub agree: f64,
    /// Smallest ratio of a run's response to the median response of the runs, for a check of its
    /// sign: a wrong sign does not change the size.
    pub alike: f64,
    /// Smallest ratio of drag area to mass of a sled or car [m2/kg]; a bobsled has 7e-4, an
    /// accelerometer in g would show a tenth of this.
    pub least_drag: f64,
    /// Largest standard deviation of a_x for a check of the air drag [m/s2]; above it the vehicle
    /// is driven or braked.
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
