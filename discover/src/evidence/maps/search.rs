//! Pressure measurements: maps and peaks against contact solves.
//!
//! Each candidate of [`kufe_case::effects`] changes the problem or the map. Its size is fitted by Gauss-Newton on all
//! rows (`line`, every point a new solve of each row), and what counts is the sum of squares that is really left:
//!
//! ```text
//! chi2 = sum over pixels (p_measured - p_simulated)^2 / var / (pixels for one independent value)  +  peaks
//! ```
//!
//! var is that of `noise`, and with it in squares what a finer mesh changes at that pixel. A claim must lower chi2 by more
//! than 30 and by a fifth; its class is every effect whose own best fit is worse by less than 9 in units of the best fit's
//! mean square. A size within three of its errors of 0 is no claim. Sizes are reported from finer meshes (`polish`).

use std::path::Path;

use kufe_case::Case;
use kufe_case::effects::{CATALOGUE, Effect, find};

use crate::error::Error;
use crate::evidence::maps::line::Line;
use crate::evidence::maps::next_case::next_case;
use crate::evidence::maps::polish::polish;
use crate::evidence::maps::rows::{Row, read};
use crate::evidence::maps::screen::{LEAST_DROP, NEED_MAPS, Steps, correlation, look};
use crate::evidence::maps::simulate::{Active, Bench, Misfit, REPORTING, SEARCHING};
use crate::evidence::maps::{bins, pictures};
use crate::finding::report::{
    ChannelGap, Detectable, Fitted, HeldOut, Interval, Report, Rival, Step, Verdict,
};
use crate::options::Options;
use crate::procedure::closed::Seen;

/// Most effects that are added.
const MOST_STEPS: usize = 3;
/// Mean square in units of the noise beyond which a residual is not clean.
const UNCLEAN: f64 = 2.0;
/// Mean square, and share of what is beyond the noise, above both of which a name is in doubt.
const MOST_LEFT: f64 = 10.0;
const LEFT_SHARE: f64 = 0.1;
/// Distance in chi2 within which a rival belongs to the class.
const CLASS: f64 = 9.0;
/// Errors that a size must be away from 0.
const SIZE_IN_ERRORS: f64 = 3.0;

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
    let told = |reason: String| Error::File {
        file: model.display().to_string(),
        reason,
    };
    let text = std::fs::read_to_string(model).map_err(|error| told(error.to_string()))?;
    let case = Case::parse(&text).map_err(|error| told(error.to_string()))?;
    let (rows, mut remarks) = read(path, model, &case)?;
    let held_row = (rows.len() >= 3).then(|| rows.len() - 1);
    let pick = |held: bool| -> Vec<&Row> {
        let chosen = rows.iter().enumerate();
        chosen
            .filter(|(i, _)| (Some(*i) == held_row) == held)
            .map(|(_, r)| r)
            .collect()
    };
    remarks.extend(remarks_on(&rows));
    let bench = Bench::new(pick(false))?;
    let locked = Bench::new(pick(true))?;
    let start = bench.misfit(&Active::new(), REPORTING)?;
    let mut found = find_steps(&bench, progress)?;
    if let Some(doubt) = found.doubt(&start) {
        remarks.push(doubt);
        found.drop_all(&bench)?;
    }
    progress("locked-away map");
    let (held_before, held_after) = (
        locked.misfit(&Active::new(), REPORTING)?,
        locked.misfit(&found.active, REPORTING)?,
    );
    found.close(&bench, &locked)?;
    let gap = |before: &Misfit, after: &Misfit, rows: &[&Row]| ChannelGap {
        channel: "p".to_owned(),
        unit: "Pa".to_owned(),
        before: before.rms,
        after: after.rms,
        noise: typical_noise(rows),
    };
    let unclean = found.last.chi2 > UNCLEAN * found.last.count;
    let verdict = match found.steps.first() {
        None if unclean => Verdict::NotIdentifiable,
        None => Verdict::None,
        Some(step) if step.class.len() == 1 => Verdict::Named,
        Some(_) => Verdict::OneOf,
    };
    let next_experiment = next_experiment(verdict, &found.steps);
    let held_out = HeldOut {
        runs: locked.rows.iter().map(|r| r.name.clone()).collect(),
        gap_before: held_before.rms,
        gap_after: held_after.rms,
        unit: "Pa".to_owned(),
        channels: match locked.rows.is_empty() {
            true => Vec::new(),
            false => vec![gap(&held_before, &held_after, &locked.rows)],
        },
    };
    let sentence = crate::procedure::sentence::sentence(
        verdict,
        &found.steps,
        &held_out,
        &next_experiment,
        &[],
    );
    let next = next_case(&text, &found.active).map_err(told)?;
    progress("pictures");
    let report = Report {
        verdict,
        sentence,
        training: vec![gap(&start, &found.last, &bench.rows)],
        bins: bins::bins(&bench, &Active::new())?,
        bins_after: bins::bins(&bench, &found.active)?,
        pictures: pictures::pictures(&bench, &locked, &found.active)?,
        steps: found.steps,
        held_out,
        minimum_detectable: found.detectable,
        next_experiment,
        base: Vec::new(),
        by_run: Vec::new(),
        clean: !unclean,
        untestable: untestable(&rows),
        remarks,
        data: "pressure measurements".to_owned(),
        seed: options.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    Ok((report, next))
}

