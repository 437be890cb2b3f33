//! One amplitude of one effect that could be missing.

use kufe_sled::effects::{Active, Kind, Level};

use crate::evidence::runs::recordings::frame::Frame;

/// One amplitude of one effect, with its settings.
#[derive(Clone)]
pub struct Candidate {
    /// Name of the effect.
    pub effect: String,
    /// What it does.
    pub kind: Kind,
    /// Place of the amplitude among the parameters.
    pub parameter: usize,
    /// Name of the amplitude.
    pub key: String,
    /// Its unit.
    pub unit: String,
    /// Smallest admissible value.
    pub low: f64,
    /// Largest admissible value.
    pub high: f64,
    /// Order of magnitude.
    pub typical: f64,
    /// Level.
    pub level: Level,
    /// Settings, with the amplitudes at 0.
    pub values: Vec<f64>,
    /// The only track it acts on.
    pub track: Option<String>,
    /// What would tell it from its rivals.
    pub decides: String,
    /// A recorded column outside the model, handed to the expression under [`CARRIER`].
    pub carrier: Option<String>,
}

/// The name under which an expression sees the column of [`Candidate::carrier`].
pub const CARRIER: &str = "humidity_pct";

impl Candidate {
    /// The effect at an amplitude.
    pub fn active(&self, amplitude: f64) -> Active {
        let mut values = self.values.clone();
        values[self.parameter] = amplitude;
        Active {
            name: self.effect.clone(),
            kind: self.kind.clone(),
            values,
            track: self.track.clone(),
        }
    }

    /// The same in a window of distance on one track.
    pub fn within(&self, track: &str, from: f64, to: f64) -> Self {
        let mut local = self.clone();
        local.track = Some(track.to_owned());
        if let Kind::Catalogue(effect) = &self.kind {
            for (value, parameter) in local.values.iter_mut().zip(effect.info().parameters) {
                match parameter.name {
                    "from_m" => *value = from,
                    "to_m" => *value = to,
                    _ => {}
                }
            }
        }
        local
    }

    /// The stretch of distance on which it acts, where it has one [m].
    pub fn window(&self) -> Option<(f64, f64)> {
        let Kind::Catalogue(effect) = &self.kind else {
            return None;
        };
        let of = |name: &str| {
            let at = effect
                .info()
                .parameters
                .iter()
                .position(|p| p.name == name)?;
            Some(self.values[at])
        };
        Some((of("from_m")?, of("to_m")?))
    }

    /// Whether it is no effect of the catalogue but a dependence on a column.
    pub fn is_unknown(&self) -> bool {
        self.effect.starts_with("unknown:")
    }

    /// The values of its carrier in a run.
    pub fn carried<'a>(&self, frame: &'a Frame) -> Option<&'a [f64]> {
        match self.carrier.as_deref()? {
            "pitch_rate_radps" => Some(&frame.rate[1]),
            name => frame.extra.get(name).map(Vec::as_slice),
        }
    }

    /// Name with the amplitude's key.
    pub fn label(&self) -> String {
        format!("{} ({})", self.effect, self.key)
    }
}
