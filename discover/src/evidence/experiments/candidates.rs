//! Candidates: catalogue effects, custom effects, linear and quadratic laws of further columns.

use std::sync::Arc;

use kufe_sled::effects::{CATALOGUE, Custom, Effect, Effects, Experiments, Info, Kind};
use rayon::prelude::*;

use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::rows::{ORDER, Row, Untestable, further_columns};
use crate::input::table::Table;
use crate::null::clusters::members;
use crate::procedure::candidate::Candidate;

/// Change of mu of a row, given mu without the effect and the size in units of `typical`.
type Change = Arc<dyn Fn(&Row, f64, f64) -> f64 + Send + Sync>;

/// How a candidate changes the coefficient of friction.
#[derive(Clone)]
pub struct FrictionChange {
    of: Change,
    /// The effect's table without its size; `None` if simulations do not have its column.
    pub table: Option<toml::Table>,
    /// The formula of a law of a column.
    pub law: Option<String>,
    /// Columns that it depends on.
    pub columns: Vec<String>,
    /// Whether most of its variance is between sessions.
    pub by_session: bool,
}

impl Candidate<FrictionChange> {
    /// Change of mu of a row at a size in units of `typical`; `mu` excludes the candidate.
    pub fn change(&self, row: &Row, mu: f64, size: f64) -> f64 {
        (self.act.of)(row, mu, size)
    }

    /// Derivative of the change with respect to the size.
    pub fn slope(&self, row: &Row, mu: f64, size: f64) -> f64 {
        const STEP: f64 = 0.01;
        (self.change(row, mu, size + STEP) - self.change(row, mu, size)) / STEP
    }
}

/// Testable candidates, and the names of untestable effects with the reason.
pub type CandidateList = (Vec<Candidate<FrictionChange>>, Untestable);

/// Lists the candidates except for the effects that the model contains.
pub fn list(rows: &[Row], table: &Table, model: &Effects, base: Base) -> CandidateList {
    let mut candidates = Vec::new();
    let mut untestable = Vec::new();
    let on = |name: &str| {
        let mut active = model.active.iter();
        active.any(|a| a.effect_name() == name && a.is_on())
    };
    for effect in CATALOGUE.iter().filter(|e| e.on_friction.is_some()) {
        let info = effect.info();
        if on(info.name) {
            continue;
        }
        match untestable_reason(info, table, base) {
            Some(reason) => untestable.push((info.name.to_owned(), reason)),
            None if info.experiments == Experiments::OverFilm => {
                candidates.extend(of_film(effect, rows));
            }
            None => candidates.extend(of_catalogue(effect)),
        }
    }
    for active in &model.active {
        let Kind::Custom(custom) = &active.kind else {
            continue;
        };
        if !custom.acts_on_friction() || active.is_on() {
            continue;
        }
        let names = custom.names();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        if are_testable(table, &names) {
            candidates.push(own(&active.name, custom, rows));
        } else {
            untestable.push((active.name.clone(), missing(&names)));
        }
    }
    for (name, values) in further_columns(rows) {
        let mut laws = of_column(name, &values);
        laws.truncate(if name == ORDER { 1 } else { 2 });
        candidates.extend(laws.into_iter().filter(|c| !on(&c.effect)));
    }
    mark_sessions(rows, &mut candidates);
    (candidates, untestable)
}

/// Why an effect of the catalogue cannot be tested; `None` if it can.
fn untestable_reason(info: &Info, table: &Table, base: Base) -> Option<String> {
    let needed = match info.needs_in_experiments() {
        Ok(needed) => needed,
        Err(reason) => return Some(reason.to_owned()),
    };
    let mut needed: Vec<&str> = needed.iter().map(|column| column.name()).collect();
    if info.experiments != Experiments::OverFilm {
        needed.retain(|column| !table.varies(column));
        return (!needed.is_empty()).then(|| missing(&needed));
    }
    if base != Base::Film {
        let reason = "needs friction.longitudinal.film = true: it changes the melt film";
        return Some(reason.to_owned());
    }
    (!are_testable(table, &needed)).then(|| missing(&needed))
}

