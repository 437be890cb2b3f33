//! The effects that a model switches on: read from its tables, checked, and acting one after the
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

    /// Refuses effects that need a column which is not `available`; an effect whose amplitudes are
    /// 0 needs none.
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

    /// How late each sensor is [s], in the order of [`Sensor::ALL`].
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

    /// From readings to true values, and from the stated constants of the sled to the true ones.
    ///
    /// `at` states time, place and weather, for expressions of them.
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
    /// An effect of one track does not act here: [`Effects::on_track`] frees it of its name.
    pub fn act(&self, at: &State, forces: &mut Forces) {
        for effect in self.everywhere() {
            effect.act(at, forces);
        }
    }

    /// What is added to the track's slope at `s` [m], downhill positive [rad]; as [`Effects::act`].
    pub fn slope(&self, s: f64) -> f64 {
        self.everywhere().map(|effect| effect.slope(s)).sum()
    }

    fn everywhere(&self) -> impl Iterator<Item = &Active> {
        self.active.iter().filter(|effect| effect.track.is_none())
    }
}

/// What kind of effect is active.
#[derive(Clone, Debug)]
pub enum Kind {
    /// From the catalogue.
    Catalogue(&'static Effect),
    /// An expression that a person adds.
    Custom(Custom),
}

/// One effect with its parameters.
#[derive(Clone, Debug)]
pub struct Active {
    /// The table's name; what follows an `@` distinguishes several of one effect.
    pub name: String,
    /// What it does.
    pub kind: Kind,
    /// Parameters in the effect's order; the amplitude alone for an expression.
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
        match self.catalogue() {
            None => self.values[0] != 0.0,
            Some(_) => self
                .parameters()
                .any(|(p, value)| p.is_amplitude() && value != 0.0),
        }
    }

    /// The effect, where it is one of the catalogue.
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

    /// Whether its size and place are each recorded run's own: its spread from run to run is not 0.
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

    /// The distance after which forces follow the slip by it [m]; 0 where they do so at once.
    pub fn relaxation(&self) -> f64 {
        let relaxes = self.catalogue().and_then(|effect| effect.relaxes);
        relaxes.map_or(0.0, |p| self.values[p])
    }

    /// How late each sensor is by it [s], in the order of [`Sensor::ALL`].
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

    /// Whether it makes a sensor late.
    pub fn is_late(&self) -> bool {
        self.delays().iter().any(|delay| *delay != 0.0)
    }

    /// The same with every sensor in time.
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

    /// The coefficient with the effect, from that without it, of a specimen of which only the
    /// operating point is known.
    ///
    /// `None` where it does not act on a friction coefficient; NaN where a condition that it needs
    /// is not known.
    pub fn coefficient(&self, mu: f64, at: &OperatingPoint) -> Option<f64> {
        match &self.kind {
            Kind::Catalogue(effect) => effect.on_friction.map(|law| law(&self.values, mu, at)),
            Kind::Custom(custom) => custom
                .acts_on_friction()
                .then(|| mu + custom.coefficient(self.values[0], at)),
        }
    }

    /// What is added to the track's slope at `s` [m], downhill positive [rad].
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
        /// The columns that there are.
        found: String,
    },
}

/// A table for each effect of the catalogue, once or by place (`NAME@PLACE`), and tables with an
/// expression.
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
            // A table with an expression is one's own effect, whatever its name.
            let either = json_schema!({ "anyOf": [table, own()] });
            (format!("^{}(@.*)?$", info.name), either)
        })
        .collect();
    json_schema!({
        "description": "Effects in addition to the base model, by name; an absent one is off.",
        "type": "object",
        "patternProperties": known,
        "additionalProperties": own(),
    })
}

fn track() -> Schema {
    json_schema!({ "description": "Acts on this track only.", "type": "string" })
}

fn own() -> Schema {
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
