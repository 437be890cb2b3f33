//! The effects that could be missing, as far as the data can speak of them.

use kufe_sled::effects::{
    Active, CATALOGUE, Channel, Column, Custom, Effects, Expression, Judged, Kind, Level,
};
use kufe_sled::effects::{Effect, Sensor};

use super::data::Data;

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
    /// A recorded column outside the model that the expression names.
    pub carrier: Option<String>,
}

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
            if let Some([begin, end]) = effect.info.window() {
                (local.values[begin], local.values[end]) = (from, to);
            }
        }
        local
    }

    /// The stretch of distance on which it acts, where it has one [m].
    pub fn window(&self) -> Option<(f64, f64)> {
        let Kind::Catalogue(effect) = &self.kind else {
            return None;
        };
        let [begin, end] = effect.info.window()?;
        Some((self.values[begin], self.values[end]))
    }

    /// Whether it is judged place by place along the track's profile.
    pub fn is_profile(&self) -> bool {
        matches!(&self.kind, Kind::Catalogue(effect) if effect.info.judged == Judged::ByProfile)
    }

    /// Whether it is no effect of the catalogue but a dependence on a column.
    pub fn is_unknown(&self) -> bool {
        self.effect.starts_with("unknown:")
    }

    /// The values of its carrier in a run.
    pub fn carried<'a>(&self, frame: &'a super::data::Frame) -> Option<&'a [f64]> {
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

