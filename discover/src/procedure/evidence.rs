//! Interface of the search to data of any kind.

use kufe_sled::effects::Info;

use crate::error::Result;
use crate::finding::{
    Baseline, Detectable, Fitted, HeldOut, Interval, ModelKind, Report, Rival, Step, Tolerated,
    Withheld,
};
use crate::procedure::candidate::Candidate;
use crate::procedure::misfit_decrease::Decrease;

/// Data of one kind, of which a part is held out, and the model that is tested with them.
pub trait Evidence {
    /// Description of how a candidate changes the model of these data.
    type Act;
    /// A model fitted to the training data.
    type Fit: Clone;

    /// Fits the base model.
    fn fit_base(&mut self, account: &mut Account) -> Result<Self::Fit>;

    /// Scores every candidate given the fit, with p-values under the null.
    fn screen(&mut self, fit: &Self::Fit, account: &mut Account) -> Result<Screen<Self::Act>>;

    /// Fits base, earlier selected effects and this one together; it belongs to step `step` of the
    /// account.
    fn add(
        &mut self,
        fit: &Self::Fit,
        selection: &Selection<Self::Act>,
        step: usize,
    ) -> Result<ExtendedFit<Self::Fit>>;

    /// Re-evaluates a selected effect at its fit: returns the effect or its replacement.
    fn exchange(
        &mut self,
        _before: &Self::Fit,
        selected: SelectedFit<Self::Act, Self::Fit>,
        _step: usize,
        _account: &Account,
    ) -> Result<SelectedFit<Self::Act, Self::Fit>> {
        Ok(selected)
    }

    /// Removes from fit and account the effects that later ones have made superfluous, and refits.
    fn remove_superfluous(&mut self, fit: Self::Fit, account: &mut Account) -> Result<Self::Fit>;

    /// Refits without the effects of a step.
    fn without(&mut self, fit: &Self::Fit, step: usize) -> Result<Self::Fit>;

    /// Decrease of the held-out misfit from the first fit to the second, all channels together;
    /// `None` without held-out data.
    fn misfit_decrease(&self, from: &Self::Fit, to: &Self::Fit) -> Result<Option<Decrease>>;

    /// Compares the two fits on the held-out data.
    fn compare(
        &mut self,
        base: &Self::Fit,
        last: &Self::Fit,
        steps: &[Step],
    ) -> Result<HeldOutResults>;

    /// The model to write: the first of these that is no worse than the model as given on data it
    /// was not fitted to: the fit with all or some effects, the refitted base, the model as given.
    fn choose(
        &mut self,
        refitted: &Self::Fit,
        last: Self::Fit,
        account: &mut Account,
    ) -> Result<Choice<Self::Fit>> {
        let _ = refitted;
        Ok(Choice {
            fit: last,
            written: if account.steps.is_empty() {
                ModelKind::Refitted
            } else {
                ModelKind::WithEffect
            },
            baselines: Vec::new(),
            withheld: Vec::new(),
        })
    }

    /// The remaining results of a report, and the next model.
    fn describe(
        &mut self,
        base: &Self::Fit,
        last: &Self::Fit,
        account: &mut Account,
    ) -> Result<Description>;
}

/// Reason for removing an effect that later ones explain.
pub const SUPERFLUOUS: &str = "became superfluous";

/// Reason for removing an effect whose size may be 0.
pub const NO_SIZE: &str = "had an interval that contains 0";

/// State of a search: what it has found and what it remarks.
#[derive(Clone, Debug, Default)]
pub struct Account {
    /// The effects that are named.
    pub steps: Vec<Step>,
    pub remarks: Vec<String>,
    /// Assumptions without which a selected effect would not be significant.
    pub depends: Vec<Dependence>,
    /// Why no effect is named although data and model differ.
    pub unexplained: Option<Unexplained>,
    /// Installation errors that exceed their tolerance, with the ratio of size to tolerance.
    pub outside_tolerance: Vec<(String, f64)>,
}

/// A difference of data and model without a named cause.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unexplained {
    /// Why the cause is not identified.
    pub reason: String,
    /// What would identify it; empty if unknown.
    pub decides: String,
}

/// An assumption on which a selected effect depends.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependence {
    /// The dependence, in words.
    pub assumption: String,
    /// A measurement that would make it unnecessary.
    pub decides: String,
}

