//! The effects that a model switches on: read from its tables, checked, and acting one after the other.

use std::collections::BTreeMap;

use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use crate::effects::Parameter;
use crate::effects::catalogue::{CATALOGUE, find};
use crate::effects::custom::{Channel, Custom, Refused};
use crate::effects::expression::ExpressionError;
use crate::effects::{Conditions, Constants, Forces, SENSORS, Sensor, Signals, State};
use crate::effects::{Effect, Reading};

/// All active effects, in the order of their names.
#[derive(Clone, Debug, Default)]
pub struct Effects {
    /// The effects.
    pub active: Vec<Active>,
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

    /// Those that act on this track, freed of its name.
    pub fn on_track(&self, track: &str) -> Self {
        let own = self.active.iter().filter(|effect| effect.acts_on(track));
        let free = |effect: &Active| Active {
            track: None,
            ..effect.clone()
        };
        Self {
            active: own.map(free).collect(),
        }
    }

    /// Refuses effects that need a column which `available` lacks; an effect whose amplitudes are 0 needs none.
    ///
    /// # Errors
    /// [`EffectError::MissingColumn`] with the effect, the column and what there is.
    ///
    /// ```
    /// use kufe_sled::effects::{Active, Effects, Kind, find};
    /// let humidity = Active {
    ///     name: "humidity".to_owned(),
    ///     kind: Kind::Catalogue(find("humidity").unwrap()),
    ///     values: vec![0.01, 70.0],
    ///     track: None,
    /// };
    /// let effects = Effects { active: vec![humidity] };
    /// assert!(effects.check_columns(&["v_mps", "humidity_pct"]).is_ok());
    /// let message = effects.check_columns(&["v_mps"]).unwrap_err().to_string();
    /// assert!(message.contains("[effects.humidity]") && message.contains("humidity_pct"));
    /// ```
    pub fn check_columns(&self, available: &[&str]) -> Result<(), EffectError> {
        for effect in self.active.iter().filter(|effect| effect.is_on()) {
            let mut needed = effect.columns().into_iter();
            if let Some(column) = needed.find(|column| !available.contains(column)) {
                return Err(EffectError::MissingColumn {
                    name: effect.name.clone(),
                    column: column.to_owned(),
                    found: available.join(", "),
                });
            }
        }
        Ok(())
    }

    /// How late each sensor is [s], in the order of [`Sensor::ALL`](crate::effects::Sensor::ALL).
    ///
    /// A delay belongs to a whole series: who has one reads it [`ahead`](crate::effects::ahead) by so much, and corrects its instants by
    /// [`Effects::in_time`].
    pub fn delays(&self) -> [f64; SENSORS] {
        let mut delays = [0.0; SENSORS];
        for effect in &self.active {
            for (sum, delay) in delays.iter_mut().zip(effect.delays()) {
                *sum += delay;
            }
        }
        delays
    }

    /// The distance after which forces follow the slip [m], where there is one.
    pub fn relaxation(&self) -> Option<f64> {
        let distance: f64 = self.active.iter().map(Active::relaxation).sum();
        (distance > 0.0).then_some(distance)
    }

    /// The same effects with every sensor in time.
    pub fn in_time(self) -> Self {
        Self {
            active: self.active.into_iter().map(Active::in_time).collect(),
        }
    }

    /// From what the sensors say to what is true, and from the stated constants of the sled to the true ones.
    ///
    /// `at` states time, place and weather, for expressions that ask for them.
    pub fn correct(&self, at: &Conditions, signals: &mut Signals) {
        for effect in &self.active {
            effect.correct(at, signals);
        }
    }

    /// From what is true to what the sensors say.
    pub fn disturb(&self, at: &Conditions, signals: &mut Signals) {
        for effect in self.active.iter().rev() {
            effect.disturb(at, signals);
        }
    }

    /// From the stated constants of the sled to the true ones.
    pub fn find_constants(&self, sled: &mut Constants) {
        for effect in &self.active {
            if let Kind::Catalogue(kind) = &effect.kind {
                kind.find_constants(&effect.values, sled);
            }
        }
    }

    /// Changes the forces of the base law.
    pub fn act(&self, track: &str, at: &State, forces: &mut Forces) {
        for effect in self.active.iter().filter(|effect| effect.acts_on(track)) {
            effect.act(at, forces);
        }
    }

