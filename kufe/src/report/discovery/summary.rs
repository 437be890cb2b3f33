//! The first screen: what is missing, how large, where, how certain, what remains, what to measure
//! next.

use std::fmt::Write as _;

use crate::plot::escape;
use crate::report::discovery::parts::{amount, meaning, p_is, shown, size};
use crate::results::finding::{ChannelGap, HeldOut, ModelKind, Report, Step, Verdict};

/// The verdict as a heading, the effects one a line, figures to act on, and what to do next.
pub fn summary(out: &mut String, report: &Report) {
    let _ = writeln!(out, "<h1>{}</h1>", in_words(report));
    if !report.explained.is_empty() {
        let _ = writeln!(out, "<p>{}</p>", escape(&report.explained));
    }
    if report.steps.is_empty() {
        let sentence = escape(&report.sentence);
        let _ = writeln!(out, "<p class=\"verdict\">{sentence}</p>");
    } else {
        out.push_str("<ol class=\"verdict\">\n");
        for step in &report.steps {
            let _ = writeln!(out, "<li>{}</li>", effect(step));
        }
        out.push_str("</ol>\n");
    }
    out.push_str("<div class=\"tiles\">\n");
    gap_tile(out, report);
    if let Some(step) = report.steps.first() {
        step_tiles(out, step, report);
        remaining_tile(out, report);
    }
    out.push_str("</div>\n");
    notes(out, report);
}

/// What is not written, what is implausible, and what to measure next.
fn notes(out: &mut String, report: &Report) {
    let mut note = |head: &str, text: &str| {
        let _ = writeln!(out, "<p><b>{head}:</b> {}</p>", escape(text));
    };
    for withheld in &report.withheld {
        let which = match withheld.model {
            ModelKind::WithEffect => format!("The model with {}", withheld.effects.join(", ")),
            _ => "The model with friction and grip refitted".to_owned(),
        };
        let text = format!(
            "{which} is worse than the model as given on data that the search had not seen: {}.",
            withheld.reason
        );
        note("Not written", &text);
    }
    if let (Some(friction), true) = (report.base.first(), report.written != ModelKind::AsGiven) {
        note("Base in the next model", &size(friction));
    }
    for parameter in &report.implausible {
        let text = format!(
            "{} is far from the given value: a sensor, the data or the model is wrong rather than this parameter.",
            size(parameter)
        );
        note("Implausible", &text);
    }
    if !report.next_experiment.is_empty() {
        note("What to measure next", &report.next_experiment);
    }
}

fn in_words(report: &Report) -> String {
    let more = match report.adequate || report.steps.is_empty() {
        true => "",
        false => ", and more is missing",
    };
    let words = match report.verdict {
        Verdict::Named if report.steps.len() > 1 => "Effects are missing from the model",
        Verdict::Named => "An effect is missing from the model",
        Verdict::OneOf => "An effect is missing: one of a few",
        Verdict::DependsOn => "Whether an effect is missing depends on an assumption",
        Verdict::Law => "Something outside the catalogue is missing: a law for it",
        Verdict::Located => "Something is missing at some places, and has no name",
        Verdict::Inadequate => "Something that repeats from run to run is missing, and has no name",
        Verdict::None => "Nothing is missing that these data could show",
        Verdict::NotIdentifiable => "Something differs, but these data cannot name it",
    };
    format!("{words}{more}")
}

/// Name, what it means, size with interval, place.
fn effect(step: &Step) -> String {
    let mut text = format!("<b>{}</b>", escape(&step.effect));
    if step.class.len() > 1 {
        let _ = write!(text, " or {}", escape(&step.class[1..].join(" or ")));
    }
    if !step.summary.is_empty() {
        let _ = write!(text, ": {}", escape(&step.summary));
    }
    let sizes: Vec<String> = step.parameters.iter().map(size).collect();
    if !sizes.is_empty() {
        let _ = write!(text, "<br>{}", escape(&sizes.join("; ")));
    }
    for parameter in &step.parameters {
        if let Some(meaning) = meaning(&step.effect, &parameter.name) {
            let _ = write!(text, "<br><small>{}: {meaning}</small>", parameter.name);
        }
    }
    if let Some(contacts) = contacts(step) {
        let _ = write!(text, "<br>{}", escape(&contacts));
    }
    if !step.place.is_empty() {
        let places = escape(&places(&step.place));
        let _ = write!(text, "<br><small>where: {places}</small>");
    }
    text
}

