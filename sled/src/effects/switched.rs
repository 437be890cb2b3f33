//! The effects that a model switches on: reading from its tables, checks, and action one after the
//! other.

use std::collections::BTreeMap;

use schemars::{Schema, SchemaGenerator, json_schema};

use crate::column::{SENSORS, Sensor};
use crate::effects::Parameter;
use crate::effects::catalogue::{CATALOGUE, find};
use crate::effects::custom::{Channel, Custom};
use crate::effects::expression::ExpressionError;
use crate::effects::{Effect, Fault, Forces, OperatingPoint, Reading, Signals, State};
use crate::sled::Sled;

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
        let active = tables.iter().map(|(name, table)| read_one(name, table));
        Ok(Self {
            active: active.collect::<Result<_, _>>()?,
        })
    }

    /// Whether nothing is switched on.
    pub fn is_empty(&self) -> bool {
        self.active.is_empty()
    }

    /// The effects that act on this track, with `track` set to `None`.
    pub fn on_track(&self, track: &str) -> Self {
        let acting = self.active.iter().filter(|effect| effect.acts_on(track));
        let without_track = |effect: &Active| Active {
            track: None,
            ..effect.clone()
        };
        Self {
            active: acting.map(without_track).collect(),
        }
    }

    /// Refuses effects that need a column which is not in `available`. Effects with amplitudes of 0
    /// are not checked.
    ///
    /// # Errors
    /// [`EffectError::MissingColumn`] with the effect, the column and the available columns.
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

    /// Delay of each sensor [s], in the order of [`Sensor::ALL`].
    ///
    /// A delay belongs to a whole series: a series is read [`ahead`](crate::effects::ahead) by it,
    /// and its instants are corrected by [`Effects::in_time`].
    pub fn delays(&self) -> [f64; SENSORS] {
        let mut delays = [0.0; SENSORS];
        for effect in &self.active {
            for (sum, delay) in delays.iter_mut().zip(effect.delays()) {
                *sum += delay;
            }
        }
        delays
    }

    /// Relaxation length of the lateral forces [m]; `None` if they follow the slip at once.
    pub fn relaxation(&self) -> Option<f64> {
        let distance: f64 = self.active.iter().map(Active::relaxation).sum();
        (distance > 0.0).then_some(distance)
    }

    /// The effects with all delays of sensors set to 0.
    pub fn in_time(self) -> Self {
        Self {
            active: self.active.into_iter().map(Active::in_time).collect(),
        }
    }

    /// From readings to true values, and from the stated constants of the sled to the true ones.
    ///
    /// `at` states time, place and weather for expressions.
    pub fn correct(&self, at: &OperatingPoint, signals: &mut Signals) {
        for effect in &self.active {
            effect.correct(at, signals);
        }
    }

    /// From true values to readings.
    pub fn disturb(&self, at: &OperatingPoint, signals: &mut Signals) {
        for effect in self.active.iter().rev() {
            effect.disturb(at, signals);
        }
    }

    /// From the stated constants of the sled to the true ones.
    pub fn find_constants(&self, sled: &mut Sled) {
        for effect in &self.active {
            if let Some(kind) = effect.catalogue() {
                kind.find_constants(&effect.values, sled);
            }
        }
    }

    /// Changes the forces of the base law.
    ///
    /// An effect of one track acts only after [`Effects::on_track`].
    pub fn act(&self, at: &State, forces: &mut Forces) {
        for effect in self.everywhere() {
            effect.act(at, forces);
        }
    }

    /// Addition to the track's slope at `s` [m], downhill positive [rad]; as [`Effects::act`].
    pub fn slope(&self, s: f64) -> f64 {
        self.everywhere().map(|effect| effect.slope(s)).sum()
    }

    fn everywhere(&self) -> impl Iterator<Item = &Active> {
        self.active.iter().filter(|effect| effect.track.is_none())
    }
}

