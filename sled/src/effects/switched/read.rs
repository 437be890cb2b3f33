//! From a table `[effects.NAME]` to an active effect.

use crate::effects::catalogue::{CATALOGUE, find};
use crate::effects::known::Parameter;
use crate::effects::switched::active::{Active, Kind};
use crate::effects::switched::channel::Channel;
use crate::effects::switched::custom::{Custom, Refused};
use crate::effects::switched::error::EffectError;

/// One table under `[effects]`.
pub(super) fn read_one(name: &str, table: &toml::Table) -> Result<Active, EffectError> {
    let track = match table.get("track") {
        None => None,
        Some(toml::Value::String(track)) => Some(track.clone()),
        Some(other) => {
            return Err(wrong(
                name,
                "track",
                other,
                "the name of a track".to_owned(),
            ));
        }
    };
    let bare = name.split('@').next().unwrap_or(name);
    if table.contains_key("expression") {
        return read_custom(name, table, track);
    }
    let Some(effect) = find(bare) else {
        let known: Vec<&str> = CATALOGUE.iter().map(|e| e.info().name).collect();
        return Err(EffectError::UnknownEffect {
            name: name.to_owned(),
            known: known.join(", "),
        });
    };
    let parameters = effect.info().parameters;
    for key in table.keys() {
        if key != "track" && !parameters.iter().any(|p| p.name == key) {
            let names: Vec<&str> = parameters.iter().map(|p| p.name).collect();
            return Err(EffectError::UnknownKey {
                name: name.to_owned(),
                key: key.clone(),
                expected: format!("{}, track", names.join(", ")),
            });
        }
    }
    let values = parameters
        .iter()
        .map(|parameter| read_parameter(name, table, parameter))
        .collect::<Result<_, _>>()?;
    Ok(Active {
        name: name.to_owned(),
        kind: Kind::Catalogue(effect),
        values,
        track,
    })
}

fn read_parameter(name: &str, table: &toml::Table, p: &Parameter) -> Result<f64, EffectError> {
    number(name, table, p.name, p.default, p.low, p.high)
}

fn number(
    name: &str,
    table: &toml::Table,
    key: &str,
    default: f64,
    low: f64,
    high: f64,
) -> Result<f64, EffectError> {
    let Some(found) = table.get(key) else {
        return Ok(default);
    };
    let value = match found {
        toml::Value::Float(value) => *value,
        toml::Value::Integer(value) => *value as f64,
        _ => f64::NAN,
    };
    if value >= low && value <= high {
        Ok(value)
    } else {
        Err(wrong(
            name,
            key,
            found,
            format!("a number from {low} to {high}"),
        ))
    }
}

fn wrong(name: &str, key: &str, found: &toml::Value, expected: String) -> EffectError {
    EffectError::Value {
        name: name.to_owned(),
        key: key.to_owned(),
        found: found.to_string(),
        expected,
    }
}

fn read_custom(
    name: &str,
    table: &toml::Table,
    track: Option<String>,
) -> Result<Active, EffectError> {
    const KEYS: [&str; 7] = [
        "expression",
        "channel",
        "unit",
        "value",
        "low",
        "high",
        "track",
    ];
    if let Some(key) = table.keys().find(|key| !KEYS.contains(&key.as_str())) {
        return Err(EffectError::UnknownKey {
            name: name.to_owned(),
            key: key.clone(),
            expected: KEYS.join(", "),
        });
    }
    let text = match &table["expression"] {
        toml::Value::String(text) => text.clone(),
        other => {
            return Err(wrong(
                name,
                "expression",
                other,
                "a formula in quotes".to_owned(),
            ));
        }
    };
    let channel = table.get("channel").and_then(toml::Value::as_str);
    let Some(channel) = channel.and_then(Channel::named) else {
        let absent = toml::Value::String("absent".to_owned());
        let found = table.get("channel").unwrap_or(&absent);
        return Err(wrong(name, "channel", found, Channel::expected()));
    };
    let custom = Custom::read(channel, &text, None).map_err(|refused| match refused {
        Refused::Unreadable(source) => EffectError::Expression {
            name: name.to_owned(),
            source,
        },
        Refused::UnknownColumn { column, known } => EffectError::Value {
            name: name.to_owned(),
            key: "expression".to_owned(),
            found: format!("the column {column}"),
            expected: known.join(", "),
        },
    })?;
    let low = number(name, table, "low", -1e12, -1e12, 1e12)?;
    let high = number(name, table, "high", 1e12, low, 1e12)?;
    let value = number(name, table, "value", 0.0, low, high)?;
    let unit = match table.get("unit") {
        None => String::new(),
        Some(toml::Value::String(unit)) => unit.clone(),
        Some(other) => return Err(wrong(name, "unit", other, "a unit in quotes".to_owned())),
    };
    let custom = custom.bounded(&unit, low, high);
    Ok(Active {
        name: name.to_owned(),
        kind: Kind::Custom(custom),
        values: vec![value],
        track,
    })
}
