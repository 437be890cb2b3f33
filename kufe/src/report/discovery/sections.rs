//! Sections of the page: each effect with its rivals, and the tables.

use std::fmt::Write;

use crate::plot::{number4, quantity, usual};

use super::bars::{self, range};
use super::data::Data;
use super::parts::{fold, p_is, p_value};
use crate::report::page::escape;

/// One effect: how far the gap falls, its sizes, its rivals.
pub fn step(out: &mut String, number: usize, step: Data, report: Data) {
    let shared = match report.list("steps").len() {
        1 => "",
        _ => " by all steps together",
    };
    let judged = match report.part("held_out").texts("runs").is_empty() {
        true => "",
        false => " on data that the search had not seen",
    };
    let learned = learned(step, report);
    let _ = write!(
        out,
        "<h2>{number}. {}</h2>\n<p>Channel {}; p {}. {} \
Of what could be explained{judged}, {:.0} % ({:.0} to {:.0} %) is closed{shared}.</p>\n",
        escape(step.text("effect")),
        escape(step.text("channel")),
        p_is(step.number("p_value")),
        escape(&learned),
        100.0 * step.part("explainable_gap_closed").number("value"),
        100.0 * step.part("explainable_gap_closed").number("low"),
        100.0 * step.part("explainable_gap_closed").number("high")
    );
    evidence(out, &step.list("evidence"));
    fold(out, "Its size, with the interval", |out| {
        parameters(out, &step.list("parameters"));
    });
    if step.list("rivals").is_empty() {
        return;
    }
    let title = format!("Why {} and not its rivals", step.text("effect"));
    fold(out, &title, |out| rivals(out, &step.list("rivals")));
}

/// How far the gap falls on the data that were learned from: of a single effect as the bars tell it, from the model as given to the
/// next one; of several, effect by effect beyond the refitted base.
fn learned(step: Data, report: Data) -> String {
    let training = report.list("training");
    let of_bars = |c: &&Data| c.text("channel") == step.text("channel");
    if let (1, Some(bars)) = (report.list("steps").len(), training.iter().find(of_bars)) {
        let gap = |key: &str| quantity(bars.number(key), bars.text("unit"));
        return format!(
            "On the data it was learned from the gap is {} with the model as given and {} with the next one.",
            gap("before"),
            gap("after")
        );
    }
    let gap = |key: &str| quantity(step.number(key), step.text("unit"));
    let (before, after) = (gap("gap_before"), gap("gap_after"));
    match step.number("gap_after") < step.number("gap_before") {
        true => {
            let beyond = match report.list("base").is_empty() {
                true => "",
                false => " beyond the refitted base",
            };
            format!(
                "On the data it was learned from it takes the gap{beyond} from {before} to {after}."
            )
        }
        false => format!(
            "On the data it was learned from the base model had bent to stand for it: the gap was {before} and is {after}."
        ),
    }
}

fn rivals(out: &mut String, rivals: &[Data]) {
    out.push_str(
        "<p>Shaded: these data cannot tell it from the named effect. <i>Explains</i>: what the rival alone explains, in units of the noise. \
<i>Named beside it</i>: how many of its errors the named effect is away from 0 once the rival has taken its part; small means alike.</p>\n\
<div class=\"wide\"><table><tr><th>rival<th>parameter<th class=n>size alone<th class=n>size / error<th class=n>explains<th class=n>correlation<th class=n>named beside it<th>what would decide</tr>\n",
    );
    for r in rivals {
        let _ = writeln!(
            out,
            "<tr{}><td>{}<td>{}<td class=n>{}<td class=n>{}<td class=n>{}<td class=n>{:.2}<td class=n>{}<td>{}</tr>",
            if r.is("in_class") { " class=in" } else { "" },
            escape(r.text("effect")),
            escape(r.text("parameter")),
            escape(&quantity(r.number("size"), r.text("unit"))),
            number4(r.number("t")),
            number4(r.number("gain")),
            r.number("correlation"),
            number4(r.number("t_of_named_beyond")),
            escape(r.text("decides"))
        );
    }
    out.push_str("</table></div>\n");
}

/// Sizes with their intervals.
pub fn parameters(out: &mut String, fitted: &[Data]) {
    out.push_str(
        "<div class=\"wide\"><table><tr><th>parameter<th class=n>value<th class=n>95 % interval<th>unit</tr>\n",
    );
    for p in fitted {
        let (_, unit) = usual(p.number("value"), p.text("unit"));
        let show = |value: f64| number4(usual(value, p.text("unit")).0);
        let _ = writeln!(
            out,
            "<tr><td>{}<td class=n>{}<td class=n>{} to {}<td>{}</tr>",
            escape(p.text("name")),
            show(p.number("value")),
            show(p.number("low")),
            show(p.number("high")),
            escape(unit)
        );
    }
    out.push_str("</table></div>\n");
}

