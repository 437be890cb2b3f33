//! Friction experiments: mu over pressure, one row a specimen or condition.
//!
//! The base is `mu = 1e-3 (b p^2 - c p + d)`, p in MPa (or a constant, where the model has a fixed mu), refitted with the
//! variance `mu_sd^2 + (dmu/dp p_sd)^2`. A candidate adds one parameter. Its t in the joint fit is compared with the largest
//! |t| over all candidates in twins (rows simulated from the base with both errors, p among them) and under permutations of
//! the rows' residuals; what is constant within a session is permuted by session.

use std::path::Path;

use kufe_friction::Longitudinal;
use kufe_friction::effects::{CATALOGUE, Column, Conditions, Effect};
use kufe_sled::Model;
use nalgebra::{DMatrix, DVector};

use crate::flips::gumbel_tail;
use crate::random::{normal, shuffle, stream};
use crate::report::{
    ChannelGap, Detectable, Fitted, HeldOut, Interval, Report, Rival, Step, Verdict,
};
use crate::score::ridge_inverse;
use crate::table::Table;
use crate::{Error, Options};

const ALPHA: f64 = 0.03;

/// One row.
#[derive(Clone, Debug)]
struct Row {
    name: String,
    session: String,
    pressure: f64,
    pressure_sd: f64,
    mu: f64,
    mu_sd: f64,
    conditions: Conditions,
}

/// Change of mu of a row at a size.
type Change = Box<dyn Fn(&Row, f64) -> f64>;
/// What can be tested, and names of what cannot with the reason.
type Listed = (Vec<Candidate>, Vec<(String, String)>);
/// Rows with their place in the file.
type Placed = Vec<(usize, Row)>;

