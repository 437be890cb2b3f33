//! Summary of the page: missing effects with size, place and certainty, the remaining misfit, and
//! the next measurement.

use crate::plot::{escape, quantity};
use crate::report::discovery::parts::{alike, meaning, p_is, size};
use crate::report::html::tiles;
use crate::results::finding::{
    ChannelGap, HeldOut, ModelKind, Remaining, Report, SessionOffset, Step, Verdict,
};

/// The effects that were fitted and tested; a quick search only selects one.
pub fn tested(report: &Report) -> &[Step] {
    match report.verdict {
        Verdict::NotIdentifiable => &[],
        _ => &report.steps,
    }
}

/// The verdict as a heading, the effects, one per line, the main figures, and the next steps.
pub fn summary(report: &Report) -> String {
    let mut out = format!("<h1>{}</h1>\n", in_words(report));
    if !report.explained.is_empty() {
        out += &format!("<p>{}</p>\n", escape(&report.explained));
    }
    let steps = tested(report);
    out += &if steps.is_empty() {
        format!("<p class=\"verdict\">{}</p>\n", escape(&report.sentence))
    } else {
        let effects = steps.iter();
        let effects = effects.map(|step| format!("<li>{}</li>\n", effect(step)));
        format!(
            "<ol class=\"verdict\">\n{}</ol>\n",
            effects.collect::<String>()
        )
    };
    let mut figures = Vec::from_iter(misfit(report));
    if let Some(step) = steps.first() {
        figures.extend(explained(step, report));
        let why = format!(
            "p-value of {}, corrected for all that was tested",
            step.effect
        );
        figures.push((format!("p {}", p_is(step.p_value)), why));
        figures.push(remaining(report));
    }
    // Prevents a line break within the unit of a moment.
    let whole = |text: String| text.replace("N m", "N\u{a0}m");
    let figures = figures.into_iter();
    out += &tiles(figures.map(|(figure, why)| (whole(figure), whole(why))));
    let notes = notes(report).into_iter();
    out.extend(notes.map(|(head, text)| format!("<p><b>{head}:</b> {}</p>\n", escape(&text))));
    out
}

/// Notes on models that are not written, implausible parameters, and the next measurement.
fn notes(report: &Report) -> Vec<(&'static str, String)> {
    let mut notes = Vec::new();
    for withheld in &report.withheld {
        let which = match withheld.model {
            ModelKind::WithEffect => format!("The model with {}", withheld.effects.join(", ")),
            _ => "The model with friction and grip refitted".to_owned(),
        };
        let text = format!(
            "{which} is worse than the model as given on held-out data: {}.{}",
            withheld.reason,
            written(report)
        );
        notes.push(("Not written", text));
    }
    let friction = report.base.iter().filter(|one| one.unit != "N/rad");
    let friction: Vec<String> = friction.map(size).collect();
    if !friction.is_empty() && report.written != ModelKind::AsGiven {
        notes.push(("Friction in the next model", friction.join(", ")));
    }
    for offsets in SessionOffset::by_sensor(&report.session_offsets) {
        if offsets.iter().any(|one| one.value.abs() > one.tolerance) {
            let text = format!("{}; corrected for.", SessionOffset::in_words(&offsets));
            notes.push(("Sensor mounted anew", text));
        }
    }
    for parameter in &report.implausible {
        let text = format!(
            "{} is far from the given value. Suspect a sensor, the data or the model rather than this parameter.",
            size(parameter)
        );
        notes.push(("Implausible", text));
    }
    // Without an identified effect the sentence may state the next experiment already.
    if !report.next_experiment.is_empty() && !report.sentence.contains(&report.next_experiment) {
        notes.push(("What to measure next", report.next_experiment.clone()));
    }
    notes
}

/// The effects of the model that is written instead of the withheld one.
fn written(report: &Report) -> String {
    let effects: Vec<&str> = report.steps.iter().map(|s| s.effect.as_str()).collect();
    match report.written {
        ModelKind::WithEffect => format!(" The model that is written has {}.", effects.join(", ")),
        _ => String::new(),
    }
}

