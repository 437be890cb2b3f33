//! Faults of recorded channels: values that contradict the name of their column.

use std::borrow::Borrow;

use rayon::prelude::*;

use crate::column::{COLUMNS, Sensor};
use crate::error::Error;
use crate::fault::{Fault, FaultKind};
use crate::record::check::corrections::{Correction, DISTANCES, G, OTHER_SIGN};
use crate::record::check::profile::{OddKind, Profile, describe_odd_samples};
use crate::record::check::relations::{Consistency, SlowChannels, required_change};
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
///   disagreement. They are proved if all relations are satisfied in the end.
/// - By the response of a sled to steering ([`response_faults`]), over all runs together.
pub fn find_faults(runs: &[impl Borrow<Run> + Sync]) -> Vec<Fault> {
    find_faults_with(runs, &RelationRules::default())
}

/// As [`find_faults`], with the thresholds `rules`.
pub fn find_faults_with(runs: &[impl Borrow<Run> + Sync], rules: &RelationRules) -> Vec<Fault> {
    let single = runs.par_iter().map(|run| {
        let run: &Run = Borrow::borrow(run);
        let faults = plain_faults(run);
        // A channel that is constant or repeated cannot be corrected by a unit.
        let slow = SlowChannels::of(run).filter(|_| faults.is_empty());
        RunFaults { run, faults, slow }
    });
    let mut all: Vec<RunFaults> = single.collect();
    let slow: Vec<&SlowChannels> = all.iter().filter_map(|one| one.slow.as_ref()).collect();
    let rotation = BoxRotation::of(&slow, rules);
    all.par_iter_mut()
        .for_each(|one| one.check(rotation.as_ref(), rules));
    withdraw_unless_in_all_runs(&mut all);
    let consistent = all
        .iter()
        .filter_map(|one| Some((one.run, one.slow.as_ref()?)));
    let by_response = response_faults(&consistent.collect::<Vec<_>>(), rules);
    let own = all.into_iter().flat_map(|one| one.faults);
    own.chain(by_response).collect()
}

/// A run with its faults.
struct RunFaults<'a> {
    run: &'a Run,
    faults: Vec<Fault>,
    /// The low-passed channels, corrected; `None` if the relations cannot be checked or are not
    /// satisfied after correction.
    slow: Option<SlowChannels>,
}

impl RunFaults<'_> {
    /// Checks relations, ranges and distance.
    fn check(&mut self, rotation: Option<&BoxRotation>, rules: &RelationRules) {
        let slow = self.slow.take().map(|mut slow| {
            if let Some(rotation) = rotation {
                self.faults.extend(rotation.correct(self.run, &mut slow));
            }
            rules.correct(self.run, &mut slow, &mut self.faults);
            slow
        });
        let ranges = range_faults(self.run, &self.faults);
        let distance = slow
            .as_ref()
            .and_then(|slow| distance_fault(self.run, slow));
        self.slow = slow.filter(|slow| {
            ranges.is_empty() && Consistency::of(slow).is_below(rules.satisfied_below)
        });
        self.faults.extend(ranges);
        self.faults.extend(distance);
    }
}

/// Sign, swap and gravity faults are proved only if every run shows them. One run proves a wrong
/// unit, since values are off by orders of magnitude.
fn withdraw_unless_in_all_runs(all: &mut [RunFaults]) {
    use FaultKind::{Gravity, Sign, Swapped};
    let runs: Vec<Vec<Fault>> = all.iter().map(|one| one.faults.clone()).collect();
    for fault in all.iter_mut().flat_map(|one| &mut one.faults) {
        let is_same = |own: &Fault| own.kind == fault.kind && own.columns == fault.columns;
        let has_it = |run: &Vec<Fault>| run.iter().any(|own| own.proven && is_same(own));
        let by_relation = matches!(fault.kind, Sign | Swapped | Gravity);
        fault.proven &= !by_relation || runs.iter().all(has_it);
    }
}

/// Refuses runs with a proved fault. Suspected faults become one remark on the first run concerned.
///
/// # Errors
/// [`Error::Wrong`] with the first proved fault and the number of further ones.
pub fn check_relations(runs: &mut [Run]) -> Result<(), Error> {
    let (proven, suspected): (Vec<Fault>, Vec<Fault>) = find_faults(runs)
        .into_iter()
        .partition(|fault| fault.proven);
    if let Some((first, more)) = proven.split_first() {
        return Err(Error::Wrong {
            fault: Box::new(first.clone()),
            more: more.len(),
        });
    }
    add_remarks(runs, &suspected);
    Ok(())
}

