//! Friction experiments: mu over pressure, one row a specimen or condition.
//!
//! The base is `mu = 1e-3 (b p^2 - c p + d)`, p in MPa (or a constant, where the model has a fixed mu), refitted with the
//! variance `mu_sd^2 + (dmu/dp p_sd)^2`. A candidate adds one parameter. Its t in the joint fit is compared with the largest
//! |t| over all candidates in twins (rows simulated from the base with both errors, p among them) and under permutations of
//! the rows' residuals; what is constant within a session is permuted by session.

use std::path::Path;

use kufe_friction::Longitudinal;
use kufe_sled::Model;
use kufe_sled::effects::Effects;

use crate::error::Error;
use crate::evidence::experiments::candidates::{Candidate, Known, list};
use crate::evidence::experiments::fit::{Fit, Setting, fit};
use crate::evidence::experiments::rows::{Row, read};
use crate::evidence::experiments::screen::{Looked, look};
use crate::evidence::experiments::{bins, pictures};
use crate::finding::report::{ChannelGap, Fitted, HeldOut, Interval, Report, Rival, Step, Verdict};
use crate::input::table::Table;
use crate::options::Options;
use crate::procedure::closed::Seen;

/// Most effects that are added.
const MOST_STEPS: usize = 4;
/// t that the named effect must keep beside a rival, to be told from it.
const BESIDE: f64 = 2.2;
/// Correlation beyond which two candidates are the same in all but name.
const ALIKE: f64 = 0.9999;