    /// What is added to the track's slope at `s` [m], downhill positive [rad].
    pub fn slope(&self, track: &str, s: f64) -> f64 {
        let own = self.active.iter().filter(|effect| effect.acts_on(track));
        own.map(|effect| effect.slope(s)).sum()
    }
}

/// What kind of effect is active.
#[derive(Clone, Debug)]
pub enum Kind {
    /// From the catalogue.
    Catalogue(&'static Effect),
    /// A person's own.
    Custom(Custom),
}

/// One effect with its parameters.
#[derive(Clone, Debug)]
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

impl Active {
    /// The effect's name without what follows an `@`.
    pub fn effect_name(&self) -> &str {
        self.name.split('@').next().unwrap_or(&self.name)
    }

    /// Whether it acts on the track of this name.
    pub fn acts_on(&self, track: &str) -> bool {
        self.track.as_deref().is_none_or(|only| only == track)
    }

    /// Whether an amplitude is not 0.
    pub fn is_on(&self) -> bool {
        match &self.kind {
            Kind::Custom(_) => self.values[0] != 0.0,
            Kind::Catalogue(effect) => {
                let parameters = effect.info.parameters.iter();
                parameters
                    .zip(&self.values)
                    .any(|(p, value)| p.is_amplitude() && *value != 0.0)
            }
        }
    }

    /// Whether its size and place are each recorded run's own: its spread from run to run is not 0.
    pub fn varies(&self) -> bool {
        let Kind::Catalogue(effect) = &self.kind else {
            return false;
        };
        let mut parameters = effect.info.parameters.iter().zip(&self.values);
        parameters.any(|(p, value)| p.name == Parameter::SPREAD.name && *value > 0.0)
    }

    /// Names of the columns that it needs.
    pub fn columns(&self) -> Vec<&str> {
        match &self.kind {
            Kind::Catalogue(effect) => effect.info.needs.iter().map(|c| c.name()).collect(),
            Kind::Custom(custom) => custom.names().iter().map(String::as_str).collect(),
        }
    }

    /// Whether it stands between a sensor and the truth or changes a constant of the sled.
    pub fn moves_signals(&self) -> bool {
        match &self.kind {
            Kind::Catalogue(effect) => effect.moves_signals(),
            Kind::Custom(custom) => custom.is_of_a_sensor(),
        }
    }

    /// The distance after which forces follow the slip by it [m]; 0 where they do so at once.
    pub fn relaxation(&self) -> f64 {
        match &self.kind {
            Kind::Catalogue(effect) => effect.relaxes.map_or(0.0, |p| self.values[p]),
            Kind::Custom(_) => 0.0,
        }
    }

    /// How late each sensor is by it [s], in the order of [`Sensor::ALL`](crate::effects::Sensor::ALL).
    pub fn delays(&self) -> [f64; SENSORS] {
        let mut delays = [0.0; SENSORS];
        if let Kind::Catalogue(effect) = &self.kind {
            let late = effect.on_sensors.iter();
            for fault in late.filter(|fault| fault.reading == Reading::Late) {
                delays[fault.of as usize] += self.values[fault.parameter];
            }
        }
        delays
    }

    /// Whether it makes a sensor late.
    pub fn is_late(&self) -> bool {
        self.delays().iter().any(|delay| *delay != 0.0)
    }

    /// The same with every sensor in time.
    pub(super) fn in_time(mut self) -> Self {
        if let Kind::Catalogue(effect) = &self.kind {
            let late = effect.on_sensors.iter();
            for fault in late.filter(|fault| fault.reading == Reading::Late) {
                self.values[fault.parameter] = 0.0;
            }
        }
        self
    }

    /// From what the sensors say to what is true, and from the stated constants of the sled to the true ones.
    pub fn correct(&self, at: &Conditions, signals: &mut Signals) {
        match &self.kind {
            Kind::Catalogue(effect) => effect.correct(&self.values, signals),
            Kind::Custom(custom) => custom.correct(self.values[0], at, signals),
        }
    }

    /// From what is true to what the sensors say.
    pub fn disturb(&self, at: &Conditions, signals: &mut Signals) {
        match &self.kind {
            Kind::Catalogue(effect) => effect.disturb(&self.values, signals),
            Kind::Custom(custom) => custom.disturb(self.values[0], at, signals),
        }
    }