/// Kind of an active effect.
#[derive(Clone, Debug)]
pub enum Kind {
    /// From the catalogue.
    Catalogue(&'static Effect),
    /// A user-defined expression.
    Custom(Custom),
}

/// One effect with its parameters.
#[derive(Clone, Debug)]
pub struct Active {
    /// Name of the table; a suffix after `@` distinguishes several tables of one effect.
    pub name: String,
    /// The effect.
    pub kind: Kind,
    /// Parameters in the effect's order; for an expression only the amplitude.
    pub values: Vec<f64>,
    /// The only track on which it acts; `None` for all tracks.
    pub track: Option<String>,
}

impl Active {
    /// The name without the suffix after `@`.
    pub fn effect_name(&self) -> &str {
        self.name.split('@').next().unwrap_or(&self.name)
    }

    /// Whether it acts on the track of this name.
    pub fn acts_on(&self, track: &str) -> bool {
        self.track.as_deref().is_none_or(|only| only == track)
    }

    /// Whether any amplitude is not 0.
    pub fn is_on(&self) -> bool {
        match self.catalogue() {
            None => self.values[0] != 0.0,
            Some(_) => self
                .parameters()
                .any(|(p, value)| p.is_amplitude() && value != 0.0),
        }
    }

    /// The effect of the catalogue; `None` for an expression.
    fn catalogue(&self) -> Option<&'static Effect> {
        match &self.kind {
            Kind::Catalogue(effect) => Some(effect),
            Kind::Custom(_) => None,
        }
    }

    /// Parameters of an effect of the catalogue with their values.
    fn parameters(&self) -> impl Iterator<Item = (&'static Parameter, f64)> {
        let parameters = self
            .catalogue()
            .map_or(&[][..], |effect| effect.info.parameters);
        parameters.iter().zip(self.values.iter().copied())
    }

    /// Whether size and place differ from run to run: the spread is not 0.
    pub fn varies(&self) -> bool {
        let varies = |(p, value): (&Parameter, f64)| p.name == Parameter::SPREAD && value > 0.0;
        self.parameters().any(varies)
    }

    /// Names of the columns that it needs.
    pub fn columns(&self) -> Vec<&str> {
        match &self.kind {
            Kind::Catalogue(effect) => effect.info.needs.iter().map(|c| c.name()).collect(),
            Kind::Custom(custom) => custom.names().iter().map(String::as_str).collect(),
        }
    }

    /// Whether it is a fault of sensors or changes a constant of the sled.
    pub fn moves_signals(&self) -> bool {
        match &self.kind {
            Kind::Catalogue(effect) => effect.moves_signals(),
            Kind::Custom(custom) => custom.is_of_a_sensor(),
        }
    }

    /// Relaxation length of the lateral forces by this effect [m]; 0 if they follow the slip at
    /// once.
    pub fn relaxation(&self) -> f64 {
        let relaxes = self.catalogue().and_then(|effect| effect.relaxes);
        relaxes.map_or(0.0, |p| self.values[p])
    }

    /// Delay of each sensor by this effect [s], in the order of [`Sensor::ALL`].
    pub fn delays(&self) -> [f64; SENSORS] {
        let mut delays = [0.0; SENSORS];
        for fault in self.late_faults() {
            delays[fault.of as usize] += self.values[fault.parameter];
        }
        delays
    }

