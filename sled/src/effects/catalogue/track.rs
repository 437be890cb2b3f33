//! The shape of the track, and events at one place of it.

use crate::effects::*;

const TRACK: Info = Info {
    acts_on: &[ActsOn::Track],
    ..Info::NEW
};

/// The shape of the track, and events at one place of it.
pub(super) const EFFECTS: &[Effect] = &[
    // The track is steeper or flatter than stated, downhill positive. An accelerometer does not
    // feel it; the speed does. A glide takes it for less friction, exactly, unless both
    // directions are run.
    Info {
        name: "slope",
        summary: "the track is steeper or flatter than stated",
        formula: "slope + k, downhill positive",
        signature: "a constant in the difference of the derivative of the speed and the \
            accelerometer",
        acts_on: &[ActsOn::Track, ActsOn::Friction],
        parameters: &[amplitude("offset_rad", "rad", -0.05, 0.05, 0.0005)],
        needs: &[Column::Slope],
        judged: Judged::BySlope,
        experiments: Experiments::Never(
            "is the same as another level of friction unless both directions are run",
        ),
        looks_like: &["accelerometer-bias", "accelerometer-tilt"],
        decides: "a levelled track, or runs in both directions",
        source: "the paired uphill and downhill glides of the ice-house experiments (a slope \
            of about 0.12 degrees averages out)",
        example: "0.002: slope_rad 0.05 -> slope_rad 0.052",
        ..TRACK
    }
    .effect()
    .on_friction(|p, mu, _| mu - p[0])
    .on_slope(|p, _| p[0]),
    // The surveyed profile is off at places, downhill positive: the same in every run, a random
    // effect with the stated survey deviation. Rough ice has the same signature where no
    // accelerometer is used.
    Info {
        name: "track-profile",
        summary: "the profile of the track is off at places",
        formula: "slope + k on a stretch, downhill positive",
        signature: "by place, in the derivative of the speed alone",
        parameters: &[
            amplitude("offset_rad", "rad", -0.05, 0.05, 0.001),
            Parameter::FROM,
            Parameter::TO,
        ],
        needs: &[Column::Slope, Column::Distance],
        judged: Judged::ByProfile,
        looks_like: &["slope", "asperities"],
        decides: "a survey of the track",
        source: "mixed models with a random profile: N.M. Laird, J.H. Ware, Biometrics 38 \
            (1982) 963-974",
        example: "0.002, 100, 200: slope_rad 0.05, s_m 150 -> slope_rad 0.052",
        ..TRACK
    }
    .effect()
    .on_slope(|p, s| if (p[1]..p[2]).contains(&s) { p[0] } else { 0.0 }),
    // The sled touches the wall: a force F before the centre of gravity by a lever x, positive
    // to the left, and the friction f of the bumper. Where the force has a spread from run to
    // run it is half a wave, `F sin^2(pi (s - from) / (to - from))`: a bumper is pressed in and
    // springs back. A run that was recorded has a force and a stretch of its own then, which its
    // side balance sets (`kufe_sled::with_own_contacts`); a run that is simulated has those
    // stated.
    Info {
        name: "wall-contact",
        summary: "the sled touches the wall",
        formula: "F_y + F, M_z + x F, F_x - f |F|, on a stretch",
        signature: "one place; with a spread in some runs only, harder or softer",
        acts_on: &[ActsOn::Across, ActsOn::Along],
        parameters: &[
            amplitude("force_n", "N", -20000.0, 20000.0, 100.0),
            Parameter::FROM,
            Parameter::TO,
            setting("friction", "", 0.0, 1.0, 0.0),
            setting("lever_m", "m", -3.0, 3.0, 0.0),
            Parameter::SPREAD,
            setting("within_m", "m", 0.0, 100.0, 0.0),
        ],
        needs: &[Column::Distance],
        judged: Judged::InWindow,
        looks_like: &["asperities"],
        decides: "a camera, or marks on the wall, at that place",
        source: "the wall contacts near 500 m and 800 m in the validation of the bobsled \
            friction model",
        example: "500, 10, 30, 0.2, 0.1, 300, 5: s_m 20 -> fx_n -100",
        ..TRACK
    }
    .effect()
    .on_forces(|p, at, forces| {
        let along = (at.point.s - p[1]) / (p[2] - p[1]);
        if !(0.0..1.0).contains(&along) {
            return;
        }
        let force = match p[5] > 0.0 {
            true => p[0] * (std::f64::consts::PI * along).sin().powi(2),
            false => p[0],
        };
        forces.body_across += force;
        forces.body_yaw += p[4] * force;
        forces.body_along -= p[3] * force.abs();
    }),
];
