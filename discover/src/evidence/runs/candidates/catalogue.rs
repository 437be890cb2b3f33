//! The effects that could be missing, as far as the data can speak of them.

use kufe_sled::effects::{CATALOGUE, Custom, Effects, Kind, Level};

use crate::evidence::runs::candidates::along::acts_only_along;
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::recordings::prepare::Data;
use crate::procedure::candidate::Candidate;

/// All candidates by the way in which they are tested.
pub struct Candidates {
    /// Within runs, everywhere.
    pub regular: Vec<Candidate<Amplitude>>,
    /// Within runs, in a window of distance that is searched for.
    pub local: Vec<Candidate<Amplitude>>,
    /// From session to session or run to run.
    pub levels: Vec<Candidate<Amplitude>>,
    /// In the track channel: slope and its rivals.
    pub track: Vec<Candidate<Amplitude>>,
    /// Effects that these data cannot speak of, and why.
    pub untestable: Vec<(String, String)>,
}

/// The catalogue and the person's own effects against what was recorded.
pub fn list(data: &Data, own: &Effects, along: bool) -> Candidates {
    let mut out = Candidates {
        regular: Vec::new(),
        local: Vec::new(),
        levels: Vec::new(),
        track: Vec::new(),
        untestable: Vec::new(),
    };
    for effect in CATALOGUE {
        let info = effect.info();
        let missing: Vec<&str> = info
            .needs
            .iter()
            .filter(|column| !data.available.contains(column))
            .map(|column| column.name())
            .collect();
        if !missing.is_empty() {
            let why = format!(
                "needs {}, which is not recorded or does not vary",
                missing.join(", ")
            );
            out.untestable.push((info.name.to_owned(), why));
            continue;
        }
        if !along && acts_only_along(*effect) {
            let why = "acts along the sled, and that channel is not used".to_owned();
            out.untestable.push((info.name.to_owned(), why));
            continue;
        }
        if matches!(info.level, Level::Session | Level::Run) && data.segmented {
            let why = "needs several runs; there is one".to_owned();
            out.untestable.push((info.name.to_owned(), why));
            continue;
        }
        let defaults: Vec<f64> = info.parameters.iter().map(|p| p.default).collect();
        for (index, parameter) in info.parameters.iter().enumerate() {
            if !parameter.is_amplitude() {
                continue;
            }
            let candidate = Candidate {
                effect: info.name.to_owned(),
                key: parameter.name.to_owned(),
                unit: parameter.unit.to_owned(),
                low: parameter.low,
                high: parameter.high,
                typical: parameter.typical,
                decides: info.decides.to_owned(),
                act: Amplitude {
                    kind: Kind::Catalogue(*effect),
                    parameter: index,
                    level: info.level,
                    values: defaults.clone(),
                    track: None,
                    carrier: None,
                },
            };
            match (info.level, info.name) {
                (Level::Track, "slope" | "track-profile") => out.track.push(candidate),
                (Level::Track, _) => out.local.push(candidate),
                (Level::Session | Level::Run, _) => out.levels.push(candidate),
                (Level::Sample, "warm-up") => {
                    for time in [3.0, 8.0, 20.0] {
                        let mut shaped = candidate.clone();
                        shaped.act.values[1] = time;
                        out.regular.push(shaped);
                    }
                }
                (Level::Sample, _) => {
                    if candidate.key == "x_mps2" || candidate.key == "pitch_rad" {
                        out.track.push(candidate.clone());
                    }
                    out.regular.push(candidate);
                }
            }
        }
    }
    for effect in &own.active {
        if let Kind::Custom(custom) = &effect.kind
            && effect.values[0] == 0.0
        {
            out.regular
                .push(own_candidate(&effect.name, custom.clone(), &effect.track));
        }
    }
    out
}

fn own_candidate(name: &str, custom: Custom, track: &Option<String>) -> Candidate<Amplitude> {
    Candidate {
        effect: name.to_owned(),
        key: "value".to_owned(),
        unit: custom.unit.clone(),
        low: custom.low,
        high: custom.high,
        // The expression is linear in its amplitude: any step gives the same direction.
        typical: 1e-3 * custom.high.clamp(1e-6, 1.0),
        decides: String::new(),
        act: Amplitude {
            kind: Kind::Custom(custom),
            parameter: 0,
            level: Level::Sample,
            values: vec![0.0],
            track: track.clone(),
            carrier: None,
        },
    }
}
