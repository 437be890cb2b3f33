//! The page, section by section.

use std::fmt::Write;

use kufe_plot::{number4, quantity, usual};
use serde_json::Value;

use super::bars::{self, range};
use super::data::Data;
use super::diagram::diagram;
use super::maps::comparison;
use crate::page::escape;

const STYLE: &str = "\
:root{color-scheme:light dark;--text:#1a1a1a;--back:#fff;--faint:#595959;--line:#d4d4d4;--box:#eef3f8;--edge:#2a6496;--in:#fff0cf}\
@media(prefers-color-scheme:dark){:root{--text:#e6e6e6;--back:#16181b;--faint:#a8a8a8;--line:#3c4046;--box:#1f2a35;--edge:#6aa5dc;--in:#463a18}}\
body{font:16px/1.5 system-ui,sans-serif;max-width:60em;margin:1.5em auto;padding:0 1em;color:var(--text);background:var(--back)}\
h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em;border-bottom:1px solid var(--line)}h3{font-size:1em}\
.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.9em}\
td,th{padding:.25em .7em;border-bottom:1px solid var(--line);text-align:left;vertical-align:top}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}td.n{white-space:nowrap}\
.verdict{font-size:1.1em;padding:.8em 1em;background:var(--box);border-left:5px solid var(--edge);overflow-wrap:anywhere}.in td{background:var(--in)}\
td:last-child:not(.n){min-width:11em}p,li{overflow-wrap:anywhere}small{color:var(--faint)}svg{max-width:100%;min-width:33em;height:auto}";

/// The page of a search for missing effects: one HTML file without scripts.
///
/// `report` is what `kufe discover` writes to `report.json`, with its `pictures` beside: each has a `title` and a `plot`,
/// whose `kind` is `scatter` (`x`, `y`, `series`, a `curve` or `zero`) or `maps` (a measured and simulated maps on one grid).
pub fn discovery_page(report: &Value) -> String {
    let report = Data(report);
    let mut out = String::new();
    let _ = write!(
        out,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
<title>What the model lacks</title><style>{STYLE}</style></head><body>\n<h1>What the model lacks</h1>\n\
<p class=\"verdict\"><b>{}.</b> {}</p>\n",
        in_words(report),
        escape(report.text("sentence"))
    );
    out.push_str("<h2>The gap before and after</h2>\n");
    wide(
        &mut out,
        &bars::gap("On the data it was learned from", &report.list("training")),
    );
    if !report.part("held_out").list("channels").is_empty() {
        wide(
            &mut out,
            &bars::gap(
                "On data locked away until the end",
                &report.part("held_out").list("channels"),
            ),
        );
        let held_out = report.part("held_out");
        let _ = writeln!(
            out,
            "<p><small>Locked away: {}. Root mean squares; the noise cannot be closed by any effect.</small></p>",
            escape(&held_out.texts("runs").join(", "))
        );
    }
    for picture in report.list("pictures") {
        let plot = picture.part("plot");
        let svg = match plot.text("kind") {
            "maps" => comparison(plot),
            _ => diagram(plot),
        };
        let _ = writeln!(
            out,
            "<h3>{}</h3>\n<div class=\"wide\">{}</div>",
            escape(picture.text("title")),
            svg
        );
    }
    bins_section(&mut out, "Where it disagrees", &report.list("bins"));
    if !report.list("steps").is_empty() {
        bins_section(&mut out, "What is left after", &report.list("bins_after"));
    }
    runs_section(&mut out, report);
    for (number, step) in report.list("steps").iter().enumerate() {
        step_section(&mut out, number + 1, *step, report);
    }
    let _ = write!(
        out,
        "<h2>What would decide, and what to measure next</h2>\n<p>{}</p>\n",
        escape(report.text("next_experiment"))
    );
    if !report.list("base").is_empty() {
        out.push_str("<h2>Base parameters, refitted</h2>\n");
        parameters(&mut out, &report.list("base"));
    }
    list(
        &mut out,
        "Within the tolerance of the installation",
        report.list("within_tolerance").iter().map(|part| {
            let size = quantity(part.number("size"), part.text("unit"));
            format!("{}: {size}", part.text("what"))
        }),
    );
    detectable_section(&mut out, report);
    list(
        &mut out,
        "Not testable with these data",
        report.list("untestable").iter().map(|pair| {
            let text = |k: usize| pair.0[k].as_str().unwrap_or_default();
            format!("{}: {}", text(0), text(1))
        }),
    );
    list(
        &mut out,
        "Remarks",
        report.texts("remarks").iter().map(|r| (*r).to_owned()),
    );
    let _ = write!(
        out,
        "<p><small>kufe {}, seed {}, data: {}</small></p>\n</body></html>\n",
        escape(report.text("version")),
        report.count("seed"),
        escape(report.text("data"))
    );
    out
}

