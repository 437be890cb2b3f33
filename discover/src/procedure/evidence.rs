//! What a search asks of data, whatever their kind.

use crate::error::Error;
use crate::finding::NextRuns;
use crate::finding::Picture;
use crate::finding::{
    Baseline, Bin, ByRun, ChannelGap, Detectable, Fitted, HeldOut, Interval, ModelKind, Remaining,
    Rival, Step, Tolerated, Withheld,
};
use crate::procedure::candidate::Candidate;
use crate::procedure::lowered::Lowered;

/// Data of one kind, a part of them held out, and the model that is judged by them.
pub trait Evidence {
    /// How a candidate acts on these data.
    type Act;
    /// The model so far, fitted to what is not held out.
    type Fit: Clone;

    /// The base model, fitted.
    ///
    /// # Errors
    /// Where it cannot be fitted.
    fn fit_base(&mut self, account: &mut Account) -> Result<Self::Fit, Error>;

    /// Who it could be: every candidate with the fit, judged against what chance shows.
    ///
    /// # Errors
    /// Those of the simulations it needs.
    fn screen(
        &mut self,
        fit: &Self::Fit,
        account: &mut Account,
    ) -> Result<Screen<Self::Act>, Error>;

    /// Base, earlier selected effects and this one fitted together; it belongs to the account's step `step`.
    ///
    /// # Errors
    /// Those of the fit.
    fn add(
        &mut self,
        fit: &Self::Fit,
        selection: &Selection<Self::Act>,
        step: usize,
    ) -> Result<Added<Self::Fit>, Error>;

    /// A selected effect judged once more at the fit that contains it: itself, or the effect that takes its place, with its fit.
    ///
    /// # Errors
    /// Those of the fit.
    fn exchange(
        &mut self,
        _before: &Self::Fit,
        selected: Selected<Self::Act, Self::Fit>,
        _step: usize,
        _account: &Account,
    ) -> Result<Selected<Self::Act, Self::Fit>, Error> {
        Ok(selected)
    }

    /// Removes from fit and account what later selected effects have made superfluous, and fits what remains once more.
    ///
    /// # Errors
    /// Those of the fit.
    fn settle(&mut self, fit: Self::Fit, account: &mut Account) -> Result<Self::Fit, Error>;

    /// The fit without the effects of a step, what remains fitted again.
    ///
    /// # Errors
    /// Those of the fit.
    fn without(&mut self, fit: &Self::Fit, step: usize) -> Result<Self::Fit, Error>;

    /// By how much the held-out data's gap is lower with the second fit than with the first, all channels together; `None`
    /// where nothing is held out.
    ///
    /// # Errors
    /// Those of the simulations it needs.
    fn lowered(&self, from: &Self::Fit, to: &Self::Fit) -> Result<Option<Lowered>, Error>;

    /// Opens the held-out data and says what the two fits leave and close there.
    ///
    /// # Errors
    /// Those of the simulations it needs.
    fn open(
        &mut self,
        base: &Self::Fit,
        last: &Self::Fit,
        account: &mut Account,
    ) -> Result<Opened, Error>;

    /// The model to write: the fit with effects, the refitted base or the model as given, whichever
    /// comes first of those that are no worse than the model as given on the held-out data.
    ///
    /// # Errors
    /// Those of the simulations it needs.
    fn choose(
        &mut self,
        refitted: &Self::Fit,
        last: Self::Fit,
        account: &mut Account,
    ) -> Result<Choice<Self::Fit>, Error> {
        let _ = refitted;
        Ok(Choice {
            fit: last,
            written: match account.steps.is_empty() {
                true => ModelKind::Refitted,
                false => ModelKind::WithEffect,
            },
            baselines: Vec::new(),
            withheld: Vec::new(),
        })
    }

    /// Everything else that a report tells, and the next model.
    ///
    /// # Errors
    /// Those of the simulations it needs.
    fn describe(
        &mut self,
        base: &Self::Fit,
        last: &Self::Fit,
        account: &mut Account,
    ) -> Result<Description, Error>;
}

/// Why a selected effect is omitted that later ones explain.
pub const SUPERFLUOUS: &str = "became superfluous";