impl Account {
    /// An installation error within its tolerance; `None` if its interval contains 0 or if it
    /// exceeds the tolerance, which adds a remark.
    ///
    /// `size`, its standard `error` and the standard deviation `sd` of the tolerance; `quantile`:
    /// half width of an interval in standard errors.
    pub fn tolerated(
        &mut self,
        what: String,
        unit: &str,
        [size, error, sd]: [f64; 3],
        quantile: f64,
    ) -> Option<Tolerated> {
        let half = quantile * error;
        let is_outside = size.abs() - half > quantile * sd;
        if is_outside {
            self.remarks.push(format!(
                "{what}: {size:.2e} {unit} +- {half:.1e}, outside its tolerance of {sd} (a standard deviation): it was corrected for and not named"
            ));
            self.outside_tolerance.push((what.clone(), size.abs() / sd));
        }
        let unit = unit.to_owned();
        (!is_outside && size.abs() > half).then_some(Tolerated { what, size, unit })
    }

    /// Removes a selected effect for a reason: [`SUPERFLUOUS`], the insufficient size or worse
    /// runs.
    pub fn remove_step(&mut self, step: usize, why: &str) {
        let removed = self.steps.remove(step);
        let message = match self.steps.is_empty() {
            false => format!("{} {why} given the others and was removed", removed.effect),
            true => not_named(&removed, "its size is within its standard error"),
        };
        self.explain_removal(vec![message]);
    }

    /// Removes every selected effect, given their closed shares on the held-out data.
    pub fn remove_all(&mut self, closed: &[Interval]) {
        let removed = std::mem::take(&mut self.steps);
        let message = |(step, closed): (&Step, &Interval)| {
            let by = -100.0 * closed.value;
            not_named(
                step,
                &format!("it increases the explainable misfit on the held-out data (by {by:.0} %)"),
            )
        };
        self.explain_removal(removed.iter().zip(closed).map(message).collect());
    }

    /// Removes these steps because the model with them is worse than the given one, for this
    /// reason.
    pub fn withhold(&mut self, steps: &[usize], reason: &str) {
        let all = std::mem::take(&mut self.steps).into_iter().enumerate();
        let (removed, kept): (Vec<_>, Vec<_>) = all.partition(|(step, _)| steps.contains(step));
        self.steps = kept.into_iter().map(|(_, step)| step).collect();
        let removed: Vec<Step> = removed.into_iter().map(|(_, step)| step).collect();
        let names: Vec<&str> = removed.iter().map(|step| step.effect.as_str()).collect();
        self.explain_removal(vec![format!(
            "{} fits the training runs (p = {:.1e}), but the model with it is worse than the model as given on runs it was not fitted to ({reason}): not named",
            names.join(" with "),
            removed.first().map_or(1.0, |step| step.p_value)
        )]);
    }

    /// Removes a step that is significant at more places than can be listed.
    pub fn remove_nonlocal(&mut self, step: usize, places: usize) {
        let removed = self.steps.remove(step);
        self.explain_removal(vec![format!(
            "{} was significant at {places} places ({}) and is so at others: it is not a local effect and is not named",
            removed.effect, removed.place
        )]);
    }

    /// Reports why effects were removed. If none remains, the misfit is unexplained.
    pub fn explain_removal(&mut self, reasons: Vec<String>) {
        if self.steps.is_empty() {
            self.depends.clear();
            self.unexplained.get_or_insert_with(|| Unexplained {
                reason: reasons.join("; "),
                ..Unexplained::default()
            });
        }
        self.remarks.extend(reasons);
    }
}

/// Why a significant effect is not named.
pub fn not_named(step: &Step, reason: &str) -> String {
    format!(
        "{} is significant on the training data (p = {:.1e}), but {reason}: not named",
        step.effect, step.p_value
    )
}

/// Results of one screen of all candidates.
pub struct Screen<A> {
    /// The selected effect, if one is significant.
    pub selection: Option<Selection<A>>,
    /// Detectable size of each effect.
    pub detectable: Vec<Detectable>,
}

/// p-values of a selected effect by randomisations, if available.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Randomised {
    /// With independent runs.
    pub runs: Option<f64>,
    /// With independent sessions.
    pub sessions: Option<f64>,
}

/// A significant effect.
pub struct Selection<A> {
    pub candidate: Candidate<A>,
    /// Size in its unit.
    pub size: f64,
    pub error: f64,
    /// Effects that the data cannot distinguish, itself first.
    pub class: Vec<String>,
    /// The rivals, best first.
    pub rivals: Vec<Rival>,
    /// p-value over all candidates of its kind.
    pub p_value: f64,
    /// p-values by randomisations of runs and sessions.
    pub randomised: Randomised,
    pub place: String,
    /// The channel that it changes most, and that channel's unit.
    pub channel: (&'static str, &'static str),
    /// A remark that is reported once it is added.
    pub remark: Option<String>,
    /// Size with its interval if it is not estimated from the forces.
    pub parameters: Vec<Fitted>,
}

