//! All effects that a model switches on.

use std::collections::BTreeMap;

use crate::effects::motion::{Conditions, Constants, Forces, SENSORS, Signals, State};
use crate::effects::switched::active::{Active, Kind};
use crate::effects::switched::error::EffectError;
use crate::effects::switched::read::read_one;

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
