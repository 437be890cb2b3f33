//! Everything that a world may hide.

use super::hidden::{Acts, Chance, Effect, Force, effect};
use super::wrong::Fault;

/// A channel that is late by so much [s], under a name of its own.
const fn late(name: &'static str, channel: usize, case: &'static str, size: f64) -> Effect {
    let acts = Acts::Recorder(Fault::Delay(channel));
    effect(name, acts, "time_s", "s", size)
        .positive()
        .called(case)
}

/// What a world may hide in a requested size: all but lags, which have fixed sizes.
pub fn sized() -> impl Iterator<Item = Effect> {
    let in_ms = |e: &Effect| e.case.ends_with("-ms");
    let lags = [
        late("yaw-rate-lag", 5, "yaw-rate-lag", 0.01),
        late("steer-lag", 8, "steer-lag", 0.01),
    ];
    EFFECTS
        .iter()
        .filter(move |e| !in_ms(e))
        .copied()
        .chain(lags)
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
    effect(
        "unknown:yaw_rate_radps",
        Acts::Recorder(Fault::Saturating(5)),
        "",
        "rad/s",
        0.7,
    )
    .positive()
    .called("yaw-rate-saturates"),
    effect(
        "unknown:t_s",
        Acts::Recorder(Fault::Warming(7)),
        "",
        "rad",
        0.004,
    )
    .like(&["slip-offset"])
    .called("slip-warms-up"),
    effect(
        "unknown:v_mps",
        Acts::Recorder(Fault::Stepping(6)),
        "",
        "m/s",
        0.8,
    )
    .like(&["speed-bias", "speed-scale"])
    .called("speed-steps"),
    effect(
        "unknown:delta_rad",
        Acts::Recorder(Fault::Bowed(8)),
        "",
        "1/rad",
        2.0,
    )
    .called("steer-bowed"),
];