/// A p-value; tails below a millionth are not known any better.
fn p_value(p: f64) -> String {
    if p < 1e-6 {
        "&lt; 1e-6".to_owned()
    } else if p < 1e-3 {
        format!("{p:.0e}")
    } else {
        format!("{p:.3}")
    }
}

/// What may be wider than a narrow screen scrolls by itself.
fn wide(out: &mut String, what: &str) {
    let _ = writeln!(out, "<div class=\"wide\">{what}</div>");
}

fn in_words(report: Data) -> &'static str {
    match report.text("verdict") {
        "named" if report.list("steps").len() > 1 => "Effects are missing, and named",
        "named" => "An effect is missing, and named",
        "one-of" => "An effect is missing, one of a few",
        "law" => "A law beyond the catalogue is missing",
        "depends-on" => "It depends on what is assumed",
        "located" => "A place, but no name",
        "none" => "Nothing is missing that these data could show",
        _ => "Something differs, but these data cannot name it",
    }
}

fn step_section(out: &mut String, number: usize, step: Data, report: Data) {
    let shared = match report.list("steps").len() {
        1 => "",
        _ => " by all steps together",
    };
    let judged = match report.part("held_out").texts("runs").is_empty() {
        true => "",
        false => " on what was locked away",
    };
    let _ = write!(
        out,
        "<h2>{number}. {}</h2>\n<p>Channel {}; where: {}; p {}. The gap on the data it was learned from went from {} to {}. \
Of what could be explained{judged}, {:.0} % ({:.0} to {:.0} %) is closed{shared}.</p>\n",
        escape(step.text("effect")),
        escape(step.text("channel")),
        escape(step.text("where")),
        match p_value(step.number("p_value")) {
            text if text.starts_with('&') => text,
            text => format!("= {text}"),
        },
        escape(&quantity(step.number("gap_before"), step.text("unit"))),
        escape(&quantity(step.number("gap_after"), step.text("unit"))),
        100.0 * step.part("explainable_gap_closed").number("value"),
        100.0 * step.part("explainable_gap_closed").number("low"),
        100.0 * step.part("explainable_gap_closed").number("high")
    );
    parameters(out, &step.list("parameters"));
    if step.list("rivals").is_empty() {
        return;
    }
    let _ = write!(
        out,
        "<h3>Why {} and not its rivals</h3>\n<p>Shaded: these data cannot tell it from the named effect. <i>Explains</i>: what the rival alone explains, in units of the noise. \
<i>Named beside it</i>: how many of its errors the named effect is away from 0 once the rival has taken its part; small means alike.</p>\n\
<div class=\"wide\"><table><tr><th>rival<th>parameter<th class=n>size alone<th class=n>size / error<th class=n>explains<th class=n>correlation<th class=n>named beside it<th>what would decide</tr>\n",
        escape(step.text("effect"))
    );
    for r in &step.list("rivals") {
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

fn parameters(out: &mut String, fitted: &[Data]) {
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

fn bins_section(out: &mut String, title: &str, bins: &[Data]) {
    let _ = writeln!(out, "<h2>{}</h2>", escape(title));
    if bins.is_empty() {
        out.push_str("<p>No bin of any variable stands out (p &gt; 0.05 over all bins).</p>\n");
        return;
    }
    wide(out, &bars::bins(bins));
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

fn runs_section(out: &mut String, report: Data) {
    if report
        .list("by_run")
        .iter()
        .all(|channel| channel.list("runs").len() < 2)
    {
        return;
    }
    out.push_str("<h2>By run and by session</h2>\n");
    for channel in &report.list("by_run") {
        wide(out, &bars::runs(*channel));
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

fn detectable_section(out: &mut String, report: Data) {
    if report.list("minimum_detectable").is_empty() {
        return;
    }
    out.push_str("<h2>What could be told apart with these data</h2>\n<p>Before any residual is judged: the smallest size that would be claimed nine times in ten, \
the share of each effect that a refit of the base leaves, and the effect that looks most like it.</p>\n\
<div class=\"wide\"><table><tr><th>effect<th>parameter<th class=n>smallest size<th class=n>left<th>most like<th class=n>correlation</tr>\n");
    for d in &report.list("minimum_detectable") {
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

fn list(out: &mut String, title: &str, items: impl Iterator<Item = String>) {
    let items: Vec<String> = items
        .map(|text| format!("<li>{}</li>\n", escape(&text)))
        .collect();
    if !items.is_empty() {
        let _ = write!(out, "<h2>{title}</h2>\n<ul>\n{}</ul>\n", items.concat());
    }
}