/// What each kind of data of a campaign says of an effect.
fn evidence(out: &mut String, kinds: &[Data]) {
    if kinds.is_empty() {
        return;
    }
    let agree = kinds.iter().all(|kind| kind.is("agrees"));
    let message = match (kinds.len(), agree) {
        (1, _) => "One kind of data of the campaign knows this effect.",
        (_, true) => {
            "The kinds of data agree: the size above is that of all together, each weighed by its error."
        }
        (_, false) => {
            "The kinds of data disagree: each keeps its own size, and the next model has that of the first."
        }
    };
    let _ = write!(
        out,
        "<p>{message}</p>\n<div class=\"wide\"><table><tr><th>data<th>parameter<th class=n>by itself<th class=n>95 % interval<th>unit<th class=n>gap not seen before, and after</tr>\n"
    );
    for kind in kinds {
        for p in kind.list("parameters") {
            let (_, unit) = usual(p.number("value"), p.text("unit"));
            let show = |key: &str| number4(usual(p.number(key), p.text("unit")).0);
            let gap = |key: &str| quantity(kind.number(key), kind.text("unit"));
            let _ = writeln!(
                out,
                "<tr><td>{}<td>{}<td class=n>{}<td class=n>{} to {}<td>{}<td class=n>{} → {}</tr>",
                escape(kind.text("data")),
                escape(p.text("name")),
                show("value"),
                show("low"),
                show("high"),
                escape(unit),
                escape(&gap("gap_before")),
                escape(&gap("gap_after"))
            );
        }
    }
    out.push_str("</table></div>\n");
}

/// Runs that would tell the members of a class apart, simulated.
pub fn next_runs(out: &mut String, plans: &[Data]) {
    out.push_str(
        "<p>Each plan was simulated with every member of the class at its fitted size and looked at with the others. <i>Expected</i>: the logarithm of the \
likelihood ratio of the two that the runs would tell apart least; shaded where that tells them apart nine times in ten.</p>\n\
<div class=\"wide\"><table><tr><th>runs<th>track<th>what differs<th>between<th class=n>expected</tr>\n",
    );
    for plan in plans {
        let _ = writeln!(
            out,
            "<tr{}><td>{}<td>{}<td>{}<td>{}<td class=n>{}</tr>",
            if plan.is("splits") { " class=in" } else { "" },
            plan.count("runs"),
            escape(plan.text("track")),
            escape(plan.text("change")),
            escape(&plan.texts("between").join(" and ")),
            number4(plan.number("expected_evidence"))
        );
    }
    out.push_str("</table></div>\n");
}

/// Bins in which the residual stands out.
pub fn bins(out: &mut String, bins: &[Data]) {
    if bins.is_empty() {
        out.push_str("<p>No bin of any variable stands out (p &gt; 0.05 over all bins).</p>\n");
        return;
    }
    out.push_str(&bars::bins(bins));
    out.push_str("<div class=\"wide\"><table><tr><th>channel<th>bin<th class=n>mean residual<th class=n>standard error<th>unit<th class=n>p over all bins</tr>\n");
    for b in bins.iter().take(15) {
        let (mean, unit) = usual(b.number("mean"), b.text("unit"));
        let _ = writeln!(
            out,
            "<tr><td>{}<td>{}<td class=n>{}<td class=n>{}<td>{}<td class=n>{}</tr>",
            escape(b.text("channel")),
            escape(&range(*b)),
            number4(mean),
            number4(usual(b.number("error"), b.text("unit")).0),
            escape(unit),
            p_value(b.number("p_value"))
        );
    }
    out.push_str("</table></div>\n");
    if bins.len() > 15 {
        let _ = writeln!(
            out,
            "<p><small>The strongest 15 of {}; all are in report.json.</small></p>",
            bins.len()
        );
    }
}

/// Mean residuals run by run.
pub fn runs(out: &mut String, by_run: &[Data]) {
    for channel in by_run {
        out.push_str(&bars::runs(*channel));
        let chance = |p: f64| match p {
            p if p >= 1.0 => "1".to_owned(),
            p => p_value(p),
        };
        let _ = writeln!(
            out,
            "<p><small>That sessions differ this much by chance has a probability of {} before and {} after.</small></p>",
            chance(channel.number("sessions_differ_before")),
            chance(channel.number("sessions_differ_after"))
        );
    }
}

/// What would be claimed, and what it would be taken for.
pub fn detectable(out: &mut String, effects: &[Data]) {
    out.push_str("<p>Before any residual is judged: the smallest size that would be claimed nine times in ten, \
the share of each effect that a refit of the base leaves, and the effect that looks most like it.</p>\n\
<div class=\"wide\"><table><tr><th>effect<th>parameter<th class=n>smallest size<th class=n>left<th>most like<th class=n>correlation</tr>\n");
    for d in effects {
        let _ = writeln!(
            out,
            "<tr><td>{}<td>{}<td class=n>{}<td class=n>{:.3}<td>{}<td class=n>{:.2}</tr>",
            escape(d.text("effect")),
            escape(d.text("parameter")),
            escape(&quantity(d.number("size"), d.text("unit"))),
            d.number("left_after_refit"),
            escape(d.text("most_like")),
            d.number("correlation")
        );
    }
    out.push_str("</table></div>\n");
}