/// Places along tracks, each track named once: `s 10-20 m on track a; s 30-40 m on track a` is
/// `track a at 10-20, 30-40 m`.
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
    let texts = parts.iter().map(|(name, at)| match at.is_empty() {
        true => (*name).to_owned(),
        false => format!("track {name} at {} m", at.join(", ")),
    });
    texts.collect::<Vec<_>>().join("; ")
}

/// How many runs met how many places and how hard, of an effect that varies from run to run.
fn contacts(step: &Step) -> Option<String> {
    let met = step.contacts.iter().flat_map(|place| &place.contacts);
    let forces: Vec<f64> = met.map(|one| one.force_n.abs()).collect();
    let least = forces.iter().copied().reduce(f64::min)?;
    let most = forces.iter().copied().fold(least, f64::max);
    Some(format!(
        "{} contacts at {} places, {least:.0} to {most:.0} N: each by the side force of its own run, judged by runs that hit the same places and by how the sled then turns and brakes",
        forces.len(),
        step.contacts.len(),
    ))
}

/// The gap before and after, on data that the search had not seen where there are any.
fn gap_tile(out: &mut String, report: &Report) {
    let held_out = &report.held_out;
    if held_out.runs.is_empty() {
        if let Some(gap) = report.training.first() {
            let figure = format!(
                "{} → {}",
                shown(gap.before, &gap.unit),
                amount(gap.after, &gap.unit)
            );
            tile(out, &figure, "gap between measured and simulated");
        }
        return;
    }
    let runs = match held_out.runs.len() {
        1 => format!("one {}", held_out.what),
        count => format!("{count} {}s", held_out.what),
    };
    let mut why = format!("gap on {runs} that the search had not seen");
    let channel = judged(held_out);
    if let Some(channel) = channel {
        let noise = amount(channel.noise, &held_out.unit);
        let _ = write!(
            why,
            " ({}); the sensors’ noise alone makes {noise}",
            channel.channel
        );
    }
    let mut baselines = report.baselines.iter();
    let baseline = baselines.find(|b| channel.is_some_and(|c| c.channel == b.quantity));
    let models = baseline.and_then(|b| Some((b, b.refitted?, b.with_effect?)));
    let figure = match models {
        Some((one, refitted, with_effect)) => {
            why += ": as given, with the base refitted, with the effect";
            let [given, refitted] = [one.as_given, refitted].map(|gap| shown(gap, &one.unit));
            format!(
                "{given} → {refitted} → {}",
                unbroken(with_effect, &one.unit)
            )
        }
        None => {
            let before = shown(held_out.gap_before, &held_out.unit);
            format!(
                "{before} → {}",
                unbroken(held_out.gap_after, &held_out.unit)
            )
        }
    };
    tile(out, &figure, &why);
}

/// A value and its unit without a break between them.
fn unbroken(value: f64, unit: &str) -> String {
    amount(value, unit).replace(' ', "\u{a0}")
}

/// The channel whose gap the report states.
fn judged(held_out: &HeldOut) -> Option<&ChannelGap> {
    held_out
        .channels
        .iter()
        .find(|c| c.before == held_out.gap_before)
}

/// Whether what remains is noise.
fn remaining_tile(out: &mut String, report: &Report) {
    let (figure, why) = match (report.clean, report.bins_after.len()) {
        (true, _) => (
            "clean",
            match scatter(&report.held_out) {
                None => "nothing more is significant".to_owned(),
                Some(scatter) => {
                    let what = &report.held_out.what;
                    format!(
                        "nothing more is significant; {scatter} in excess of the sensors’ noise differ from {what} to {what}"
                    )
                }
            },
        ),
        (false, 0) => (
            "not clean",
            format!(
                "{} remain, more than the noise: something else may be missing",
                remaining(report)
            ),
        ),
        (false, 1) => (
            "not clean",
            "one bin is still significant: something else is missing, too".to_owned(),
        ),
        (false, bins) => (
            "not clean",
            format!("{bins} bins are still significant: something else is missing, too"),
        ),
    };
    tile(out, figure, &why);
}

