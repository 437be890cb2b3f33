//! Pressure measurements: maps and peaks against contact solves.
//!
//! Each candidate of [`kufe_contact::effects`] changes the problem or the map. Its size is fitted by Gauss-Newton on all
//! rows (every step a new solve), and what counts is the sum of squares that is really left:
//!
//! ```text
//! chi2 = sum over pixels (p_measured - p_simulated)^2 / sd^2 / (pixels for one independent value)  +  peaks
//! ```
//!
//! sd is the larger of the sensor's noise (from pixels far from contact) and 1.5 per cent of the peak, for the two
//! discretisations differ. A claim must lower chi2 by more than 30 and by a fifth; its class is every effect whose own best fit
//! is worse by less than 9 in units of the best fit's mean square.

use std::path::{Path, PathBuf};

use kufe_contact::case::Case;
use kufe_contact::effects::{CATALOGUE, Effect, Map};
use kufe_contact::{Load, Problem, Solution, solve};
use rayon::prelude::*;

use crate::exr_map::read_map;
use crate::report::{
    ChannelGap, Detectable, Fitted, HeldOut, Interval, Report, Rival, Step, Verdict,
};
use crate::table::Table;
use crate::{Error, Options};

/// Cells over half the patch of the solves.
const CELLS: usize = 20;
/// Pixels that count as one independent value along each direction.
const PATCH: f64 = 4.0;

struct Row {
    name: String,
    problem: Problem,
    p_max: f64,
    p_max_sd: f64,
    map: Option<Map>,
    noise: f64,
}