    fn late_faults(&self) -> impl Iterator<Item = &'static Fault> + use<> {
        let faults = self.catalogue().map_or(&[][..], |effect| effect.on_sensors);
        faults.iter().filter(|fault| fault.reading == Reading::Late)
    }

    /// Whether it delays a sensor.
    pub fn is_late(&self) -> bool {
        self.delays().iter().any(|delay| *delay != 0.0)
    }

    /// The effect with all delays of sensors set to 0.
    pub(super) fn in_time(mut self) -> Self {
        for fault in self.late_faults() {
            self.values[fault.parameter] = 0.0;
        }
        self
    }

    /// From readings to true values, and from the stated constants of the sled to the true ones.
    pub fn correct(&self, at: &OperatingPoint, signals: &mut Signals) {
        match &self.kind {
            Kind::Catalogue(effect) => effect.correct(&self.values, signals),
            Kind::Custom(custom) => custom.correct(self.values[0], at, signals),
        }
    }

    /// From true values to readings.
    pub fn disturb(&self, at: &OperatingPoint, signals: &mut Signals) {
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

    /// The friction coefficient of a specimen with the effect, from the coefficient `mu` without
    /// it.
    ///
    /// `None` if it does not act on a friction coefficient; NaN if a condition that it needs is
    /// unknown.
    pub fn coefficient(&self, mu: f64, at: &OperatingPoint) -> Option<f64> {
        match &self.kind {
            Kind::Catalogue(effect) => effect.on_friction.map(|law| law(&self.values, mu, at)),
            Kind::Custom(custom) => custom
                .acts_on_friction()
                .then(|| mu + custom.coefficient(self.values[0], at)),
        }
    }

    /// Addition to the track's slope at `s` [m], downhill positive [rad].
    pub fn slope(&self, s: f64) -> f64 {
        let effect = self.catalogue();
        effect.map_or(0.0, |effect| effect.slope(&self.values, s))
    }

    /// The table that states it in a model.
    pub fn table(&self) -> toml::Table {
        let mut table = toml::Table::new();
        let mut insert = |key: &str, value: toml::Value| table.insert(key.to_owned(), value);
        match &self.kind {
            Kind::Catalogue(_) => {
                for (parameter, value) in self.parameters() {
                    if value != 0.0 || !parameter.is_amplitude() {
                        insert(parameter.name, value.into());
                    }
                }
            }
            Kind::Custom(custom) => {
                insert("expression", custom.text.clone().into());
                insert("channel", custom.channel.name().into_owned().into());
                insert("unit", custom.unit.clone().into());
                insert("value", self.values[0].into());
                insert("low", custom.low.into());
                insert("high", custom.high.into());
            }
        }
        if let Some(track) = &self.track {
            insert("track", track.clone().into());
        }
        table
    }
}

/// One table under `[effects]`.
pub(super) fn read_one(name: &str, table: &toml::Table) -> Result<Active, EffectError> {
    let table = NamedTable { name, table };
    let track = table.text("track", "the name of a track")?;
    let (kind, values) = if table.table.contains_key("expression") {
        table.custom()?
    } else {
        table.of_catalogue()?
    };
    Ok(Active {
        name: name.to_owned(),
        kind,
        values,
        track,
    })
}

/// Keys of a table with an expression.
const CUSTOM_KEYS: [&str; 7] = [
    "expression",
    "channel",
    "unit",
    "value",
    "low",
    "high",
    "track",
];

/// A table under `[effects]` with its name.
struct NamedTable<'a> {
    name: &'a str,
    table: &'a toml::Table,
}

