//! The score at half and at twice each chosen constant of a search.

use std::path::Path;

use toml::Value;

use crate::cases::answer::CaseError;
use crate::cases::catalogue::{Spec, all};
use crate::score::outcome::Outcome;
use crate::score::run::{Options, score};

/// Seed of the cases, outside the range of the full table.
const SEED: u64 = 911;

/// Cheap cases of each kind of data: nulls, and effects that are well seen, hardly seen and hard to
/// tell apart.
const RUNS: [&str; 9] = [
    "null/ar1",
    "null/unstated-noise",
    "longitudinal/temperature@0.02",
    "longitudinal/track-profile@0.06",
    "lateral/wall-contact@0.06",
    "fault/slip-offset@0.007",
    "twin/slope~accelerometer-tilt@0.02",
    "clean-effect/wall-contact-by-run",
    "delays-effect/drag-area@10",
];
/// Laws outside the catalogue: nothing, of a column that the model has no name for, of a product, of
/// a sensor.
const LAWS: [&str; 4] = [
    "clean-null/none",
    "beyond/pitch_rate@0.06",
    "beyond/v_mps*gamma_rad@0.06",
    "clean-effect/yaw-rate-saturates",
];
const EXPERIMENTS: [&str; 6] = [
    "null/seven-points",
    "null/experiments",
    "experiment/temperature@0.5",
    "experiment/humidity@1.5",
    "experiment/load@1.5",
    "experiment/wear@4",
];
const MAPS: [&str; 2] = ["null/pressures", "pressure/sensor-gain"];

/// The chosen constants that decide on selections, by the kind of data that they act on. Those that
/// only size what is shown, and what else of the lock is chosen, are left out.
const RUN_KEYS: [&str; 41] = [
    "lock.every",
    "search.superfluous_t",
    "search.beyond_scatter",
    "search.clear",
    "search.material",
    "runs.alpha",
    "runs.alpha_levels",
    "runs.alpha_column",
    "runs.alpha_track",
    "runs.alpha_again",
    "runs.least_left",
    "runs.least_left_installed",
    "runs.least_signal",
    "runs.window_competes",
    "runs.rivals.needed_t",
    "runs.rivals.needed_t_few",
    "runs.rivals.least_gain",
    "runs.level_rivals.needed_t",
    "runs.level_rivals.least_gain",
    "runs.track_rivals.needed_t",
    "runs.track_agrees",
    "runs.slope_sd_rad",
    "runs.window_m",
    "runs.track_bin_m",
    "runs.noise_piece_s",
    "runs.explains_alone",
    "runs.explains_beyond",
    "runs.recordings.signal_cutoff_hz",
    "runs.recordings.row_cutoff_hz",
    "runs.recordings.quietest_axis",
    "runs.contacts.differs",
    "runs.contacts.together",
    "runs.contacts.ends",
    "runs.contacts.most",
    "runs.contacts.alpha",
    "runs.contacts.met_by_chance",
    "runs.contacts.most_of_a_row",
    "runs.contacts.inside",
    "runs.contacts.over",
    "runs.belief",
    "runs.discrepancy_m",
];
const LAW_KEYS: [&str; 4] = [
    "runs.laws.number",
    "runs.laws.alike",
    "runs.laws.as_good",
    "runs.laws.tried",
];
const EXPERIMENT_KEYS: [&str; 4] = [
    "experiments.alpha",
    "experiments.least_left",
    "experiments.near_largest",
    "experiments.rivals.needed_t",
];
const MAP_KEYS: [&str; 10] = [
    "maps.least_drop",
    "maps.least_share",
    "maps.rivals.needed_t",
    "maps.unclean",
    "maps.searching_cells",
    "maps.independent_pixels",
    "maps.pixel_place",
    "maps.film_shift_m",
    "maps.film_rotation_rad",
    "maps.solves",
];

/// What a search scores with one constant moved.
#[derive(Debug, Clone)]
pub struct Row {
    /// The constant, as a dotted key; empty for the rules as they are.
    pub key: String,
    /// Its value.
    pub value: f64,
    /// Kind of data.
    pub kind: &'static str,
    /// Cases.
    pub cases: usize,
    /// Claims where nothing was hidden, or of something else than what was.
    pub false_claims: usize,
    /// Hidden effects named themselves or in the class that is named.
    pub in_class: usize,
    /// Hidden effects.
    pub hidden: usize,
    /// Mean size of the classes that hold the hidden effect.
    pub class_size: f64,
    /// Searches that gave no report.
    pub failures: usize,
}

