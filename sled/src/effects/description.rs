//! Description of an effect: name, formula, parameters, required columns, and the test that decides
//! on it.

use std::collections::BTreeMap;

use schemars::{Schema, json_schema};
use serde::{Deserialize, Deserializer};

use crate::column::Column;
use crate::effects::Fault;

/// Quantity on which an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ActsOn {
    /// The friction coefficient of a runner.
    Friction,
    /// Forces along the sled.
    Along,
    /// Forces across the sled.
    Across,
    /// The reading of a sensor.
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

/// Validity of the formula with growing size of the effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// It holds at every admissible size.
    #[default]
    Exact,
    /// It holds to first order in the size.
    FirstOrder,
    /// Its size has at least this relative standard deviation, whatever the noise.
    Open(f64),
}

/// Description of an effect.
///
/// Read from a built-in catalogue, whose texts and lists live as long as the program.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Info {
    /// Name as in `[effects.NAME]`.
    pub name: &'static str,
    /// One line for reports.
    pub summary: &'static str,
    /// The law as printed in reports.
    pub formula: &'static str,
    /// Its signature in data.
    pub signature: &'static str,
    /// Quantities that it acts on.
    #[serde(deserialize_with = "leaked")]
    pub acts_on: &'static [ActsOn],
    /// Parameters in the order in which they are passed.
    #[serde(deserialize_with = "leaked")]
    pub parameters: &'static [Parameter],
    /// Columns that must be recorded or stated for the effect to act and to be testable.
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
    /// Measurement that would distinguish it from the effects of `looks_like`.
    pub decides: &'static str,
    /// Source of the formula.
    pub source: &'static str,
    /// Parameters, known quantities and the expected result, by the names in files:
    /// `0.5, 1000: mu 0.004, fz_n 2250 -> mu 0.006`. Everything else is 0.
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

    /// Parameter values at which the effect changes nothing.
    pub fn off(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.default).collect()
    }

    /// Indices of the parameters that are the two ends of its stretch of distance; `None` if it
    /// acts everywhere.
    pub fn window(&self) -> Option<[usize; 2]> {
        let end = |edge| self.parameters.iter().position(|p| p.edge == Some(edge));
        Some([end(Edge::From)?, end(Edge::To)?])
    }

    /// Columns that a table of friction experiments must have to test the effect.
    ///
    /// # Errors
    /// The reason why friction experiments cannot test it.
    pub fn needs_in_experiments(&self) -> Result<&'static [Column], &'static str> {
        match self.experiments {
            Experiments::AsNeeded | Experiments::OverFilm => Ok(self.needs),
            Experiments::Needs(columns) => Ok(columns),
            Experiments::Never(reason) => Err(reason),
        }
    }

    /// Whether it acts only on the forces along the sled, on the friction coefficient, or on the
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
    /// Unit in print; empty for a dimensionless parameter.
    pub unit: &'static str,
    /// Smallest admissible value.
    pub low: f64,
    /// Largest admissible value.
    pub high: f64,
    /// Value if the key is absent; 0 for an amplitude, which switches the effect off.
    #[serde(default)]
    pub default: f64,
    /// Order of magnitude of a noticeable change, from which finite-difference steps follow. 0 for
    /// a setting that is not fitted.
    #[serde(default)]
    pub typical: f64,
    /// Values of a setting that a search tries in turn; if empty, only the default.
    #[serde(default, deserialize_with = "leaked")]
    pub tried: &'static [f64],
    /// The end of the stretch of distance that the setting is; `None` for other parameters.
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
    /// Key of the standard deviation of an amplitude from run to run. If it is not 0, every
    /// recorded run has its own amplitude.
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
    /// In the balance of speed and height, which does not depend on friction, with one size
    /// everywhere.
    BySlope,
    /// In the balance of speed and height, place by place.
    ByProfile,
    /// By measured pressures: no effect on runs.
    ByPressure,
}

/// The level on which an effect varies, which is the unit of randomisation.
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
    /// The level on which effects of this test vary.
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
    /// It can be tested if the columns that it needs are present and vary.
    #[default]
    AsNeeded,
    /// It can be tested if these columns are present and vary.
    Needs(#[serde(deserialize_with = "leaked")] &'static [Column]),
    /// It can be tested if the melt film is the base law, the columns that it needs are present and
    /// one of them varies.
    OverFilm,
    /// It cannot be tested, for this reason.
    Never(&'static str),
}
