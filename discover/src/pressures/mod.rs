//! Pressure measurements: maps and peaks against contact solves.
//!
//! Each candidate of [`kufe_contact::effects`] changes the problem or the map. Its size is fitted by Gauss-Newton on all
//! rows (every step a new solve), and what counts is the sum of squares that is really left:
//!
//! ```text
//! chi2 = sum over pixels (p_measured - p_simulated)^2 / sd^2 / (pixels for one independent value)  +  peaks
//! ```
//!
//! sd is the larger of the sensor's noise (from pixels far from contact) and 1.5 per cent of the peak, and with it in squares
//! what a finer mesh changes at that pixel. A claim must lower chi2 by more than 30 and by a fifth; its class is every effect whose own best fit
//! is worse by less than 9 in units of the best fit's mean square. A size within three of its errors of 0 is no claim.

use std::path::Path;

mod fit;
mod rows;
mod simulate;

use kufe_contact::case::Case;
use kufe_contact::effects::CATALOGUE;

use crate::report::{
    ChannelGap, Detectable, Fitted, HeldOut, Interval, Report, Rival, Step, Verdict,
};
use crate::{Error, Options};
use rows::{Row, read};
use simulate::{Active, Bench};

/// Most effects that are added.
const MOST_STEPS: usize = 3;
/// Effects that are fitted in full, by what one step of differences promises.
const FITTED: usize = 4;
/// Mean square in units of the noise beyond which a residual is not clean.
const UNCLEAN: f64 = 2.0;