/// Scores the rules as they are, and with each chosen constant at half and at twice its value;
/// `rules` is their TOML text, `only` holds words of which a constant's key must hold one, where
/// there are any.
///
/// # Errors
/// [`CaseError`] where a constant is not among the rules, or files cannot be written.
pub fn constants(
    rules: &str,
    only: &[String],
    options: &Options,
    done: &(dyn Fn(&Row) + Sync),
) -> Result<Vec<Row>, CaseError> {
    let defaults: toml::Table = rules
        .parse()
        .map_err(|error| CaseError::Unknown(format!("rules: {error}")))?;
    let folder = tempfile::tempdir().map_err(|source| CaseError::File {
        path: "temporary folder".into(),
        source,
    })?;
    let file = folder.path().join("rules.toml");
    let mut rows = Vec::new();
    for (kind, cases, keys) in [
        ("runs", &RUNS[..], &RUN_KEYS[..]),
        ("laws", &LAWS, &LAW_KEYS),
        ("experiments", &EXPERIMENTS, &EXPERIMENT_KEYS),
        ("maps", &MAPS, &MAP_KEYS),
    ] {
        let specs: Vec<Spec> = all()
            .into_iter()
            .filter(|spec| cases.iter().any(|id| *id == spec.id()))
            .collect();
        let is_selected =
            |key: &&&str| only.is_empty() || only.iter().any(|word| key.contains(word));
        let keys: Vec<&&str> = keys.iter().filter(is_selected).collect();
        if keys.is_empty() {
            continue;
        }
        let mut tried: Vec<(String, f64)> = vec![(String::new(), 1.0)];
        for key in keys {
            let value = read(&defaults, key)?;
            tried.extend([0.5, 2.0].map(|factor| ((*key).to_owned(), factor * value)));
        }
        for (key, value) in tried {
            let mut moved = defaults.clone();
            if !key.is_empty() {
                write(&mut moved, &key, value);
            }
            save(&file, &moved)?;
            let options = Options {
                first_seed: SEED,
                seeds: 1,
                rules: Some(file.clone()),
                ..options.clone()
            };
            let row = summed(key, value, kind, &score(&specs, &options, &|_| {})?);
            done(&row);
            rows.push(row);
        }
    }
    Ok(rows)
}

/// The rows as a Markdown table.
pub fn markdown(rows: &[Row]) -> String {
    let mut out = String::from(
        "| data | constant | value | false claims | in class | mean class | no report |\n|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let (key, value) = match row.key.as_str() {
            "" => ("as it is".to_owned(), String::new()),
            key => (format!("`{key}`"), format!("{:.3e}", row.value)),
        };
        out += &format!(
            "| {} | {key} | {value} | {} of {} | {} of {} | {:.2} | {} |\n",
            row.kind,
            row.false_claims,
            row.cases,
            row.in_class,
            row.hidden,
            row.class_size,
            row.failures
        );
    }
    out
}

fn summed(key: String, value: f64, kind: &'static str, outcomes: &[Outcome]) -> Row {
    let found: Vec<_> = outcomes.iter().flat_map(|o| &o.found).collect();
    let sizes: Vec<usize> = found
        .iter()
        .filter(|f| f.in_class)
        .filter_map(|f| f.class_size)
        .collect();
    Row {
        key,
        value,
        kind,
        cases: outcomes.len(),
        false_claims: outcomes.iter().filter(|o| o.false_claim).count(),
        in_class: found.iter().filter(|f| f.in_class).count(),
        hidden: found.len(),
        class_size: sizes.iter().sum::<usize>() as f64 / sizes.len().max(1) as f64,
        failures: outcomes.iter().filter(|o| o.failure.is_some()).count(),
    }
}

fn save(path: &Path, rules: &toml::Table) -> Result<(), CaseError> {
    std::fs::write(path, rules.to_string()).map_err(|source| CaseError::File {
        path: path.display().to_string(),
        source,
    })
}

/// The number at a dotted key.
fn read(rules: &toml::Table, key: &str) -> Result<f64, CaseError> {
    let unknown = || CaseError::Unknown(format!("rule {key}"));
    let mut parts = key.split('.');
    let mut value = rules
        .get(parts.next().unwrap_or_default())
        .ok_or_else(unknown)?;
    for part in parts {
        value = value.get(part).ok_or_else(unknown)?;
    }
    let whole = value.as_integer().map(|whole| whole as f64);
    value.as_float().or(whole).ok_or_else(unknown)
}

/// Puts a number at a dotted key that [`read`] has found, rounded where the present one is an integer.
fn write(rules: &mut toml::Table, key: &str, number: f64) {
    let Some((first, rest)) = key.split_once('.') else {
        let number = match rules.get(key) {
            Some(Value::Integer(_)) => Value::Integer(number.round() as i64),
            _ => Value::Float(number),
        };
        rules.insert(key.to_owned(), number);
        return;
    };
    if let Some(Value::Table(inner)) = rules.get_mut(first) {
        write(inner, rest, number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_is_read_and_moved_by_its_dotted_key() -> Result<(), CaseError> {
        let mut rules: toml::Table =
            "[runs]\nalpha = 0.005\nnear = 3\n[runs.rivals]\nneeded_t = 2.0\n"
                .parse()
                .expect("TOML");
        assert_eq!(read(&rules, "runs.rivals.needed_t")?, 2.0);
        write(&mut rules, "runs.rivals.needed_t", 4.0);
        assert_eq!(read(&rules, "runs.rivals.needed_t")?, 4.0);
        assert_eq!(read(&rules, "runs.alpha")?, 0.005);
        write(&mut rules, "runs.near", 1.5);
        assert_eq!(rules["runs"]["near"], Value::Integer(2));
        assert!(read(&rules, "runs.gamma").is_err());
        Ok(())
    }
}
