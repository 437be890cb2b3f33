//! The first screen: what is missing, how large, where, how sure, what is left, what to measure next.

use std::fmt::Write as _;

use crate::plot::{number4, quantity, usual};

use super::data::Data;
use super::parts::{meaning, p_is};
use crate::report::page::escape;

/// The verdict as a heading, the effects one a line, figures to act on, and what to do next.
pub fn summary(out: &mut String, report: Data) {
    let _ = writeln!(out, "<h1>{}</h1>", in_words(report));
    if !report.text("explained").is_empty() {
        let _ = writeln!(out, "<p>{}</p>", escape(report.text("explained")));
    }
    let steps = report.list("steps");
    if steps.is_empty() {
        let _ = writeln!(
            out,
            "<p class=\"verdict\">{}</p>",
            escape(report.text("sentence"))
        );
    } else {
        out.push_str("<ol class=\"verdict\">\n");
        for step in &steps {
            let _ = writeln!(out, "<li>{}</li>", effect(*step));
        }
        out.push_str("</ol>\n");
    }
    out.push_str("<div class=\"tiles\">\n");
    gap_tile(out, report);
    if let Some(step) = steps.first() {
        step_tiles(out, *step, report);
    }
    if !steps.is_empty() {
        let left = report.list("bins_after").len();
        let what = report.part("held_out").text("what");
        let (text, why) = match report.is("clean") {
            true => (
                "clean".to_owned(),
                match scatter(report) {
                    None => "nothing more stands out of chance".to_owned(),
                    Some(scatter) => format!(
                        "nothing more stands out of chance; {scatter} beyond the sensors’ noise differ from {what} to {what}"
                    ),
                },
            ),
            false => (
                "not clean".to_owned(),
                match left {
                    0 => format!(
                        "{} are left, more than the noise: something else may be missing",
                        left_over(report)
                    ),
                    1 => "one bin still stands out: something else is missing, too".to_owned(),
                    _ => format!("{left} bins still stand out: something else is missing, too"),
                },
            ),
        };
        tile(out, &text, &why);
    }
    out.push_str("</div>\n");
    for withheld in report.list("withheld") {
        let which = match withheld.text("model") {
            "with-effect" => format!("The model with {}", withheld.texts("effects").join(", ")),
            _ => "The model with friction and grip refitted".to_owned(),
        };
        let _ = writeln!(
            out,
            "<p><b>Not written:</b> {} is worse than the model as given on data that the search had not seen: {}.</p>",
            escape(&which),
            escape(withheld.text("reason"))
        );
    }
    let base: Vec<String> = report.list("base").into_iter().map(size).collect();
    if let (Some(friction), true) = (base.first(), report.text("written") != "as-given") {
        let _ = writeln!(
            out,
            "<p><b>Base in the next model:</b> {}</p>",
            escape(friction)
        );
    }
    for parameter in report.list("implausible") {
        let _ = writeln!(
            out,
            "<p><b>Implausible:</b> {} is far from the given value: a sensor, the data or the model is wrong rather than this parameter.</p>",
            escape(&size(parameter))
        );
    }
    if !report.text("next_experiment").is_empty() {
        let _ = writeln!(
            out,
            "<p><b>What to measure next:</b> {}</p>",
            escape(report.text("next_experiment"))
        );
    }
}

fn in_words(report: Data) -> String {
    let more =
        match report.is("adequate") || !report.has("adequate") || report.list("steps").is_empty() {
            true => "",
            false => ", and more is missing",
        };
    let words = match report.text("verdict") {
        "named" if report.list("steps").len() > 1 => "Effects are missing from the model",
        "named" => "An effect is missing from the model",
        "one-of" => "An effect is missing: one of a few",
        "depends-on" => "Whether an effect is missing depends on an assumption",
        "law" => "Something beyond the catalogue is missing: a law for it",
        "located" => "Something is missing at some places, and has no name",
        "inadequate" => "Something that repeats from run to run is missing, and has no name",
        "none" => "Nothing is missing that these data could show",
        _ => "Something differs, but these data cannot name it",
    };
    format!("{words}{more}")
}