/// All candidates by the way in which they are tested.
pub struct Candidates {
    /// Within runs, everywhere.
    pub regular: Vec<Candidate>,
    /// Within runs, in a window of distance that is searched for.
    pub local: Vec<Candidate>,
    /// From session to session or run to run.
    pub levels: Vec<Candidate>,
    /// In the track channel: slope and its rivals.
    pub track: Vec<Candidate>,
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
        if !along && info.acts_only_along() {
            let why = "acts along the sled, and that channel is not used".to_owned();
            out.untestable.push((info.name.to_owned(), why));
            continue;
        }
        if matches!(info.level(), Level::Session | Level::Run) && data.segmented {
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
                kind: Kind::Catalogue(*effect),
                parameter: index,
                key: parameter.name.to_owned(),
                unit: parameter.unit.to_owned(),
                low: parameter.low,
                high: parameter.high,
                typical: parameter.typical,
                level: info.level(),
                values: defaults.clone(),
                track: None,
                decides: info.decides.to_owned(),
                carrier: None,
            };
            match info.judged {
                Judged::BySlope | Judged::ByProfile => out.track.push(candidate),
                Judged::InWindow => out.local.push(candidate),
                Judged::BetweenSessions | Judged::BetweenRuns => out.levels.push(candidate),
                Judged::WithinRuns => {
                    if reads_ahead(effect, index) {
                        out.track.push(candidate.clone());
                    }
                    out.regular.extend(shapes(candidate, effect));
                }
                Judged::ByPressure => {}
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

/// Whether an amplitude is a fault of the accelerometer ahead, which the track channel holds against the slope.
fn reads_ahead(effect: &Effect, parameter: usize) -> bool {
    let mut faults = effect.on_sensors.iter();
    faults.any(|fault| fault.of == Sensor::Ax && fault.parameter == parameter)
}

/// The candidate with every value of a setting that is to be tried.
fn shapes(candidate: Candidate, effect: &Effect) -> Vec<Candidate> {
    let mut settings = effect.info.parameters.iter().enumerate();
    let Some((place, setting)) = settings.find(|(_, p)| !p.tried.is_empty()) else {
        return vec![candidate];
    };
    let with = |value: &f64| {
        let mut shaped = candidate.clone();
        shaped.values[place] = *value;
        shaped
    };
    setting.tried.iter().map(with).collect()
}

fn own_candidate(name: &str, custom: Custom, track: &Option<String>) -> Candidate {
    Candidate {
        effect: name.to_owned(),
        parameter: 0,
        key: "value".to_owned(),
        unit: custom.unit.clone(),
        low: custom.low,
        high: custom.high,
        // The expression is linear in its amplitude: any step gives the same direction.
        typical: 1e-3 * custom.high.clamp(1e-6, 1.0),
        level: Level::Sample,
        values: vec![0.0],
        track: track.clone(),
        decides: String::new(),
        carrier: None,
        kind: Kind::Custom(custom),
    }
}

/// Dependences on single columns beyond the catalogue: a slope and a bend of the friction and of the grip, and a side force.
///
/// Columns that the model has no name for, the pitch rate among them, are handed in as carriers: they are judged, but no
/// simulation could follow them.
pub fn unknown(data: &Data, mass: f64, along: bool) -> Vec<Candidate> {
    let known = [
        ("v_mps", Column::Speed),
        ("fz_n", Column::Load),
        ("alpha_rad", Column::Slip),
        ("delta_rad", Column::Steering),
        ("gamma_rad", Column::RollSplit),
        ("roll_rate_radps", Column::RollRate),
        ("roll_acceleration_radps2", Column::RollRate),
        ("t_s", Column::Time),
    ];
    let mut columns: Vec<(String, Option<String>)> = known
        .iter()
        .filter(|(_, column)| data.available.contains(column))
        .map(|(name, _)| ((*name).to_owned(), None))
        .collect();
    let mut carried = vec!["pitch_rate_radps".to_owned()];
    if let Some(frame) = data.frames.first() {
        let everywhere = |name: &&String| data.frames.iter().all(|f| f.extra.contains_key(*name));
        let own = |name: &&String| name.as_str() != "humidity_pct" && name.as_str() != "distance_m";
        carried.extend(frame.extra.keys().filter(everywhere).filter(own).cloned());
    }
    columns.extend(carried.into_iter().map(|name| (name.clone(), Some(name))));
    let mut out = Vec::new();
    for (name, carrier) in columns {
        let Some((centre, scale)) = spread(data, mass, &name) else {
            continue;
        };
        let x = Expression::quoted(&name);
        let z = format!("(({x} - {centre:.6e}) / {scale:.6e})");
        let size = format!("abs({x}) / {scale:.6e}");
        let mut forms = vec![
            (Channel::Grip, z.clone(), 0.02, ""),
            (Channel::Grip, format!("{z}^2"), 0.02, ""),
            (Channel::Lateral, format!("{x} / {scale:.6e}"), 10.0, "N"),
        ];
        if along {
            forms.push((Channel::Friction, z.clone(), 1e-4, ""));
            forms.push((Channel::Friction, format!("{z}^2"), 1e-4, ""));
        }
        if centre.abs() < scale {
            // Signs change: the column's size is a form of its own.
            forms.push((Channel::Grip, size.clone(), 0.02, ""));
            if along {
                forms.push((Channel::Friction, size, 1e-4, ""));
            }
        }
        for (channel, text, typical, unit) in forms {
            let Some(custom) = Custom::new(channel, &text, carrier.as_deref()) else {
                continue;
            };
            let limit = if channel == Channel::Lateral {
                1e5
            } else {
                10.0
            };
            out.push(Candidate {
                effect: format!("unknown:{name}"),
                kind: Kind::Custom(custom.bounded(unit, -limit, limit)),
                parameter: 0,
                key: "value".to_owned(),
                unit: unit.to_owned(),
                low: -limit,
                high: limit,
                typical,
                level: Level::Sample,
                values: vec![0.0],
                track: None,
                decides: format!("runs in which {name} is varied by itself"),
                carrier: carrier.clone(),
            });
        }
    }
    out
}

fn spread(data: &Data, mass: f64, name: &str) -> Option<(f64, f64)> {
    let mut all: Vec<f64> = Vec::new();
    for frame in &data.frames {
        let column: &[f64] = match name {
            "v_mps" => &frame.v,
            "fz_n" => &frame.acceleration[2],
            "alpha_rad" => &frame.slip,
            "delta_rad" => &frame.steer,
            "gamma_rad" => &frame.roll_split,
            "roll_rate_radps" => &frame.rate[0],
            "pitch_rate_radps" => &frame.rate[1],
            "roll_acceleration_radps2" => &frame.rate_slope[0],
            "t_s" => &frame.t,
            other => frame.extra.get(other)?,
        };
        let unit = if name == "fz_n" { mass } else { 1.0 };
        all.extend(column.iter().map(|x| unit * x));
    }
    let n = all.len() as f64;
    let mean = all.iter().sum::<f64>() / n;
    let sd = (all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    (sd > 0.0).then_some((mean, sd))
}