/// A candidate: one effect, or a straight line in one column.
struct Candidate {
    name: String,
    key: String,
    unit: String,
    low: f64,
    high: f64,
    typical: f64,
    decides: String,
    /// Change of mu with the parameter, by row, in units of `typical`.
    change: Change,
    /// Whether `model.toml` has it.
    in_catalogue: bool,
    by_session: bool,
}

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
    let rows = read(&table)?;
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
    let mut remarks = Vec::new();
    let (candidates, untestable) = list(&rows, &table)?;
    // Every fifth row is locked away where there are rows enough to spare.
    let spare = rows.len() >= 20;
    let (held, training): (Placed, Placed) = rows
        .iter()
        .cloned()
        .enumerate()
        .partition(|(i, _)| spare && i % 5 == 4);
    let held: Vec<Row> = held.into_iter().map(|(_, r)| r).collect();
    let training: Vec<Row> = training.into_iter().map(|(_, r)| r).collect();
    if !spare {
        remarks.push(format!(
            "{} rows are too few to lock any away; sizes are judged by leaving single rows out",
            rows.len()
        ));
    }
    let mut chosen: Vec<usize> = Vec::new();
    let mut steps: Vec<Step> = Vec::new();
    let mut detectable = Vec::new();
    let first = fit(&training, &candidates, &[], base);
    let freedom = training.len() - base;
    remarks.push(format!(
        "base fit: chi2 = {:.1} on {freedom} degrees of freedom",
        first.chi2
    ));
    while steps.len() < 4 && training.len() > base + chosen.len() + 2 {
        progress(&format!("look {}", steps.len() + 1));
        let look = look(&training, &candidates, &chosen, base, options);
        if steps.is_empty() {
            detectable = look.detectable(&candidates);
        }
        let best = (0..candidates.len())
            .filter(|c| look.claimable(*c, &candidates[*c]))
            .max_by(|a, b| look.t[*a].abs().total_cmp(&look.t[*b].abs()));
        let Some(named) = best else { break };
        let before = fit(&training, &candidates, &chosen, base).rms;
        let mut class = vec![candidates[named].name.clone()];
        let mut rivals = Vec::new();
        for (j, rival) in candidates.iter().enumerate() {
            if j == named || chosen.contains(&j) || look.t[j].abs() < 1.5 {
                continue;
            }
            let mut both = chosen.clone();
            both.extend([j, named]);
            let joint = fit(&training, &candidates, &both, base);
            let beyond =
                joint.step[base + both.len() - 1] / joint.errors[base + both.len() - 1].max(1e-300);
            let in_class = rival.in_catalogue
                && (rival.low..=rival.high).contains(&(look.size[j] * rival.typical))
                && (beyond.abs() < 2.2 || !beyond.is_finite());
            if in_class {
                class.push(rival.name.clone());
            }
            rivals.push(Rival {
                effect: rival.name.clone(),
                parameter: rival.key.clone(),
                size: look.size[j] * rival.typical,
                unit: rival.unit.clone(),
                t: look.t[j],
                gain: look.t[j].powi(2),
                correlation: look.correlation(named, j),
                t_of_named_beyond: beyond,
                in_class,
                decides: rival.decides.clone(),
            });
        }
        rivals.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        chosen.push(named);
        let after = fit(&training, &candidates, &chosen, base).rms;
        steps.push(Step {
            effect: candidates[named].name.clone(),
            class,
            channel: "mu".to_owned(),
            place: "all rows".to_owned(),
            p_value: look.p_value(named),
            parameters: Vec::new(),
            gap_before: before,
            gap_after: after,
            unit: String::new(),
            explainable_gap_closed: Interval {
                value: 0.0,
                low: 0.0,
                high: 0.0,
            },
            rivals,
        });
    }
    let last = fit(&training, &candidates, &chosen, base);
    let quantile = 1.96 + 2.5 / (training.len() as f64 - (base + chosen.len()) as f64).max(1.0);
    for (k, step) in steps.iter_mut().enumerate() {
        let candidate = &candidates[chosen[k]];
        let (value, error) = (
            last.step[base + k] * candidate.typical,
            last.errors[base + k] * candidate.typical,
        );
        step.parameters.push(Fitted {
            name: candidate.key.clone(),
            value,
            low: value - quantile * error,
            high: value + quantile * error,
            unit: candidate.unit.clone(),
        });
        // The noise-free share of what the step explains: t^2 counts 1 for chance.
        let t2 = (last.step[base + k] / last.errors[base + k]).powi(2);
        let left = 1.0 / t2.max(1.0);
        step.explainable_gap_closed = Interval {
            value: 1.0 - left,
            low: 1.0 - (quantile * quantile / t2.max(1e-9)).min(1.0),
            high: 1.0,
        };
    }
    let (held_before, held_after) = (
        rms_of(&held, &candidates, &[], &first, base),
        rms_of(&held, &candidates, &chosen, &last, base),
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
        _ => crate::sentence::sentence(verdict, &steps, &held_out, &next_experiment, &[]),
    };
    let names: &[&str] = if quadratic { &["b", "c", "d"] } else { &["mu"] };
    let value = |k: usize| last.base_value(k, quadratic);
    let base_parameters = names
        .iter()
        .enumerate()
        .map(|(k, name)| Fitted {
            name: (*name).to_owned(),
            value: value(k),
            low: value(k) - quantile * last.errors[k],
            high: value(k) + quantile * last.errors[k],
            unit: match *name {
                "b" => "1/MPa2 (1e-3)",
                "c" => "1/MPa (1e-3)",
                "d" => "(1e-3)",
                _ => "",
            }
            .to_owned(),
        })
        .collect();
    let mut next = model.clone();
    let keys = &mut next.friction.longitudinal;
    if quadratic {
        keys.b = Some(value(0));
        keys.c = Some(value(1));
        keys.d = Some(value(2));
    } else {
        keys.mu = Some(value(0));
    }
    for (step, c) in steps.iter().zip(&chosen) {
        if candidates[*c].in_catalogue {
            let mut table = toml::Table::new();
            table.insert(candidates[*c].key.clone(), step.parameters[0].value.into());
            next.effects.insert(step.effect.clone(), table);
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
        bins: Vec::new(),
        bins_after: Vec::new(),
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

fn read(table: &Table) -> Result<Vec<Row>, Error> {
    let names = table.texts("specimen")?;
    let pressure = table.numbers("p_max_pa", 0.0, 1e10)?;
    let pressure_sd = table.numbers("p_max_sd_pa", 0.0, 1e10)?;
    let mu = table.numbers("mu", 0.0, 1.0)?;
    let mu_sd = table.numbers("mu_sd", 1e-9, 1.0)?;
    let sessions = match table.place("session") {
        Some(_) => table.texts("session")?,
        None => names.clone(),
    };
    let column = |name: &str, low: f64, high: f64| table.optional(name, low, high);
    let fz = column("fz_n", 1e-3, 1e6)?;
    let v = column("v_mps", 1e-3, 200.0)?;
    let ice = column("ice_c", -80.0, 5.0)?;
    let air = column("air_c", -80.0, 60.0)?;
    let humidity = column("humidity_pct", 0.0, 100.0)?;
    let air_pa = column("air_pa", 4e4, 1.2e5)?;
    let distance = column("distance_m", 0.0, 1e9)?;
    let rows: Vec<Row> = (0..names.len())
        .map(|i| {
            let get = |x: &Option<Vec<f64>>, default: f64| x.as_ref().map_or(default, |x| x[i]);
            let (air_c, air_pa) = (get(&air, 0.0), get(&air_pa, 95_000.0));
            Row {
                name: names[i].clone(),
                session: sessions[i].clone(),
                pressure: pressure[i],
                pressure_sd: pressure_sd[i],
                mu: mu[i],
                mu_sd: mu_sd[i],
                conditions: Conditions {
                    t: f64::NAN,
                    s: f64::NAN,
                    v: get(&v, f64::NAN),
                    fz: get(&fz, f64::NAN),
                    ice_c: get(&ice, f64::NAN),
                    air_c,
                    air_pa,
                    humidity_pct: get(&humidity, f64::NAN),
                    distance: get(&distance, f64::NAN),
                    air_density: kufe_sled::aero::air_density(air_pa, air_c),
                    drag_area: 0.25,
                },
            }
        })
        .collect();
    for (i, row) in table.rows.iter().enumerate() {
        let place = table.place("specimen");
        let same = |other: &Vec<String>| {
            row.iter()
                .zip(other)
                .enumerate()
                .all(|(k, (a, b))| Some(k) == place || a == b)
        };
        if let Some(j) = table.rows[..i].iter().position(same) {
            return Err(Error::Duplicate {
                file: table.file.clone(),
                first: format!("row {}", j + 2),
                second: format!("row {}", i + 2),
            });
        }
    }
    Ok(rows)
}

fn list(rows: &[Row], table: &Table) -> Result<Listed, Error> {
    let mut candidates = Vec::new();
    let mut untestable = Vec::new();
    let varies = |column: Column| {
        table
            .place(column.name())
            .is_some_and(|at| table.rows.iter().any(|row| row[at] != table.rows[0][at]))
    };
    for effect in CATALOGUE {
        let effect: &'static dyn Effect = *effect;
        let info = effect.info();
        let missing: Vec<&str> = info
            .needs
            .iter()
            .filter(|c| !varies(**c))
            .map(|c| c.name())
            .collect();
        if info.name == "slope" {
            untestable.push((
                info.name.to_owned(),
                "is the same as another level of friction unless both directions are run"
                    .to_owned(),
            ));
            continue;
        }
        if !missing.is_empty() {
            untestable.push((
                info.name.to_owned(),
                format!(
                    "needs {}, which is absent or does not vary",
                    missing.join(", ")
                ),
            ));
            continue;
        }
        let Some(index) = info.parameters.iter().position(|p| p.is_amplitude()) else {
            continue;
        };
        let p = info.parameters[index];
        let defaults: Vec<f64> = info.parameters.iter().map(|p| p.default).collect();
        candidates.push(Candidate {
            name: info.name.to_owned(),
            key: p.name.to_owned(),
            unit: p.unit.to_owned(),
            low: p.low,
            high: p.high,
            typical: p.typical,
            decides: info.decides.to_owned(),
            change: Box::new(move |row, mu| {
                let mut values = defaults.clone();
                values[index] = 0.01 * p.typical;
                (effect.coefficient(&values, mu, &row.conditions) - mu) / 0.01
            }),
            in_catalogue: true,
            by_session: false,
        });
    }
    const KNOWN: [&str; 6] = [
        "specimen",
        "session",
        "p_max_pa",
        "p_max_sd_pa",
        "mu",
        "mu_sd",
    ];
    for name in &table.header {
        if KNOWN.contains(&name.as_str()) {
            continue;
        }
        let Ok(values) = table.numbers(name, f64::MIN, f64::MAX) else {
            continue;
        };
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let sd = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
        if sd <= 1e-12 * mean.abs() {
            continue;
        }
        let by_name: std::collections::BTreeMap<String, f64> = rows
            .iter()
            .zip(&values)
            .map(|(row, x)| (row.name.clone() + &row.mu.to_string(), (x - mean) / sd))
            .collect();
        candidates.push(Candidate {
            name: format!("unknown:{name}"),
            key: "value".to_owned(),
            unit: format!("for {sd:.4} of {name}"),
            low: -1.0,
            high: 1.0,
            typical: 1e-4,
            decides: format!("rows in which {name} is varied by itself"),
            change: Box::new(move |row, _| {
                1e-4 * by_name
                    .get(&(row.name.clone() + &row.mu.to_string()))
                    .copied()
                    .unwrap_or(0.0)
            }),
            in_catalogue: false,
            by_session: false,
        });
    }
    let mut sessions: Vec<&str> = rows.iter().map(|r| r.session.as_str()).collect();
    sessions.sort_unstable();
    sessions.dedup();
    if sessions.len() < rows.len() {
        for candidate in &mut candidates {
            candidate.by_session = sessions.iter().all(|s| {
                let mut own = rows
                    .iter()
                    .filter(|r| r.session == *s)
                    .map(|r| (candidate.change)(r, 0.004));
                let one = own.next().unwrap_or(0.0);
                own.all(|x| (x - one).abs() <= 1e-9 * one.abs().max(1e-12))
            });
        }
    }
    Ok((candidates, untestable))
}

struct Fit {
    /// Base coefficients (of p^2, p, 1 in MPa, or of 1), then the candidates' in units of `typical`.
    step: DVector<f64>,
    errors: Vec<f64>,
    chi2: f64,
    rms: f64,
    /// Whitened residual.
    rest: DVector<f64>,
    /// Whitened columns.
    columns: DMatrix<f64>,
}

impl Fit {
    fn base_value(&self, k: usize, quadratic: bool) -> f64 {
        match (quadratic, k) {
            (true, 1) => -1e3 * self.step[1],
            (true, _) => 1e3 * self.step[k],
            _ => self.step[0],
        }
    }
}

fn base_row(row: &Row, base: usize) -> Vec<f64> {
    let p = row.pressure / 1e6;
    if base == 3 {
        vec![p * p, p, 1.0]
    } else {
        vec![1.0]
    }
}

fn fit(rows: &[Row], candidates: &[Candidate], chosen: &[usize], base: usize) -> Fit {
    let n = rows.len();
    let m = base + chosen.len();
    let mut step = DVector::zeros(m);
    let mut fit = None;
    for round in 0..6 {
        let mut columns = DMatrix::zeros(n, m);
        let mut y = DVector::zeros(n);
        let mut weights = vec![0.0; n];
        for (i, row) in rows.iter().enumerate() {
            let own = base_row(row, base);
            let mu: f64 = if round == 0 {
                row.mu
            } else {
                own.iter().zip(step.iter()).map(|(a, b)| a * b).sum()
            };
            let slope = if base == 3 {
                2.0 * step[0] * row.pressure / 1e6 + step[1]
            } else {
                0.0
            };
            let sd = row.mu_sd.hypot(slope * row.pressure_sd / 1e6);
            weights[i] = 1.0 / sd;
            for (k, x) in own.iter().enumerate() {
                columns[(i, k)] = x / sd;
            }
            for (k, c) in chosen.iter().enumerate() {
                columns[(i, base + k)] = (candidates[*c].change)(row, mu.max(1e-5)) / sd;
            }
            y[i] = row.mu / sd;
        }
        let inverse = ridge_inverse(columns.tr_mul(&columns));
        step = &inverse * columns.tr_mul(&y);
        let rest = &y - &columns * &step;
        let chi2 = rest.norm_squared();
        let excess = (chi2 / (n as f64 - m as f64).max(1.0)).max(1.0);
        fit = Some(Fit {
            step: step.clone(),
            errors: (0..m)
                .map(|k| (inverse[(k, k)].max(0.0) * excess).sqrt())
                .collect(),
            chi2,
            rms: (rest
                .iter()
                .zip(&weights)
                .map(|(r, w)| (r / w).powi(2))
                .sum::<f64>()
                / n as f64)
                .sqrt(),
            rest,
            columns,
        });
    }
    fit.expect("six rounds")
}

fn rms_of(rows: &[Row], candidates: &[Candidate], chosen: &[usize], fit: &Fit, base: usize) -> f64 {
    let sum: f64 = rows
        .iter()
        .map(|row| {
            let own: f64 = base_row(row, base)
                .iter()
                .zip(fit.step.iter())
                .map(|(a, b)| a * b)
                .sum();
            let more: f64 = chosen
                .iter()
                .enumerate()
                .map(|(k, c)| (candidates[*c].change)(row, own.max(1e-5)) * fit.step[base + k])
                .sum();
            (row.mu - own - more).powi(2)
        })
        .sum();
    (sum / rows.len().max(1) as f64).sqrt()
}

struct Looked {
    t: Vec<f64>,
    size: Vec<f64>,
    error: Vec<f64>,
    left: Vec<f64>,
    free: Vec<DVector<f64>>,
    twins: Vec<f64>,
    permuted: Vec<f64>,
    permuted_sessions: Vec<f64>,
    by_session: Vec<bool>,
    critical: f64,
}

impl Looked {
    fn p_value(&self, c: usize) -> f64 {
        let t = self.t[c].abs();
        let null = if self.by_session[c] {
            &self.permuted_sessions
        } else {
            &self.permuted
        };
        let above = null.iter().filter(|m| **m >= t - 1e-9).count();
        let by_permutation = (above + 1) as f64 / (null.len() + 1) as f64;
        by_permutation.max(gumbel_tail(&self.twins, t))
    }

    fn claimable(&self, c: usize, candidate: &Candidate) -> bool {
        self.left[c] > 0.02
            && self.p_value(c) <= ALPHA
            && (candidate.low..=candidate.high).contains(&(self.size[c] * candidate.typical))
    }

    fn correlation(&self, a: usize, b: usize) -> f64 {
        let norm = self.free[a].norm() * self.free[b].norm();
        if norm > 0.0 {
            self.free[a].dot(&self.free[b]) / norm
        } else {
            0.0
        }
    }

    fn detectable(&self, candidates: &[Candidate]) -> Vec<Detectable> {
        (0..candidates.len())
            .map(|c| {
                let like = (0..candidates.len())
                    .filter(|j| {
                        candidates[*j].in_catalogue && candidates[*j].name != candidates[c].name
                    })
                    .max_by(|a, b| {
                        self.correlation(c, *a)
                            .abs()
                            .total_cmp(&self.correlation(c, *b).abs())
                    });
                Detectable {
                    effect: candidates[c].name.clone(),
                    parameter: candidates[c].key.clone(),
                    size: (self.critical + 1.28) * self.error[c] * candidates[c].typical,
                    unit: candidates[c].unit.clone(),
                    left_after_refit: self.left[c],
                    most_like: like.map_or(String::new(), |j| candidates[j].name.clone()),
                    correlation: like.map_or(0.0, |j| self.correlation(c, j)),
                }
            })
            .collect()
    }
}

/// t of every candidate added to the chosen ones, and the nulls of the largest.
fn look(
    rows: &[Row],
    candidates: &[Candidate],
    chosen: &[usize],
    base: usize,
    options: &Options,
) -> Looked {
    let now = fit(rows, candidates, chosen, base);
    let n = rows.len();
    let inverse = ridge_inverse(now.columns.tr_mul(&now.columns));
    let project = |x: &DVector<f64>| -> DVector<f64> {
        x - &now.columns * (&inverse * now.columns.tr_mul(x))
    };
    let whitened = |c: usize| -> DVector<f64> {
        DVector::from_fn(n, |i, _| {
            // The last base column is 1/sd.
            let mu: f64 = base_row(&rows[i], base)
                .iter()
                .zip(now.step.iter())
                .map(|(a, b)| a * b)
                .sum();
            (candidates[c].change)(&rows[i], mu.max(1e-5)) * now.columns[(i, base - 1)]
        })
    };
    let raw: Vec<DVector<f64>> = (0..candidates.len()).map(whitened).collect();
    let free: Vec<DVector<f64>> = raw.iter().map(&project).collect();
    let left: Vec<f64> = raw
        .iter()
        .zip(&free)
        .map(|(r, f)| f.norm_squared() / r.norm_squared().max(1e-300))
        .collect();
    let freedom = (n as f64 - base as f64 - chosen.len() as f64 - 1.0).max(1.0);
    // Errors are scaled up by what is left where the rows scatter more than stated, never down.
    let t_of = |rest: &DVector<f64>, c: usize| -> f64 {
        if left[c] <= 0.02 || chosen.contains(&c) {
            return 0.0;
        }
        let norm = free[c].norm();
        let score = free[c].dot(rest) / norm;
        let excess = ((rest.norm_squared() - score * score) / freedom).max(1.0);
        score / excess.sqrt()
    };
    let all = |rest: &DVector<f64>| -> Vec<f64> {
        (0..candidates.len()).map(|c| t_of(rest, c)).collect()
    };
    let largest = |rest: &DVector<f64>, only_sessions: bool| -> f64 {
        (0..candidates.len())
            .filter(|c| !only_sessions || candidates[*c].by_session)
            .map(|c| t_of(rest, c).abs())
            .fold(0.0, f64::max)
    };
    let t = all(&now.rest);
    let permuted = (0..options.flips)
        .map(|k| {
            let mut order: Vec<usize> = (0..n).collect();
            shuffle(&mut stream(options.seed, 0x9E12, k as u64), &mut order);
            largest(
                &project(&DVector::from_fn(n, |i, _| now.rest[order[i]])),
                false,
            )
        })
        .collect();
    let mut sessions: Vec<&str> = rows.iter().map(|r| r.session.as_str()).collect();
    sessions.sort_unstable();
    sessions.dedup();
    let permuted_sessions = (0..options.flips)
        .map(|k| {
            let mut order: Vec<usize> = (0..sessions.len()).collect();
            shuffle(&mut stream(options.seed, 0x9E13, k as u64), &mut order);
            // A session takes the mean residual of another one and keeps its own scatter.
            let mean: Vec<f64> = sessions
                .iter()
                .map(|s| {
                    let own: Vec<f64> = (0..n)
                        .filter(|i| rows[*i].session == *s)
                        .map(|i| now.rest[i])
                        .collect();
                    own.iter().sum::<f64>() / own.len() as f64
                })
                .collect();
            let mixed = DVector::from_fn(n, |i, _| {
                let at = sessions
                    .iter()
                    .position(|s| *s == rows[i].session)
                    .unwrap_or(0);
                now.rest[i] - mean[at] + mean[order[at]]
            });
            largest(&project(&mixed), true)
        })
        .collect();
    let twins: Vec<f64> = (0..options.twins.max(40))
        .map(|k| {
            let mut rng = stream(options.seed, 0x7A17, k);
            let twin: Vec<Row> = rows
                .iter()
                .map(|row| {
                    let mut twin = row.clone();
                    let mut mu: f64 = base_row(row, base)
                        .iter()
                        .zip(now.step.iter())
                        .map(|(a, b)| a * b)
                        .sum();
                    for (j, c) in chosen.iter().enumerate() {
                        mu += (candidates[*c].change)(row, mu.max(1e-5)) * now.step[base + j];
                    }
                    twin.mu = mu + row.mu_sd * normal(&mut rng);
                    twin.pressure = row.pressure + row.pressure_sd * normal(&mut rng);
                    twin
                })
                .collect();
            let refit = fit(&twin, candidates, chosen, base);
            largest(&project(&refit.rest), false)
        })
        .collect();
    let mut order = twins.clone();
    order.sort_by(f64::total_cmp);
    let critical = order[(0.97 * order.len() as f64) as usize % order.len()];
    Looked {
        size: (0..candidates.len())
            .map(|c| free[c].dot(&now.rest) / free[c].norm_squared().max(1e-300))
            .collect(),
        error: free.iter().map(|f| 1.0 / f.norm().max(1e-300)).collect(),
        by_session: candidates.iter().map(|c| c.by_session).collect(),
        t,
        left,
        free,
        twins,
        permuted,
        permuted_sessions,
        critical,
    }
}
