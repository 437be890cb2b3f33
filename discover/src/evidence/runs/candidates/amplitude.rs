//! An amplitude of an effect on a sled.

use kufe_sled::effects::{Active, Custom, Judged, Kind, Level};

use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::candidate::Candidate;

/// One amplitude of one effect of a sled, with its settings.
#[derive(Clone)]
pub struct Amplitude {
    pub kind: Kind,
    /// Index of the amplitude among the effect's parameters.
    pub parameter: usize,
    /// Whether it varies within runs, between runs, between sessions or over place.
    pub level: Level,
    /// Settings, with amplitudes of 0.
    pub values: Vec<f64>,
    /// The only track on which it acts.
    pub track: Option<String>,
    /// A recorded column outside the model in the expression.
    pub carrier: Option<String>,
}

impl Candidate<Amplitude> {
    /// A custom law of these columns, with the amplitude's unit, typical value and largest value;
    /// `carrier` is a column outside the model.
    pub fn law(
        columns: &[&str],
        custom: Custom,
        carrier: Option<String>,
        unit: &str,
        [typical, limit]: [f64; 2],
    ) -> Self {
        Self {
            effect: format!("unknown:{}", columns.join("*")),
            key: "value".to_owned(),
            unit: unit.to_owned(),
            low: -limit,
            high: limit,
            typical,
            decides: format!("runs in which {} is varied alone", columns.join(" times ")),
            act: Amplitude {
                kind: Kind::Custom(custom.bounded(unit, -limit, limit)),
                parameter: 0,
                level: Level::Sample,
                values: vec![0.0],
                track: None,
                carrier,
            },
        }
    }

    /// Whether two amplitudes have the same effect, settings and place.
    pub fn is(&self, other: &Self) -> bool {
        let (own, its) = (&self.act, &other.act);
        let same = match (&own.kind, &its.kind) {
            (Kind::Custom(a), Kind::Custom(b)) => a.text == b.text && a.channel == b.channel,
            _ => self.effect == other.effect,
        };
        same && own.parameter == its.parameter && own.values == its.values && own.track == its.track
    }

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

    /// This amplitude within a window of distance on one track.
    pub fn within(&self, track: &str, from: f64, to: f64) -> Self {
        let mut local = self.clone();
        local.act.track = Some(track.to_owned());
        if let Kind::Catalogue(effect) = &self.act.kind
            && let Some([begin, end]) = effect.info.window()
        {
            (local.act.values[begin], local.act.values[end]) = (from, to);
        }
        local
    }

    /// The interval of distance on which it acts \[m\], if any.
    pub fn window(&self) -> Option<(f64, f64)> {
        let Kind::Catalogue(effect) = &self.act.kind else {
            return None;
        };
        let [begin, end] = effect.info.window()?;
        Some((self.act.values[begin], self.act.values[end]))
    }

    /// Whether it is a track profile, which is judged by place.
    pub fn is_profile(&self) -> bool {
        matches!(&self.act.kind, Kind::Catalogue(effect) if effect.info.judged == Judged::ByProfile)
    }

    /// The values of its carrier in a run.
    pub fn carried<'a>(&self, frame: &'a Frame) -> Option<&'a [f64]> {
        let name = self.act.carrier.as_deref()?;
        frame.extra.get(name).map(Vec::as_slice)
    }
}