/// Whether all of these columns are present and one of them varies.
fn are_testable(table: &Table, columns: &[&str]) -> bool {
    let mut all = columns.iter();
    all.all(|c| table.place(c).is_some()) && columns.iter().any(|c| table.varies(c))
}

fn missing(columns: &[&str]) -> String {
    let columns = columns.join(", ");
    format!("needs {columns}, which is absent or does not vary")
}

fn of_catalogue(effect: &'static Effect) -> Option<Candidate<FrictionChange>> {
    let info = effect.info();
    let index = info.parameters.iter().position(|p| p.is_amplitude())?;
    let p = &info.parameters[index];
    let needed = info.needs_in_experiments().unwrap_or_default();
    let act = FrictionChange {
        of: Arc::new(move |row, mu, size| {
            let mut values = info.off();
            values[index] = size * p.typical;
            effect.coefficient(&values, mu, &row.conditions) - mu
        }),
        table: Some(toml::Table::new()),
        law: None,
        columns: needed.iter().map(|c| c.name().to_owned()).collect(),
        by_session: false,
    };
    Some(Candidate::of_catalogue(info, p, act))
}

/// An effect on the melt film. Solving the film in every fit is too slow: its factor on mu is
/// solved at some sizes of each row, denser towards 0, and interpolated linearly.
fn of_film(effect: &'static Effect, rows: &[Row]) -> Option<Candidate<FrictionChange>> {
    /// Sizes in addition to 0. With 64 the relative error of the interpolated mu is below 1e-3.
    const SIZES: usize = 64;
    let mut candidate = of_catalogue(effect)?;
    let most = candidate.high / candidate.typical;
    let size = move |k: usize| most * (k as f64 / SIZES as f64).powi(2);
    let solved = |row: &Row| -> Vec<f64> {
        let excess = |k| candidate.change(row, 1.0, size(k));
        (0..=SIZES).map(excess).collect()
    };
    let tables: Vec<Vec<f64>> = rows.par_iter().map(solved).collect();
    candidate.act.of = Arc::new(move |row, mu, at| {
        // A simulated row has the order number of its original.
        let table = &tables[row.columns[ORDER] as usize];
        let k = ((at.max(0.0) / most).sqrt() * SIZES as f64) as usize;
        let k = k.min(SIZES - 1);
        let share = (at - size(k)) / (size(k + 1) - size(k));
        mu * (table[k] + share * (table[k + 1] - table[k]))
    });
    Some(candidate)
}

/// A custom law of friction within bounds, as the table of a model.
fn custom_table(expression: &str, [low, high]: [f64; 2]) -> toml::Table {
    let entry = |key: &str, value: toml::Value| (key.to_owned(), value);
    toml::Table::from_iter([
        entry("expression", expression.into()),
        entry("channel", "friction".into()),
        entry("low", low.into()),
        entry("high", high.into()),
    ])
}

/// A custom effect that `model.toml` proposes with `value = 0`.
fn own(name: &str, custom: &Custom, rows: &[Row]) -> Candidate<FrictionChange> {
    let custom = custom.clone();
    let columns = custom.names().iter().map(ToString::to_string).collect();
    let squares = rows
        .iter()
        .map(|row| custom.coefficient(1.0, &row.conditions).powi(2));
    let size = (squares.sum::<f64>() / rows.len() as f64).sqrt();
    let typical = if size > 0.0 { 1e-4 / size } else { 1.0 };
    let mut table = custom_table(&custom.text, [custom.low, custom.high]);
    table.insert("unit".to_owned(), custom.unit.clone().into());
    Candidate {
        effect: name.to_owned(),
        key: "value".to_owned(),
        unit: custom.unit.clone(),
        low: custom.low,
        high: custom.high,
        typical,
        decides: format!("rows in which {} is varied alone", custom.text),
        act: FrictionChange {
            of: Arc::new(move |row, _, size| custom.coefficient(size * typical, &row.conditions)),
            table: Some(table),
            law: None,
            columns,
            by_session: false,
        },
    }
}

