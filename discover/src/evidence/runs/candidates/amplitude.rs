//! How an amplitude of an effect acts on a sled.

use kufe_sled::effects::{Active, Kind, Level};

use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::candidate::Candidate;

/// The name under which an expression sees the column of [`Candidate::carrier`].
pub const CARRIER: &str = "humidity_pct";

/// One amplitude of one effect of a sled, with its settings.
#[derive(Clone)]
pub struct Amplitude {
    /// What the effect does.
    pub kind: Kind,
    /// Place of the amplitude among the effect's parameters.
    pub parameter: usize,
    /// Whether it differs from sample to sample, run to run, session to session or place to place.
    pub level: Level,
    /// Settings, with the amplitudes at 0.
    pub values: Vec<f64>,
    /// The only track it acts on.
    pub track: Option<String>,
    /// A recorded column outside the model, handed to the expression under [`CARRIER`].
    pub carrier: Option<String>,
}

impl Candidate<Amplitude> {
    /// The effect at an amplitude.
    pub fn active(&self, amplitude: f64) -> Active {
        let mut values = self.act.values.clone();
        values[self.act.parameter] = amplitude;
        Active {
            name: self.effect.clone(),
            kind: self.act.kind.clone(),
            values,
            track: self.act.track.clone(),
        }
    }

    /// The same in a window of distance on one track.
    pub fn within(&self, track: &str, from: f64, to: f64) -> Self {
        let mut local = self.clone();
        local.act.track = Some(track.to_owned());
        if let Kind::Catalogue(effect) = &self.act.kind {
            for (value, parameter) in local.act.values.iter_mut().zip(effect.info().parameters) {
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
        let Kind::Catalogue(effect) = &self.act.kind else {
            return None;
        };
        let of = |name: &str| {
            let at = effect
                .info()
                .parameters
                .iter()
                .position(|p| p.name == name)?;
            Some(self.act.values[at])
        };
        Some((of("from_m")?, of("to_m")?))
    }

    /// The values of its carrier in a run.
    pub fn carried<'a>(&self, frame: &'a Frame) -> Option<&'a [f64]> {
        match self.act.carrier.as_deref()? {
            "pitch_rate_radps" => Some(&frame.rate[1]),
            name => frame.extra.get(name).map(Vec::as_slice),
        }
    }
}