/// The gap that remains.
fn remaining(report: &Report) -> String {
    let held_out = &report.held_out;
    match report.training.first() {
        Some(gap) if held_out.runs.is_empty() => amount(gap.after, &gap.unit),
        _ => amount(held_out.gap_after, &held_out.unit),
    }
}

/// What remains in excess of the sensors' noise, where that is more than the noise.
fn scatter(held_out: &HeldOut) -> Option<String> {
    let noise = judged(held_out)?.noise;
    let excess = (held_out.gap_after * held_out.gap_after - noise * noise)
        .max(0.0)
        .sqrt();
    (excess > noise).then(|| amount(excess, &held_out.unit))
}

fn step_tiles(out: &mut String, step: &Step, report: &Report) {
    let closed = &step.explainable_gap_closed;
    let [value, low, high] = [closed.value, closed.low, closed.high].map(|share| 100.0 * share);
    if value.is_finite() {
        let by = match report.steps.len() {
            1 => "by it",
            _ => "by all of them together",
        };
        let known = match (low > -100.0 || high < 100.0, low < 0.0) {
            (true, false) => format!(" ({low:.0} to {high:.0} %)"),
            (true, true) => {
                format!(" ({low:.0} to {high:.0} %: too few data to decide whether any)")
            }
            (false, _) => ": too few data to decide".to_owned(),
        };
        let judged = match report.held_out.runs.is_empty() {
            true => "",
            false => " on data not seen",
        };
        let why = format!("of what effects could explain{judged} is explained {by}{known}");
        tile(out, &format!("{value:.0} %"), &why);
    }
    let p = format!("p {}", p_is(step.p_value));
    tile(out, &p, "probability that noise alone resembles the first");
}

fn tile(out: &mut String, figure: &str, why: &str) {
    // A moment's unit is not broken in two.
    let whole = |text: &str| escape(text).replace(" N m", "\u{a0}N\u{a0}m");
    let _ = writeln!(
        out,
        "<div><b>{}</b><span>{}</span></div>",
        whole(figure),
        whole(why)
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::finding::Bin;

    #[test]
    fn what_remains_without_a_bin_is_stated_by_its_size() {
        let mut report = Report {
            verdict: Verdict::Named,
            steps: vec![Step::default()],
            training: vec![ChannelGap {
                channel: "p".to_owned(),
                unit: "Pa".to_owned(),
                before: 9e6,
                after: 3e6,
                noise: 1e6,
            }],
            ..Report::default()
        };
        let page = |report: &Report| {
            let mut out = String::new();
            summary(&mut out, report);
            out
        };
        assert!(
            page(&report).contains("3.000 MPa remain"),
            "{}",
            page(&report)
        );
        report.held_out = HeldOut {
            what: "map".to_owned(),
            runs: vec!["row 5".to_owned()],
            unit: "Pa".to_owned(),
            gap_after: 4e6,
            ..HeldOut::default()
        };
        assert!(
            page(&report).contains("4.000 MPa remain"),
            "{}",
            page(&report)
        );
        report.bins_after = vec![Bin::default()];
        let still = "one bin is still significant";
        assert!(page(&report).contains(still), "{}", page(&report));
    }

    #[test]
    fn places_name_each_track_once_and_leave_other_words_alone() {
        let text =
            "all runs of session 3; s 10-20 m on track a; s 5-6 m on track b; s 30-40 m on track a";
        assert_eq!(
            places(text),
            "all runs of session 3; track a at 10-20, 30-40 m; track b at 5-6 m"
        );
        assert_eq!(places("s 480-520 m"), "s 480-520 m");
    }
}
