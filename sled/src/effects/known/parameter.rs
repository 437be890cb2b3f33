//! Parameters of an effect.

/// A parameter of an effect: name, unit and the range that physics allows.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    pub default: f64,
    /// Order of magnitude of a noticeable change; steps of differences are taken from it. 0 for a setting that is not fitted.
    pub typical: f64,
    /// Values of a setting that a search tries in turn; the default alone where empty.
    pub tried: &'static [f64],
    /// Which end of a window of distance the setting is, where it is one.
    pub edge: Option<Edge>,
}

/// An end of the stretch of distance on which an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Where it begins.
    From,
    /// Where it ends.
    To,
}

impl Parameter {
    /// An amplitude: 0 means off.
    pub const fn amplitude(
        name: &'static str,
        unit: &'static str,
        low: f64,
        high: f64,
        typical: f64,
    ) -> Self {
        Self {
            name,
            unit,
            low,
            high,
            default: 0.0,
            typical,
            tried: &[],
            edge: None,
        }
    }

    /// A setting that shapes the effect and is not fitted with it.
    pub const fn setting(
        name: &'static str,
        unit: &'static str,
        low: f64,
        high: f64,
        default: f64,
    ) -> Self {
        Self {
            name,
            unit,
            low,
            high,
            default,
            typical: 0.0,
            tried: &[],
            edge: None,
        }
    }

    /// A setting of which a search tries these values.
    pub const fn tried(mut self, values: &'static [f64]) -> Self {
        self.tried = values;
        self
    }

    /// Where a stretch of the track begins [m].
    pub const FROM: Self = Self {
        edge: Some(Edge::From),
        ..Self::setting("from_m", "m", -1.0e5, 1.0e6, 0.0)
    };

    /// Where a stretch of the track ends [m].
    pub const TO: Self = Self {
        edge: Some(Edge::To),
        ..Self::setting("to_m", "m", -1.0e5, 1.0e6, 1.0e6)
    };

    /// How far an amplitude differs from run to run, a standard deviation: where it is not 0 every recorded run has its own.
    pub const SPREAD: Self = Self::setting("spread_n", "N", 0.0, 20000.0, 0.0);

    /// Whether the parameter is an amplitude, fitted to data.
    pub fn is_amplitude(&self) -> bool {
        self.typical != 0.0
    }
}
