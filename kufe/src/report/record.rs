//! The page of a check of recorded runs: faults, anomalies and remedies, and the properties of
//! every channel.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use kufe_sled::{Examination, Profile};

use crate::charts::OddCurve;
use crate::plot::{escape, number4};
use crate::report::html::{columns, fold, fold_with, for_both, plain_page, small, table, tiles};
use crate::report::viewer::{Stretch, ViewedPart, viewer_links};
use crate::results::RunCheck;

/// The number of runs that are provably wrong, as a sentence.
pub fn verdict(wrong: usize, count: usize) -> String {
    match (wrong, count) {
        (0, 1) => "Nothing is provably wrong in the run.".to_owned(),
        (0, _) => format!("Nothing is provably wrong in {count} runs."),
        (1, 1) => "The run is provably wrong.".to_owned(),
        (1, _) => format!("1 of {count} runs is provably wrong."),
        _ => format!("{wrong} of {count} runs are provably wrong."),
    }
}

/// The page of `check.json`: one HTML file without scripts. It begins with a summary, which lists
/// each finding once with its runs; the runs follow, the worst first. `curves` are the curves of
/// each run. `viewer` is the address of the page of the runs, if it exists.
pub fn record_page(check: &RunCheck, curves: &[Vec<OddCurve>], viewer: Option<&str>) -> String {
    let verdict = verdict(check.wrong, check.runs.len());
    let class = if check.wrong == 0 { "good" } else { "wrong" };
    let mut out = format!(
        "<h1>Recorded runs</h1>\n<p class=\"finding {class}\"><b>{verdict}</b> <small>{}</small></p>\n",
        escape(&check.index)
    );
    let findings = run_findings(&check.runs);
    let of_class = |class| findings.iter().filter(|one| one.class == class).count();
    let is_clean = |run: &&Examination| findings_of(0, run).is_empty();
    let figures = [
        (of_class("wrong"), "findings that are wrong"),
        (of_class("odd"), "findings that are odd"),
        (
            check.runs.iter().filter(is_clean).count(),
            "runs without findings",
        ),
    ];
    out += &tiles(figures.map(|(count, what)| (count.to_string(), what.to_owned())));
    out += &small(
        "Wrong is what channels prove of one another; odd is what only you can judge. Equal \
         findings of several runs are one box.",
    );
    let mut drawn = BTreeSet::new();
    for finding in &findings {
        let number = finding.runs[0];
        let mut curves = curves[number].iter();
        let curve = curves.find(|curve| Some(&curve.column) == finding.column);
        let run = &check.runs[number];
        let viewer = viewer.filter(|_| run.refused.is_none());
        let link = viewer.map(|viewer| finding_link(viewer, &run.run, finding.column, curve));
        // A channel is drawn once.
        let curve = curve.filter(|curve| drawn.insert((number, &curve.column)));
        out += &entry(finding, &check.runs, curve, link);
    }
    out += "<h2>Every run</h2>\n";
    for (number, run) in check.runs.iter().enumerate() {
        out += &one_run(number, run, viewer);
    }
    out += &small(&format!(
        "A delay is that of the channel if it alone is late. kufe {}",
        check.version
    ));
    plain_page("Recorded runs", &out)
}

/// A link to the stretch of a run that its curve shows, or to the whole run.
fn finding_link(
    viewer: &str,
    run: &str,
    column: Option<&String>,
    curve: Option<&OddCurve>,
) -> String {
    let odd = curve.filter(|curve| curve.marked.is_some());
    let ends = odd.and_then(|curve| Some((curve, curve.points.first()?.0, curve.points.last()?.0)));
    let runs = [run];
    let part = ViewedPart {
        channel: column.map(String::as_str),
        stretch: ends.map(|(curve, from, to)| Stretch::Time(from - curve.t0_s, to - curve.t0_s)),
        ..ViewedPart::of_runs(&runs)
    };
    part.link(viewer, run)
}

/// A finding with its runs.
pub struct RunFinding<'a> {
    /// "wrong" or "odd".
    pub class: &'static str,
    /// The first channel; `None` for a finding about the whole run.
    pub column: Option<&'a String>,
    /// Heading: the channels and what they resemble.
    pub head: String,
    /// The evidence in the first run.
    pub what: &'a str,
    /// Remedy.
    pub mend: &'a str,
    /// Approximate fraction of the run that is lost; 1 for faults.
    pub weight: f64,
    /// Indices of the runs, the worst first.
    pub runs: Vec<usize>,
}

/// The findings of one run, worst first.
fn findings_of(number: usize, run: &Examination) -> Vec<RunFinding<'_>> {
    let runs = vec![number];
    let refused = run.refused.iter().map(|reason| RunFinding {
        class: "wrong",
        column: None,
        head: "Refused".to_owned(),
        what: reason,
        mend: "",
        weight: 1.0,
        runs: runs.clone(),
    });
    let faults = run.faults.iter().map(|fault| {
        let s = if fault.columns.len() == 1 { "s" } else { "" };
        let columns = fault.columns.join(", ");
        RunFinding {
            class: if fault.proven { "wrong" } else { "odd" },
            column: fault.columns.first(),
            head: format!("{columns} resemble{s} {}", fault.looks_like),
            what: &fault.evidence,
            mend: &fault.mend,
            weight: 1.0,
            runs: runs.clone(),
        }
    });
    let notes = run.notes.iter().map(|note| {
        let column = Some(&note.column).filter(|name| !name.is_empty());
        RunFinding {
            class: "odd",
            column,
            head: column.map_or("The run", |name| name).to_owned(),
            what: &note.what,
            mend: &note.advice,
            weight: note.weight,
            runs: runs.clone(),
        }
    });
    refused.chain(faults).chain(notes).collect()
}

