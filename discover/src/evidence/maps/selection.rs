//! Selection of the effect with the smallest misfit, with its class.

use kufe::case::effects::Effect;

use crate::evidence::maps::line::LineSearch;
use crate::evidence::maps::simulate::{Misfit, Simulations};
use crate::finding::Rival;
use crate::procedure::evidence::Selection;
use crate::procedure::rivals::{NamedEffect, RivalRule};

/// The first of `lines` as a selection; `before` is the sum of squares without it.
pub fn select(
    lines: &[LineSearch],
    before: f64,
    mean_square: f64,
    rule: &RivalRule,
) -> Selection<&'static Effect> {
    let best = &lines[0];
    let others = lines[1..].iter().map(|line| {
        let excess = ((line.chi2() - best.chi2()) / mean_square).max(0.0);
        let t = line.size() / line.error().max(1e-300);
        Rival {
            gain: before - line.chi2(),
            correlation: best.correlation(line),
            t_of_named_beyond: excess.sqrt(),
            in_class: true,
            ..line.candidate.rival(line.size(), t)
        }
    });
    let drop = (before - best.chi2()) / mean_square;
    let named = NamedEffect {
        effect: &best.candidate.effect,
        // The effect's t is the root of the drop of chi2.
        t: drop.sqrt(),
        gain: before - best.chi2(),
        units: 1,
    };
    let (class, rivals) = rule.class(&named, others.collect());
    let candidate = best.candidate.clone();
    Selection {
        class,
        rivals,
        // All effects were tried with free sizes: no randomisation was made.
        p_value: (lines.len() as f64 * (-0.5 * drop).exp()).clamp(1e-12, 1.0),
        ..Selection::new(candidate, best.size(), best.error(), ("", ("p", "Pa")))
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
