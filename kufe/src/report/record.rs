//! The page of recorded runs: what is wrong, what is odd, what to do, and the properties of every
//! channel.

use std::collections::BTreeSet;
use std::fmt::Write;

use kufe_sled::{Examination, Octave, Profile};

use crate::charts::OddCurve;
use crate::plot::number4;
use crate::report::page::{escape, plain_page};
use crate::report::viewer::{Stretch, ViewedPart, viewer_links};
use crate::results::RunCheck;

/// The page of `check.json`: one HTML file without scripts. A summary comes first, each finding
/// once with the runs that it is in, then the runs, the worst first. `curves` are those of each
/// run. `viewer` is the address of the page that shows the runs, where there is one.
pub fn record_page(check: &RunCheck, curves: &[Vec<OddCurve>], viewer: Option<&str>) -> String {
    let count = check.runs.len();
    let (class, verdict) = match check.wrong {
        0 => (
            "good",
            format!("Nothing is provably wrong in {count} runs."),
        ),
        1 => ("wrong", format!("1 of {count} runs is provably wrong.")),
        wrong => (
            "wrong",
            format!("{wrong} of {count} runs are provably wrong."),
        ),
    };
    let mut out = format!(
        "<h1>Recorded runs</h1>\n<p class=\"finding {class}\"><b>{verdict}</b> <small>{}</small></p>\n",
        escape(&check.index)
    );
    let clean = check.runs.iter().filter(|run| is_clean(run)).count();
    let findings = findings(&check.runs);
    let of_class = |class| {
        findings
            .iter()
            .filter(|finding| finding.class == class)
            .count()
    };
    let _ = writeln!(
        out,
        "<div class=\"tiles\"><div><b>{}</b><span>findings that are wrong</span></div><div><b>{}</b><span>findings that are odd</span></div>\
<div><b>{clean}</b><span>runs without findings</span></div></div>",
        of_class("wrong"),
        of_class("odd")
    );
    out.push_str("<p><small>Wrong is what channels prove of one another; odd is what only you can judge. Equal findings of several runs are one box.</small></p>\n");
    let mut drawn = BTreeSet::new();
    for finding in &findings {
        let column = finding.columns.first();
        let curve = curves[finding.runs[0]]
            .iter()
            .find(|curve| Some(&curve.column) == column);
        let first = &check.runs[finding.runs[0]];
        let link = viewer.filter(|_| first.refused.is_none());
        let link = link.map(|viewer| finding_link(viewer, &first.run, column, curve));
        // A channel is drawn once.
        let curve = curve.filter(|curve| drawn.insert((finding.runs[0], &curve.column)));
        entry(&mut out, finding, &check.runs, curve, link);
    }
    out.push_str("<h2>Every run</h2>\n");
    for (number, run) in check.runs.iter().enumerate() {
        one_run(&mut out, number, run, viewer);
    }
    let _ = writeln!(
        out,
        "<p><small>Noise by octave: bars are white noise with as much in that octave, the highest frequencies first, on a logarithmic scale. \
A delay is that of the channel if it alone is late. kufe {}</small></p>",
        escape(&check.version)
    );
    plain_page("Recorded runs", &out)
}

/// A link to what is odd in a run, as its curve shows it, or to the whole run.
fn finding_link(
    viewer: &str,
    run: &str,
    column: Option<&String>,
    curve: Option<&OddCurve>,
) -> String {
    let odd = curve.filter(|curve| curve.marked.is_some());
    let ends = odd.and_then(|curve| Some((curve, curve.points.first()?.0, curve.points.last()?.0)));
    let part = ViewedPart {
        runs: &[run],
        channel: column.map(String::as_str),
        stretch: ends.map(|(curve, from, to)| Stretch::Time(from - curve.t0_s, to - curve.t0_s)),
        ..ViewedPart::default()
    };
    part.link(viewer, run)
}

/// Whether nothing is wrong or odd.
fn is_clean(run: &Examination) -> bool {
    run.refused.is_none() && run.faults.is_empty() && run.notes.is_empty()
}

/// A finding and the runs that have it.
struct Finding<'a> {
    class: &'static str,
    /// The channels, none of the whole run.
    columns: Vec<String>,
    head: String,
    /// Of the first run.
    what: &'a str,
    mend: &'a str,
    /// Places in the list of runs, the worst first.
    runs: Vec<usize>,
}

