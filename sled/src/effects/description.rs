//! What is known of an effect before it is fitted: name, formula, parameters, columns it needs, and
//! the test that decides on it.

use std::collections::BTreeMap;

use schemars::{Schema, json_schema};
use serde::{Deserialize, Deserializer};

use crate::column::Column;
use crate::effects::Fault;

/// What an effect acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ActsOn {
    /// The friction coefficient of a runner.
    Friction,
    /// Forces along the sled.
    Along,
    /// Forces across the sled.
    Across,
    /// What a sensor reads.
    Sensor,
    /// Mass, inertia and places of the sled.
    Sled,
    /// The track's slope.
    Track,
    /// The contact problem.
    Contact,
    /// The measured pressure map.
    Map,
}

/// How far the effect's formula can be trusted with its size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// It holds at every admissible size.
    #[default]
    Exact,
    /// It holds to first order in the size.
    FirstOrder,
    /// Its size is known to this relative standard deviation at best, whatever the noise.
    Open(f64),
}

/// What is known of an effect.
///
/// Read from a built-in catalogue, whose texts and lists live as long as the program.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Info {
    /// Name as in `[effects.NAME]`.
    pub name: &'static str,
    /// One line for reports.
    pub summary: &'static str,
    /// The law as it is printed.
    pub formula: &'static str,
    /// How it shows in data.
    pub signature: &'static str,
    /// What it acts on.
    #[serde(deserialize_with = "leaked")]
    pub acts_on: &'static [ActsOn],
    /// Parameters in the order in which they are passed.
    #[serde(deserialize_with = "leaked")]
    pub parameters: &'static [Parameter],
    /// What must be recorded or stated for the effect to act and to be testable.
    #[serde(default, deserialize_with = "leaked")]
    pub needs: &'static [Column],
    /// Which test decides about it on runs.
    #[serde(default)]
    pub judged: Judged,
    /// Whether friction experiments can test it, where it acts on the friction coefficient.
    #[serde(default)]
    pub experiments: Experiments,
    /// Whether the formula holds at every size.
    #[serde(default)]
    pub form: Form,
    /// Names of the effects with a similar signature.
    #[serde(default, deserialize_with = "leaked")]
    pub looks_like: &'static [&'static str],
    /// What would distinguish it from those.
    pub decides: &'static str,
    /// Where the formula is from.
    pub source: &'static str,
    /// Parameters, known quantities and the number that the effect must give, by the names that
    /// files use: `0.5, 1000: mu 0.004, fz_n 2250 -> mu 0.006`. Everything else is 0.
    #[serde(default)]
    pub example: &'static str,
    /// Faults of sensors.
    #[serde(default, deserialize_with = "leaked")]
    pub faults: &'static [Fault],
}

fn leaked<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    list: D,
) -> Result<&'static [T], D::Error> {
    Ok(Vec::deserialize(list)?.leak())
}

impl Info {
    /// The level on which it varies.
    pub fn level(&self) -> Level {
        self.judged.level()
    }

    /// JSON schema of each parameter, by the parameter's name.
    pub fn parameter_schemas(&self) -> BTreeMap<String, Schema> {
        let schema = |p: &Parameter| {
            let schema = json_schema!({
                "description": format!("[{}]", p.unit),
                "type": "number",
                "minimum": p.low,
                "maximum": p.high,
            });
            (p.name.to_owned(), schema)
        };
        self.parameters.iter().map(schema).collect()
    }

