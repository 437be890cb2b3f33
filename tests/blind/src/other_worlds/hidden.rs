//! What a case of another world hides.

use super::wrong::Fault;

/// A hidden force, by the size that stands in its law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Force {
    Temperature,
    Speed,
    SlipDrag,
    DragArea,
    AeroYaw,
    SpeedGrip,
    TemperatureGrip,
    LoadGrip,
    Camber,
    Relaxation,
    PitchGrip,
    HumpGrip,
    ProductGrip,
    PitchDip,
}

/// A channel that is late by so much [s], under a name of its own.
const fn late(name: &'static str, channel: usize, case: &'static str, size: f64) -> Effect {
    let acts = Acts::Recorder(Fault::Delay(channel));
    effect(name, acts, "time_s", "s", size)
        .positive()
        .called(case)
}

/// What an effect changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Acts {
    /// Ice or air.
    Force(Force),
    /// A channel of the recorder.
    Recorder(Fault),
    /// The mass that the model states is too small by so much [kg].
    Mass,
    /// The yaw inertia of the model is too small by this factor.
    YawInertia,
    /// The true centre of gravity lies so much ahead of the model's [m].
    Centre,
    /// A wall that pushes at one place in every run [N].
    Wall,
    /// Walls at several places that some runs hit, harder or softer; the size is the lever of the bumper [m].
    Bumper(Chance),
}

/// Who hits a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Chance {
    /// Anybody, by chance.
    ByRun,
    /// By driver: one often and hard, one seldom and softly.
    ByDriver,
}

/// An effect that a world may hide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Its name in reports.
    pub name: &'static str,
    /// What its case is called: its name, and its size where there are several.
    pub case: &'static str,
    /// What it changes.
    pub acts: Acts,
    /// Key and unit of its parameter.
    pub key: &'static str,
    /// Unit of its parameter.
    pub unit: &'static str,
    /// A size that somebody who looks for it would meet.
    pub size: f64,
    /// Whether both signs occur.
    pub both: bool,
    /// Names that nobody could tell from it on such runs.
    pub class: &'static [&'static str],
}

const fn effect(
    name: &'static str,
    acts: Acts,
    key: &'static str,
    unit: &'static str,
    size: f64,
) -> Effect {
    Effect {
        name,
        case: name,
        acts,
        key,
        unit,
        size,
        both: true,
        class: &[],
    }
}

impl Effect {
    const fn positive(mut self) -> Effect {
        self.both = false;
        self
    }

    const fn called(mut self, case: &'static str) -> Effect {
        self.case = case;
        self
    }

    const fn like(mut self, class: &'static [&'static str]) -> Effect {
        self.class = class;
        self
    }
}

