//! The page of recorded runs: what is wrong, what is odd, what to do, and what every channel is like.

use std::fmt::Write;

use crate::plot::number4;
use serde_json::Value;

use crate::report::page::{escape, plain_page};

/// The page of `check.json`: one HTML file without scripts.
///
/// `check` holds `index`, `wrong` and `runs`, each with `run`, `refused`, `faults`, `notes`, `length_s`, `used_s`, `rate_hz`
/// and `channels`, as `kufe runs check` writes them.
pub fn record_page(check: &Value) -> String {
    let runs = list(&check["runs"]);
    let wrong = check["wrong"].as_u64().unwrap_or(0);
    let (class, verdict) = match wrong {
        0 => (
            "good",
            format!("Nothing is provably wrong in {} runs.", runs.len()),
        ),
        1 => (
            "wrong",
            format!("1 of {} runs is provably wrong.", runs.len()),
        ),
        wrong => (
            "wrong",
            format!("{wrong} of {} runs are provably wrong.", runs.len()),
        ),
    };
    let mut out = format!(
        "<h1>Recorded runs</h1>\n<p class=\"told {class}\"><b>{verdict}</b> <small>{}</small></p>\n",
        escape(text(&check["index"]))
    );
    out.push_str("<p><small>Wrong is what channels prove of one another; odd is what only you can judge. The worst run comes first.</small></p>\n");
    let (clean, entry): (Vec<&Value>, Vec<&Value>) = runs.iter().partition(|run| is_clean(run));
    for run in entry {
        let _ = writeln!(out, "<h2>{}</h2>", escape(text(&run["run"])));
        one_run(&mut out, run);
    }
    if !clean.is_empty() {
        out.push_str("<h2>Runs of which there is nothing to tell</h2>\n");
    }
    for run in clean {
        let name = escape(text(&run["run"]));
        let _ = writeln!(out, "<details><summary>{name}</summary>");
        one_run(&mut out, run);
        out.push_str("</details>\n");
    }
    let _ = writeln!(
        out,
        "<p><small>Noise by octave: bars are white noise with as much in that octave, the highest frequencies left, on a logarithmic scale. \
A delay is that of the channel if it alone is late. kufe {}</small></p>",
        escape(text(&check["version"]))
    );
    plain_page("Recorded runs", &out)
}

/// Whether nothing is wrong or odd.
fn is_clean(run: &Value) -> bool {
    let silent = |key: &str| list(&run[key]).is_empty();
    run["refused"].is_null() && silent("faults") && silent("notes")
}

/// What a run is like, below its name.
fn one_run(out: &mut String, run: &Value) {
    let number = |key: &str| run[key].as_f64().unwrap_or(0.0);
    if let Some(reason) = run["refused"].as_str() {
        entry(out, "wrong", "Refused", reason, "");
    } else {
        let _ = writeln!(
            out,
            "<p><small>{}: {:.2} s at {} Hz, {:.2} s of it take part</small></p>",
            escape(text(&run["file"])),
            number("length_s"),
            number4(number("rate_hz")),
            number("used_s")
        );
    }
    for fault in list(&run["faults"]) {
        let columns: Vec<&str> = list(&fault["columns"]).iter().map(text).collect();
        let resembles = if columns.len() == 1 {
            "looks like"
        } else {
            "look like"
        };
        let head = format!(
            "{} {resembles} {}",
            columns.join(", "),
            text(&fault["looks_like"])
        );
        let class = if fault["proven"] == false {
            "odd"
        } else {
            "wrong"
        };
        entry(
            out,
            class,
            &head,
            text(&fault["evidence"]),
            text(&fault["mend"]),
        );
    }
    for note in list(&run["notes"]) {
        let column = text(&note["column"]);
        let head = if column.is_empty() { "The run" } else { column };
        entry(out, "odd", head, text(&note["what"]), text(&note["advice"]));
    }
    let Some(channels) = run["channels"]
        .as_object()
        .filter(|channels| !channels.is_empty())
    else {
        return;
    };
    let folded = match (is_clean(run), list(&run["faults"]).is_empty()) {
        (true, _) => ["", ""],
        (false, true) => ["<details><summary>Every channel</summary>\n", "</details>"],
        (false, false) => [
            "<details open><summary>Every channel</summary>\n",
            "</details>",
        ],
    };
    let _ = writeln!(
        out,
        "{}<div class=\"wide\"><table><tr><th>channel</th><th class=\"n\">missing</th><th class=\"n\">noise</th>\
<th class=\"n\">steps</th><th class=\"n\">still [s]</th><th class=\"n\">leaps</th><th class=\"n\">drop-outs</th><th class=\"n\">at its stop</th><th class=\"n\">at rest</th><th class=\"n\">delay [ms]</th><th>by octave</th></tr>",
        folded[0]
    );
    for (name, channel) in channels {
        let known = |key: &str| channel[key].as_f64().map_or(String::new(), number4);
        let delay = list(&channel["delay_s"]);
        let delay = match (
            delay.first().and_then(Value::as_f64),
            delay.last().and_then(Value::as_f64),
        ) {
            (Some(delay), Some(error)) => format!("{:.0} ± {:.0}", 1e3 * delay, 1e3 * error),
            _ => String::new(),
        };
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{:.2}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
<td class=\"n\">{}</td><td class=\"n\">{delay}</td><td>{}</td></tr>",
            escape(name),
            channel["missing"],
            known("noise_sd"),
            known("quantum"),
            channel["longest_still_s"].as_f64().unwrap_or(0.0),
            channel["leaps"],
            channel["dropouts"],
            channel["saturation"]["samples"].as_u64().unwrap_or(0),
            known("at_standstill"),
            strip(list(&channel["octaves"]))
        );
    }
    let _ = writeln!(out, "</table></div>{}", folded[1]);
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
fn strip(octaves: &[Value]) -> String {
    const DECADES: f64 = 5.0;
    let height =
        |value: f64, most: f64| 22.0 * (1.0 + (value / most).log10() / DECADES).clamp(0.04, 1.0);
    let sd = |octave: &Value| octave["sd"].as_f64().unwrap_or(0.0);
    let most = octaves.iter().map(sd).fold(0.0, f64::max);
    if most <= 0.0 {
        return String::new();
    }
    let mut svg = String::from(
        "<svg class=\"bars\" width=\"80\" height=\"22\" role=\"img\" aria-label=\"noise by octave\">",
    );
    for (k, octave) in octaves.iter().enumerate() {
        let tall = height(sd(octave).max(1e-300), most);
        let _ = write!(
            svg,
            "<rect x=\"{}\" y=\"{:.1}\" width=\"8\" height=\"{tall:.1}\"><title>up to {} Hz: {}</title></rect>",
            10 * k,
            22.0 - tall,
            number4(octave["to_hz"].as_f64().unwrap_or(0.0)),
            number4(sd(octave))
        );
    }
    svg + "</svg>"
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or("")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn runs_of_which_there_is_something_to_tell_stand_first_and_open() {
        let channels = json!({ "v_mps": { "missing": 0, "leaps": 0, "dropouts": 0 } });
        let check = json!({ "wrong": 0, "runs": [
            { "run": "still", "file": "a.csv", "channels": channels },
            { "run": "odd", "file": "b.csv", "notes": [{ "column": "v_mps", "what": "stands still" }], "channels": channels },
        ] });
        let page = record_page(&check);
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