/// Name, what it means, size with interval, place.
fn effect(step: Data) -> String {
    let mut text = format!("<b>{}</b>", escape(step.text("effect")));
    let class = step.texts("class");
    if class.len() > 1 {
        let _ = write!(text, " or {}", escape(&class[1..].join(" or ")));
    }
    if !step.text("summary").is_empty() {
        let _ = write!(text, ": {}", escape(step.text("summary")));
    }
    let parameters = step.list("parameters");
    let sizes: Vec<String> = parameters.iter().map(|p| size(*p)).collect();
    if !sizes.is_empty() {
        let _ = write!(text, "<br>{}", escape(&sizes.join("; ")));
    }
    for (name, meaning) in parameters.iter().filter_map(|p| {
        Some((
            p.text("name"),
            meaning(step.text("effect"), p.text("name"))?,
        ))
    }) {
        let _ = write!(text, "<br><small>{name}: {meaning}</small>");
    }
    if let Some(contacts) = contacts(step) {
        let _ = write!(text, "<br>{}", escape(&contacts));
    }
    if !step.text("where").is_empty() {
        let _ = write!(
            text,
            "<br><small>where: {}</small>",
            escape(&places(step.text("where")))
        );
    }
    text
}

/// Places along tracks, each track named once: `s 10-20 m on track a; s 30-40 m on track a` is `track a at 10-20, 30-40 m`.
fn places(text: &str) -> String {
    let mut parts: Vec<(&str, Vec<&str>)> = Vec::new();
    for part in text.split("; ") {
        let place = part.strip_prefix("s ");
        match place.and_then(|place| place.split_once(" m on track ")) {
            None => parts.push((part, Vec::new())),
            Some((place, track)) => match parts
                .iter_mut()
                .find(|(name, at)| *name == track && !at.is_empty())
            {
                Some((_, at)) => at.push(place),
                None => parts.push((track, vec![place])),
            },
        }
    }
    let told = parts.iter().map(|(name, at)| match at.is_empty() {
        true => (*name).to_owned(),
        false => format!("track {name} at {} m", at.join(", ")),
    });
    told.collect::<Vec<_>>().join("; ")
}

/// How many runs met how many places and how hard, of an effect that varies from run to run.
fn contacts(step: Data) -> Option<String> {
    let places = step.list("contacts");
    let met = places.iter().flat_map(|place| place.list("contacts"));
    let forces: Vec<f64> = met.map(|one| one.number("force_n").abs()).collect();
    let least = forces.iter().copied().reduce(f64::min)?;
    let most = forces.iter().copied().fold(least, f64::max);
    Some(format!(
        "{} contacts at {} places, {least:.0} to {most:.0} N: each by the side force of its own run, judged by runs that hit the same places and by how the sled then turns and brakes",
        forces.len(),
        places.len(),
    ))
}

/// `name value unit (low to high)`.
fn size(parameter: Data) -> String {
    let (value, unit) = usual(parameter.number("value"), parameter.text("unit"));
    let show = |key: &str| number4(usual(parameter.number(key), parameter.text("unit")).0);
    let name = parameter.text("name");
    let (low, high) = (show("low"), show("high"));
    let text = format!("{name} = {} {unit}", number4(value));
    let text = format!("{} (95 % interval {low} to {high})", text.trim_end());
    match unit {
        // Nobody knows ice by the inverse of its hardness.
        "1/Pa" => format!("{text}, the inverse of {}", quantity(1.0 / value, "Pa")),
        _ => text,
    }
}

fn gap_tile(out: &mut String, report: Data) {
    let held = report.part("held_out");
    let runs = held.texts("runs");
    let learned = report.list("training");
    if runs.is_empty() {
        if let Some(gap) = learned.first() {
            let shown = format!(
                "{} → {}",
                number4(usual(gap.number("before"), gap.text("unit")).0),
                quantity(gap.number("after"), gap.text("unit"))
            );
            tile(out, &shown, "gap between measured and simulated");
        }
        return;
    }
    let unit = held.text("unit");
    let shown = judged(held);
    let mut why = format!(
        "gap on {} that the search had not seen",
        counted(runs.len(), held.text("what"))
    );
    if let Some(channel) = shown {
        let _ = write!(
            why,
            " ({}); the sensors’ noise alone makes {}",
            channel.text("channel"),
            quantity(channel.number("noise"), unit)
        );
    }
    let baselines = report.list("baselines");
    let of_channel = |b: &&Data| {
        b.has("refitted") && shown.is_some_and(|c| c.text("channel") == b.text("quantity"))
    };
    if let Some(one) = baselines
        .iter()
        .find(of_channel)
        .filter(|b| b.has("with_effect"))
    {
        let unit = one.text("unit");
        let [given, refitted] =
            ["as_given", "refitted"].map(|key| number4(usual(one.number(key), unit).0));
        let with = quantity(one.number("with_effect"), unit).replace(' ', "\u{a0}");
        let why = format!("{why}: as given, with the base refitted, with the effect");
        return tile(out, &format!("{given} → {refitted} → {with}"), &why);
    }
    let before = number4(usual(held.number("gap_before"), unit).0);
    let after = quantity(held.number("gap_after"), unit).replace(' ', "\u{a0}");
    tile(out, &format!("{before} → {after}"), &why);
}

