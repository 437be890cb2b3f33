//! The verdict in words.

use kufe::plot::{number4, quantity};

use crate::finding::report::{HeldOut, Verdict};
use crate::procedure::evidence::{Account, Words};

/// One sentence for the top of the report.
pub fn sentence(
    verdict: Verdict,
    account: &Account,
    held: &HeldOut,
    next: &str,
    words: &Words,
) -> String {
    let (steps, depends) = (&account.steps, &account.depends);
    let names: Vec<String> = steps
        .iter()
        .map(|step| {
            let sizes: Vec<String> = step
                .parameters
                .iter()
                .map(|p| {
                    format!(
                        "{} = {} {} ({} to {})",
                        p.name,
                        number4(p.value),
                        p.unit,
                        number4(p.low),
                        number4(p.high)
                    )
                })
                .collect();
            let class = if step.class.len() > 1 {
                format!(", or one of {}", step.class[1..].join(", "))
            } else {
                String::new()
            };
            let law = match &step.law {
                Some(law) if step.summary.is_empty() => format!(", {law}"),
                Some(_) => format!(", {}", step.summary),
                None => String::new(),
            };
            format!("{} [{}{law}]{class}", step.effect, sizes.join("; "))
        })
        .collect();
    let gap = if held.runs.is_empty() {
        String::new()
    } else {
        format!(
            " On {} that the search had not seen the gap went from {} to {}.",
            match held.runs.len() {
                1 => format!("one {}", held.what),
                count => format!("{count} {}s", held.what),
            },
            quantity(held.gap_before, &held.unit),
            quantity(held.gap_after, &held.unit)
        )
    };
    match verdict {
        Verdict::Law => format!("Beyond the catalogue: {}.{gap}", names.join(", then ")),
        Verdict::Named => format!("Missing from the model: {}.{gap}", names.join(", then ")),
        Verdict::OneOf => format!(
            "Missing from the model: {}. These data cannot tell the members of a class apart; what would: {next}.{gap}",
            names.join(", then ")
        ),
        Verdict::DependsOn => format!("{}; {}.{gap}", names.join(", then "), depends.join("; ")),
        Verdict::Located => "The residual is not clean at the places listed, and no effect of the catalogue fits.".to_owned(),
        Verdict::Inadequate => "The model does not explain what repeats from run to run, and no effect of the catalogue does.".to_owned(),
        Verdict::None if !words.nothing.is_empty() => words.nothing.clone(),
        Verdict::None => "Nothing to be found: no effect stands out from chance and from the noise of the inputs.".to_owned(),
        Verdict::NotIdentifiable => format!("Something differs that these data cannot name: {next}."),
    }
}
