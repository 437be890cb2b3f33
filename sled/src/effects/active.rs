//! The effects that a model switches on.

use std::collections::BTreeMap;

use kufe_friction::effects::{Expression, ExpressionError};

use super::custom::{COLUMNS, Channel, Custom};
use super::{CATALOGUE, Effect, Forces, Measured, Parameter, State, find};

/// What is wrong with an `[effects.NAME]` table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// The name is neither in the catalogue nor an expression.
    #[error(
        "[effects.{name}]: unknown effect; expected one of {known}, or a table with `expression`"
    )]
    UnknownEffect {
        /// The name found.
        name: String,
        /// All names.
        known: String,
    },
    /// A key that the effect does not have.
    #[error("[effects.{name}]: unknown key `{key}`; expected {expected}")]
    UnknownKey {
        /// The effect.
        name: String,
        /// The key found.
        key: String,
        /// The keys it has.
        expected: String,
    },
    /// A value of the wrong type or out of bounds.
    #[error("[effects.{name}]: `{key}` = {found}; expected {expected}")]
    Value {
        /// The effect.
        name: String,
        /// The key.
        key: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: String,
    },
    /// The expression cannot be read.
    #[error("[effects.{name}]: `expression` {source}")]
    Expression {
        /// The effect.
        name: String,
        /// Where it stops making sense.
        source: ExpressionError,
    },
}

/// What kind of effect is active.
#[derive(Clone)]
pub enum Kind {
    /// From the catalogue.
    Catalogue(&'static dyn Effect),
    /// A person's own.
    Custom(Custom),
}

/// One effect with its parameters.
#[derive(Clone)]
pub struct Active {
    /// The table's name; what follows an `@` tells several of one effect apart.
    pub name: String,
    /// What it does.
    pub kind: Kind,
    /// Parameters in the effect's order; the amplitude alone for an effect of one's own.
    pub values: Vec<f64>,
    /// The only track on which it acts; everywhere where absent.
    pub track: Option<String>,
}

/// All active effects, in the order of their names.
#[derive(Clone, Default)]
pub struct Effects {
    /// The effects.
    pub active: Vec<Active>,
}

impl Active {
    /// The effect's name without what follows an `@`.
    pub fn effect_name(&self) -> &str {
        self.name.split('@').next().unwrap_or(&self.name)
    }

    fn acts_on(&self, track: &str) -> bool {
        self.track.as_deref().is_none_or(|only| only == track)
    }
}

impl Effects {
    /// Reads the tables under `[effects]`.
    ///
    /// # Errors
    /// [`EffectError`] with the effect, the key, what was found and what was expected.
    ///
    /// ```
    /// let text = "[effects.temperature-grip]\nslope_per_k = -0.01";
    /// let table: toml::Table = text.parse().unwrap();
    /// let tables = table["effects"].as_table().unwrap();
    /// let tables = tables.iter().map(|(k, v)| (k.clone(), v.as_table().unwrap().clone())).collect();
    /// let effects = kufe_sled::effects::Effects::from_tables(&tables).unwrap();
    /// assert_eq!(effects.active[0].values, [-0.01, -5.0]);
    /// ```
    pub fn from_tables(tables: &BTreeMap<String, toml::Table>) -> Result<Self, EffectError> {
        let active = tables
            .iter()
            .map(|(name, table)| read_one(name, table))
            .collect::<Result<_, _>>()?;
        Ok(Self { active })
    }

    /// Whether nothing is switched on.
    pub fn is_empty(&self) -> bool {
        self.active.is_empty()
    }

    /// From what the sensors say to what is true.
    pub fn correct(&self, measured: &mut Measured) {
        for effect in &self.active {
            if let Kind::Catalogue(kind) = &effect.kind {
                kind.correct(&effect.values, measured);
            }
        }
    }

    /// From what is true to what the sensors say.
    pub fn disturb(&self, measured: &mut Measured) {
        for effect in self.active.iter().rev() {
            if let Kind::Catalogue(kind) = &effect.kind {
                kind.disturb(&effect.values, measured);
            }
        }
    }

    /// Changes the forces of the base law.
    pub fn act(&self, track: &str, at: &State, forces: &mut Forces) {
        for effect in &self.active {
            if effect.acts_on(track) {
                match &effect.kind {
                    Kind::Catalogue(kind) => kind.act(&effect.values, at, forces),
                    Kind::Custom(custom) => custom.act(effect.values[0], at, forces),
                }
            }
        }
    }

    /// What is added to the track's slope at `s` [m], downhill positive [rad].
    pub fn slope(&self, track: &str, s: f64) -> f64 {
        self.active
            .iter()
            .filter(|effect| effect.acts_on(track))
            .map(|effect| match &effect.kind {
                Kind::Catalogue(kind) => kind.slope(&effect.values, s),
                Kind::Custom(_) => 0.0,
            })
            .sum()
    }
}

fn read_one(name: &str, table: &toml::Table) -> Result<Active, EffectError> {
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
    let expression = Expression::parse(&text).map_err(|source| EffectError::Expression {
        name: name.to_owned(),
        source,
    })?;
    if let Some(unknown) = expression
        .names()
        .iter()
        .find(|n| !COLUMNS.contains(&n.as_str()))
    {
        return Err(EffectError::Value {
            name: name.to_owned(),
            key: "expression".to_owned(),
            found: format!("the column {unknown}"),
            expected: COLUMNS.join(", "),
        });
    }
    let expected = "\"longitudinal\", \"lateral\", \"friction\" or \"grip\"";
    let channel = match table.get("channel").and_then(toml::Value::as_str) {
        Some("longitudinal") => Channel::Longitudinal,
        Some("lateral") => Channel::Lateral,
        Some("friction") => Channel::Friction,
        Some("grip") => Channel::Grip,
        _ => {
            let absent = toml::Value::String("absent".to_owned());
            let found = table.get("channel").unwrap_or(&absent);
            return Err(wrong(name, "channel", found, expected.to_owned()));
        }
    };
    let low = number(name, table, "low", -1e12, -1e12, 1e12)?;
    let high = number(name, table, "high", 1e12, low, 1e12)?;
    let value = number(name, table, "value", 0.0, low, high)?;
    let unit = match table.get("unit") {
        None => String::new(),
        Some(toml::Value::String(unit)) => unit.clone(),
        Some(other) => return Err(wrong(name, "unit", other, "a unit in quotes".to_owned())),
    };
    Ok(Active {
        name: name.to_owned(),
        kind: Kind::Custom(Custom {
            channel,
            expression,
            text,
            unit,
            low,
            high,
        }),
        values: vec![value],
        track,
    })
}