fn in_words(report: &Report) -> String {
    let words = match report.verdict {
        Verdict::Named if report.steps.len() > 1 => "Effects are missing from the model",
        Verdict::Named => "An effect is missing from the model",
        Verdict::OneOf => "An effect is missing from the model: one of several",
        Verdict::DependsOn => "Whether an effect is missing depends on an assumption",
        Verdict::Law => "A law is missing from the model that is no effect of the catalogue",
        Verdict::Located => "The model is wrong at some places, for an unknown reason",
        Verdict::Inadequate => "The residual repeats from run to run, for an unknown reason",
        Verdict::None => "No missing effect is significant in these data",
        Verdict::NotIdentifiable if !report.steps.is_empty() => {
            "The screen selects an effect, which is not tested yet"
        }
        Verdict::NotIdentifiable => "Model and data differ, and these data do not show why",
    };
    let is_all = report.adequate || tested(report).is_empty();
    let more = if is_all { "" } else { ", and more is missing" };
    format!("{words}{more}")
}

/// One effect: name, meaning, parameters with intervals, and place.
fn effect(step: &Step) -> String {
    let mut text = format!("<b>{}</b>", escape(&step.effect));
    // Appends a part of the text between its marks; an empty part is omitted.
    let mut add = |before: &str, part: &str, after: &str| {
        if !part.is_empty() {
            text += &[before, &escape(part), after].concat();
        }
    };
    add(
        " or ",
        &step.class.get(1..).unwrap_or_default().join(" or "),
        "",
    );
    add(": ", &step.summary, "");
    let contacts = step.contacts_in_words().unwrap_or_default();
    add("<br>", &contacts, "");
    let sizes: Vec<String> = step.parameters.iter().map(size).collect();
    add("<br>", &sizes.join("; "), "");
    for parameter in &step.parameters {
        if let Some(meaning) = meaning(&step.effect, &parameter.name) {
            let text = format!("{}: {meaning}", parameter.name);
            add("<br><small>", &text, "</small>");
        }
    }
    if contacts.is_empty() {
        add("<br><small>where: ", &places(&step.place), "</small>");
    }
    text
}

/// Merges places along tracks: `s 10-20 m on track a; s 30-40 m on track a` becomes `track a at
/// 10-20, 30-40 m`.
fn places(text: &str) -> String {
    let mut parts: Vec<(&str, Vec<&str>)> = Vec::new();
    for part in text.split("; ") {
        let place = part.strip_prefix("s ");
        let Some((place, track)) = place.and_then(|place| place.split_once(" m on track ")) else {
            parts.push((part, Vec::new()));
            continue;
        };
        let mut known = parts.iter_mut();
        match known.find(|(name, at)| *name == track && !at.is_empty()) {
            Some((_, at)) => at.push(place),
            None => parts.push((track, vec![place])),
        }
    }
    let texts = parts.iter().map(|(name, at)| match at[..] {
        [] => (*name).to_owned(),
        _ => format!("track {name} at {} m", at.join(", ")),
    });
    texts.collect::<Vec<_>>().join("; ")
}

/// A figure and its description.
type Tile = (String, String);

/// Misfits with arrows between them, in one unit and without line breaks.
fn arrow<const N: usize>(gaps: [f64; N], unit: &str) -> String {
    let (gaps, scale) = alike(gaps, unit);
    let text = scale.with_unit(&gaps.join("→"));
    text.replace(' ', "\u{a0}").replace('→', " → ")
}

/// The misfit before and after, on held-out data if there are any.
fn misfit(report: &Report) -> Option<Tile> {
    let held_out = &report.held_out;
    if held_out.runs.is_empty() {
        let shares = report.remaining.iter();
        let most = shares.max_by(|a, b| a.of_misfit.value.total_cmp(&b.of_misfit.value));
        let of_most = |c: &&ChannelGap| most.is_some_and(|most| most.channel == c.channel);
        let mut training = report.training.iter();
        let gap = training.find(of_most).or(report.training.first())?;
        let figure = arrow([gap.before, gap.after], &gap.unit);
        let why = format!("rms {} residual: model as given, as fitted", gap.channel);
        return Some((figure, why));
    }
    let channel = judged(held_out);
    let of_channel = channel.map_or(String::new(), |one| format!("{} ", one.channel));
    let mut why = format!("rms {of_channel}residual on {}", held_out.in_words());
    let noise = channel.map_or(String::new(), |one| {
        let noise = quantity(one.noise, &held_out.unit);
        format!("; {noise} by the sensors’ noise alone")
    });
    let mut baselines = report.baselines.iter();
    let baseline = baselines.find(|b| channel.is_some_and(|c| c.channel == b.quantity));
    let models = baseline.and_then(|b| Some((b, b.refitted?, b.with_effect?)));
    let Some((one, refitted, with_effect)) = models else {
        let figure = arrow([held_out.gap_before, held_out.gap_after], &held_out.unit);
        return Some((figure, why + &noise));
    };
    why += ": model as given, with friction and grip refitted, with the effect";
    why += &noise;
    Some((arrow([one.as_given, refitted, with_effect], &one.unit), why))
}

