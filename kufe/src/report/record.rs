//! The page of recorded runs: what is wrong, what is odd, what to do, and the properties of every
//! channel.

use std::fmt::Write;

use kufe_sled::{Examination, Octave, Profile};

use crate::plot::number4;
use crate::report::page::{escape, plain_page};
use crate::results::RunCheck;

/// The page of `check.json`: one HTML file without scripts, the worst run first.
pub fn record_page(check: &RunCheck) -> String {
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
        "<h1>Recorded runs</h1>\n<p class=\"told {class}\"><b>{verdict}</b> <small>{}</small></p>\n",
        escape(&check.index)
    );
    out.push_str("<p><small>Wrong is what channels prove of one another; odd is what only you can judge. The worst run comes first.</small></p>\n");
    let (clean, entry): (Vec<_>, Vec<_>) = check.runs.iter().partition(|run| is_clean(run));
    for run in entry {
        let _ = writeln!(out, "<h2>{}</h2>", escape(&run.run));
        one_run(&mut out, run);
    }
    if !clean.is_empty() {
        out.push_str("<h2>Runs without findings</h2>\n");
    }
    for run in clean {
        let _ = writeln!(out, "<details><summary>{}</summary>", escape(&run.run));
        one_run(&mut out, run);
        out.push_str("</details>\n");
    }
    let _ = writeln!(
        out,
        "<p><small>Noise by octave: bars are white noise with as much in that octave, the highest frequencies first, on a logarithmic scale. \
A delay is that of the channel if it alone is late. kufe {}</small></p>",
        escape(&check.version)
    );
    plain_page("Recorded runs", &out)
}

/// Whether nothing is wrong or odd.
fn is_clean(run: &Examination) -> bool {
    run.refused.is_none() && run.faults.is_empty() && run.notes.is_empty()
}

/// The findings and the channels of a run, below its name.
fn one_run(out: &mut String, run: &Examination) {
    if let Some(reason) = &run.refused {
        entry(out, "wrong", "Refused", reason, "");
    } else {
        let _ = writeln!(
            out,
            "<p><small>{}: {:.2} s at {} Hz, {:.2} s of it take part</small></p>",
            escape(&run.file),
            run.length_s,
            number4(run.rate_hz),
            run.used_s
        );
    }
    for fault in &run.faults {
        let verb = if fault.columns.len() == 1 {
            "resembles"
        } else {
            "resemble"
        };
        let head = format!("{} {verb} {}", fault.columns.join(", "), fault.looks_like);
        let class = if fault.proven { "wrong" } else { "odd" };
        entry(out, class, &head, &fault.evidence, &fault.mend);
    }
    for note in &run.notes {
        let head = if note.column.is_empty() {
            "The run"
        } else {
            &note.column
        };
        entry(out, "odd", head, &note.what, &note.advice);
    }
    if run.channels.is_empty() {
        return;
    }
    let [begin, end] = match (is_clean(run), run.faults.is_empty()) {
        (true, _) => ["", ""],
        (false, true) => ["<details><summary>Every channel</summary>\n", "</details>"],
        (false, false) => [
            "<details open><summary>Every channel</summary>\n",
            "</details>",
        ],
    };
    let _ = writeln!(
        out,
        "{begin}<div class=\"wide\"><table><tr><th>channel</th><th class=\"n\">missing</th><th class=\"n\">noise</th>\
<th class=\"n\">steps</th><th class=\"n\">still [s]</th><th class=\"n\">leaps</th><th class=\"n\">drop-outs</th><th class=\"n\">at its stop</th><th class=\"n\">at rest</th><th class=\"n\">delay [ms]</th><th>by octave</th></tr>"
    );
    for (name, channel) in &run.channels {
        row(out, name, channel);
    }
    let _ = writeln!(out, "</table></div>{end}");
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

fn entry(out: &mut String, class: &str, head: &str, what: &str, mend: &str) {
    let _ = write!(
        out,
        "<div class=\"told {class}\"><p><b>{}.</b> {}</p>",
        escape(head),
        escape(what)
    );
    if !mend.is_empty() {
        let _ = write!(out, "<p>To do: <code>{}</code></p>", escape(mend));
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
    fn runs_with_findings_come_first_and_open() {
        let run = |name: &str, notes| Examination {
            run: name.into(),
            file: format!("{name}.csv"),
            notes,
            channels: BTreeMap::from([("v_mps".to_owned(), Profile::default())]),
            ..Examination::default()
        };
        let note = Note {
            column: "v_mps".into(),
            what: "stands still".into(),
            advice: String::new(),
            weight: 0.1,
        };
        let page = record_page(&RunCheck::new(
            "runs.csv",
            vec![run("still", Vec::new()), run("odd", vec![note])],
        ));
        let at = |text: &str| {
            page.find(text)
                .unwrap_or_else(|| panic!("{text} in {page}"))
        };
        assert!(at("<h2>odd</h2>") < at("stands still"));
        assert!(at("stands still") < at("<details><summary>still</summary>"));
        // Of either the channels are there, once.
        assert_eq!(page.matches("<td>v_mps</td>").count(), 2);
        assert_eq!(
            page.matches("<details>").count(),
            page.matches("</details>").count()
        );
    }
}
