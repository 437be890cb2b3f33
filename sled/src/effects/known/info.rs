//! What an effect is called, what it does in words, and what it takes.

use crate::effects::known::column::Column;
use crate::effects::known::judged::{Experiments, Judged, Level};
use crate::effects::known::parameter::{Edge, Parameter};

/// What an effect acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// It holds at every admissible size.
    Exact,
    /// It holds to first order in the size.
    FirstOrder,
    /// It leaves this relative standard deviation of the size open, whatever the noise.
    Open(f64),
}

/// What is known of an effect.
#[derive(Clone, Copy, Debug)]
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
    pub acts_on: &'static [ActsOn],
    /// Parameters in the order in which they are passed.
    pub parameters: &'static [Parameter],
    /// What must be recorded or stated for the effect to act and to be testable.
    pub needs: &'static [Column],
    /// Which test decides about it on runs.
    pub judged: Judged,
    /// What friction experiments say of it, where it acts on the friction coefficient.
    pub experiments: Experiments,
    /// Whether the formula holds at every size.
    pub form: Form,
    /// Names of the effects that look like it.
    pub looks_like: &'static [&'static str],
    /// What would tell it from those.
    pub decides: &'static str,
    /// Where the formula is from.
    pub source: &'static str,
}

impl Info {
    /// What a file of an effect leaves out: nothing needed, judged within runs, exact.
    pub const NEW: Info = Info {
        name: "",
        summary: "",
        formula: "",
        signature: "",
        acts_on: &[],
        parameters: &[],
        needs: &[],
        judged: Judged::WithinRuns,
        experiments: Experiments::AsNeeded,
        form: Form::Exact,
        looks_like: &[],
        decides: "",
        source: "",
    };

    /// The level on which it varies.
    pub fn level(&self) -> Level {
        self.judged.level()
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

    /// Columns that a table of friction experiments must have, varying, or why it says nothing of the effect.
    ///
    /// # Errors
    /// The reason in words.
    pub fn needs_in_experiments(&self) -> Result<&'static [Column], &'static str> {
        match self.experiments {
            Experiments::AsNeeded => Ok(self.needs),
            Experiments::Needs(columns) => Ok(columns),
            Experiments::Never(reason) => Err(reason),
        }
    }

    /// Whether it acts on none but the forces along the sled, the coefficient behind them, and the track's slope.
    pub fn acts_only_along(&self) -> bool {
        self.acts_on
            .iter()
            .all(|on| matches!(on, ActsOn::Friction | ActsOn::Along | ActsOn::Track))
    }
}