/// The findings of one run, worst first.
fn findings_of(number: usize, run: &Examination) -> Vec<Finding<'_>> {
    let refused = run.refused.iter().map(|reason| Finding {
        class: "wrong",
        columns: Vec::new(),
        head: "Refused".to_owned(),
        what: reason,
        mend: "",
        runs: vec![number],
    });
    let faults = run.faults.iter().map(|fault| {
        let verb = match fault.columns.len() {
            1 => "resembles",
            _ => "resemble",
        };
        Finding {
            class: if fault.proven { "wrong" } else { "odd" },
            columns: fault.columns.clone(),
            head: format!("{} {verb} {}", fault.columns.join(", "), fault.looks_like),
            what: &fault.evidence,
            mend: &fault.mend,
            runs: vec![number],
        }
    });
    let notes = run.notes.iter().map(|note| {
        let of_run = note.column.is_empty();
        Finding {
            class: "odd",
            columns: (!of_run).then(|| note.column.clone()).into_iter().collect(),
            head: if of_run {
                "The run".to_owned()
            } else {
                note.column.clone()
            },
            what: &note.what,
            mend: &note.advice,
            runs: vec![number],
        }
    });
    refused.chain(faults).chain(notes).collect()
}

/// Findings of all runs, those that differ only in their numbers as one; what is wrong comes first,
/// then what is in most runs.
fn findings(runs: &[Examination]) -> Vec<Finding<'_>> {
    let words = |text: &str| text.replace(|c: char| c.is_ascii_digit() || c == '.', "");
    let mut all: Vec<Finding> = Vec::new();
    for one in runs
        .iter()
        .enumerate()
        .flat_map(|(number, run)| findings_of(number, run))
    {
        let same = |known: &&mut Finding| {
            (known.class, &known.head, known.mend) == (one.class, &one.head, one.mend)
                && words(known.what) == words(one.what)
        };
        match all.iter_mut().find(same) {
            Some(known) => known.runs.extend(one.runs),
            None => all.push(one),
        }
    }
    all.sort_by_key(|finding| {
        (
            finding.class != "wrong",
            std::cmp::Reverse(finding.runs.len()),
        )
    });
    all
}

/// A run: its findings in a line each, and its channels, folded.
fn one_run(out: &mut String, number: usize, run: &Examination, viewer: Option<&str>) {
    let own = findings_of(number, run);
    let wrong = own
        .iter()
        .filter(|finding| finding.class == "wrong")
        .count();
    let state = match (wrong, own.len() - wrong) {
        (0, 0) => String::new(),
        (wrong, odd) => format!(": {wrong} wrong, {odd} odd"),
    };
    let _ = writeln!(
        out,
        "<details id=\"run-{number}\"><summary>{}{state}</summary>",
        escape(&run.run)
    );
    if run.refused.is_none() {
        let _ = writeln!(
            out,
            "<p><small>{}: {:.2} s at {} Hz, {:.2} s of it take part</small></p>",
            escape(&run.file),
            run.length_s,
            number4(run.rate_hz),
            run.used_s
        );
        let whole = ViewedPart {
            runs: &[&run.run],
            ..ViewedPart::default()
        };
        let link = viewer.map(|viewer| whole.link(viewer, &run.run));
        out.push_str(&viewer_links(link.as_slice()));
    }
    for finding in &own {
        let _ = writeln!(
            out,
            "<p class=\"finding {}\"><b>{}.</b> {}</p>",
            finding.class,
            escape(&finding.head),
            escape(finding.what)
        );
    }
    if !run.channels.is_empty() {
        out.push_str(
            "<div class=\"wide\"><table><tr><th>channel</th><th class=\"n\">missing</th><th class=\"n\">noise</th>\
<th class=\"n\">steps</th><th class=\"n\">still [s]</th><th class=\"n\">leaps</th><th class=\"n\">drop-outs</th><th class=\"n\">at its stop</th><th class=\"n\">at rest</th><th class=\"n\">delay [ms]</th><th>by octave</th></tr>\n",
        );
        for (name, channel) in &run.channels {
            row(out, name, channel);
        }
        out.push_str("</table></div>\n");
    }
    out.push_str("</details>\n");
}

/// One channel.
fn row(out: &mut String, name: &str, channel: &Profile) {
    let shown = |value: Option<f64>| {
        let value = value.filter(|value| value.is_finite());
        value.map_or(String::new(), number4)
    };
    let delay = channel.delay_s.map_or(String::new(), |[delay, error]| {
        format!("{:.0} ± {:.0}", 1e3 * delay, 1e3 * error)
    });
    let cells = [
        channel.missing.to_string(),
        shown(Some(channel.noise_sd)),
        shown(channel.quantum),
        format!("{:.2}", channel.longest_still_s),
        channel.leaps.to_string(),
        channel.dropouts.to_string(),
        channel
            .saturation
            .map_or(0, |stop| stop.samples)
            .to_string(),
        shown(channel.at_standstill),
        delay,
    ];
    let _ = write!(out, "<tr><td>{}</td>", escape(name));
    for cell in cells {
        let _ = write!(out, "<td class=\"n\">{cell}</td>");
    }
    let _ = writeln!(out, "<td>{}</td></tr>", bars(&channel.octaves));
}