/// What a search has to tell so far.
#[derive(Clone, Debug, Default)]
pub struct Account {
    /// The effects that are named.
    pub steps: Vec<Step>,
    /// What the reader should know.
    pub remarks: Vec<String>,
    /// Assumptions without which a selected effect would not be significant.
    pub depends: Vec<Dependence>,
    /// What differs although nothing can be named.
    pub unexplained: Option<String>,
}

/// An assumption on which a selected effect depends.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependence {
    /// What depends on what.
    pub assumption: String,
    /// What to measure to be free of it.
    pub decides: String,
}

impl Account {
    /// Takes back a selected effect, and says why: [`SUPERFLUOUS`], or why its size does not suffice.
    pub fn leave_out(&mut self, step: usize, why: &str) {
        let gone = self.steps.remove(step);
        let message = match self.steps.is_empty() {
            false => format!(
                "{} {why} once the others were there and was removed",
                gone.effect
            ),
            true => format!(
                "{} is significant on the training data (p = {:.1e}), but its size not from its own error: it is not named",
                gone.effect, gone.p_value
            ),
        };
        if self.steps.is_empty() {
            self.unexplained.get_or_insert(message.clone());
        }
        self.remarks.push(message);
    }

    /// Takes back every selected effect, of which these shares of what can be explained on the held-out data are closed.
    pub fn take_back_all(&mut self, closed: &[Interval]) {
        let gone = std::mem::take(&mut self.steps);
        let message: Vec<String> = gone
            .iter()
            .zip(closed)
            .map(|(step, closed)| {
                format!(
                    "{} is significant on the training data (p = {:.1e}), but with it more remains of what can be explained on the held-out data (by {:.0} %): not named",
                    step.effect,
                    step.p_value,
                    -100.0 * closed.value
                )
            })
            .collect();
        self.is_left_without(message);
    }

    /// Takes back every step: the model with them is worse than the one as given, for this reason.
    pub fn are_withheld(&mut self, reason: &str) {
        let gone = std::mem::take(&mut self.steps);
        let names: Vec<&str> = gone.iter().map(|step| step.effect.as_str()).collect();
        let withheld = format!(
            "{} fits the training runs (p = {:.1e}), but the model with it is worse than the model as given on the held-out runs ({reason}): not named",
            names.join(" with "),
            gone.first().map_or(1.0, |step| step.p_value)
        );
        self.is_left_without(vec![withheld]);
    }

    /// A step is taken back that is significant at more places than it can be bound to.
    pub fn is_everywhere(&mut self, step: usize, places: usize) {
        let gone = self.steps.remove(step);
        let message = format!(
            "{} was significant at {places} places ({}) and still does at others: what acts at so many is not bound to them; it is not named",
            gone.effect, gone.place
        );
        match self.steps.is_empty() {
            true => self.is_left_without(vec![message]),
            false => self.remarks.push(message),
        }
    }

    /// Nothing is named any more, for these reasons.
    pub fn is_left_without(&mut self, message: Vec<String>) {
        self.depends.clear();
        self.unexplained.get_or_insert(message.join("; "));
        self.remarks.extend(message);
    }
}

/// What one screen of all candidates shows.
pub struct Screen<A> {
    /// The selected effect, where one is significant.
    pub selection: Option<Selection<A>>,
    /// The smallest size of each effect that would be selected.
    pub detectable: Vec<Detectable>,
}

/// p-values of a selected effect by randomisations, where they can be made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Randomised {
    /// Runs independent of one another.
    pub runs: Option<f64>,
    /// Sessions independent, the runs of one not.
    pub sessions: Option<f64>,
}

/// One effect that is significant.
pub struct Selection<A> {
    /// The effect.
    pub candidate: Candidate<A>,
    /// Size in its unit.
    pub size: f64,
    /// Standard error of the size.
    pub error: f64,
    /// Every effect that the data cannot tell from it, itself first.
    pub class: Vec<String>,
    /// The rivals, best first.
    pub rivals: Vec<Rival>,
    /// p-value over all candidates of its kind.
    pub p_value: f64,
    /// p-values by randomisations of runs and sessions.
    pub randomised: Randomised,
    /// Where.
    pub place: String,
    /// Channel in which it shows most, and that channel's unit.
    pub channel: (&'static str, &'static str),
    /// What the reader should know of it, once it is added.
    pub remark: Option<String>,
    /// Size with its interval where the fit of the forces does not set it.
    pub parameters: Vec<Fitted>,
}