    /// Changes the forces of the base law, whatever the track.
    pub fn act(&self, at: &State, forces: &mut Forces) {
        match &self.kind {
            Kind::Catalogue(effect) => effect.act(&self.values, at, forces),
            Kind::Custom(custom) => custom.act(self.values[0], at, forces),
        }
    }

    /// The coefficient with the effect, from that without it, of a specimen whose conditions alone are known.
    ///
    /// `None` where it does not act on a friction coefficient; NaN where a condition that it needs is not known.
    pub fn coefficient(&self, mu: f64, at: &Conditions) -> Option<f64> {
        match &self.kind {
            Kind::Catalogue(effect) => effect.on_friction.map(|law| law(&self.values, mu, at)),
            Kind::Custom(custom) => custom
                .acts_on_friction()
                .then(|| mu + custom.coefficient(self.values[0], at)),
        }
    }

    /// What is added to the track's slope at `s` [m], downhill positive [rad].
    pub fn slope(&self, s: f64) -> f64 {
        match &self.kind {
            Kind::Catalogue(effect) => effect.slope(&self.values, s),
            Kind::Custom(_) => 0.0,
        }
    }

    /// The table that states it in a model.
    pub fn table(&self) -> toml::Table {
        let mut table = toml::Table::new();
        match &self.kind {
            Kind::Catalogue(effect) => {
                for (parameter, value) in effect.info.parameters.iter().zip(&self.values) {
                    if *value != 0.0 || !parameter.is_amplitude() {
                        table.insert(parameter.name.to_owned(), (*value).into());
                    }
                }
            }
            Kind::Custom(custom) => {
                let channel = custom.channel.name().into_owned();
                table.insert("expression".to_owned(), custom.text.clone().into());
                table.insert("channel".to_owned(), channel.into());
                table.insert("unit".to_owned(), custom.unit.clone().into());
                table.insert("value".to_owned(), self.values[0].into());
                table.insert("low".to_owned(), custom.low.into());
                table.insert("high".to_owned(), custom.high.into());
            }
        }
        if let Some(track) = &self.track {
            table.insert("track".to_owned(), track.clone().into());
        }
        table
    }
}

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
    /// A column that an effect needs is neither recorded nor stated.
    #[error(
        "[effects.{name}]: needs the column {column}, which is neither recorded nor stated; found {found}"
    )]
    MissingColumn {
        /// The effect.
        name: String,
        /// The column.
        column: String,
        /// The columns that there are.
        found: String,
    },
}

/// A table for each effect of the catalogue, once or by place (`NAME@PLACE`), and tables with an expression.
pub fn schema(_: &mut SchemaGenerator) -> Schema {
    let known: Map<String, Value> = CATALOGUE
        .iter()
        .map(|effect| {
            let info = &effect.info;
            let mut keys = info.parameter_schemas();
            keys.insert("track".to_owned(), track());
            let table = json!({
                "description": info.summary,
                "type": "object",
                "properties": keys,
                "additionalProperties": false,
            });
            // A table with an expression is one's own effect, whatever its name.
            let either = json!({ "anyOf": [table, own()] });
            (format!("^{}(@.*)?$", info.name), either)
        })
        .collect();
    json_schema!({
        "description": "Effects beyond the base model, by name; an absent one is off.",
        "type": "object",
        "patternProperties": known,
        "additionalProperties": own(),
    })
}

fn track() -> Value {
    json!({ "description": "Acts on this track only.", "type": "string" })
}

fn own() -> Value {
    let sensors = Sensor::ALL.into_iter().map(Channel::Sensor);
    let channels = Channel::NAMED
        .iter()
        .map(|(_, channel)| *channel)
        .chain(sensors);
    let channels: Vec<_> = channels.map(Channel::name).collect();
    json!({
        "description": "An effect of one's own: value times expression.",
        "type": "object",
        "properties": {
            "expression": { "description": "Formula of columns.", "type": "string" },
            "channel": { "enum": channels },
            "unit": { "type": "string" },
            "value": { "type": "number" },
            "low": { "type": "number" },
            "high": { "type": "number" },
            "track": track(),
        },
        "required": ["expression", "channel"],
        "additionalProperties": false,
    })
}