impl NamedTable<'_> {
    fn of_catalogue(&self) -> Result<(Kind, Vec<f64>), EffectError> {
        let bare = self.name.split('@').next().unwrap_or(self.name);
        let effect = find(bare).ok_or_else(|| {
            let known: Vec<&str> = CATALOGUE.iter().map(|e| e.info().name).collect();
            EffectError::UnknownEffect {
                name: self.name.to_owned(),
                known: known.join(", "),
            }
        })?;
        let parameters = effect.info().parameters;
        let names = parameters.iter().map(|p| p.name);
        self.check_keys(&names.chain(["track"]).collect::<Vec<_>>())?;
        let read = |p: &Parameter| self.number(p.name, p.default, p.low, p.high);
        let values = parameters.iter().map(read).collect::<Result<_, _>>()?;
        Ok((Kind::Catalogue(effect), values))
    }

    fn custom(&self) -> Result<(Kind, Vec<f64>), EffectError> {
        self.check_keys(&CUSTOM_KEYS)?;
        let text = self.text("expression", "a formula in quotes")?;
        let channel = self.table.get("channel").and_then(toml::Value::as_str);
        let channel = channel.and_then(Channel::named).ok_or_else(|| {
            let absent = toml::Value::String("absent".to_owned());
            let found = self.table.get("channel").unwrap_or(&absent);
            self.wrong("channel", found, Channel::expected())
        })?;
        let custom = Custom::read(self.name, channel, &text.unwrap_or_default(), None)?;
        let low = self.number("low", -1e12, -1e12, 1e12)?;
        let high = self.number("high", 1e12, low, 1e12)?;
        let value = self.number("value", 0.0, low, high)?;
        let unit = self.text("unit", "a unit in quotes")?.unwrap_or_default();
        Ok((Kind::Custom(custom.bounded(&unit, low, high)), vec![value]))
    }

    fn check_keys(&self, known: &[&str]) -> Result<(), EffectError> {
        let unknown = |key: &&String| !known.contains(&key.as_str());
        match self.table.keys().find(unknown) {
            None => Ok(()),
            Some(key) => Err(EffectError::UnknownKey {
                name: self.name.to_owned(),
                key: key.clone(),
                expected: known.join(", "),
            }),
        }
    }

    fn text(&self, key: &str, expected: &str) -> Result<Option<String>, EffectError> {
        match self.table.get(key) {
            None => Ok(None),
            Some(toml::Value::String(text)) => Ok(Some(text.clone())),
            Some(other) => Err(self.wrong(key, other, expected.to_owned())),
        }
    }

    fn number(&self, key: &str, default: f64, low: f64, high: f64) -> Result<f64, EffectError> {
        let Some(found) = self.table.get(key) else {
            return Ok(default);
        };
        let whole = found.as_integer().map(|value| value as f64);
        let value = found.as_float().or(whole);
        let value = value.filter(|value| (low..=high).contains(value));
        value.ok_or_else(|| self.wrong(key, found, format!("a number from {low} to {high}")))
    }

    fn wrong(&self, key: &str, found: &toml::Value, expected: String) -> EffectError {
        EffectError::Value {
            name: self.name.to_owned(),
            key: key.to_owned(),
            found: found.to_string(),
            expected,
        }
    }
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
        /// The value found.
        found: String,
        /// The values that are allowed.
        expected: String,
    },
    /// The expression cannot be read.
    #[error("[effects.{name}]: `expression` {source}")]
    Expression {
        /// The effect.
        name: String,
        /// The place that cannot be read.
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
        /// The available columns.
        found: String,
    },
}

/// JSON schema of `[effects]`: a table for each effect of the catalogue, once or by place
/// (`NAME@PLACE`), and tables with an expression.
pub fn schema(_: &mut SchemaGenerator) -> Schema {
    let known: BTreeMap<String, Schema> = CATALOGUE
        .iter()
        .map(|effect| {
            let info = &effect.info;
            let mut keys = info.parameter_schemas();
            keys.insert("track".to_owned(), track());
            let table = json_schema!({
                "description": info.summary,
                "type": "object",
                "properties": keys,
                "additionalProperties": false,
            });
            // A table with an expression is a user-defined effect, whatever its name.
            let table_or_custom = json_schema!({ "anyOf": [table, custom_schema()] });
            (format!("^{}(@.*)?$", info.name), table_or_custom)
        })
        .collect();
    json_schema!({
        "description": "Effects in addition to the base model, by name; an absent one is off.",
        "type": "object",
        "patternProperties": known,
        "additionalProperties": custom_schema(),
    })
}

fn track() -> Schema {
    json_schema!({ "description": "Acts on this track only.", "type": "string" })
}

fn custom_schema() -> Schema {
    let sensors = Sensor::ALL.map(Channel::Sensor);
    let channels = Channel::NAMED.map(|(_, channel)| channel).into_iter();
    let channels: Vec<_> = channels.chain(sensors).map(Channel::name).collect();
    json_schema!({
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