/// What was found on the rows not locked away.
struct Found {
    active: Active,
    steps: Vec<Step>,
    detectable: Vec<Detectable>,
    last: Misfit,
    /// What would lower the misfit most beside what was found, claimed or not.
    next: Option<(&'static dyn Effect, f64)>,
}

impl Found {
    /// How much is closed, on the locked-away rows where there are any, of what everything found and the next best effect
    /// explain on the others.
    fn close(&mut self, bench: &Bench, locked: &Bench) -> Result<(), Error> {
        if self.steps.is_empty() {
            return Ok(());
        }
        let mut all = self.active.clone();
        all.extend(self.next);
        let change = |bench: &Bench| -> Result<(Vec<f64>, Misfit), Error> {
            let before = bench.misfit(&Active::new(), REPORTING)?;
            let least = match bench.misfit(&all, REPORTING) {
                Ok(least) => least,
                Err(_) => bench.misfit(&self.active, REPORTING)?,
            };
            let pairs = before.rest.iter().zip(&least.rest);
            Ok((pairs.map(|(a, b)| a - b).collect(), before))
        };
        let judge = match locked.rows.is_empty() {
            true => bench,
            false => locked,
        };
        let (direction, before) = change(judge)?;
        let closed = Seen {
            direction: &direction,
            before: &before.rest,
            after: &judge.misfit(&self.active, REPORTING)?.rest,
            fitted: &change(bench)?.0,
            spread: self.last.mean_square().sqrt(),
        }
        .closed();
        for step in &mut self.steps {
            step.explainable_gap_closed = closed.clone();
        }
        Ok(())
    }

    /// A name in whose company most of what was wrong stays wrong is none: what was tried, in words.
    fn doubt(&self, start: &Misfit) -> Option<String> {
        let left = (self.last.chi2 - self.last.count) / (start.chi2 - start.count).max(1e-9);
        let doubtful = self.last.chi2 > MOST_LEFT * self.last.count && left > LEFT_SHARE;
        let names: Vec<&str> = self.steps.iter().map(|s| s.effect.as_str()).collect();
        (doubtful && !names.is_empty()).then(|| {
            format!(
                "{} would lower the gap, but leaves {:.0} % of what is beyond the noise: not named",
                names.join(" and "),
                100.0 * left
            )
        })
    }