/// The channel that the gap is told of.
fn judged(held: Data) -> Option<Data> {
    let channels = held.list("channels");
    let told = |c: &&Data| c.number("before") == held.number("gap_before");
    channels.iter().find(told).copied()
}

/// The gap that is left.
fn left_over(report: Data) -> String {
    let held = report.part("held_out");
    match report.list("training").first() {
        Some(learned) if held.texts("runs").is_empty() => {
            quantity(learned.number("after"), learned.text("unit"))
        }
        _ => quantity(held.number("gap_after"), held.text("unit")),
    }
}

/// What is left beyond the sensors' noise where that is more than the noise.
fn scatter(report: Data) -> Option<String> {
    let held = report.part("held_out");
    let [after, noise] = [held.number("gap_after"), judged(held)?.number("noise")];
    let beyond = (after * after - noise * noise).max(0.0).sqrt();
    (beyond > noise).then(|| quantity(beyond, held.text("unit")))
}

fn step_tiles(out: &mut String, step: Data, report: Data) {
    let closed = step.part("explainable_gap_closed");
    let [value, low, high] = ["value", "low", "high"].map(|key| 100.0 * closed.number(key));
    if value.is_finite() {
        let steps = report.list("steps");
        let by = match steps.len() {
            1 => "by it",
            _ => "by all of them together",
        };
        let known = match (low > -100.0 || high < 100.0, low < 0.0) {
            (true, false) => format!(" ({low:.0} to {high:.0} %)"),
            (true, true) => {
                format!(" ({low:.0} to {high:.0} %: too few data to tell whether any)")
            }
            (false, _) => ": too few data to tell".to_owned(),
        };
        let judged = match report.part("held_out").texts("runs").is_empty() {
            true => "",
            false => " on data not seen",
        };
        tile(
            out,
            &format!("{value:.0} %"),
            &format!("of what effects could explain{judged} is explained {by}{known}"),
        );
    }
    let _ = writeln!(
        out,
        "<div><b>p {}</b><span>chance that noise alone looks like the first</span></div>",
        p_is(step.number("p_value"))
    );
}

fn tile(out: &mut String, figure: &str, why: &str) {
    let _ = writeln!(
        out,
        "<div><b>{}</b><span>{}</span></div>",
        whole(figure),
        whole(why)
    );
}

/// A text for a narrow box: a moment's unit is not broken in two.
fn whole(text: &str) -> String {
    escape(text).replace(" N m", "\u{a0}N\u{a0}m")
}

/// `2 runs`, `one measurement`.
fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("one {what}"),
        _ => format!("{count} {what}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_without_a_bin_is_told_by_its_size() {
        let mut report = serde_json::json!({
            "verdict": "named", "steps": [{ "effect": "hardness" }], "clean": false,
            "training": [{ "channel": "p", "unit": "Pa", "before": 9e6, "after": 3e6 }],
        });
        let told = |report: &serde_json::Value| {
            let mut out = String::new();
            summary(&mut out, Data(report));
            out
        };
        assert!(
            told(&report).contains("3.000 MPa are left"),
            "{}",
            told(&report)
        );
        report["held_out"] =
            serde_json::json!({ "what": "map", "runs": ["row 5"], "unit": "Pa", "gap_after": 4e6 });
        assert!(
            told(&report).contains("4.000 MPa are left"),
            "{}",
            told(&report)
        );
        report["bins_after"] = serde_json::json!([{}]);
        assert!(
            told(&report).contains("one bin still stands out"),
            "{}",
            told(&report)
        );
    }

    #[test]
    fn places_name_each_track_once_and_leave_other_words_alone() {
        let told =
            "all runs of session 3; s 10-20 m on track a; s 5-6 m on track b; s 30-40 m on track a";
        assert_eq!(
            places(told),
            "all runs of session 3; track a at 10-20, 30-40 m; track b at 5-6 m"
        );
        assert_eq!(places("s 480-520 m"), "s 480-520 m");
    }
}
