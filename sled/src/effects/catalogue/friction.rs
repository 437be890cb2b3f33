//! The friction coefficient, and what brakes along the runners.

use crate::effects::*;

const FRICTION: Info = Info {
    acts_on: &[ActsOn::Friction],
    ..Info::NEW
};

/// The friction coefficient, and what brakes along the runners.
pub(super) const EFFECTS: &[Effect] = &[
    // A rough stretch of ice: the asperity factors zeta_x = 1 + k and zeta_y = 1 + k_y of the
    // friction model on a part of the track. The lateral part grows with the slip there.
    Info {
        name: "asperities",
        summary: "a rough stretch of ice",
        formula: "mu (1 + k), on runs also F_y (1 + k_y), on a stretch",
        signature: "one place, the same in every run",
        acts_on: &[ActsOn::Friction, ActsOn::Across],
        parameters: &[
            amplitude("excess", "", -0.9, 20.0, 0.2),
            amplitude("grip_excess", "", -0.9, 5.0, 0.05),
            Parameter::FROM,
            Parameter::TO,
        ],
        needs: &[Column::Distance],
        judged: Judged::InWindow,
        looks_like: &["wall-contact", "track-profile"],
        decides: "the ice surface inspected there, and the stretch scraped",
        source: "the asperity factors zeta_x and zeta_y of the bobsled friction model",
        example: "0.5, 0, 100, 200: mu 0.004, s_m 150 -> mu 0.006",
        ..FRICTION
    }
    .effect()
    .on_friction(|p, mu, at| {
        if (p[2]..p[3]).contains(&at.s) {
            mu * (1.0 + p[0])
        } else {
            mu
        }
    })
    .on_forces(|p, at, forces| {
        if (p[2]..p[3]).contains(&at.point.s) {
            for runner in 0..2 {
                forces.along[runner] *= 1.0 + p[0];
                forces.across[runner] *= 1.0 + p[1];
            }
        }
    }),
    // Groove and melt film instead of a constant: the law that `kufe lut` computes for the
    // runners at hand, switched on by a share. m is what the runner's table of mu says at its
    // load, curvature, speed and ice temperature, over the mean of the table's nodes, so that
    // the level stays the base model's. Speed, load and temperature are its parts, and resemble
    // it where little varies.
    Info {
        name: "film",
        summary: "friction follows groove and melt film, as the runners' tables have them",
        formula: "mu (1 + k (m - 1)), m = mu_table/mean(mu_table)",
        signature: "over speed, load and curvature, and a level from session to session",
        parameters: &[amplitude("share", "", -1.0, 3.0, 0.5)],
        needs: &[Column::Film, Column::Speed],
        experiments: Experiments::Never("its tables are those of a sled's runners"),
        looks_like: &["speed", "load", "temperature", "warm-up"],
        decides: "runs on ice of other temperatures, and from other heights of start",
        source: "E. Lozowski, K. Szilder, S. Maw, Sports Eng. 16 (2013) 239-253; solved for \
            each runner by kufe lut",
        example: "0.5: mu 0.004, film 1.5 -> mu 0.005",
        ..FRICTION
    }
    .effect()
    .on_friction(|p, mu, at| mu * (1.0 + p[0] * (at.film - 1.0))),
    // Frost grows from humid air and roughens the ice (k > 0); h is the relative humidity.
    Info {
        name: "humidity",
        summary: "friction changes with the humidity of the air",
        formula: "mu (1 + k (h - h_ref))",
        signature: "a level from session to session",
        parameters: &[
            amplitude("slope_per_pct", "1/%", -0.05, 0.05, 0.002),
            setting("reference_pct", "%", 0.0, 100.0, 70.0),
        ],
        needs: &[Column::Humidity],
        judged: Judged::BetweenSessions,
        looks_like: &["temperature"],
        decides: "sessions of equal ice temperature and different humidity",
        source: "A.-M. Kietzig, S.G. Hatzikiriakos, P. Englezos, J. Appl. Phys. 107 (2010) \
            081101",
        example: "0.01, 70: mu 0.004, humidity_pct 80 -> mu 0.0044",
        ..FRICTION
    }
    .effect()
    .on_friction(|p, mu, at| mu * (1.0 + p[0] * (at.conditions.humidity_pct - p[1]))),
    // The friction coefficient changes with the normal force: n = -1/3 for a line contact with a
    // melt film, near 0 for plowing. Load and side force rise in the same curves: drag of
    // lateral slip has the same signature.
    Info {
        name: "load",
        summary: "friction changes with the normal force",
        formula: "mu (F_z/F_ref)^n",
        signature: "over load, in curves",
        parameters: &[
            amplitude("exponent", "", -1.0, 1.0, 0.05),
            setting("reference_n", "N", 1.0, 20000.0, 1000.0),
        ],
        needs: &[Column::Load],
        looks_like: &["plowing", "slip-drag", "accelerometer-tilt"],
        decides: "the same runs with ballast",
        source: "P. Oksanen, J. Keinonen, Wear 78 (1982) 315-324",
        example: "0.5, 1000: mu 0.004, fz_n 2250 -> mu 0.006",
        ..FRICTION
    }
    .effect()
    .on_friction(|p, mu, at| mu * (at.fz.max(1.0) / p[1]).powf(p[0])),
    // The runner plows a groove: its cross-section over load for a runner of constant section
    // radius, k >= 0. The hardness of ice is H(T) = (14.7 - 0.6 T) MPa, T in deg C.
    Info {
        name: "plowing",
        summary: "the runner plows a groove",
        formula: "mu + k sqrt(F_z/kN H(0)/H(T)), H = 14.7 - 0.6 T MPa",
        signature: "over load, stronger on warm ice",
        parameters: &[amplitude("coefficient", "", 0.0, 0.02, 0.0005)],
        needs: &[Column::Load, Column::IceTemperature],
        looks_like: &["load", "temperature"],
        decides: "ballast on ice of one temperature; the groove's profile after the run",
        source: "L. Poirier, E.P. Lozowski, R.I. Thompson, Cold Reg. Sci. Technol. 67 (2011) \
            129-134; E.P. Lozowski, K. Szilder, Int. J. Offshore Polar Eng. 23 (2013)",
        example: "0.001: mu 0.004, fz_n 4000, ice_c 0 -> mu 0.006",
        ..FRICTION
    }
    .effect()
    .on_friction(|p, mu, at| {
        if p[0] == 0.0 {
            return mu;
        }
        let softness = 14.7 / (14.7 - 0.6 * at.conditions.ice_c.min(0.0));
        mu + p[0] * (at.fz.max(0.0) / 1000.0 * softness).sqrt()
    }),
    // Slip brakes more than the side force explains: k is the share of the work of the side
    // force on the slip that ploughs sideways. Slip, side force and load rise in the same
    // curves.
    Info {
        name: "slip-drag",
        summary: "slip brakes more than the side force explains",
        formula: "F_x - k |F_y alpha| at each runner",
        signature: "slip squared",
        acts_on: &[ActsOn::Along],
        parameters: &[amplitude("factor", "", -2.0, 20.0, 0.1)],
        needs: &[Column::Slip],
        looks_like: &["aero-yaw", "load", "steer-drag"],
        decides: "runs of one driver with deliberate drifts on a straight",
        source: "driver evaluation of the bobsled friction model; F. Braghin, F. Cheli, S. \
            Melzi, E. Sabbioni, N. Poerio, The Engineering Approach to Winter Sports (2016)",
        example: "0.5: fy_f_n -300, alpha_f_rad 0.02, fx_f_n -7 -> fx_f_n -10",
        ..FRICTION
    }
    .effect()
    .on_forces(|p, at, forces| {
        for runner in 0..2 {
            forces.along[runner] -= p[0] * (forces.across[runner] * at.slip[runner]).abs();
        }
    }),
    // The friction coefficient changes with speed: n = -1/2 for frictional heating with a dry
    // fraction, +1/2 for a sheared film. Speed, time and distance run together on one track:
    // drag area, warm-up and slope have the same signature.
    Info {
        name: "speed",
        summary: "friction changes with speed",
        formula: "mu (v/v_ref)^n",
        signature: "over speed",
        parameters: &[
            amplitude("exponent", "", -1.5, 1.5, 0.1),
            setting("reference_mps", "m/s", 1.0, 60.0, 25.0),
        ],
        needs: &[Column::Speed],
        looks_like: &["drag-area", "warm-up", "headwind"],
        decides: "runs from a lower start, or a glide on a flat rink with the drag area varied",
        source: "D.C.B. Evans, J.F. Nye, K.J. Cheeseman, Proc. R. Soc. A 347 (1976) 493-512; \
            J.J. de Koning, G. de Groot, G.J. van Ingen Schenau, J. Biomechanics 25 (1992) \
            565-571",
        example: "0.5, 25: mu 0.004, v_mps 36 -> mu 0.0048",
        ..FRICTION
    }
    .effect()
    .on_friction(|p, mu, at| mu * (at.v.max(0.1) / p[1]).powf(p[0])),
    // Steering brakes: the steered runner scrubs in addition to the rotation of its side force.
    Info {
        name: "steer-drag",
        summary: "steering brakes",
        formula: "F_x,f - k F_z,f |delta|",
        signature: "the steering angle",
        acts_on: &[ActsOn::Along],
        parameters: &[amplitude("coefficient_per_rad", "1/rad", -5.0, 50.0, 0.05)],
        needs: &[Column::Steering],
        looks_like: &["slip-drag"],
        decides: "steering pulses on a straight",
        source: "L. Poirier, PhD thesis, University of Calgary (2011)",
        example: "0.1: fz_f_n 2000, delta_rad -0.02, fx_f_n -8 -> fx_f_n -12",
        ..FRICTION
    }
    .effect()
    .on_forces(|p, at, forces| {
        forces.along[0] -= p[0] * at.load[0].max(0.0) * at.steering.abs();
    }),
    // The friction coefficient changes with the ice temperature. Friction on ice has a minimum
    // at a few degrees below zero and grows towards cold ice (k < 0) as the melt film thins.
    Info {
        name: "temperature",
        summary: "friction changes with the ice temperature",
        formula: "mu (1 + k (T_ice - T_ref))",
        signature: "a level from session to session",
        parameters: &[
            amplitude("slope_per_k", "1/K", -0.2, 0.2, 0.01),
            setting("reference_c", "deg C", -40.0, 0.0, -5.0),
        ],
        needs: &[Column::IceTemperature],
        judged: Judged::BetweenSessions,
        looks_like: &["humidity", "wear"],
        decides: "sessions at other ice temperatures with the other conditions equal",
        source: "M. Akkok, C.M. McC. Ettles, S.J. Calabrese, J. Tribology 109 (1987) 552-561; \
            L. Poirier, PhD thesis, University of Calgary (2011)",
        example: "0.01, -5: mu 0.004, ice_c -10 -> mu 0.0038",
        ..FRICTION
    }
    .effect()
    .on_friction(|p, mu, at| mu * (1.0 + p[0] * (at.conditions.ice_c - p[1]))),
    // Friction is higher until the runner has warmed up; tau is the time in which the surface of
    // the steel settles. Speed, distance and slope are tied to time on one track.
    Info {
        name: "warm-up",
        summary: "friction is higher until the runner has warmed up",
        formula: "mu (1 + k exp(-t/tau))",
        signature: "over time from the start",
        parameters: &[
            amplitude("excess", "", -0.9, 10.0, 0.1),
            setting("time_s", "s", 0.1, 1000.0, 10.0).tried(&[3.0, 8.0, 20.0]),
        ],
        needs: &[Column::Time],
        looks_like: &["speed", "slope", "drag-area"],
        decides: "runs with preheated and with cold steel, and a start further down the track",
        source: "E. Lozowski, K. Szilder, S. Maw, Sports Eng. 16 (2013) 239-253 (heat into the \
            blade)",
        example: "0.5, 10: mu 0.004, t_s 0 -> mu 0.006",
        ..FRICTION
    }
    .effect()
    .on_friction(|p, mu, at| mu * (1.0 + p[0] * (-at.t / p[1]).exp())),
    // Scratches roughen the polished steel (k > 0); d is the distance run on this finish before
    // the run.
    Info {
        name: "wear",
        summary: "friction grows with the distance run on one finish",
        formula: "mu (1 + k d)",
        signature: "a level that climbs from run to run",
        parameters: &[amplitude("slope_per_km", "1/km", -0.2, 1.0, 0.02)],
        needs: &[Column::Wear],
        judged: Judged::BetweenRuns,
        looks_like: &["temperature", "humidity"],
        decides: "a run on freshly finished runners late in the session",
        source: "A.-M. Kietzig, S.G. Hatzikiriakos, P. Englezos, J. Appl. Phys. 106 (2009) \
            024303",
        example: "0.1: mu 0.004, distance_m 2500 -> mu 0.005",
        ..FRICTION
    }
    .effect()
    .on_friction(|p, mu, at| mu * (1.0 + p[0] * at.conditions.distance_m / 1000.0)),
];
