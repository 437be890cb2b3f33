//! The verdict in words.

use crate::report::{HeldOut, Step, Verdict};

/// One sentence for the top of the report.
pub fn sentence(
    verdict: Verdict,
    steps: &[Step],
    held: &HeldOut,
    next: &str,
    depends: &[String],
) -> String {
    let names: Vec<String> = steps
        .iter()
        .map(|step| {
            let sizes: Vec<String> = step
                .parameters
                .iter()
                .map(|p| {
                    format!(
                        "{} = {:.4} {} ({:.4} to {:.4})",
                        p.name, p.value, p.unit, p.low, p.high
                    )
                })
                .collect();
            let class = if step.class.len() > 1 {
                format!(", or one of {}", step.class[1..].join(", "))
            } else {
                String::new()
            };
            format!("{} [{}]{class}", step.effect, sizes.join("; "))
        })
        .collect();
    let gap = if held.runs.is_empty() {
        String::new()
    } else {
        format!(
            " On {} locked-away runs the gap went from {:.4} to {:.4} {}.",
            held.runs.len(),
            held.gap_before,
            held.gap_after,
            held.unit
        )
    };
    match verdict {
        Verdict::Named => format!("Missing from the model: {}.{gap}", names.join(", then ")),
        Verdict::OneOf => format!(
            "Missing from the model: {}. These data cannot tell the members of a class apart; what would: {next}.{gap}",
            names.join(", then ")
        ),
        Verdict::DependsOn => format!("{}; {}.{gap}", names.join(", then "), depends.join("; ")),
        Verdict::Located => "The residual is not clean at the places listed, and no effect of the catalogue fits.".to_owned(),
        Verdict::None => "Nothing to be found: no effect stands out from chance and from the noise of the inputs.".to_owned(),
        Verdict::NotIdentifiable => format!("Something differs that these data cannot name: {next}."),
    }
}