/// Searches a `pressures.csv`; `model` is the case file that is to be improved.
///
/// # Errors
/// [`Error::Cell`], [`Error::MissingColumn`], [`Error::File`], those of the case and of the solver.
pub fn search(
    path: &Path,
    model: &Path,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<(Report, String), Error> {
    let text = std::fs::read_to_string(model).map_err(|error| Error::File {
        file: model.display().to_string(),
        reason: error.to_string(),
    })?;
    let told = |error: kufe_contact::case::CaseError| Error::File {
        file: model.display().to_string(),
        reason: error.to_string(),
    };
    let case = Case::parse(&text).map_err(told)?;
    let rows = read(path, model, &case)?;
    let held_row = if rows.len() >= 3 {
        Some(rows.len() - 1)
    } else {
        None
    };
    let training: Vec<&Row> = rows
        .iter()
        .enumerate()
        .filter(|(i, _)| Some(*i) != held_row)
        .map(|(_, r)| r)
        .collect();
    let held: Vec<&Row> = held_row.map(|i| &rows[i]).into_iter().collect();
    let mut active: Active = Vec::new();
    let mut steps: Vec<Step> = Vec::new();
    let mut remarks = vec![
        "the tests use the sensor's noise and 1.5 % of the peak, and what a finer mesh changes at each pixel; neighbouring pixels count in patches".to_owned(),
    ];
    if rows.iter().any(|r| r.map.is_none()) {
        remarks.push("rows without a map contribute their peak pressure alone".to_owned());
    }
    let mut detectable = Vec::new();
    let names: Vec<String> = held.iter().map(|r| r.name.clone()).collect();
    let bench = Bench::new(training.clone())?;
    let locked = Bench::new(held)?;
    let start = bench.misfit(&active)?;
    let mut chi2 = start.chi2;
    for number in 0..MOST_STEPS {
        let mut fits: Vec<(usize, f64, f64, f64)> = Vec::new();
        for (index, effect) in CATALOGUE.iter().enumerate() {
            if active
                .iter()
                .any(|(e, _)| e.info().name == effect.info().name)
            {
                continue;
            }
            progress(&format!("look {}: {}", number + 1, effect.info().name));
            if let Some(f) = fit::screen(&bench, &active, *effect)? {
                fits.push((index, f.size, f.chi2, f.error));
            }
        }
        fits.sort_by(|a, b| a.2.total_cmp(&b.2));
        if number == 0 {
            detectable = fits
                .iter()
                .map(|(index, _, _, error)| {
                    let info = CATALOGUE[*index].info();
                    Detectable {
                        effect: info.name.to_owned(),
                        parameter: info.key.to_owned(),
                        size: 5.5 * error,
                        unit: info.unit.to_owned(),
                        left_after_refit: 1.0,
                        most_like: String::new(),
                        correlation: 0.0,
                    }
                })
                .collect();
        }
        // Worn sections and bounds on the pressure are far from linear: they are fitted whatever their first step says.
        for (place, one) in fits.iter_mut().enumerate() {
            let effect = CATALOGUE[one.0];
            let bent = ["hardness", "section-wear"].contains(&effect.info().name);
            if (chi2 - one.2 < 30.0 || place >= FITTED) && !bent {
                continue;
            }
            progress(&format!(
                "look {}: fitting {}",
                number + 1,
                effect.info().name
            ));
            if let Some(f) = fit::refine(&bench, &active, effect)? {
                *one = (one.0, f.size, f.chi2, f.error);
            } else {
                one.2 = chi2;
            }
        }
        let Some(best) = fits.iter().min_by(|a, b| a.2.total_cmp(&b.2)).copied() else {
            break;
        };
        if chi2 - best.2 < 30.0 || best.2 > 0.8 * chi2 {
            break;
        }
        let info = CATALOGUE[best.0].info();
        let count = bench.misfit(&active)?.count;
        let unit_square = (best.2 / (count - 1.0).max(1.0)).max(1.0);
        if best.1.abs() < 3.0 * best.3 * unit_square.sqrt() {
            break;
        }
        let mut class = vec![info.name.to_owned()];
        let mut rivals = Vec::new();
        for fit in fits.iter().filter(|f| f.0 != best.0) {
            let other = CATALOGUE[fit.0].info();
            let in_class = (fit.2 - best.2) / unit_square < 9.0;
            if in_class {
                class.push(other.name.to_owned());
            }
            rivals.push(Rival {
                effect: other.name.to_owned(),
                parameter: other.key.to_owned(),
                size: fit.1,
                unit: other.unit.to_owned(),
                t: fit.1 / fit.3.max(1e-300),
                gain: chi2 - fit.2,
                correlation: 0.0,
                t_of_named_beyond: ((fit.2 - best.2) / unit_square).max(0.0).sqrt(),
                in_class,
                decides: other.decides.to_owned(),
            });
        }
        rivals.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let before = bench.misfit(&active)?;
        active.push((CATALOGUE[best.0], best.1));
        let after = bench.misfit(&active)?;
        let spread = 1.96 * best.3 * unit_square.sqrt();
        steps.push(Step {
            effect: info.name.to_owned(),
            class,
            channel: "p".to_owned(),
            place: "all maps".to_owned(),
            p_value: (-0.5 * (chi2 - best.2) / unit_square).exp().max(1e-12),
            parameters: vec![Fitted {
                name: info.key.to_owned(),
                value: best.1,
                low: best.1 - spread,
                high: best.1 + spread,
                unit: info.unit.to_owned(),
            }],
            gap_before: before.rms,
            gap_after: after.rms,
            unit: "Pa".to_owned(),
            explainable_gap_closed: closed(before.chi2, after.chi2, count),
            rivals,
        });
        chi2 = after.chi2;
    }
    let last = bench.misfit(&active)?;
    let (held_before, held_after) = (locked.misfit(&Vec::new())?, locked.misfit(&active)?);
    let gap = |before: f64, after: f64, rows: &[&Row]| ChannelGap {
        channel: "p".to_owned(),
        unit: "Pa".to_owned(),
        before,
        after,
        noise: rows.iter().map(|r| r.noise).sum::<f64>() / rows.len().max(1) as f64,
    };
    let verdict = match steps.first() {
        None if start.chi2 > UNCLEAN * start.count => Verdict::NotIdentifiable,
        None => Verdict::None,
        Some(step) if step.class.len() == 1 => Verdict::Named,
        Some(_) => Verdict::OneOf,
    };
    let next_experiment = match verdict {
        Verdict::None => {
            "maps at several loads, on straight and curved track, show smaller effects".to_owned()
        }
        _ => steps
            .iter()
            .flat_map(|s| &s.class)
            .filter_map(|name| kufe_contact::effects::find(name))
            .map(|e| format!("{}: {}", e.info().name, e.info().decides))
            .collect::<Vec<_>>()
            .join("; "),
    };
    let held_out = HeldOut {
        runs: names,
        gap_before: held_before.rms,
        gap_after: held_after.rms,
        unit: "Pa".to_owned(),
        channels: if locked.rows.is_empty() {
            Vec::new()
        } else {
            vec![gap(held_before.rms, held_after.rms, &locked.rows)]
        },
    };
    let sentence = crate::sentence::sentence(verdict, &steps, &held_out, &next_experiment, &[]);
    let mut next: toml::Table = text.parse().map_err(|error: toml::de::Error| Error::File {
        file: model.display().to_string(),
        reason: error.to_string(),
    })?;
    let effects = next
        .entry("effects")
        .or_insert_with(|| toml::Table::new().into());
    if let toml::Value::Table(effects) = effects {
        for (effect, size) in &active {
            let mut one = toml::Table::new();
            one.insert(effect.info().key.to_owned(), (*size).into());
            effects.insert(effect.info().name.to_owned(), one.into());
        }
        if effects.is_empty() {
            next.remove("effects");
        }
    }
    let report = Report {
        verdict,
        sentence,
        training: vec![gap(start.rms, last.rms, &training)],
        steps,
        held_out,
        minimum_detectable: detectable,
        next_experiment,
        base: Vec::new(),
        bins: Vec::new(),
        bins_after: Vec::new(),
        clean: last.chi2 < UNCLEAN * last.count,
        untestable: Vec::new(),
        remarks,
        data: "pressure measurements".to_owned(),
        seed: options.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    Ok((report, next.to_string()))
}

/// Of chi2 beyond its expectation, the share that is gone; the interval from chi2's own deviation.
fn closed(before: f64, after: f64, count: f64) -> Interval {
    let explainable = (before - count).max(1e-9);
    let left = (after - count).max(0.0);
    let error = (2.0 * count).sqrt() / explainable;
    let value = 1.0 - left / explainable;
    Interval {
        value,
        low: value - 2.0 * error,
        high: (value + 2.0 * error).min(1.0),
    }
}
