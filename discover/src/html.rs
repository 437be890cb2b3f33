//! The report as one self-contained page.

use std::fmt::Write;

use crate::report::{Bin, ChannelGap, Report, Step};

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#1a1a1a;background:#fff}\
h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em;border-bottom:1px solid #ccc}table{border-collapse:collapse;font-size:.9em}\
td,th{padding:.25em .7em;border-bottom:1px solid #ddd;text-align:left}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}\
.verdict{font-size:1.1em;padding:.8em 1em;background:#eef3f8;border-left:5px solid #2a6496}.in{background:#fff4dc}small{color:#555}svg{max-width:100%}";

/// The page.
pub fn page(report: &Report) -> String {
    let mut out = String::new();
    let verdict = serde_json::to_string(&report.verdict).unwrap_or_default();
    let _ = write!(
        out,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
<title>What the model lacks</title><style>{STYLE}</style></head><body>\n<h1>What the model lacks</h1>\n\
<p class=\"verdict\"><b>{}</b>: {}</p>\n",
        escape(verdict.trim_matches('"')),
        escape(&report.sentence)
    );
    out.push_str("<h2>The gap before and after</h2>\n");
    out.push_str(&gap_picture("On data used for learning", &report.training));
    if !report.held_out.channels.is_empty() {
        let title = format!("On locked-away data ({})", report.held_out.runs.join(", "));
        out.push_str(&gap_picture(&title, &report.held_out.channels));
    }
    for (number, step) in report.steps.iter().enumerate() {
        step_section(&mut out, number + 1, step);
    }
    let binned = report.data.contains("run");
    if binned {
        bins_section(&mut out, "Where it disagrees, before", &report.bins);
    }
    if binned && !report.steps.is_empty() {
        bins_section(&mut out, "What is left after", &report.bins_after);
    }
    let _ = write!(
        out,
        "<h2>What would decide, and what to measure next</h2>\n<p>{}</p>\n",
        escape(&report.next_experiment)
    );
    if !report.base.is_empty() {
        out.push_str("<h2>Base parameters, refitted</h2>\n<table><tr><th>parameter<th class=n>value<th class=n>95 % interval<th>unit</tr>\n");
        for p in &report.base {
            let _ = writeln!(
                out,
                "<tr><td>{}<td class=n>{}<td class=n>{} to {}<td>{}</tr>",
                escape(&p.name),
                number4(p.value),
                number4(p.low),
                number4(p.high),
                escape(&p.unit)
            );
        }
        out.push_str("</table>\n");
    }
    out.push_str("<h2>What could be told apart with these data</h2>\n<p>Before any residual is judged: the smallest size that would be claimed nine times in ten, \
the share of each effect that a refit of the base leaves, and the effect that looks most like it.</p>\n\
<table><tr><th>effect<th>parameter<th class=n>smallest size<th>unit<th class=n>left<th>most like<th class=n>correlation</tr>\n");
    for d in &report.minimum_detectable {
        let _ = writeln!(
            out,
            "<tr><td>{}<td>{}<td class=n>{}<td>{}<td class=n>{:.3}<td>{}<td class=n>{:.2}</tr>",
            escape(&d.effect),
            escape(&d.parameter),
            number4(d.size),
            escape(&d.unit),
            d.left_after_refit,
            escape(&d.most_like),
            d.correlation
        );
    }
    out.push_str("</table>\n");
    if !report.untestable.is_empty() {
        out.push_str("<h2>Not testable with these data</h2>\n<ul>\n");
        for (name, why) in &report.untestable {
            let _ = writeln!(out, "<li>{}: {}</li>", escape(name), escape(why));
        }
        out.push_str("</ul>\n");
    }
    if !report.remarks.is_empty() {
        out.push_str("<h2>Remarks</h2>\n<ul>\n");
        for remark in &report.remarks {
            let _ = writeln!(out, "<li>{}</li>", escape(remark));
        }
        out.push_str("</ul>\n");
    }
    let _ = write!(
        out,
        "<p><small>kufe {}, seed {}, data: {}</small></p>\n</body></html>\n",
        escape(&report.version),
        report.seed,
        escape(&report.data)
    );
    out
}

fn step_section(out: &mut String, number: usize, step: &Step) {
    let _ = write!(
        out,
        "<h2>{number}. {}</h2>\n<p>Channel {}; where: {}; p = {:.2e}. Gap on learning data {} to {} {}; explainable gap closed: {:.0} % ({:.0} to {:.0} %) by all steps together, on locked-away data.</p>\n",
        escape(&step.effect),
        escape(&step.channel),
        escape(&step.place),
        step.p_value,
        number4(step.gap_before),
        number4(step.gap_after),
        escape(&step.unit),
        100.0 * step.explainable_gap_closed.value,
        100.0 * step.explainable_gap_closed.low,
        100.0 * step.explainable_gap_closed.high
    );
    out.push_str(
        "<table><tr><th>parameter<th class=n>value<th class=n>95 % interval<th>unit</tr>\n",
    );
    for p in &step.parameters {
        let _ = writeln!(
            out,
            "<tr><td>{}<td class=n>{}<td class=n>{} to {}<td>{}</tr>",
            escape(&p.name),
            number4(p.value),
            number4(p.low),
            number4(p.high),
            escape(&p.unit)
        );
    }
    out.push_str("</table>\n");
    if step.rivals.is_empty() {
        return;
    }
    out.push_str("<p>Why this and not its rivals. Shaded: these data cannot tell it from the named effect.</p>\n\
<table><tr><th>rival<th>parameter<th class=n>size alone<th>unit<th class=n>T alone<th class=n>explains<th class=n>correlation<th class=n>T of the named beside it<th>what would decide</tr>\n");
    for r in &step.rivals {
        let _ = writeln!(
            out,
            "<tr{}><td>{}<td>{}<td class=n>{}<td>{}<td class=n>{:.1}<td class=n>{:.1}<td class=n>{:.2}<td class=n>{:.1}<td>{}</tr>",
            if r.in_class { " class=in" } else { "" },
            escape(&r.effect),
            escape(&r.parameter),
            number4(r.size),
            escape(&r.unit),
            r.t,
            r.gain,
            r.correlation,
            r.t_of_named_beyond,
            escape(&r.decides)
        );
    }
    out.push_str("</table>\n");
}

fn bins_section(out: &mut String, title: &str, bins: &[Bin]) {
    let _ = writeln!(out, "<h2>{}</h2>", escape(title));
    if bins.is_empty() {
        out.push_str("<p>No bin of any variable stands out (p &gt; 0.05 over all bins).</p>\n");
        return;
    }
    out.push_str(&bins_picture(bins));
    out.push_str("<table><tr><th>channel<th>column<th class=n>from<th class=n>to<th class=n>mean residual<th class=n>error<th>unit<th class=n>p</tr>\n");
    for b in bins.iter().take(15) {
        let _ = writeln!(
            out,
            "<tr><td>{}<td>{}<td class=n>{}<td class=n>{}<td class=n>{}<td class=n>{}<td>{}<td class=n>{:.3}</tr>",
            escape(&b.channel),
            escape(&b.column),
            number4(b.from),
            number4(b.to),
            number4(b.mean),
            number4(b.error),
            escape(&b.unit),
            b.p_value
        );
    }
    out.push_str("</table>\n");
}

/// Horizontal bars, each channel in its own scale: before, after, and what the sensors' noise alone would give.
fn gap_picture(title: &str, channels: &[ChannelGap]) -> String {
    let height = 34 + channels.len() * 74;
    let mut svg = format!(
        "<svg viewBox=\"0 0 760 {height}\" width=\"760\" role=\"img\" aria-label=\"{0}\" font-family=\"system-ui,sans-serif\" font-size=\"13\"><text x=\"0\" y=\"16\" font-weight=\"bold\">{0}</text>\n",
        escape(title)
    );
    for (k, c) in channels.iter().enumerate() {
        let y = 30 + k * 74;
        let most = c.before.max(c.after).max(c.noise).max(1e-300);
        let _ = write!(
            svg,
            "<text x=\"0\" y=\"{}\">{} [{}]</text>",
            y + 30,
            escape(&c.channel),
            escape(&c.unit)
        );
        for (row, (label, value, colour)) in [
            ("before", c.before, "#b5532a"),
            ("after", c.after, "#2a6496"),
            ("sensor noise", c.noise, "#888888"),
        ]
        .into_iter()
        .enumerate()
        {
            let top = y + row * 20;
            let width = 430.0 * value / most;
            let _ = writeln!(
                svg,
                "<text x=\"185\" y=\"{}\" text-anchor=\"end\">{label}</text><rect x=\"192\" y=\"{}\" width=\"{width:.1}\" height=\"14\" fill=\"{colour}\"/><text x=\"{:.1}\" y=\"{}\">{}</text>",
                top + 13,
                top + 2,
                198.0 + width,
                top + 13,
                number4(value)
            );
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Mean residuals with two standard errors, strongest bins first.
fn bins_picture(bins: &[Bin]) -> String {
    let shown = &bins[..bins.len().min(12)];
    let height = 24 + 22 * shown.len();
    let mut svg = format!(
        "<svg viewBox=\"0 0 760 {height}\" width=\"760\" role=\"img\" aria-label=\"mean residual by bin\" font-family=\"system-ui,sans-serif\" font-size=\"12\"><text x=\"0\" y=\"14\">mean residual by bin, relative to the largest of its channel, with two standard errors</text>\n"
    );
    for (k, b) in shown.iter().enumerate() {
        let largest = shown
            .iter()
            .filter(|o| o.channel == b.channel)
            .fold(1e-300_f64, |m, o| m.max(o.mean.abs() + 2.0 * o.error));
        let y = 34 + 22 * k;
        let x = |v: f64| 550.0 + 195.0 * v / largest;
        let _ = writeln!(
            svg,
            "<text x=\"340\" y=\"{}\" text-anchor=\"end\">{} | {} {} to {}</text><line x1=\"550\" x2=\"550\" y1=\"{}\" y2=\"{}\" stroke=\"#bbb\"/>\
<line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y}\" y2=\"{y}\" stroke=\"#2a6496\" stroke-width=\"2\"/><circle cx=\"{:.1}\" cy=\"{y}\" r=\"4\" fill=\"#b5532a\"/>",
            y + 4,
            escape(&b.channel),
            escape(&b.column),
            number4(b.from),
            number4(b.to),
            y - 10,
            y + 12,
            x(b.mean - 2.0 * b.error),
            x(b.mean + 2.0 * b.error),
            x(b.mean)
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// Four significant digits.
pub fn number4(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let digits = 3 - x.abs().log10().floor() as i32;
    if (0..=8).contains(&digits) {
        format!("{x:.*}", digits as usize)
    } else if (-3..0).contains(&digits) {
        format!("{x:.0}")
    } else {
        format!("{x:.3e}")
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_four_digits() {
        assert_eq!(number4(0.012_345_6), "0.01235");
        assert_eq!(number4(123_456.0), "123456");
        assert_eq!(number4(1.5e-7), "1.500e-7");
    }

    #[test]
    fn text_from_files_cannot_become_markup() {
        assert_eq!(escape("<a&\">"), "&lt;a&amp;&quot;&gt;");
    }
}