/// Adds remarks on leaps, drop-outs and implausibly constant values to each run, and one remark on
/// all suspected faults to the first run concerned.
pub(crate) fn add_remarks(runs: &mut [Run], suspected: &[Fault]) {
    runs.par_iter_mut().for_each(add_remarks_on_odd_samples);
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

fn add_remarks_on_odd_samples(run: &mut Run) {
    let mut remarks = Vec::new();
    for name in COLUMNS {
        let Some(column) = run.columns.get(name) else {
            continue;
        };
        let (_, mut odd) = Profile::of(column, &run.gaps.pieces, run.rate_hz());
        // Constant values at an end stop have their own remark.
        let stop = run.saturated.get(name).map(|stop| stop.at);
        odd.retain(|one| one.kind != OddKind::Still || Some(column[one.samples.start]) != stop);
        let file = run.entry.file.display();
        for (_, text) in describe_odd_samples(run, column, &odd) {
            remarks.push(format!("{file}: column {name}: {text}"));
        }
    }
    run.remarks.extend(remarks);
}

/// A set of corrections, and the consistency of the channels after them.
struct Trial {
    corrections: Vec<Correction>,
    slow: SlowChannels,
    after: Consistency,
}

impl Trial {
    fn of(corrections: &[Correction], slow: &SlowChannels) -> Trial {
        let apply = |slow: SlowChannels, one: &Correction| one.applied(&slow);
        let slow = corrections.iter().fold(slow.clone(), apply);
        Trial {
            corrections: corrections.to_vec(),
            after: Consistency::of(&slow),
            slow,
        }
    }
}

impl RelationRules {
    /// Corrects the channels by the relations, and appends the faults.
    ///
    /// If the relations are not satisfied and no single correction is accepted, pairs of
    /// corrections are tried: one fault may hide another.
    fn correct(&self, run: &Run, slow: &mut SlowChannels, faults: &mut Vec<Fault>) {
        let all = Correction::all(slow);
        let singles: Vec<Vec<Correction>> = all.iter().map(|one| vec![*one]).collect();
        let with_later = |k: usize| all[k + 1..].iter().map(move |other| (k, *other));
        let pairs: Vec<Vec<Correction>> = (0..all.len())
            .flat_map(with_later)
            .map(|(k, other)| vec![all[k], other])
            .collect();
        let mut found = Vec::new();
        for _ in 0..MAX_CORRECTIONS {
            let before = Consistency::of(slow);
            let mut best = self.best(slow, &before, &singles);
            if best.is_none() && !before.is_below(self.satisfied_below) {
                best = self.best(slow, &before, &pairs);
            }
            let Some(best) = best else { break };
            // Proved if a relation is satisfied within its noise after the correction and was not
            // before.
            let mut changes = before.changes(&best.after);
            let proven = changes.any(|(_, b, a)| b >= self.noise_below && a < self.noise_below);
            for one in &best.corrections {
                let fault = one.fault(run, before.describe_change(&best.after));
                found.push(fault.proven_if(proven));
            }
            *slow = best.slow;
        }
        // A correction is not proved if a relation is still violated.
        let mut residuals = Consistency::of(slow).residual.into_iter().flatten();
        if residuals.any(|residual| residual > self.violated_above) {
            found.iter_mut().for_each(|fault| fault.proven = false);
        }
        faults.append(&mut found);
        if let Some((one, evidence)) = self.lateral_scale(slow) {
            faults.push(one.fault(run, evidence).proven_if(false));
            *slow = one.applied(slow);
        }
    }

    /// The accepted set of corrections with the least disagreement, the first of equals; `None` if
    /// none is accepted.
    fn best(
        &self,
        slow: &SlowChannels,
        before: &Consistency,
        sets: &[Vec<Correction>],
    ) -> Option<Trial> {
        let trials = sets.par_iter().map(|set| Trial::of(set, slow));
        let accepted: Vec<Trial> = trials
            .filter(|trial| self.is_accepted(before, trial))
            .collect();
        accepted.into_iter().reduce(|a, b| {
            let is_better = b.after.disagreement() < a.after.disagreement() - 1e-9;
            if is_better { b } else { a }
        })
    }

    /// Whether a violated relation becomes satisfied, and no other relation gets worse.
    fn is_accepted(&self, before: &Consistency, trial: &Trial) -> bool {
        let changes = || before.changes(&trial.after);
        let is_mended = changes()
            .any(|(_, b, a)| a < self.satisfied_below && b > self.violated_above && a < 0.7 * b);
        let none_worse =
            changes().all(|(_, b, a)| a < self.satisfied_below || a < b + self.max_increase);
        let min_gain = self.min_gain * trial.corrections.len() as f64;
        let gain = before.disagreement() - trial.after.disagreement();
        gain >= min_gain && is_mended && none_worse
    }

    /// A wrong unit or sign of the lateral acceleration, found by regression on the motion of the
    /// other channels. Its effect on the residual of a relation is often too small to be seen, but
    /// the regression still determines the scale well.
    ///
    /// The scale of the longitudinal acceleration is not determined: gravity along the sled is far
    /// larger. If the recorded pitch rate misses changes of slope, the estimate may have any sign.
    fn lateral_scale(&self, slow: &SlowChannels) -> Option<(Correction, String)> {
        const AXIS: [Sensor; 1] = [Sensor::Ay];
        // The scale is meaningless if the relation is not satisfied.
        Consistency::of(slow).residual[AXIS[0] as usize]
            .filter(|residual| *residual < self.satisfied_below)?;
        [G, OTHER_SIGN].into_iter().find_map(|scale| {
            let one = Correction::Scale(scale, &AXIS);
            let (steps, error) = required_change(slow, &one.applied(slow))?;
            // One step changes the factor from 1 to that of the scale.
            let factor = 1.0 + steps * (scale.factor - 1.0);
            let error = error * (scale.factor - 1.0).abs();
            let is_near = (factor - scale.factor).abs() < 0.5 * scale.factor.abs().max(1.0);
            let is_significant =
                error < 0.15 * scale.factor.abs() && (factor - 1.0).abs() > self.min_t * error;
            let evidence = format!(
                "the other channels' motion requires {factor:.2} +- {error:.2} times its values"
            );
            (is_near && is_significant).then_some((one, evidence))
        })
    }
}

/// Distance in another unit, compared with the integral of the corrected speed.
fn distance_fault(run: &Run, slow: &SlowChannels) -> Option<Fault> {
    // Runs follow the middle of the track within a few per cent. A speed divided by 3.6 once too
    // often would match a distance in feet within 10 %. A distance that restarts on a circuit
    // matches no unit.
    const MAX_DEVIATION: f64 = 0.06;
    let s = run.columns.get("s_m")?;
    let v = slow[Sensor::Speed].as_ref()?;
    let mean_speed = v.iter().sum::<f64>() / v.len() as f64;
    let travelled = mean_speed * run.len() as f64 * run.dt_s;
    let recorded = s.last()? - s.first()?;
    let unit = DISTANCES
        .iter()
        .find(|unit| (recorded * unit.factor / travelled - 1.0).abs() < MAX_DEVIATION)?;
    let evidence = format!("{recorded:.5} where the speed adds up to {travelled:.1} m");
    Some(unit.fault(run, &["s_m"], evidence))
}

/// Thresholds of the relations. Residuals are mean squares relative to the relation's terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelationRules {
    /// Smallest decrease of the disagreement per correction; 1 is a factor of e in the mean square
    /// residual of one relation. In clean runs no candidate lowers it by more than 0.4. With half
    /// this threshold, 1 of 11 runs with little slip was falsely reported as in degrees.
    pub min_gain: f64,
    /// A relation is satisfied after a correction if its residual is below this.
    pub satisfied_below: f64,
    /// A relation is satisfied within its noise if its residual is below this: 15 % as a root mean
    /// square.
    pub noise_below: f64,
    /// A relation is violated before a correction if its residual is above this. In clean runs it
    /// is up to 0.1 (`relations`). A wrong sign can lower the part due to gravity that the recorded
    /// pitch rate misses. A correction that leaves a residual above this is suspected, not proved.
    pub violated_above: f64,
    /// Largest increase of the residual of another relation by a correction.
    pub max_increase: f64,
    /// Smallest distance of a wrong coefficient from the right one in standard errors: by chance
    /// once in 10^9.
    pub min_t: f64,
    /// Smallest share of runs that show a fault which is found over all runs together.
    pub min_run_share: f64,
    /// Smallest ratio of a run's response to the median response of the runs, for a check of its
    /// sign by this run alone: a wrong sign does not change the size.
    pub min_relative_response: f64,
    /// Smallest ratio of drag area to mass of a sled or car [m2/kg]; a bobsled has 7e-4, an
    /// accelerometer in g would show a tenth of this.
    pub min_drag: f64,
    /// Largest standard deviation of a_x for a check of the air drag [m/s2]; above it the vehicle
    /// is driven or braked.
    pub max_coasting_sd: f64,
}

impl Default for RelationRules {
    fn default() -> Self {
        RelationRules {
            min_gain: 1.0,
            satisfied_below: 0.25,
            noise_below: 0.15 * 0.15,
            violated_above: 0.1,
            max_increase: 0.1,
            min_t: 6.0,
            min_run_share: 0.8,
            min_relative_response: 0.5,
            min_drag: 2e-4,
            max_coasting_sd: 1.0,
        }
    }
}