/// Laws of a column: z, the standardised column, and the parabola `z^2 - s z - 1`, which is
/// uncorrelated with z if s is the mean of z^3.
fn of_column(name: &str, values: &[f64]) -> Vec<Candidate<FrictionChange>> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let sd = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    if sd <= 1e-9 * mean.abs() || sd == 0.0 {
        return Vec::new();
    }
    let cubes = values.iter().map(|x| ((x - mean) / sd).powi(3));
    let skew = cubes.sum::<f64>() / n;
    let law = |effect: String, unit: String, expression: &str, shape: fn(f64, f64) -> f64| {
        let column = name.to_owned();
        Candidate {
            effect: format!("unknown:{effect}"),
            key: "value".to_owned(),
            unit,
            low: -1.0,
            high: 1.0,
            typical: 1e-4,
            decides: format!("rows in which {name} is varied alone"),
            act: FrictionChange {
                of: Arc::new(move |row, _, size| {
                    let z = (row.columns.get(&column).copied().unwrap_or(mean) - mean) / sd;
                    1e-4 * size * shape(z, skew)
                }),
                // Simulations have only the columns of expressions.
                table: kufe_sled::effects::is_column(name)
                    .then(|| custom_table(expression, [-1.0, 1.0])),
                law: Some(expression.to_owned()),
                columns: vec![name.to_owned()],
                by_session: false,
            },
        }
    };
    let z = format!("({name} - ({mean:?})) / {sd:?}");
    let unit = format!("for {sd:.4} of {name}");
    let mut laws = vec![law(name.to_owned(), unit, &z, |z, _| z)];
    // With fewer than three distinct values a parabola is not determined.
    let mut distinct = values.to_vec();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    if distinct.len() >= 3 {
        let effect = format!("{name}*{name}");
        let unit = format!("for ({sd:.4})^2 of {name}");
        let parabola = format!("({z})^2 - ({skew:?}) * ({z}) - 1");
        laws.push(law(effect, unit, &parabola, |z, skew| {
            z * z - skew * z - 1.0
        }));
    }
    laws
}

/// Candidates of which most of the variance is between sessions are tested by permuting sessions.
fn mark_sessions(rows: &[Row], candidates: &mut [Candidate<FrictionChange>]) {
    let sessions = members(rows.iter().map(|row| row.session.as_str()));
    if sessions.len() == rows.len() {
        return;
    }
    for candidate in candidates {
        let slopes = rows.iter().map(|row| candidate.slope(row, 0.004, 0.0));
        let slopes: Vec<f64> = slopes.collect();
        let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
        let all: f64 = slopes.iter().map(|x| (x - mean).powi(2)).sum();
        let between = sessions.values().map(|own| {
            let sum: f64 = own.iter().map(|i| slopes[*i] - mean).sum();
            sum * sum / own.len() as f64
        });
        candidate.act.by_session = between.sum::<f64>() > 0.5 * all;
    }
}

#[cfg(test)]
mod tests {
    use kufe_sled::effects::find;

    use super::*;

    #[test]
    fn the_interpolated_film_is_that_of_a_solve() {
        let text = "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd,fz_n,v_mps,ice_c,contact_length_m,contact_width_m,roughness_m\n\
                    a,1e7,0,4e-3,1e-4,950,1.0,-12,0.06,0.9e-3,0.3e-6\n\
                    b,1e7,0,4e-3,1e-4,500,5.0,-5,0.04,0.8e-3,0.5e-6\n\
                    c,1e7,0,4e-3,1e-4,900,25.0,-2,0.07,1.1e-3,1.0e-6\n";
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("experiments.csv");
        std::fs::write(&path, text).unwrap();
        let table = Table::read(&path).unwrap();
        let rows = crate::evidence::experiments::rows::read(&table, 0.0)
            .unwrap()
            .0;
        let effect = find("boundary").unwrap();
        let (exact, tabled) = (
            of_catalogue(effect).unwrap(),
            of_film(effect, &rows).unwrap(),
        );
        for row in &rows {
            for size in [0.0, 0.07, 1.3, 6.0, 21.0, 90.0] {
                let [exact, tabled] = [&exact, &tabled].map(|c| 1.0 + c.change(row, 1.0, size));
                assert!(
                    (tabled / exact - 1.0).abs() < 1e-3,
                    "{size}: {tabled} {exact}"
                );
            }
        }
    }
}
