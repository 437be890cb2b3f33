//! What a case may hide: effects of the catalogue, laws outside it, and causes that no effect and no
//! law of one column can represent.

/// How a hidden thing acts; the forces of [`super::ride`] and the readings of [`super::recorder`]
/// hold the formulas.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Acts {
    Temperature,
    Speed,
    SlipDrag,
    SteerDrag,
    DragArea,
    AeroYaw,
    SpeedGrip,
    TemperatureGrip,
    LoadGrip,
    Camber,
    Relaxation,
    Wall,
    Mass,
    YawInertia,
    Centre,
    /// Factor of a channel, by its place in a row.
    Scale(usize),
    /// Delay of a channel [s].
    Delay(usize),
    PitchGrip,
    RollFriction,
    HumpGrip,
    WarmRunnerGrip,
    Play,
    CrewSlides,
    DriftedSnow,
    Hysteresis,
    IceChips,
}

/// One thing that a case may hide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Name as in reports: of the catalogue, `unknown:COLUMN`, or `beyond:` with a cause that
    /// reports have no name for.
    pub name: &'static str,
    /// How it acts.
    pub acts: Acts,
    /// Key of its parameter in a model.
    pub key: &'static str,
    /// The parameter's unit.
    pub unit: &'static str,
    /// Size from which the wanted one is sought.
    pub start: f64,
    /// Largest size.
    pub most: f64,
    /// Whether it may be negative.
    pub signed: bool,
    /// Names that measured runs may be unable to distinguish from it.
    pub class: &'static [&'static str],
}

const fn effect(
    name: &'static str,
    acts: Acts,
    key: &'static str,
    unit: &'static str,
    [start, most]: [f64; 2],
    signed: bool,
    class: &'static [&'static str],
) -> Effect {
    Effect {
        name,
        acts,
        key,
        unit,
        start,
        most,
        signed,
        class,
    }
}

/// Effects of the catalogue.
#[rustfmt::skip]
pub const CATALOGUE: &[Effect] = &[
    effect("temperature", Acts::Temperature, "slope_per_k", "1/K", [0.03, 0.15], true, &[]),
    effect("speed", Acts::Speed, "exponent", "", [0.3, 3.0], true, &["drag-area", "air-density", "headwind"]),
    effect("slip-drag", Acts::SlipDrag, "factor", "", [0.5, 8.0], false, &[]),
    effect("steer-drag", Acts::SteerDrag, "coefficient_per_rad", "1/rad", [0.02, 0.5], false, &[]),
    effect("drag-area", Acts::DragArea, "cda_m2", "m2", [0.03, 0.15], true, &["air-density", "headwind", "speed"]),
    effect("aero-yaw", Acts::AeroYaw, "per_deg", "1/deg", [0.1, 1.0], false, &["slip-drag"]),
    effect("speed-grip", Acts::SpeedGrip, "slope_s_per_m", "s/m", [0.004, 0.03], true, &[]),
    effect("temperature-grip", Acts::TemperatureGrip, "slope_per_k", "1/K", [0.008, 0.06], true, &[]),
    effect("load-sensitivity", Acts::LoadGrip, "exponent", "", [0.06, 0.4], true, &[]),
    effect("camber-thrust", Acts::Camber, "coefficient_per_rad", "1/rad", [0.05, 0.6], true, &[]),
    effect("relaxation-length", Acts::Relaxation, "length_m", "m", [0.1, 1.0], false, &["slip-lag"]),
    effect("wall-contact", Acts::Wall, "force_n", "N", [200.0, 1500.0], true, &["asperities"]),
    effect("mass", Acts::Mass, "excess_kg", "kg", [8.0, 60.0], true, &[]),
    effect("yaw-inertia", Acts::YawInertia, "factor", "", [0.08, 0.5], true, &["yaw-rate-scale"]),
    effect("cg-place", Acts::Centre, "x_m", "m", [0.03, 0.2], true, &[]),
    effect("slip-scale", Acts::Scale(7), "factor", "", [0.04, 0.3], true, &[]),
    effect("steer-scale", Acts::Scale(8), "factor", "", [0.04, 0.4], true, &[]),
    effect("yaw-rate-scale", Acts::Scale(5), "factor", "", [0.03, 0.2], true, &["yaw-inertia"]),
    effect("speed-scale", Acts::Scale(6), "factor", "", [0.01, 0.1], true, &[]),
    effect("yaw-rate-lag", Acts::Delay(5), "time_s", "s", [0.01, 0.08], false, &[]),
    effect("slip-lag", Acts::Delay(7), "time_s", "s", [0.01, 0.08], false, &["relaxation-length"]),
];

/// Laws of one column that no effect of the catalogue has.
#[rustfmt::skip]
pub const LAWS: &[Effect] = &[
    // F_y (1 + k q^2)
    effect("unknown:pitch_rate_radps", Acts::PitchGrip, "", "s2/rad2", [0.05, 0.6], true, &[]),
    // mu (1 + k p^2)
    effect("unknown:roll_rate_radps", Acts::RollFriction, "", "s2/rad2", [0.5, 12.0], false, &[]),
    // F_y (1 + k exp(-((v - 24)/3)^2))
    effect("unknown:v_mps", Acts::HumpGrip, "", "", [0.05, 0.5], true, &[]),
    // F_y (1 + k T), T of the runner, which is recorded
    effect("unknown:runner_c", Acts::WarmRunnerGrip, "", "1/K", [0.02, 0.3], true, &[]),
];

/// Causes that nothing in the catalogue and no law of recorded columns can represent.
#[rustfmt::skip]
pub const CAUSES: &[Effect] = &[
    // play of the steering
    effect("beyond:steering-play", Acts::Play, "", "rad", [0.004, 0.06], false, &[]),
    // the crew slides along the sled by k times the vertical load of the last 0.5 s
    effect("beyond:crew-slides", Acts::CrewSlides, "", "s2", [0.002, 0.01], true, &[]),
    // mu (1 + k w(s)), w a smooth curve of unit variance, another one in each session
    effect("beyond:drifted-snow", Acts::DriftedSnow, "", "", [0.1, 0.5], false, &[]),
    // F_y (1 + k tanh(x/1 mrad)), x = (alpha - mean of alpha over 50 ms) sign(alpha)
    effect("beyond:hysteresis", Acts::Hysteresis, "", "", [0.05, 0.5], true, &[]),
    // mu (1 + k) for 0.4 s, four times a run, anywhere
    effect("beyond:ice-chips", Acts::IceChips, "", "", [0.5, 8.0], false, &[]),
];

/// A thing hidden in a case.
#[derive(Debug, Clone, Copy)]
pub struct Hidden {
    /// What it is.
    pub effect: Effect,
    /// Its size, in its unit.
    pub size: f64,
    /// Where it acts if it is a wall: from, to [m], on the first track.
    pub place_m: [f64; 2],
}

/// All that is hidden in a case.
#[derive(Debug, Clone, Default)]
pub struct Secret(pub Vec<Hidden>);

impl Secret {
    /// Size of what acts like this, 0 if nothing does.
    pub fn of(&self, acts: Acts) -> f64 {
        let same = self.0.iter().find(|hidden| hidden.effect.acts == acts);
        same.map_or(0.0, |hidden| hidden.size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_searched_from_a_positive_start() {
        for effect in CATALOGUE.iter().chain(LAWS).chain(CAUSES) {
            let sizes = [effect.start, effect.most];
            assert!(
                0.0 < sizes[0] && sizes[0] < sizes[1],
                "{} {sizes:?}",
                effect.name
            );
        }
    }
}
