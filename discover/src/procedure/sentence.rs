//! The verdict in words.

use kufe::plot::{number4, quantity};

use crate::finding::{Fitted, Interval, Remaining, Report, Step, Verdict};
use crate::procedure::evidence::Account;

/// One sentence for the top of the report; `nothing` is the sentence of these data without a
/// finding.
pub fn sentence(report: &Report, account: &Account, nothing: &str) -> String {
    let steps = &account.steps;
    let size = |p: &Fitted| {
        let [value, low, high] = [p.value, p.low, p.high].map(number4);
        format!("{} = {value} {} ({low} to {high})", p.name, p.unit)
    };
    let name = |step: &Step| {
        let sizes = step.parameters.iter().map(size);
        let sizes: Vec<String> = step.contacts_in_words().into_iter().chain(sizes).collect();
        let class = match step.class.len() {
            0 | 1 => String::new(),
            _ => format!(" (or instead {})", step.class[1..].join(", ")),
        };
        let law = match &step.law {
            Some(law) if step.summary.is_empty() => format!(", {law}"),
            Some(_) => format!(", {}", step.summary),
            None => String::new(),
        };
        format!("{} [{}{law}]{class}", step.effect, sizes.join("; "))
    };
    let names: Vec<String> = steps.iter().map(name).collect();
    let names = names.join("; and ");
    let misfit = misfit(steps, report);
    let more = if report.adequate {
        ""
    } else {
        ", and more is missing"
    };
    let next = &report.next_experiment;
    let depends = account
        .depends
        .iter()
        .map(|one| format!("; {}", one.assumption));
    let depends: String = depends.collect();
    match report.verdict {
        Verdict::Law => format!("Outside the catalogue: {names}{more}{depends}.{misfit}"),
        Verdict::Named => format!("Missing from the model: {names}{more}{depends}.{misfit}"),
        Verdict::OneOf => format!(
            "Missing from the model: {names}{more}{depends}. These data do not distinguish an effect from those in its parentheses. To measure: {next}.{misfit}"
        ),
        Verdict::DependsOn => format!("{names}{depends}.{misfit}"),
        Verdict::Located => "The residual is significant at the places listed, and no effect of the catalogue explains it.".to_owned(),
        Verdict::Inadequate => "Part of the misfit repeats from run to run, and no effect of the catalogue explains it.".to_owned(),
        Verdict::None if !nothing.is_empty() => nothing.to_owned(),
        Verdict::None => "No effect is significant: noise and installation errors explain the residual.".to_owned(),
        Verdict::NotIdentifiable => {
            let why = account.unexplained.as_ref().map_or("", |one| &one.reason);
            format!("Model and data differ, but these data do not identify the cause: {why}.")
        }
    }
}

/// The misfit on held-out data by each of the compared models.
fn misfit(steps: &[Step], report: &Report) -> String {
    let held_out = &report.held_out;
    if held_out.runs.is_empty() {
        return String::new();
    }
    let data = held_out.in_words();
    let of_step = steps.first().and_then(|step| {
        let mut baselines = report.baselines.iter();
        let one = baselines.find(|b| b.quantity == step.channel)?;
        Some((one, one.refitted?, one.with_effect?))
    });
    match of_step {
        Some((one, refitted, with_effect)) => {
            let [given, refitted, with_effect] =
                [one.as_given, refitted, with_effect].map(|rms| quantity(rms, &one.unit));
            format!(
                " On {data} the rms {} residual is {given} with the model as given, {refitted} with friction and grip refitted and {with_effect} with the effect.",
                one.quantity
            )
        }
        None => {
            let [before, after] = [held_out.gap_before, held_out.gap_after];
            let [before, after] = [before, after].map(|rms| quantity(rms, &held_out.unit));
            format!(" On {data} the rms residual goes from {before} to {after}.")
        }
    }
}

/// Explained and remaining repeatable misfit, with its places; empty if unknown.
pub fn adequacy(steps: &[Step], remaining: &[Remaining]) -> String {
    let share = |share: &Interval| {
        let [value, low, high] = [share.value, share.low, share.high].map(|x| 100.0 * x);
        format!("{value:.0} % ({low:.0} to {high:.0} %)")
    };
    let most = |a: &&Remaining, b: &&Remaining| a.of_misfit.value.total_cmp(&b.of_misfit.value);
    let Some(worst) = remaining.iter().max_by(most) else {
        return String::new();
    };
    let of_step = steps.first().and_then(|step| {
        let own = remaining.iter().find(|r| r.channel == step.channel)?;
        let explained = own.explained()?;
        Some(format!(
            "The effects found explain {} of the mean square {} residual that repeats from run to run. ",
            share(&explained),
            own.channel
        ))
    });
    let mut rest = format!(
        "{} of the mean square {} residual still repeats, more than of any other channel",
        share(&worst.of_misfit),
        worst.channel
    );
    if !worst.is_small || worst.of_misfit.value > LARGE && !worst.places.is_empty() {
        rest += &format!(", most at {}", worst.places.join("; "));
    }
    rest += if worst.is_small {
        "."
    } else {
        ". An effect that is not identified is missing from the model."
    };
    of_step.unwrap_or_default() + &rest
}

/// Repeating share of the mean square from which the sentence names the places, even if the share
/// may be small by its interval.
const LARGE: f64 = 0.1;

#[cfg(test)]
mod tests {
    use super::*;

    fn remaining(channel: &str, share: f64, of_misfit: f64) -> Remaining {
        let interval = |value: f64| Interval {
            value,
            low: value - 0.05,
            high: value + 0.05,
        };
        Remaining {
            channel: channel.to_owned(),
            unit: "N".to_owned(),
            repeatable: 1.0,
            share: interval(share),
            of_misfit: interval(of_misfit),
            is_small: of_misfit < 0.1,
            places: vec!["track a, s 100 to 120 m: 60 %".to_owned()],
        }
    }

    #[test]
    fn adequacy_is_that_of_the_channel_with_the_largest_repeatable_share() {
        let small = adequacy(
            &[],
            &[remaining("side", 1.0, 0.06), remaining("yaw", 1.0, 0.02)],
        );
        assert_eq!(
            small,
            "6 % (1 to 11 %) of the mean square side residual still repeats, more than of any other channel."
        );
        let large = adequacy(
            &[],
            &[remaining("side", 1.0, 0.06), remaining("yaw", 1.0, 0.8)],
        );
        assert!(large.starts_with("80 % (75 to 85 %) of the mean square yaw residual"));
        assert!(large.contains("track a, s 100 to 120 m"));
        assert!(adequacy(&[], &[]).is_empty());
    }
}