/// Everything that a world may hide.
pub const EFFECTS: &[Effect] = &[
    effect(
        "temperature",
        Acts::Force(Force::Temperature),
        "slope_per_k",
        "1/K",
        0.04,
    ),
    effect("speed", Acts::Force(Force::Speed), "exponent", "", 0.6).like(&[
        "drag-area",
        "air-density",
        "headwind",
    ]),
    effect("slip-drag", Acts::Force(Force::SlipDrag), "factor", "", 1.5).positive(),
    effect(
        "drag-area",
        Acts::Force(Force::DragArea),
        "cda_m2",
        "m2",
        0.05,
    )
    .like(&["air-density", "headwind", "speed"]),
    effect(
        "aero-yaw",
        Acts::Force(Force::AeroYaw),
        "per_deg",
        "1/deg",
        0.15,
    )
    .positive(),
    effect(
        "speed-grip",
        Acts::Force(Force::SpeedGrip),
        "slope_s_per_m",
        "s/m",
        0.008,
    ),
    effect(
        "temperature-grip",
        Acts::Force(Force::TemperatureGrip),
        "slope_per_k",
        "1/K",
        0.012,
    ),
    effect(
        "load-sensitivity",
        Acts::Force(Force::LoadGrip),
        "exponent",
        "",
        0.12,
    ),
    effect(
        "camber-thrust",
        Acts::Force(Force::Camber),
        "coefficient_per_rad",
        "1/rad",
        0.6,
    ),
    effect(
        "relaxation-length",
        Acts::Force(Force::Relaxation),
        "length_m",
        "m",
        0.25,
    )
    .positive()
    .like(&["slip-lag"]),
    effect(
        "slip-offset",
        Acts::Recorder(Fault::Bias(7)),
        "offset_rad",
        "rad",
        0.004,
    ),
    effect(
        "slip-scale",
        Acts::Recorder(Fault::Scale(7)),
        "factor",
        "",
        0.05,
    ),
    effect(
        "slip-lag",
        Acts::Recorder(Fault::Delay(7)),
        "time_s",
        "s",
        0.012,
    )
    .positive()
    .like(&["relaxation-length"]),
    effect(
        "steer-offset",
        Acts::Recorder(Fault::Bias(8)),
        "offset_rad",
        "rad",
        0.004,
    )
    .like(&["slip-offset"]),
    effect(
        "yaw-rate-scale",
        Acts::Recorder(Fault::Scale(5)),
        "factor",
        "",
        0.05,
    )
    .like(&["yaw-inertia"]),
    effect(
        "yaw-rate-bias",
        Acts::Recorder(Fault::Bias(5)),
        "offset_radps",
        "rad/s",
        0.02,
    ),
    effect(
        "speed-scale",
        Acts::Recorder(Fault::Scale(6)),
        "factor",
        "",
        0.02,
    ),
    effect(
        "accelerometer-bias",
        Acts::Recorder(Fault::Bias(1)),
        "y_mps2",
        "m/s2",
        0.15,
    )
    .like(&["accelerometer-tilt", "slip-offset"]),
    effect("mass", Acts::Mass, "excess_kg", "kg", 12.0),
    effect("yaw-inertia", Acts::YawInertia, "factor", "", 0.15),
    effect("wall-contact", Acts::Wall, "force_n", "N", 400.0).like(&["asperities"]),
    effect(
        "unknown:pitch_rate_radps",
        Acts::Force(Force::PitchGrip),
        "",
        "s/rad",
        0.25,
    ),
    effect("unknown:v_mps", Acts::Force(Force::HumpGrip), "", "", 0.12).like(&["speed-grip"]),
    effect(
        "steer-scale",
        Acts::Recorder(Fault::Scale(8)),
        "factor",
        "",
        0.06,
    ),
    effect(
        "speed-bias",
        Acts::Recorder(Fault::Bias(6)),
        "offset_mps",
        "m/s",
        0.6,
    )
    .like(&["speed-scale"]),
    effect(
        "speed-lag",
        Acts::Recorder(Fault::Delay(6)),
        "time_s",
        "s",
        0.1,
    )
    .positive(),
    effect(
        "roll-rate-scale",
        Acts::Recorder(Fault::Scale(3)),
        "factor",
        "",
        0.1,
    ),
    effect(
        "pitch-rate-scale",
        Acts::Recorder(Fault::Scale(4)),
        "factor",
        "",
        0.1,
    ),
    effect(
        "roll-split-bias",
        Acts::Recorder(Fault::Bias(9)),
        "offset_rad",
        "rad",
        0.02,
    )
    .like(&["camber-thrust", "steer-offset", "slip-offset"]),
    effect(
        "roll-split-scale",
        Acts::Recorder(Fault::Scale(9)),
        "factor",
        "",
        0.2,
    )
    .like(&["camber-thrust"]),
    effect(
        "accelerometer-scale",
        Acts::Recorder(Fault::Scale(1)),
        "y_factor",
        "",
        0.04,
    )
    .like(&["yaw-inertia", "mass"]),
    effect("cg-place", Acts::Centre, "x_m", "m", 0.08),
    late("yaw-rate-lag", 5, "yaw-rate-lag-2-ms", 0.002),
    late("slip-lag", 7, "slip-lag-2-ms", 0.002).like(&["relaxation-length"]),
    late("steer-lag", 8, "steer-lag-2-ms", 0.002),
    late("yaw-rate-lag", 5, "yaw-rate-lag-5-ms", 0.005),
    late("slip-lag", 7, "slip-lag-5-ms", 0.005).like(&["relaxation-length"]),
    late("steer-lag", 8, "steer-lag-5-ms", 0.005),
    late("yaw-rate-lag", 5, "yaw-rate-lag-20-ms", 0.02),
    late("slip-lag", 7, "slip-lag-20-ms", 0.02).like(&["relaxation-length"]),
    late("steer-lag", 8, "steer-lag-20-ms", 0.02),
    effect(
        "unknown:v_mps*gamma_rad",
        Acts::Force(Force::ProductGrip),
        "",
        "s/(m rad)",
        0.1,
    ),
    effect(
        "unknown:pitch_rate_radps",
        Acts::Force(Force::PitchDip),
        "",
        "",
        0.12,
    )
    .called("pitch-rate-dip"),
    effect(
        "wall-contact",
        Acts::Bumper(Chance::ByRun),
        "lever_m",
        "m",
        0.3,
    )
    .called("wall-contact-by-run"),
    effect(
        "wall-contact",
        Acts::Bumper(Chance::ByDriver),
        "lever_m",
        "m",
        0.3,
    )
    .called("wall-contact-by-driver"),
];

/// An effect with the size it has in a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hidden {
    /// The effect.
    pub effect: Effect,
    /// Its size.
    pub size: f64,
    /// Where a wall pushes [m].
    pub place_m: [f64; 2],
}

impl Hidden {
    /// The size of this force; 0 where another one is hidden.
    pub fn force(&self, force: Force) -> f64 {
        match self.effect.acts {
            Acts::Force(hidden) if hidden == force => self.size,
            _ => 0.0,
        }
    }
}
