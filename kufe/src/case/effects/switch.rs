//! A case's `[effects]` tables, read and acting on its problem.

use std::collections::BTreeMap;

use kufe_contact::Problem;

use crate::case::CaseError;
use crate::case::effects::catalogue::{CATALOGUE, find};

/// Changes a problem by the effects of a case's `[effects]` tables; those of the sensor leave it as it is.
///
/// # Errors
/// [`CaseError::Effect`] with the effect, what was found and what was expected.
pub(crate) fn switch_on(
    tables: &BTreeMap<String, toml::Table>,
    problem: &mut Problem,
) -> Result<(), CaseError> {
    for (name, table) in tables {
        let told = |found: String, expected: String| CaseError::Effect {
            name: name.clone(),
            found,
            expected,
        };
        let Some(effect) = find(name) else {
            let known: Vec<&str> = CATALOGUE.iter().map(|e| e.info.name).collect();
            return Err(told("an unknown effect".to_owned(), known.join(", ")));
        };
        let p = effect.parameter();
        if let Some(key) = table.keys().find(|key| *key != p.name) {
            return Err(told(format!("the key `{key}`"), format!("`{}`", p.name)));
        }
        let value = match table.get(p.name) {
            None => 0.0,
            Some(toml::Value::Float(value)) => *value,
            Some(toml::Value::Integer(value)) => *value as f64,
            Some(_) => f64::NAN,
        };
        if !(value >= p.low && value <= p.high) {
            let found = table.get(p.name).map_or(String::new(), ToString::to_string);
            return Err(told(
                format!("`{}` = {found}", p.name),
                format!("a number from {} to {} {}", p.low, p.high, p.unit),
            ));
        }
        effect.alter(value, problem);
    }
    Ok(())
}