impl<A> Selection<A> {
    /// A selection without rivals, tests and remarks; its class is itself.
    pub fn new(
        candidate: Candidate<A>,
        size: f64,
        error: f64,
        (place, channel): (&str, (&'static str, &'static str)),
    ) -> Self {
        Self {
            class: vec![candidate.effect.clone()],
            candidate,
            size,
            error,
            rivals: Vec::new(),
            p_value: 1.0,
            randomised: Randomised::default(),
            place: place.to_owned(),
            channel,
            remark: None,
            parameters: Vec::new(),
        }
    }

    /// This selection with another action.
    pub fn with_act<B>(&self, act: B) -> Selection<B> {
        Selection {
            candidate: self.candidate.with_act(act),
            size: self.size,
            error: self.error,
            class: self.class.clone(),
            rivals: self.rivals.clone(),
            p_value: self.p_value,
            randomised: self.randomised,
            place: self.place.clone(),
            channel: self.channel,
            remark: self.remark.clone(),
            parameters: self.parameters.clone(),
        }
    }
}

/// A model with one more effect.
pub struct ExtendedFit<F> {
    pub fit: F,
    /// Whether a model file can contain the effect; if not, the search ends.
    pub is_writable: bool,
    /// Root mean square of the selected effect's channel before and after.
    pub rms: [f64; 2],
    /// Where it acts, if that follows from the fit; includes earlier places of the effect.
    pub place: Option<String>,
}

/// A selected effect with the model that contains it.
pub type SelectedFit<A, F> = (Selection<A>, ExtendedFit<F>);

/// Results on the held-out data.
pub struct HeldOutResults {
    /// Misfit before and after.
    pub held_out: HeldOut,
    /// Closed share of the explainable misfit, by step.
    pub closed: Vec<Interval>,
}

impl HeldOutResults {
    /// Whether every step increases the explainable misfit, outside its interval.
    pub fn are_worse(&self) -> bool {
        !self.closed.is_empty() && self.closed.iter().all(|closed| closed.high < 0.0)
    }
}

/// The model to write, with its comparison on the held-out data.
pub struct Choice<F> {
    pub fit: F,
    /// Which model it is.
    pub written: ModelKind,
    /// Root mean squares of all three models.
    pub baselines: Vec<Baseline>,
    /// Models that are worse than the given one.
    pub withheld: Vec<Withheld>,
}

/// The remaining results of a search.
#[derive(Default)]
pub struct Description {
    /// The report without verdict, steps and comparison.
    pub report: Report,
    /// Parameters of each step.
    pub parameters: Vec<Vec<Fitted>>,
    /// The formula of each step that is a law, as the next model has it.
    pub laws: Vec<Option<String>>,
    /// Whether places are significant without a named effect.
    pub located: bool,
    /// Meaning of the effects that may be named.
    pub effects: Vec<Meaning>,
    /// The verdict without a finding; empty: a general sentence.
    pub nothing: String,
    /// What to measure next without a finding.
    pub next_after_nothing: String,
    /// The next model, as its file's text.
    pub next_model: String,
    /// The next case, if pressures are searched together with other data.
    pub next_case: Option<String>,
}

impl Description {
    /// Whether little of the misfit of every channel still repeats; for data without repetitions,
    /// whether the residual is clean.
    pub fn is_adequate(&self) -> bool {
        let remaining = &self.report.remaining;
        if remaining.is_empty() {
            self.report.clean
        } else {
            remaining.iter().all(|channel| channel.is_small)
        }
    }

    /// Summary of an effect; empty if it has none.
    pub fn summary(&self, effect: &str) -> String {
        let mut known = self.effects.iter();
        let known = known.find(|meaning| meaning.name == effect);
        known.map_or(String::new(), |meaning| meaning.summary.clone())
    }
}

/// Meaning of an effect.
#[derive(Clone, Debug)]
pub struct Meaning {
    pub name: String,
    /// Summary; empty for a column outside the catalogue.
    pub summary: String,
    /// Measurement that would distinguish it from its rivals.
    pub decides: String,
}

impl Meaning {
    /// Meaning of an effect of a catalogue.
    pub fn of(info: &Info) -> Self {
        Self {
            name: info.name.to_owned(),
            summary: info.summary.to_owned(),
            decides: info.decides.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_is_worse_if_the_misfit_grows_outside_its_interval() {
        let opened = |closed: &[[f64; 3]]| HeldOutResults {
            held_out: HeldOut::default(),
            closed: closed
                .iter()
                .map(|&[low, value, high]| Interval { value, low, high })
                .collect(),
        };
        assert!(opened(&[[-0.4, -0.3, -0.2]]).are_worse());
        assert!(!opened(&[[-0.4, -0.1, 0.2]]).are_worse());
        assert!(!opened(&[[-0.4, -0.3, -0.2], [0.5, 0.8, 1.0]]).are_worse());
        assert!(!opened(&[]).are_worse());
    }
}