impl<A> Selection<A> {
    /// The same selection of a candidate that acts otherwise.
    pub fn acting<B>(&self, act: B) -> Selection<B> {
        Selection {
            candidate: self.candidate.acting(act),
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
pub struct Added<F> {
    /// The fit.
    pub fit: F,
    /// Whether a model can hold the effect; where not, the search ends.
    pub written: bool,
    /// Root mean square of the selected effect's channel before and after.
    pub gap: [f64; 2],
    /// Where it acts, if that is known only now; with the places of an effect that acts elsewhere already.
    pub place: Option<String>,
}

/// A selected effect with the model that contains it.
pub type Selected<A, F> = (Selection<A>, Added<F>);

/// What the held-out data say.
pub struct Opened {
    /// The gap before and after.
    pub held_out: HeldOut,
    /// Share of the explainable gap that is closed, by step.
    pub closed: Vec<Interval>,
}

impl Opened {
    /// Whether every step leaves more of what can be explained than there was, outside its interval.
    pub fn are_worse(&self) -> bool {
        !self.closed.is_empty() && self.closed.iter().all(|closed| closed.high < 0.0)
    }
}

/// The model to write, and how it compares on the held-out data.
pub struct Choice<F> {
    /// Its fit.
    pub fit: F,
    /// Which model it is.
    pub written: ModelKind,
    /// Root mean squares of all three models.
    pub baselines: Vec<Baseline>,
    /// Models that are worse than the one as given.
    pub withheld: Vec<Withheld>,
}

/// The rest of a report.
#[derive(Default)]
pub struct Description {
    /// Kind of data.
    pub data: String,
    /// Gap on the data that were learned from.
    pub training: Vec<ChannelGap>,
    /// Parameters of each step.
    pub parameters: Vec<Vec<Fitted>>,
    /// The formula of each step that is one, as the next model has it.
    pub laws: Vec<Option<String>>,
    /// What the installation is off by, within its tolerance.
    pub within_tolerance: Vec<Tolerated>,
    /// Base parameters.
    pub base: Vec<Fitted>,
    /// Those of them that a refit moves out of their plausible range.
    pub implausible: Vec<Fitted>,
    /// Bins that are significant before.
    pub bins: Vec<Bin>,
    /// Bins that are significant after.
    pub bins_after: Vec<Bin>,
    /// Means by run.
    pub by_run: Vec<ByRun>,
    /// Pictures of the page.
    pub pictures: Vec<Picture>,
    /// Whether the residual is clean.
    pub clean: bool,
    /// What remains of the repeatable misfit, by channel.
    pub remaining: Vec<Remaining>,
    /// Whether places are significant although nothing is named.
    pub located: bool,
    /// Effects that could not be tested, and why.
    pub untestable: Vec<(String, String)>,
    /// What is known of the effects that may be named.
    pub effects: Vec<Meaning>,
    /// Sentences of this kind of data.
    pub words: Words,
    /// Runs that would split a class, the best first.
    pub next_runs: Vec<NextRuns>,
    /// The next model, as its file's text.
    pub next_model: String,
    /// The next case, where pressures are searched together with other data.
    pub next_case: Option<String>,
}

/// What an effect means.
#[derive(Clone, Debug)]
pub struct Meaning {
    /// Its name.
    pub name: String,
    /// What it means; empty for a column that no effect has.
    pub summary: String,
    /// What would tell it from its rivals.
    pub decides: String,
}

/// Sentences of one kind of data.
#[derive(Clone, Debug, Default)]
pub struct Words {
    /// The verdict where nothing is found; a general sentence where it is empty.
    pub nothing: String,
    /// What to measure next where nothing is found.
    pub next_after_nothing: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_that_leaves_more_beyond_its_interval_is_worse() {
        let opened = |closed: &[[f64; 3]]| Opened {
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