/// Findings of all runs; findings that differ only in their numbers are merged. Faults come first,
/// then the findings with most runs.
pub fn run_findings(runs: &[Examination]) -> Vec<RunFinding<'_>> {
    let words = |text: &str| text.replace(|c: char| c.is_ascii_digit() || c == '.', "");
    let mut all: Vec<RunFinding> = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        for one in findings_of(number, run) {
            let same = |known: &&mut RunFinding| {
                (known.class, &known.head, known.mend) == (one.class, &one.head, one.mend)
                    && words(known.what) == words(one.what)
            };
            match all.iter_mut().find(same) {
                Some(known) if known.runs.last() == Some(&number) => {}
                Some(known) => known.runs.extend(one.runs),
                None => all.push(one),
            }
        }
    }
    all.sort_by_key(|finding| (finding.class != "wrong", Reverse(finding.runs.len())));
    all
}

/// A folded section of a run: its findings, one per line, and a table of its channels.
fn one_run(number: usize, run: &Examination, viewer: Option<&str>) -> String {
    let own = findings_of(number, run);
    let wrong = own.iter().filter(|one| one.class == "wrong").count();
    let state = match own.len() {
        0 => String::new(),
        all => format!(": {wrong} wrong, {} odd", all - wrong),
    };
    let mut out = String::new();
    if run.refused.is_none() {
        let (length, rate, used) = (run.length_s, number4(run.rate_hz), run.used_s);
        let file = &run.file;
        out += &small(&format!(
            "{file}: {length:.2} s at {rate} Hz, {used:.2} s of it take part"
        ));
        let link = viewer.map(|viewer| ViewedPart::of_runs(&[&run.run]).link(viewer, &run.run));
        out += &viewer_links(link.as_slice());
    }
    for finding in &own {
        out += &format!("{}</p>\n", head(finding, "p"));
    }
    if !run.channels.is_empty() {
        let columns = columns(
            "channel|#missing|#noise|#steps|#still [s]|#leaps|#drop-outs|#at its stop|#at rest|\
             #delay [ms]",
        );
        let channels = run.channels.iter();
        out += &table(&columns, channels.map(|(name, channel)| row(name, channel)));
    }
    fold_with(
        &format!(" id=\"run-{number}\""),
        &format!("{}{state}", run.run),
        &out,
    )
}

/// The beginning of an element that shows a finding.
fn head(finding: &RunFinding, element: &str) -> String {
    let [head, what] = [&finding.head, finding.what].map(escape);
    format!(
        "<{element} class=\"finding {}\"><b>{head}.</b> {what}",
        finding.class
    )
}

/// The cells of one channel.
fn row(name: &str, channel: &Profile) -> [String; 10] {
    let shown = |value: Option<f64>| {
        let value = value.filter(|value| value.is_finite());
        value.map_or(String::new(), number4)
    };
    let delay = channel.delay_s.map_or(String::new(), |[delay, error]| {
        format!("{:.0} ± {:.0}", 1e3 * delay, 1e3 * error)
    });
    let at_stop = channel.saturation.map_or(0, |stop| stop.samples);
    [
        escape(name),
        channel.missing.to_string(),
        shown(Some(channel.noise_sd)),
        shown(channel.quantum),
        format!("{:.2}", channel.longest_still_s),
        channel.leaps.to_string(),
        channel.dropouts.to_string(),
        at_stop.to_string(),
        shown(channel.at_standstill),
        delay,
    ]
}

/// Largest number of run names that are shown unfolded.
const MAX_NAMES: usize = 6;

/// A finding with its runs, and the curve of its channel in the first run.
fn entry(
    finding: &RunFinding,
    runs: &[Examination],
    curve: Option<&OddCurve>,
    link: Option<String>,
) -> String {
    let mut out = head(finding, "div");
    if !finding.mend.is_empty() {
        out += &format!("<p>To do: <code>{}</code></p>", escape(finding.mend));
    }
    let name = |number: usize| &runs[number].run;
    let links = finding.runs.iter();
    let links = links.map(|&k| format!("<a href=\"#run-{k}\">{}</a>", escape(name(k))));
    let links: Vec<String> = links.collect();
    let (first, count) = (name(finding.runs[0]), links.len());
    let links = links.join(", ");
    out += &match count {
        ..=MAX_NAMES => format!("<p>In {links}</p>\n"),
        _ => {
            let title = format!("In {count} runs; the numbers are those of {first}");
            fold(&title, &format!("<p>{links}</p>"))
        }
    };
    out += &viewer_links(link.as_slice());
    if let Some(curve) = curve {
        let svg = for_both(860.0, curve.figure(first));
        out += &format!("<div class=\"figures\"><div class=\"whole\">{svg}</div></div>\n");
    }
    out + "</div>\n"
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
        assert_eq!(many.matches("<td>v_mps<td").count(), 43);
        assert!(at("<h2>Every run") < at("41.5 % leap"));
        assert!(at("href=\"#run-41\"") < at("id=\"run-41\""));
        assert_eq!(
            many.matches("<details").count(),
            many.matches("</details>").count()
        );
    }
}
