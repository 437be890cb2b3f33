//! Selection of the effect with the smallest misfit, with its class.

use kufe::case::effects::Effect;

use crate::evidence::maps::line::LineSearch;
use crate::evidence::maps::screen::correlation;
use crate::evidence::maps::simulate::{Misfit, Simulations};
use crate::finding::Rival;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Randomised, Selection};
use crate::procedure::rivals::{NamedEffect, RivalRule};

/// The first of `lines` as a selection; `before` is the sum of squares without it.
pub fn select(
    lines: &[LineSearch],
    before: f64,
    mean_square: f64,
    rule: &RivalRule,
) -> Selection<&'static Effect> {
    let best = &lines[0];
    let (info, parameter) = (best.effect.info(), best.effect.parameter());
    let others = lines[1..]
        .iter()
        .map(|line| {
            let (info, parameter) = (line.effect.info(), line.effect.parameter());
            let excess = ((line.chi2() - best.chi2()) / mean_square).max(0.0);
            Rival {
                effect: info.name.to_owned(),
                parameter: parameter.name.to_owned(),
                size: line.size(),
                unit: parameter.unit.to_owned(),
                t: line.size() / line.error().max(1e-300),
                gain: before - line.chi2(),
                correlation: correlation(best, line),
                t_of_named_beyond: excess.sqrt(),
                in_class: true,
                decides: info.decides.to_owned(),
            }
        })
        .collect();
    let drop = (before - best.chi2()) / mean_square;
    let named = NamedEffect {
        effect: info.name,
        // The effect's t is the root of the drop of chi2.
        t: drop.sqrt(),
        gain: before - best.chi2(),
        units: 1,
    };
    let (class, rivals) = rule.class(&named, others);
    Selection {
        candidate: Candidate {
            effect: info.name.to_owned(),
            key: parameter.name.to_owned(),
            unit: parameter.unit.to_owned(),
            low: parameter.low,
            high: parameter.high,
            typical: parameter.typical,
            decides: info.decides.to_owned(),
            act: best.effect,
        },
        size: best.size(),
        error: best.error(),
        class,
        rivals,
        // All effects were tried with free sizes: no randomisation was made.
        randomised: Randomised::default(),
        p_value: (lines.len() as f64 * (-0.5 * drop).exp()).clamp(1e-12, 1.0),
        place: String::new(),
        channel: ("p", "Pa"),
        remark: None,
        parameters: Vec::new(),
    }
}

/// The rows whose misfit falls, with the one where it falls most.
pub fn place(simulations: &Simulations, before: &Misfit, after: &Misfit) -> String {
    let gains = before.by_row.iter().zip(&after.by_row).map(|(a, b)| a - b);
    let most = gains.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    match most {
        Some((row, _)) if simulations.rows.len() > 1 => {
            format!("all maps, most in {}", simulations.rows[row].name)
        }
        _ => "the map".to_owned(),
    }
}