/// Effects with their sizes.
type Active = Vec<(&'static dyn Effect, f64)>;

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
        "the tests use the sensor's noise and 1.5 % of the peak for differing discretisations; neighbouring pixels count in patches".to_owned(),
    ];
    if rows.iter().any(|r| r.map.is_none()) {
        remarks.push("rows without a map contribute their peak pressure alone".to_owned());
    }
    let mut detectable = Vec::new();
    let start = misfit(&training, &active)?;
    let mut chi2 = start.chi2;
    for number in 0..2 {
        let mut fits: Vec<(usize, f64, f64, f64)> = Vec::new();
        for (index, effect) in CATALOGUE.iter().enumerate() {
            if active
                .iter()
                .any(|(e, _)| e.info().name == effect.info().name)
            {
                continue;
            }
            progress(&format!("look {}: {}", number + 1, effect.info().name));
            if let Some((size, left, error)) = fit_one(&training, &active, *effect)? {
                fits.push((index, size, left, error));
            }
        }
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
        let Some(best) = fits.iter().min_by(|a, b| a.2.total_cmp(&b.2)).copied() else {
            break;
        };
        if chi2 - best.2 < 30.0 || best.2 > 0.8 * chi2 {
            break;
        }
        let info = CATALOGUE[best.0].info();
        let count = misfit(&training, &active)?.count;
        let unit_square = (best.2 / (count - 1.0).max(1.0)).max(1.0);
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
        let before = misfit(&training, &active)?;
        active.push((CATALOGUE[best.0], best.1));
        let after = misfit(&training, &active)?;
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
    let last = misfit(&training, &active)?;
    let (held_before, held_after) = (misfit(&held, &Vec::new())?, misfit(&held, &active)?);
    let gap = |before: f64, after: f64, rows: &[&Row]| ChannelGap {
        channel: "p".to_owned(),
        unit: "Pa".to_owned(),
        before,
        after,
        noise: rows.iter().map(|r| r.noise).sum::<f64>() / rows.len().max(1) as f64,
    };
    let verdict = match steps.first() {
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
        runs: held.iter().map(|r| r.name.clone()).collect(),
        gap_before: held_before.rms,
        gap_after: held_after.rms,
        unit: "Pa".to_owned(),
        channels: if held.is_empty() {
            Vec::new()
        } else {
            vec![gap(held_before.rms, held_after.rms, &held)]
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
        clean: last.chi2 < 2.0 * last.count,
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

fn read(path: &Path, model: &Path, model_case: &Case) -> Result<Vec<Row>, Error> {
    let table = Table::read(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let cases = table.texts("case")?;
    let fz = table.numbers("fz_n", 1e-3, 1e6)?;
    let radius = table.numbers("radius_m", f64::NEG_INFINITY, f64::INFINITY)?;
    let p_max = table.numbers("p_max_pa", 0.0, 1e12)?;
    let p_max_sd = table.numbers("p_max_sd_pa", 1e-9, 1e12)?;
    let maps = match table.place("map") {
        Some(_) => table.texts("map")?,
        None => vec![String::new(); cases.len()],
    };
    let same = |a: &PathBuf, b: &Path| {
        a.canonicalize()
            .ok()
            .is_some_and(|a| b.canonicalize().is_ok_and(|b| a == b))
    };
    let mut rows: Vec<Row> = Vec::new();
    for i in 0..cases.len() {
        let file = folder.join(&cases[i]);
        let told = |error: kufe_contact::case::CaseError| Error::File {
            file: file.display().to_string(),
            reason: error.to_string(),
        };
        let (case, base) = if same(&file, model) {
            (model_case.clone(), model.parent().unwrap_or(Path::new("")))
        } else {
            let text = std::fs::read_to_string(&file).map_err(|error| Error::File {
                file: file.display().to_string(),
                reason: error.to_string(),
            })?;
            (
                Case::parse(&text).map_err(told)?,
                file.parent().unwrap_or(Path::new("")),
            )
        };
        let mut problem = case.problem(base).map_err(told)?;
        if let Load::Force { fz: force, .. } = &mut problem.load {
            *force = fz[i];
        }
        if radius[i] == 0.0 {
            return Err(Error::Cell {
                file: table.file.clone(),
                row: i as u64 + 2,
                column: "radius_m".to_owned(),
                found: "0".to_owned(),
                expected: "a radius, or inf for a straight".to_owned(),
            });
        }
        problem.track_curvature = 1.0 / radius[i];
        let map = match maps[i].is_empty() {
            true => None,
            false => Some(read_map(&folder.join(&maps[i]))?),
        };
        let noise = map.as_ref().map_or(0.0, far_noise).max(0.015 * p_max[i]);
        if let Some(copy) = rows.iter().position(|r| r.map.is_some() && r.map == map) {
            return Err(Error::Duplicate {
                file: table.file.clone(),
                first: format!("row {}", copy + 2),
                second: format!("row {}", i + 2),
            });
        }
        rows.push(Row {
            name: format!("row {} ({:.0} N, radius {} m)", i + 2, fz[i], radius[i]),
            problem,
            p_max: p_max[i],
            p_max_sd: p_max_sd[i].max(0.015 * p_max[i]),
            map,
            noise,
        });
    }
    Ok(rows)
}

/// Noise of the sensor from the rim of the map, where nothing presses.
fn far_noise(map: &Map) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for j in 0..map.ny {
        for i in 0..map.nx {
            if j == 0 || j + 1 == map.ny || i == 0 || i + 1 == map.nx {
                sum += map.pressure[j * map.nx + i].powi(2);
                count += 1.0;
            }
        }
    }
    (sum / f64::max(count, 1.0)).sqrt()
}

struct Misfit {
    chi2: f64,
    /// Independent values.
    count: f64,
    rms: f64,
    /// Weighted residuals, row after row.
    rest: Vec<f64>,
}

fn misfit(rows: &[&Row], active: &Active) -> Result<Misfit, Error> {
    let each: Vec<(Vec<f64>, f64, f64, f64)> = rows
        .par_iter()
        .map(|row| one_row(row, active))
        .collect::<Result<_, _>>()?;
    let mut out = Misfit {
        chi2: 0.0,
        count: 0.0,
        rms: 0.0,
        rest: Vec::new(),
    };
    let mut pixels = 0.0;
    for (rest, count, square, n) in each {
        out.chi2 += rest.iter().map(|r| r * r).sum::<f64>();
        out.count += count;
        out.rms += square;
        pixels += n;
        out.rest.extend(rest);
    }
    out.rms = (out.rms / f64::max(pixels, 1.0)).sqrt();
    Ok(out)
}

/// Weighted residuals of a row, independent values, sum of squares [Pa2] and number of values.
fn one_row(row: &Row, active: &Active) -> Result<(Vec<f64>, f64, f64, f64), Error> {
    let mut problem = row.problem.clone();
    for (effect, size) in active {
        effect.alter(*size, &mut problem);
    }
    let options = kufe_contact::Options {
        cells: Some(CELLS),
        ..kufe_contact::Options::default()
    };
    let solution = solve(&problem, &options)?;
    let Some(measured) = &row.map else {
        let gain: f64 = active
            .iter()
            .map(|(e, v)| {
                if e.info().name == "sensor-gain" {
                    1.0 + v
                } else {
                    1.0
                }
            })
            .product();
        let r = row.p_max - gain * solution.p_max;
        return Ok((vec![r / row.p_max_sd], 1.0, r * r, 1.0));
    };
    let mut map = sample(&solution, measured);
    for (effect, size) in active {
        effect.sense(*size, &mut map);
    }
    // A patch of pixels counts as one value, no larger than a quarter of the contact's width.
    let patch = (PATCH * PATCH)
        .min((map.nx * map.ny) as f64 / 64.0)
        .max(1.0);
    let weight = 1.0 / (row.noise * patch.sqrt());
    let mut square = 0.0;
    let mut rest = Vec::with_capacity(map.pressure.len());
    let mut touched = 0.0;
    for (m, s) in measured.pressure.iter().zip(&map.pressure) {
        square += (m - s).powi(2);
        rest.push((m - s) * weight);
        if *s > 0.0 {
            touched += 1.0;
        }
    }
    Ok((rest, touched / patch, square, f64::max(touched, 1.0)))
}

/// The solution's pressure on the measured map's pixels: bilinear between nodes, the mean of nine points a pixel.
fn sample(solution: &Solution, like: &Map) -> Map {
    let surface = &solution.surface;
    let (nx, ny) = (surface.x.len(), surface.y.len());
    let place = |nodes: &[f64], x: f64| -> Option<(usize, f64)> {
        let at = nodes.partition_point(|n| *n <= x);
        (at > 0 && at < nodes.len())
            .then(|| (at - 1, (x - nodes[at - 1]) / (nodes[at] - nodes[at - 1])))
    };
    let value = |x: f64, y: f64| -> f64 {
        match (place(&surface.x, x), place(&surface.y, y)) {
            (Some((i, a)), Some((j, b))) if i + 1 < nx && j + 1 < ny => {
                let p = |i: usize, j: usize| surface.pressure[j * nx + i];
                (1.0 - b) * ((1.0 - a) * p(i, j) + a * p(i + 1, j))
                    + b * ((1.0 - a) * p(i, j + 1) + a * p(i + 1, j + 1))
            }
            _ => 0.0,
        }
    };
    let mut map = like.clone();
    for j in 0..map.ny {
        for i in 0..map.nx {
            let (x, y) = (map.x0 + i as f64 * map.dx, map.y0 + j as f64 * map.dy);
            let mut sum = 0.0;
            for u in [-1.0, 0.0, 1.0] {
                for v in [-1.0, 0.0, 1.0] {
                    sum += value(x + u * map.dx / 3.0, y + v * map.dy / 3.0);
                }
            }
            map.pressure[j * map.nx + i] = sum / 9.0;
        }
    }
    map
}

/// Fits one effect beside the active ones: size, chi2 left, standard error. `None` where it cannot be solved or does nothing.
fn fit_one(
    rows: &[&Row],
    active: &Active,
    effect: &'static dyn Effect,
) -> Result<Option<(f64, f64, f64)>, Error> {
    let info = effect.info();
    let at = |size: f64| -> Result<Misfit, Error> {
        let mut with = active.clone();
        with.push((effect, size));
        misfit(rows, &with)
    };
    let base = at(0.0)?;
    let mut best = (0.0, base.chi2, f64::INFINITY);
    // A bound on the pressure acts only below the peak: it starts there.
    let mut size = match info.name {
        "hardness" => 1.1 / rows.iter().map(|r| r.p_max).fold(1.0, f64::max),
        _ => 0.0,
    };
    let mut now = if size == 0.0 {
        base
    } else {
        match at(size) {
            Ok(m) => m,
            Err(_) => return Ok(None),
        }
    };
    for round in 0..5 {
        let step = if round == 0 || info.name != "hardness" {
            info.typical
        } else {
            0.05 * size
        };
        let step = if size + step > info.high { -step } else { step };
        let Ok(moved) = at(size + step) else { break };
        let (mut dd, mut dr) = (0.0, 0.0);
        for (a, b) in now.rest.iter().zip(&moved.rest) {
            let d = (a - b) / step;
            dd += d * d;
            dr += d * a;
        }
        if dd <= 0.0 {
            break;
        }
        let error = 1.0 / dd.sqrt();
        if now.chi2 <= best.1 {
            best = (size, now.chi2, error);
        }
        let mut share = 1.0;
        let mut better = None;
        for _ in 0..4 {
            let trial = (size + share * dr / dd).clamp(info.low, info.high);
            if let Ok(m) = at(trial)
                && m.chi2 < now.chi2
            {
                better = Some((trial, m));
                break;
            }
            share *= 0.3;
        }
        let Some((trial, m)) = better else { break };
        let gained = now.chi2 - m.chi2;
        size = trial;
        now = m;
        if now.chi2 < best.1 {
            best = (size, now.chi2, error);
        }
        if gained < 0.01 * now.chi2.max(1.0) {
            break;
        }
    }
    Ok(best.2.is_finite().then_some(best))
}
