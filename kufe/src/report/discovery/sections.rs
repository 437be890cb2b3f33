//! Sections of the page: each effect with its rivals, and the tables.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::plot::{escape, number4};
use crate::report::discovery::parts::{
    amount, fold, p_is, p_value, range, shown, table, unit_text,
};
use crate::report::discovery::pictures;
use crate::report::viewer::{ViewedPart, viewer_links};
use crate::results::finding::{
    Bin, ByRun, Detectable, Fitted, NextRuns, OfKind, Report, Rival, Step,
};

/// Bins of a table.
const MOST_BINS: usize = 15;

/// One effect: how far the gap falls, its sizes, its rivals.
pub fn step(out: &mut String, number: usize, step: &Step, report: &Report) {
    let shared = if report.steps.len() == 1 {
        ""
    } else {
        " by all steps together"
    };
    let judged = match report.held_out.runs.is_empty() {
        true => "",
        false => " on data that the search had not seen",
    };
    let [value, low, high] = {
        let closed = &step.explainable_gap_closed;
        [closed.value, closed.low, closed.high].map(|share| 100.0 * share)
    };
    let _ = write!(
        out,
        "<h2>{number}. {}</h2>\n<p>Channel {}; p {}. {} \
Of what could be explained{judged}, {value:.0} % ({low:.0} to {high:.0} %) is closed{shared}.</p>\n",
        escape(&step.effect),
        escape(&step.channel),
        escape(&p_is(step.p_value)),
        escape(&fitted_gap(step, report)),
    );
    evidence(out, &step.evidence);
    fold(out, "Its size, with the interval", |out| {
        parameters(out, &step.parameters)
    });
    if !step.rivals.is_empty() {
        let title = format!("Why {} and not its rivals", step.effect);
        fold(out, &title, |out| rivals(out, &step.rivals));
    }
}

/// How far the gap falls on the data that were fitted: of a single effect as the bars show it, from
/// the model as given to the next one; of several, effect by effect after the base was refitted.
fn fitted_gap(step: &Step, report: &Report) -> String {
    let bars = report.training.iter().find(|c| c.channel == step.channel);
    if let (1, Some(bars)) = (report.steps.len(), bars) {
        let [before, after] = [bars.before, bars.after].map(|gap| amount(gap, &bars.unit));
        return format!(
            "On the data it was fitted to the gap is {before} with the model as given and {after} with the next one."
        );
    }
    let [before, after] = [step.gap_before, step.gap_after].map(|gap| amount(gap, &step.unit));
    if step.gap_after >= step.gap_before {
        return format!(
            "On the data it was fitted to the base model had taken its place: the gap was {before} and is {after}."
        );
    }
    let base = match report.base.is_empty() {
        true => "",
        false => " of the refitted base",
    };
    format!("On the data it was fitted to it takes the gap{base} from {before} to {after}.")
}

fn rivals(out: &mut String, rivals: &[Rival]) {
    out.push_str(
        "<p>Shaded: these data cannot distinguish it from the named effect. <i>Explains</i>: what the rival alone explains, in units of the noise. \
<i>Named given it</i>: how many of its errors the named effect is away from 0 once the rival has taken its part; small means alike.</p>\n",
    );
    let columns = "rival|parameter|#size alone|#size / error|#explains|#correlation|#named given it|what would decide";
    let row = |r: &Rival| {
        let cells = [
            r.effect.clone(),
            r.parameter.clone(),
            amount(r.size, &r.unit),
            number4(r.t),
            number4(r.gain),
            format!("{:.2}", r.correlation),
            number4(r.t_of_named_beyond),
            r.decides.clone(),
        ];
        (r.in_class, cells)
    };
    table(out, columns, rivals.iter().map(row));
}

/// Sizes with their intervals.
pub fn parameters(out: &mut String, fitted: &[Fitted]) {
    let row = |p: &Fitted| {
        let [value, low, high] = [p.value, p.low, p.high].map(|value| shown(value, &p.unit));
        (
            false,
            [
                p.name.clone(),
                value,
                format!("{low} to {high}"),
                unit_text(&p.unit),
            ],
        )
    };
    table(
        out,
        "parameter|#value|#95 % interval|unit",
        fitted.iter().map(row),
    );
}