    fn drop_all(&mut self, bench: &Bench) -> Result<(), Error> {
        self.active.clear();
        self.steps.clear();
        self.last = bench.misfit(&self.active, REPORTING)?;
        Ok(())
    }
}

fn find_steps(bench: &Bench, progress: &(dyn Fn(&str) + Sync)) -> Result<Found, Error> {
    let mut first_steps = Steps::new();
    let mut found = Found {
        active: Active::new(),
        steps: Vec::new(),
        detectable: Vec::new(),
        last: bench.misfit(&Active::new(), REPORTING)?,
        next: None,
    };
    let mut errors: Vec<f64> = Vec::new();
    while found.steps.len() < MOST_STEPS {
        let before = bench.misfit(&found.active, SEARCHING)?;
        let number = found.steps.len() + 1;
        let lines = look(bench, &found.active, &mut first_steps, &|name| {
            progress(&format!("look {number}: {name}"));
        });
        if number == 1 {
            found.detectable = detectable(&lines);
        }
        found.next = None;
        let Some(best) = lines.first() else { break };
        let mean_square = (best.chi2() / (before.count - 1.0).max(1.0)).max(1.0);
        if before.chi2 - best.chi2() < LEAST_DROP
            || best.chi2() > 0.8 * before.chi2
            || best.size().abs() < SIZE_IN_ERRORS * best.error() * mean_square.sqrt()
        {
            found.next = Some((best.effect, best.size()));
            break;
        }
        let rivals = rivals(&lines, before.chi2, mean_square);
        let mut class = vec![best.effect.info().name.to_owned()];
        class.extend(
            rivals
                .iter()
                .filter(|r| r.in_class)
                .map(|r| r.effect.clone()),
        );
        found.active.push((best.effect, best.size()));
        errors.push(best.error());
        progress(&format!("look {number}: finer meshes"));
        let polished = polish(bench, &found.active, &errors)?;
        let after = bench.misfit(&polished.active, SEARCHING)?;
        let drop = (before.chi2 - best.chi2()) / mean_square;
        found.steps.push(Step {
            effect: best.effect.info().name.to_owned(),
            class,
            channel: "p".to_owned(),
            place: place(bench, &before, &after),
            // Of one of all effects tried, each with its size free.
            p_value: (lines.len() as f64 * (-0.5 * drop).exp()).clamp(1e-12, 1.0),
            parameters: Vec::new(),
            gap_before: found.last.rms,
            gap_after: polished.misfit.rms,
            unit: "Pa".to_owned(),
            // Of all steps together, once the locked-away map is opened.
            explainable_gap_closed: Interval::default(),
            rivals,
        });
        found.active = polished.active;
        errors = polished.errors;
        found.last = polished.misfit;
    }
    remove_idle(bench, &mut found, &mut errors)?;
    let spread = found.last.mean_square().sqrt();
    for ((step, (effect, size)), error) in found.steps.iter_mut().zip(&found.active).zip(&errors) {
        let info = effect.info();
        let half = 1.96 * (error * spread).hypot(effect.form_error() * size);
        step.parameters.push(Fitted {
            name: info.key.to_owned(),
            value: *size,
            low: (size - half).max(info.low),
            high: (size + half).min(info.high),
            unit: info.unit.to_owned(),
        });
    }
    Ok(found)
}

/// Takes out again what the effects found later explain as well: its removal raises chi2 by less than a claim must lower it.
fn remove_idle(bench: &Bench, found: &mut Found, errors: &mut Vec<f64>) -> Result<(), Error> {
    let start = bench.misfit(&Active::new(), REPORTING)?;
    let mut k = 0;
    while found.active.len() > 1 && k < found.active.len() {
        let (mut active, mut own) = (found.active.clone(), errors.clone());
        active.remove(k);
        own.remove(k);
        let mut without = polish(bench, &active, &own)?;
        for _ in 0..2 {
            without = polish(bench, &without.active, &without.errors)?;
        }
        if without.misfit.chi2 - found.last.chi2 < LEAST_DROP * found.last.mean_square() {
            found.steps.remove(k);
            found.steps[0].gap_before = start.rms;
            found.active = without.active;
            *errors = without.errors;
            found.last = without.misfit;
            if let Some(last) = found.steps.last_mut() {
                last.gap_after = found.last.rms;
            }
            k = 0;
        } else {
            k += 1;
        }
    }
    Ok(())
}

fn rivals(lines: &[Line], before: f64, mean_square: f64) -> Vec<Rival> {
    let Some((best, others)) = lines.split_first() else {
        return Vec::new();
    };
    let beyond = |line: &Line| ((line.chi2() - best.chi2()) / mean_square).max(0.0);
    others
        .iter()
        .map(|line| {
            let info = line.effect.info();
            Rival {
                effect: info.name.to_owned(),
                parameter: info.key.to_owned(),
                size: line.size(),
                unit: info.unit.to_owned(),
                t: line.size() / line.error().max(1e-300),
                gain: before - line.chi2(),
                correlation: correlation(best, line),
                t_of_named_beyond: beyond(line).sqrt(),
                in_class: beyond(line) < CLASS,
                decides: info.decides.to_owned(),
            }
        })
        .collect()
}

fn detectable(lines: &[Line]) -> Vec<Detectable> {
    lines
        .iter()
        .enumerate()
        .map(|(k, line)| {
            let like = (0..lines.len())
                .filter(|j| *j != k)
                .map(|j| (j, correlation(line, &lines[j])))
                .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            let info = line.effect.info();
            Detectable {
                effect: info.name.to_owned(),
                parameter: info.key.to_owned(),
                // A drop of 30 in chi2, nine times in ten.
                size: line.size_at(LEAST_DROP.sqrt() + 1.28),
                unit: info.unit.to_owned(),
                left_after_refit: 1.0,
                most_like: like.map_or(String::new(), |(j, _)| {
                    lines[j].effect.info().name.to_owned()
                }),
                correlation: like.map_or(0.0, |(_, r)| r),
            }
        })
        .collect()
}

/// The rows that gain, with the one that gains most.
fn place(bench: &Bench, before: &Misfit, after: &Misfit) -> String {
    let gains = before.by_row.iter().zip(&after.by_row).map(|(a, b)| a - b);
    let most = gains.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    match most {
        Some((row, _)) if bench.rows.len() > 1 => {
            format!("all maps, most in {}", bench.rows[row].name)
        }
        _ => "the map".to_owned(),
    }
}

fn next_experiment(verdict: Verdict, steps: &[Step]) -> String {
    match verdict {
        Verdict::None => {
            "maps at several loads, on straight and curved track, show smaller effects".to_owned()
        }
        Verdict::NotIdentifiable => "maps of the same runner at more loads and turned by a known angle, and a map of a ball of known radius, which tells the sensor from the runner".to_owned(),
        _ => steps
            .iter()
            .flat_map(|s| &s.class)
            .filter_map(|name| find(name))
            .map(|e| format!("{}: {}", e.info().name, e.info().decides))
            .collect::<Vec<_>>()
            .join("; "),
    }
}

fn typical_noise(rows: &[&Row]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for row in rows {
        for sd in row
            .noise
            .iter()
            .chain(row.noise.is_empty().then_some(&row.p_max_sd))
        {
            sum += sd * sd;
            count += 1.0;
        }
    }
    f64::sqrt(sum / f64::max(count, 1.0))
}

fn untestable(rows: &[Row]) -> Vec<(String, String)> {
    if rows.iter().any(|r| r.map.is_some()) {
        return Vec::new();
    }
    CATALOGUE
        .iter()
        .map(|e| e.info().name)
        .filter(|name| NEED_MAPS.contains(name))
        .map(|name| {
            (
                name.to_owned(),
                "needs the column map, which is absent or empty".to_owned(),
            )
        })
        .collect()
}

fn remarks_on(rows: &[Row]) -> Vec<String> {
    let mut remarks = vec![
        "errors of a pixel: the sensor's noise as the map itself shows it, a third of a pixel in its place, 0.3 % of the peak, and what a finer mesh changes; 16 neighbouring pixels count as one value".to_owned(),
    ];
    if rows.iter().any(|r| r.map.is_none()) {
        remarks.push("rows without a map contribute their peak pressure alone".to_owned());
    }
    if rows.len() < 3 {
        remarks.push(format!(
            "{} rows are too few to lock one away: the gap is judged on the rows that were fitted",
            rows.len()
        ));
    }
    let same = |value: &dyn Fn(&Row) -> f64| rows.iter().all(|r| value(r) == value(&rows[0]));
    if same(&|r| r.fz) && same(&|r| r.problem.track_curvature) {
        remarks.push(format!(
            "fz_n and radius_m are the same in all rows ({} N): effects that differ by load alone cannot be told apart",
            rows[0].fz
        ));
    }
    remarks
}