/// Most names of runs that are shown at once.
const MOST_NAMES: usize = 6;

/// A finding with its runs and the curve of its channel in the first of them.
fn entry(
    out: &mut String,
    finding: &Finding,
    runs: &[Examination],
    curve: Option<&OddCurve>,
    link: Option<String>,
) {
    let _ = write!(
        out,
        "<div class=\"finding {}\"><p><b>{}.</b> {}</p>",
        finding.class,
        escape(&finding.head),
        escape(finding.what)
    );
    if !finding.mend.is_empty() {
        let _ = write!(out, "<p>To do: <code>{}</code></p>", escape(finding.mend));
    }
    let links = finding.runs.iter().map(|&number| {
        format!(
            "<a href=\"#run-{number}\">{}</a>",
            escape(&runs[number].run)
        )
    });
    let links: Vec<String> = links.collect();
    let (first, count) = (escape(&runs[finding.runs[0]].run), links.len());
    let _ = match count {
        ..=MOST_NAMES => writeln!(out, "<p>In {}</p>", links.join(", ")),
        _ => writeln!(
            out,
            "<details><summary>In {count} runs; the numbers are those of {first}</summary><p>{}</p></details>",
            links.join(", ")
        ),
    };
    out.push_str(&viewer_links(link.as_slice()));
    if let Some(curve) = curve {
        let _ = writeln!(
            out,
            "<div class=\"figures\"><div class=\"whole\">{}</div></div>",
            curve.svg(&runs[finding.runs[0]].run)
        );
    }
    out.push_str("</div>\n");
}

/// Bars of the octaves over five decades below the largest.
fn bars(octaves: &[Octave]) -> String {
    const DECADES: f64 = 5.0;
    let height =
        |value: f64, most: f64| 22.0 * (1.0 + (value / most).log10() / DECADES).clamp(0.04, 1.0);
    let most = octaves.iter().map(|octave| octave.sd).fold(0.0, f64::max);
    if most <= 0.0 {
        return String::new();
    }
    let mut svg = String::from(
        "<svg class=\"bars\" width=\"80\" height=\"22\" role=\"img\" aria-label=\"noise by octave\">",
    );
    for (k, octave) in octaves.iter().enumerate() {
        let tall = height(octave.sd.max(1e-300), most);
        let _ = write!(
            svg,
            "<rect x=\"{}\" y=\"{:.1}\" width=\"8\" height=\"{tall:.1}\"><title>up to {} Hz: {}</title></rect>",
            10 * k,
            22.0 - tall,
            number4(octave.to_hz),
            number4(octave.sd)
        );
    }
    svg + "</svg>"
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use kufe_sled::Note;

    use super::*;

    #[test]
    fn equal_findings_are_one_box_and_the_summary_comes_first() {
        let run = |name: String, notes| Examination {
            file: format!("{name}.csv"),
            run: name,
            notes,
            channels: BTreeMap::from([("v_mps".to_owned(), Profile::default())]),
            ..Examination::default()
        };
        let note = |what: &str| Note {
            column: "v_mps".into(),
            what: what.into(),
            advice: String::new(),
            weight: 0.1,
        };
        let page = |count: usize| {
            let odd = |k: usize| run(format!("r<{k}>"), vec![note(&format!("{k}.5 % leap"))]);
            let other = run("other".to_owned(), vec![note("stands still")]);
            let runs: Vec<Examination> = (0..count).map(odd).chain([other]).collect();
            let curves: Vec<Vec<OddCurve>> = runs.iter().map(|_| Vec::new()).collect();
            record_page(&RunCheck::new("runs.csv", runs), &curves, None)
        };
        let (few, many) = (page(2), page(42));
        let boxes = |page: &str| page.matches("<div class=\"finding").count();
        assert_eq!((boxes(&few), boxes(&many)), (2, 2), "{many}");
        assert!(
            many.contains("In 42 runs; the numbers are those of r&lt;0&gt;"),
            "{many}"
        );
        let at = |text: &str| {
            many.find(text)
                .unwrap_or_else(|| panic!("{text} in {many}"))
        };
        assert!(at("0.5 % leap") < at("stands still") && at("stands still") < at("<h2>Every run"));
        // Each run has its channels, once, and its own numbers.
        assert_eq!(many.matches("<td>v_mps</td>").count(), 43);
        assert!(at("<h2>Every run") < at("41.5 % leap"));
        assert!(at("href=\"#run-41\"") < at("id=\"run-41\""));
        assert_eq!(
            many.matches("<details").count(),
            many.matches("</details>").count()
        );
    }
}