/// What each kind of data of a campaign says of an effect.
fn evidence(out: &mut String, kinds: &[OfKind]) {
    let agree = kinds.iter().all(|kind| kind.agrees);
    let message = match (kinds.len(), agree) {
        (0, _) => return,
        (1, _) => "One kind of data of the campaign knows this effect.",
        (_, true) => {
            "The kinds of data agree: the size above is that of all together, each weighed by its error."
        }
        (_, false) => {
            "The kinds of data disagree: each has its own size, and the next model has that of the first."
        }
    };
    let _ = writeln!(out, "<p>{message}</p>");
    let columns = "data|parameter|#by itself|#95 % interval|unit|#gap not seen before, and after";
    let row = |(kind, p): (&OfKind, &Fitted)| {
        let [value, low, high] = [p.value, p.low, p.high].map(|value| shown(value, &p.unit));
        let [before, after] = [kind.gap_before, kind.gap_after].map(|gap| amount(gap, &kind.unit));
        let cells = [
            kind.data.clone(),
            p.name.clone(),
            value,
            format!("{low} to {high}"),
            unit_text(&p.unit),
            format!("{before} → {after}"),
        ];
        (false, cells)
    };
    let pairs = kinds
        .iter()
        .flat_map(|kind| kind.parameters.iter().map(move |p| (kind, p)));
    table(out, columns, pairs.map(row));
}

/// Runs that would distinguish the members of a class, simulated.
pub fn next_runs(out: &mut String, plans: &[NextRuns]) {
    out.push_str(
        "<p>Each plan was simulated with every member of the class at its fitted size and examined with the others. <i>Expected</i>: the logarithm of the \
likelihood ratio of the two that the runs would distinguish least; shaded where that distinguishes them nine times in ten.</p>\n",
    );
    let row = |plan: &NextRuns| {
        let cells = [
            plan.runs.to_string(),
            plan.track.clone(),
            plan.change.clone(),
            plan.between.join(" and "),
            number4(plan.expected_evidence),
        ];
        (plan.splits, cells)
    };
    let columns = "runs|track|what differs|between|#expected";
    table(out, columns, plans.iter().map(row));
}

/// Bins in which the residual is significant.
pub fn bins(out: &mut String, bins: &[Bin]) {
    if bins.is_empty() {
        out.push_str("<p>No bin of any variable is significant (p &gt; 0.05 over all bins).</p>\n");
        return;
    }
    out.push_str(&pictures::bins(bins));
    let row = |b: &Bin| {
        let [mean, error] = [b.mean, b.error].map(|value| shown(value, &b.unit));
        let cells = [
            b.channel.clone(),
            range(b),
            mean,
            error,
            unit_text(&b.unit),
            p_value(b.p_value),
        ];
        (false, cells)
    };
    let columns = "channel|bin|#mean residual|#standard error|unit|#p over all bins";
    table(out, columns, bins.iter().take(MOST_BINS).map(row));
    if bins.len() > MOST_BINS {
        let _ = writeln!(
            out,
            "<p><small>The most significant {MOST_BINS} of {}; all are in report.json.</small></p>",
            bins.len()
        );
    }
}

/// Mean residuals run by run, and links to the runs.
pub fn runs(out: &mut String, by_run: &[ByRun], viewer: Option<&str>) {
    let names = by_run.iter().flat_map(|channel| &channel.runs);
    let names: BTreeSet<&str> = names.map(|run| run.run.as_str()).collect();
    let links = viewer.into_iter().flat_map(|viewer| {
        let link = |run: &&str| {
            let part = ViewedPart {
                runs: &[run],
                ..ViewedPart::default()
            };
            part.link(viewer, run)
        };
        names.iter().map(link).collect::<Vec<_>>()
    });
    out.push_str(&viewer_links(&links.collect::<Vec<_>>()));
    for channel in by_run {
        out.push_str(&pictures::runs(channel));
        let chance = |p: f64| match p {
            p if p >= 1.0 => "1".to_owned(),
            p => escape(&p_value(p)),
        };
        let _ = writeln!(
            out,
            "<p><small>That sessions differ this much by chance has a probability of {} before and {} after.</small></p>",
            chance(channel.sessions_differ_before),
            chance(channel.sessions_differ_after)
        );
    }
}

/// What would be found, and what it would be confused with.
pub fn detectable(out: &mut String, effects: &[Detectable]) {
    out.push_str("<p>Before any residual is judged: the smallest size that would be found nine times in ten, \
the share of each effect that a refit of the base leaves, and the effect that resembles it most.</p>\n");
    let row = |d: &Detectable| {
        let cells = [
            d.effect.clone(),
            d.parameter.clone(),
            amount(d.size, &d.unit),
            format!("{:.3}", d.left_after_refit),
            d.most_like.clone(),
            format!("{:.2}", d.correlation),
        ];
        (false, cells)
    };
    let columns = "effect|parameter|#smallest size|#share after the refit|most like|#correlation";
    table(out, columns, effects.iter().map(row));
}