    /// Its first amplitude; every effect has one.
    ///
    /// # Panics
    /// For an effect without parameters, which the catalogue's tests refuse.
    pub fn amplitude(&self) -> &'static Parameter {
        let first = self.parameters.iter().find(|p| p.is_amplitude());
        first.unwrap_or(&self.parameters[0])
    }

    /// The values of its parameters that change nothing.
    pub fn off(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.default).collect()
    }

    /// Places among the parameters of the two ends of its stretch of distance, where it has one.
    pub fn window(&self) -> Option<[usize; 2]> {
        let end = |edge| self.parameters.iter().position(|p| p.edge == Some(edge));
        Some([end(Edge::From)?, end(Edge::To)?])
    }

    /// Columns that a table of friction experiments must have, or why it cannot test the effect.
    ///
    /// # Errors
    /// The reason in words.
    pub fn needs_in_experiments(&self) -> Result<&'static [Column], &'static str> {
        match self.experiments {
            Experiments::AsNeeded | Experiments::OverFilm => Ok(self.needs),
            Experiments::Needs(columns) => Ok(columns),
            Experiments::Never(reason) => Err(reason),
        }
    }

    /// Whether it acts on none but the forces along the sled, the coefficient behind them, and the
    /// track's slope.
    pub fn acts_only_along(&self) -> bool {
        self.acts_on
            .iter()
            .all(|on| matches!(on, ActsOn::Friction | ActsOn::Along | ActsOn::Track))
    }
}

/// A parameter of an effect: name, unit and the range that physics allows.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Key in the model or case file, with its unit as a suffix.
    pub name: &'static str,
    /// Unit as it is printed; empty for a pure number.
    pub unit: &'static str,
    /// Smallest admissible value.
    pub low: f64,
    /// Largest admissible value.
    pub high: f64,
    /// Value when the key is absent; 0 for an amplitude, which switches the effect off.
    #[serde(default)]
    pub default: f64,
    /// Order of magnitude of a noticeable change; steps of differences are taken from it. 0 for a
    /// setting that is not fitted.
    #[serde(default)]
    pub typical: f64,
    /// Values of a setting that a search tries in turn; the default alone where empty.
    #[serde(default, deserialize_with = "leaked")]
    pub tried: &'static [f64],
    /// Which end of a window of distance the setting is, where it is one.
    pub edge: Option<Edge>,
}

/// An end of the stretch of distance on which an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Edge {
    /// Where it begins.
    From,
    /// Where it ends.
    To,
}

impl Parameter {
    /// The key of the standard deviation of an amplitude from run to run: where it is not 0 every
    /// recorded run has its own.
    pub const SPREAD: &'static str = "spread_n";

    /// Whether the parameter is an amplitude, fitted to data.
    pub fn is_amplitude(&self) -> bool {
        self.typical != 0.0
    }
}

/// Which test decides about an effect on runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Judged {
    /// Sample by sample within runs, everywhere.
    #[default]
    WithinRuns,
    /// Within runs, in a window of distance on one track that is searched for.
    InWindow,
    /// By its level from run to run.
    BetweenRuns,
    /// By its level from session to session.
    BetweenSessions,
    /// In the balance of speed and height, which is free of friction, as one size everywhere.
    BySlope,
    /// In the same balance, place by place.
    ByProfile,
    /// By measured pressures: no effect on runs.
    ByPressure,
}

/// The level on which an effect varies, and with it the unit that randomisation must move as one
/// piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Within a run, from sample to sample.
    Sample,
    /// From run to run.
    Run,
    /// From session to session.
    Session,
    /// The same in all runs on one track.
    Track,
}

impl Level {
    /// The level in words.
    pub fn name(self) -> &'static str {
        match self {
            Level::Sample => "sample",
            Level::Run => "run",
            Level::Session => "session",
            Level::Track => "track",
        }
    }
}

impl Judged {
    /// What varies as one piece.
    pub fn level(self) -> Level {
        match self {
            Judged::WithinRuns | Judged::ByPressure => Level::Sample,
            Judged::BetweenRuns => Level::Run,
            Judged::BetweenSessions => Level::Session,
            Judged::InWindow | Judged::BySlope | Judged::ByProfile => Level::Track,
        }
    }
}

/// Whether a table of friction coefficients can test an effect on them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Experiments {
    /// It can be tested where the columns that it needs are there and vary.
    #[default]
    AsNeeded,
    /// It can be tested where these columns are there and vary.
    Needs(#[serde(deserialize_with = "leaked")] &'static [Column]),
    /// It can be tested where the melt film is the base law and the columns that it needs are there,
    /// one of them varying.
    OverFilm,
    /// It cannot be tested, for this reason.
    Never(&'static str),
}
