//! Candidates that the data can test.

use kufe_sled::effects::{
    CATALOGUE, Custom, Effect, Effects, Info, Judged, Kind, Level, Reading, Sensor,
};

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::candidates::columns::covariates;
use crate::evidence::runs::recordings::prepare::Data;
use crate::options::{OUTSIDE_CATALOGUE, Options};
use crate::procedure::candidate::Candidate;

/// All candidates by the way in which they are tested.
#[derive(Default)]
pub struct Candidates {
    /// Within runs, everywhere.
    pub regular: Vec<Candidate<Amplitude>>,
    /// Within runs, in a window of distance that is searched for.
    pub local: Vec<Candidate<Amplitude>>,
    /// Between sessions or runs.
    pub levels: Vec<Candidate<Amplitude>>,
    /// In the track channel: slope and its rivals.
    pub track: Vec<Candidate<Amplitude>>,
    pub untestable: Vec<(String, String)>,
}

/// Lists the effects of the catalogue and custom effects that the recorded columns allow.
pub fn list(data: &Data, model: &Effects, along: bool, options: &Options) -> Candidates {
    let mut out = Candidates::default();
    for effect in CATALOGUE.iter() {
        let info = effect.info();
        if !options.includes(info.name) {
            continue;
        }
        if let Some(reason) = untestable_reason(info, data, along) {
            out.untestable.push((info.name.to_owned(), reason));
            continue;
        }
        for (index, parameter) in info.parameters.iter().enumerate() {
            if !parameter.is_amplitude() {
                continue;
            }
            let act = Amplitude {
                kind: Kind::Catalogue(effect),
                parameter: index,
                level: info.level(),
                values: info.off(),
                track: None,
                carrier: None,
            };
            let candidate = Candidate::of_catalogue(info, parameter, act);
            match info.judged {
                Judged::BySlope | Judged::ByProfile => out.track.push(candidate),
                Judged::InWindow => out.local.push(candidate),
                Judged::BetweenSessions | Judged::BetweenRuns => out.levels.push(candidate),
                Judged::WithinRuns => {
                    if against_slope(effect, index) {
                        out.track.push(candidate.clone());
                    }
                    out.regular.extend(with_trial_settings(candidate, effect));
                }
                Judged::ByPressure => {}
            }
        }
    }
    if options.includes(OUTSIDE_CATALOGUE) && !data.segmented {
        out.levels.extend(covariates(data, along));
    }
    for effect in &model.active {
        if let Kind::Custom(custom) = &effect.kind
            && effect.values[0] == 0.0
            && options.includes(&effect.name)
        {
            let candidate = custom_candidate(&effect.name, custom.clone(), &effect.track);
            out.regular.push(candidate);
        }
    }
    out
}

/// Why an effect cannot be tested; `None` if it can.
fn untestable_reason(info: &Info, data: &Data, along: bool) -> Option<String> {
    let missing = info.needs.iter().filter(|c| !data.available.contains(c));
    let missing: Vec<&str> = missing.map(|column| column.name()).collect();
    if !missing.is_empty() {
        let missing = missing.join(", ");
        return Some(format!(
            "needs {missing}, which is not recorded or does not vary"
        ));
    }
    if !along && info.acts_only_along() {
        return Some("acts along the sled, and that channel is not used".to_owned());
    }
    let is_of_runs = matches!(info.level(), Level::Session | Level::Run);
    (is_of_runs && data.segmented).then(|| "needs several runs; there is one".to_owned())
}

/// Whether the track channel can confuse an error of the speed or of the longitudinal accelerometer
/// with the slope. The accelerometer's scale is excluded, as its signal there is small.
fn against_slope(effect: &Effect, parameter: usize) -> bool {
    let mut faults = effect.on_sensors.iter();
    faults.any(|fault| {
        let is_confused = match fault.of {
            Sensor::Ax => fault.reading != Reading::Scaled,
            sensor => sensor == Sensor::Speed,
        };
        is_confused && fault.parameter == parameter
    })
}

/// The candidate with each trial value of its setting; the candidate itself without such a setting.
fn with_trial_settings(
    candidate: Candidate<Amplitude>,
    effect: &Effect,
) -> Vec<Candidate<Amplitude>> {
    let mut settings = effect.info.parameters.iter().enumerate();
    let Some((place, setting)) = settings.find(|(_, p)| !p.tried.is_empty()) else {
        return vec![candidate];
    };
    let with = |value: &f64| {
        let mut shaped = candidate.clone();
        shaped.act.values[place] = *value;
        shaped
    };
    setting.tried.iter().map(with).collect()
}

/// A custom effect that the model proposes with a value of 0, as a candidate.
fn custom_candidate(name: &str, custom: Custom, track: &Option<String>) -> Candidate<Amplitude> {
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
            parameter: 0,
            level: Level::Sample,
            values: vec![0.0],
            track: track.clone(),
            carrier: None,
            kind: Kind::Custom(custom),
        },
    }
}