/// Searches an `experiments.csv`.
///
/// # Errors
/// [`Error::Cell`], [`Error::MissingColumn`], [`Error::Duplicate`], [`Error::TooFew`] below five rows.
pub fn search(
    path: &Path,
    model: &Model,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<(Report, Model), Error> {
    let table = Table::read(path)?;
    let rows = read(&table, model.sled.cda_m2)?;
    let quadratic = matches!(
        model.friction.longitudinal.model()?,
        Longitudinal::Pressure(_)
    );
    let base = if quadratic { 3 } else { 1 };
    if rows.len() < base + 2 {
        return Err(Error::TooFew {
            what: format!("{}: rows", table.file),
            found: rows.len(),
            needed: base + 2,
        });
    }
    let effects = Effects::from_tables(&model.effects)?;
    let (known, others) = Known::new(&effects, &table)?;
    let (candidates, untestable) = list(&rows, &table, &effects);
    let setting = Setting {
        candidates: &candidates,
        known: &known,
        base,
    };
    let mut remarks = Vec::new();
    if !others.is_empty() {
        remarks.push(format!(
            "effects of the model that these data say nothing about: {}",
            others.join(", ")
        ));
    }
    // Every fifth row is locked away where there are rows enough to spare.
    let spare = rows.len() >= 20;
    let pick = |held: bool| -> Vec<Row> {
        let chosen = rows.iter().enumerate();
        chosen
            .filter(|(i, _)| (spare && i % 5 == 4) == held)
            .map(|(_, row)| row.clone())
            .collect()
    };
    let (training, held) = (pick(false), pick(true));
    if !spare {
        remarks.push(format!(
            "{} rows are too few to lock any away: the gap is judged on the rows that were fitted",
            rows.len()
        ));
    }
    let first = fit(&setting, &training, &[]);
    let freedom = training.len() - base;
    remarks.push(format!(
        "base fit: chi2 = {:.1} on {freedom} degrees of freedom",
        first.chi2
    ));
    let mut chosen: Vec<usize> = Vec::new();
    let mut steps: Vec<Step> = Vec::new();
    let mut detectable = Vec::new();
    let mut next_best = None;
    while steps.len() < MOST_STEPS && training.len() > base + chosen.len() + 2 {
        progress(&format!("look {}", steps.len() + 1));
        let look = look(&setting, &training, &chosen, options);
        if steps.is_empty() {
            detectable = look.detectable(&candidates);
        }
        let Some(named) = strongest(&look, &setting, &training, &chosen) else {
            next_best = look.largest(&chosen);
            break;
        };
        let before = fit(&setting, &training, &chosen).rms;
        let rivals = rivals(&look, &setting, &training, &chosen, named);
        let mut class = vec![candidates[named].name.clone()];
        class.extend(
            rivals
                .iter()
                .filter(|r| r.in_class)
                .map(|r| r.effect.clone()),
        );
        chosen.push(named);
        steps.push(Step {
            effect: candidates[named].name.clone(),
            class,
            channel: "mu".to_owned(),
            place: "all rows".to_owned(),
            p_value: look.p_value(named),
            parameters: Vec::new(),
            gap_before: before,
            gap_after: fit(&setting, &training, &chosen).rms,
            unit: String::new(),
            // Of all steps together, once the locked-away rows are opened.
            explainable_gap_closed: Interval::default(),
            rivals,
        });
    }
    let last = fit(&setting, &training, &chosen);
    let quantile = 1.96 + 2.5 / (training.len() as f64 - (base + chosen.len()) as f64).max(1.0);
    for (k, step) in steps.iter_mut().enumerate() {
        size(step, &candidates[chosen[k]], &last, base + k, quantile);
    }
    if !steps.is_empty() {
        let fits = [(&first, &[][..]), (&last, &chosen)];
        let closed = closed(&setting, &training, &held, fits, next_best);
        for step in &mut steps {
            step.explainable_gap_closed = closed.clone();
        }
    }
    let (held_before, held_after) = (
        first.rms_of(&setting, &held, &[]),
        last.rms_of(&setting, &held, &chosen),
    );
    let noise =
        f64::sqrt(training.iter().map(|r| r.mu_sd * r.mu_sd).sum::<f64>() / training.len() as f64);
    let gap = |before: f64, after: f64| ChannelGap {
        channel: "mu".to_owned(),
        unit: String::new(),
        before,
        after,
        noise,
    };
    let verdict = match steps.first() {
        None => Verdict::None,
        Some(step) if step.class.len() == 1 => Verdict::Named,
        Some(_) => Verdict::OneOf,
    };
    let next_experiment = match verdict {
        Verdict::None => format!(
            "{} rows leave {freedom} degrees of freedom; more specimens, each at several pressures and conditions, would let smaller effects be seen",
            rows.len()
        ),
        _ => steps
            .iter()
            .flat_map(|s| &s.class)
            .filter_map(|name| candidates.iter().find(|c| c.name == *name))
            .map(|c| format!("{}: {}", c.name, c.decides))
            .collect::<Vec<_>>()
            .join("; "),
    };
    let held_out = HeldOut {
        runs: held.iter().map(|r| r.name.clone()).collect(),
        gap_before: held_before,
        gap_after: held_after,
        unit: String::new(),
        channels: if held.is_empty() {
            Vec::new()
        } else {
            vec![gap(held_before, held_after)]
        },
    };
    let sentence = match verdict {
        Verdict::None => format!(
            "Nothing to be found with {} points: the base fit has chi2 {:.1} on {freedom} degrees of freedom, and no effect stands out from chance.",
            rows.len(),
            first.chi2
        ),
        _ => {
            crate::procedure::sentence::sentence(verdict, &steps, &held_out, &next_experiment, &[])
        }
    };
    let names: &[&str] = if quadratic { &["b", "c", "d"] } else { &["mu"] };
    let value = |k: usize| last.base_value(k, quadratic);
    let base_parameters = names
        .iter()
        .enumerate()
        .map(|(k, name)| {
            let (value, error) = value(k);
            Fitted {
                name: (*name).to_owned(),
                value,
                low: value - quantile * error,
                high: value + quantile * error,
                unit: match *name {
                    "b" => "1e-3/MPa2",
                    "c" => "1e-3/MPa",
                    "d" => "1e-3",
                    _ => "",
                }
                .to_owned(),
            }
        })
        .collect();
    let mut next = model.clone();
    let keys = &mut next.friction.longitudinal;
    if quadratic {
        keys.b = Some(value(0).0);
        keys.c = Some(value(1).0);
        keys.d = Some(value(2).0);
    } else {
        keys.mu = Some(value(0).0);
    }
    for (step, c) in steps.iter().zip(&chosen) {
        let candidate = &candidates[*c];
        if let Some(mut table) = candidate.table.clone() {
            table.insert(candidate.key.clone(), step.parameters[0].value.into());
            next.effects.insert(step.effect.clone(), table);
        } else {
            remarks.push(format!(
                "{} is not in model.next.toml: simulations have no such column",
                step.effect
            ));
        }
    }
    let report = Report {
        verdict,
        sentence,
        training: vec![gap(first.rms, last.rms)],
        steps,
        held_out,
        minimum_detectable: detectable,
        next_experiment,
        base: base_parameters,
        bins: bins::bins(&setting, &training, &first, &[]),
        bins_after: bins::bins(&setting, &training, &last, &chosen),
        pictures: pictures::pictures(&setting, &training, &first, (&last, &chosen)),
        by_run: Vec::new(),
        clean: last.chi2
            < 3.0 * (training.len() as f64 - base as f64 - chosen.len() as f64).max(1.0),
        untestable,
        remarks,
        data: "friction experiments".to_owned(),
        seed: options.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    Ok((report, next))
}

/// The claimable candidate that leaves least, fitted in full; an effect by name goes before a mere column that it explains
/// as well.
fn strongest(
    look: &Looked,
    setting: &Setting,
    training: &[Row],
    chosen: &[usize],
) -> Option<usize> {
    let claimable: Vec<usize> = (0..setting.candidates.len())
        .filter(|c| look.claimable(*c, &setting.candidates[*c]))
        .collect();
    let largest = claimable
        .iter()
        .fold(0.0_f64, |m, c| m.max(look.t[*c].abs()));
    let left: Vec<(usize, f64)> = claimable
        .into_iter()
        .filter(|c| look.t[*c].abs() > 0.6 * largest)
        .map(|c| {
            let with = [chosen, &[c]].concat();
            (c, fit(setting, training, &with).chi2)
        })
        .collect();
    let least = |by_name: bool| {
        left.iter()
            .filter(|(c, _)| setting.candidates[*c].by_name || !by_name)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(c, _)| *c)
    };
    let best = least(false)?;
    match least(true) {
        Some(named) if named != best => {
            let beside = beside(look, setting, training, chosen, named, best);
            Some(if beside.abs() < BESIDE { named } else { best })
        }
        _ => Some(best),
    }
}

/// t of one candidate in the fit that has another one too; 0 where the two cannot be told apart at all.
fn beside(
    look: &Looked,
    setting: &Setting,
    training: &[Row],
    chosen: &[usize],
    other: usize,
    one: usize,
) -> f64 {
    if look.correlation(other, one).abs() > ALIKE {
        return 0.0;
    }
    let both = [chosen, &[other, one]].concat();
    let joint = fit(setting, training, &both);
    let at = setting.base + both.len() - 1;
    let t = joint.step[at] / joint.errors[at].max(1e-300);
    if t.is_finite() { t } else { 0.0 }
}

fn rivals(
    look: &Looked,
    setting: &Setting,
    training: &[Row],
    chosen: &[usize],
    named: usize,
) -> Vec<Rival> {
    let mut rivals = Vec::new();
    for (j, rival) in setting.candidates.iter().enumerate() {
        if j == named || chosen.contains(&j) || look.t[j].abs() < 1.5 {
            continue;
        }
        let beyond = beside(look, setting, training, chosen, j, named);
        let size = look.size[j] * rival.typical;
        rivals.push(Rival {
            effect: rival.name.clone(),
            parameter: rival.key.clone(),
            size,
            unit: rival.unit.clone(),
            t: look.t[j],
            gain: look.t[j].powi(2),
            correlation: look.correlation(named, j),
            t_of_named_beyond: beyond,
            in_class: rival.by_name
                && (rival.low..=rival.high).contains(&size)
                && beyond.abs() < BESIDE,
            decides: rival.decides.clone(),
        });
    }
    rivals.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    rivals
}

/// How much is closed, on the locked-away rows where there are any, of what everything chosen and the next best candidate
/// explain on the others. `before` and `after` are the fits without and with what was chosen.
fn closed(
    setting: &Setting,
    training: &[Row],
    held: &[Row],
    [before, after]: [(&Fit, &[usize]); 2],
    next_best: Option<usize>,
) -> Interval {
    let all: Vec<usize> = after.1.iter().copied().chain(next_best).collect();
    let least = fit(setting, training, &all);
    let last = after.0;
    let rest = |rows: &[Row], (fit, chosen): (&Fit, &[usize])| -> Vec<f64> {
        let left = |row: &Row| row.mu - fit.predict(setting, row, chosen).1;
        let rows = rows.iter();
        rows.map(|row| left(row) / last.deviation(setting, row))
            .collect()
    };
    let change = |rows: &[Row]| -> Vec<f64> {
        let (before, least) = (rest(rows, before), rest(rows, (&least, &all)));
        before.iter().zip(least).map(|(a, b)| a - b).collect()
    };
    let judged = match held.is_empty() {
        true => training,
        false => held,
    };
    let freedom = (training.len() as f64 - last.step.len() as f64).max(1.0);
    Seen {
        direction: &change(judged),
        before: &rest(judged, before),
        after: &rest(judged, after),
        fitted: &change(training),
        spread: (last.chi2 / freedom).max(1.0).sqrt(),
    }
    .closed()
}

/// Writes a step's size with its interval.
fn size(step: &mut Step, candidate: &Candidate, last: &Fit, at: usize, quantile: f64) {
    let value = last.step[at] * candidate.typical;
    let error = last.errors[at] * candidate.typical;
    step.parameters.push(Fitted {
        name: candidate.key.clone(),
        value,
        low: value - quantile * error,
        high: value + quantile * error,
        unit: candidate.unit.clone(),
    });
}