/// The channel whose misfit the report states.
fn judged(held_out: &HeldOut) -> Option<&ChannelGap> {
    let mut channels = held_out.channels.iter();
    channels.find(|c| c.before == held_out.gap_before)
}

/// Whether the remaining misfit is noise.
fn remaining(report: &Report) -> Tile {
    let held_out = &report.held_out;
    let gap = match report.training.first() {
        Some(gap) if held_out.runs.is_empty() => quantity(gap.after, &gap.unit),
        _ => quantity(held_out.gap_after, &held_out.unit),
    };
    let why = match (report.clean, report.bins_after.len()) {
        (true, _) => match scatter(held_out) {
            None => "no bin of the residual over place, speed and other columns is significant"
                .to_owned(),
            Some(scatter) => format!(
                "no bin of the mean residual over place, speed and other columns is significant; {scatter} rms beyond the sensors’ noise remain on held-out {}s",
                held_out.what
            ),
        },
        (false, 0) => format!("{gap} remain, more than the noise: something else may be missing"),
        (false, 1) => "one bin of the residual is still significant: more is missing".to_owned(),
        (false, bins) => {
            format!("{bins} bins of the residual are still significant: more is missing")
        }
    };
    let figure = if report.clean {
        "no pattern left"
    } else {
        "pattern left"
    };
    (figure.to_owned(), why)
}

/// Remaining misfit in excess of the sensor noise; `None` if it is below the noise.
fn scatter(held_out: &HeldOut) -> Option<String> {
    let noise = judged(held_out)?.noise;
    let square = held_out.gap_after * held_out.gap_after - noise * noise;
    let excess = square.max(0.0).sqrt();
    (excess > noise).then(|| quantity(excess, &held_out.unit))
}

/// The explained fraction of the first effect's channel: of the residual that repeats from run to
/// run, or if that is unknown, of what effects of the catalogue could explain; `None` if both are.
fn explained(step: &Step, report: &Report) -> Option<Tile> {
    let mut channels = report.remaining.iter();
    let own = channels.find(|channel| channel.channel == step.channel);
    if let Some(share) = own.and_then(Remaining::explained) {
        let [value, low, high] = [share.value, share.low, share.high].map(|share| 100.0 * share);
        let why = format!(
            "of the mean square {} residual that repeats from run to run is explained ({low:.0} to {high:.0} %)",
            step.channel
        );
        return Some((format!("{value:.0} %"), why));
    }
    let closed = &step.explainable_gap_closed;
    let [value, low, high] = [closed.value, closed.low, closed.high].map(|share| 100.0 * share);
    let by = match report.steps.len() {
        1 => "by it",
        _ => "by all of them together",
    };
    let known = match (low > -100.0 || high < 100.0, low < 0.0) {
        (true, false) => format!(" ({low:.0} to {high:.0} %)"),
        (true, true) => format!(" ({low:.0} to {high:.0} %: it may be none)"),
        (false, _) => ": too few data to decide".to_owned(),
    };
    let judged = match report.held_out.runs[..] {
        [] => "",
        _ => " on held-out data",
    };
    let why =
        format!("of what effects of the catalogue could explain{judged} is explained {by}{known}");
    value.is_finite().then(|| (format!("{value:.0} %"), why))
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
        let page = summary;
        assert!(page(&report).contains("3 MPa remain"), "{}", page(&report));
        report.held_out = HeldOut {
            what: "map".to_owned(),
            runs: vec!["row 5".to_owned()],
            unit: "Pa".to_owned(),
            gap_after: 4e6,
            ..HeldOut::default()
        };
        assert!(page(&report).contains("4 MPa remain"), "{}", page(&report));
        report.bins_after = vec![Bin::default()];
        let still = "one bin of the residual is still significant";
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
