//! Side forces of the runners.

use crate::effects::*;

const GRIP: Info = Info {
    acts_on: &[ActsOn::Across],
    ..Info::NEW
};

/// Side forces of the runners.
pub(super) const EFFECTS: &[Effect] = &[
    // The turned front runner pushes sideways: leaning by the roll split it cuts in.
    Info {
        name: "camber-thrust",
        summary: "the turned front runner pushes sideways",
        formula: "F_y,f + k gamma F_z,f",
        signature: "roll-split angle times load, front only",
        parameters: &[amplitude("coefficient_per_rad", "1/rad", -10.0, 10.0, 0.02)],
        needs: &[Column::RollSplit],
        looks_like: &["lever-arm", "load-transfer"],
        decides: "runs with the roll split locked",
        source: "H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 4",
        example: "0.5: fy_f_n 300, gamma_rad -0.02, fz_f_n 2000 -> fy_f_n 280",
        ..GRIP
    }
    .effect()
    .on_forces(|p, at, forces| {
        forces.across[0] += p[0] * at.roll_split * at.load[0];
    }),
    // Braking or driving takes grip from the side force: F_x/F_z from the accelerometer,
    // a_x/a_z.
    Info {
        name: "combined-slip",
        summary: "braking or driving takes grip from the side force",
        formula: "F_y/(1 + k (a_x/a_z)^2)",
        signature: "longitudinal acceleration squared, in curves",
        parameters: &[amplitude("factor", "", -5.0, 1.0e3, 0.1)],
        needs: &[Column::LongitudinalAcceleration],
        looks_like: &["saturation"],
        decides: "curves taken with and without braking",
        source: "H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 4 (friction \
            ellipse)",
        example: "100: fy_f_n 300, ax_mps2 -2, az_mps2 20 -> fy_f_n 150",
        ..GRIP
    }
    .effect()
    .on_forces(|p, at, forces| {
        let ratio = at.acceleration[0] / at.acceleration[2].max(1.0);
        let factor = 1.0 / (1.0 + p[0] * ratio * ratio).max(0.05);
        for across in &mut forces.across {
            *across *= factor;
        }
    }),
    // Lateral grip over load is no straight line.
    Info {
        name: "load-sensitivity",
        summary: "lateral grip changes with the load",
        formula: "F_y (F_z/F_ref)^n",
        signature: "over load",
        parameters: &[
            amplitude("exponent", "", -1.5, 1.5, 0.03),
            setting("reference_n", "N", 1.0, 20000.0, 2000.0),
        ],
        needs: &[Column::Load],
        looks_like: &["saturation", "speed-grip"],
        decides: "the same runs with ballast",
        source: "H.B. Pacejka, E. Bakker, Vehicle System Dynamics 21 (1992) sup. 1, 1-18",
        example: "-0.5, 2000: fy_f_n 300, fz_f_n 4500 -> fy_f_n 200",
        ..GRIP
    }
    .effect()
    .on_forces(|p, at, forces| {
        for runner in 0..2 {
            forces.across[runner] *= (at.load[runner].max(1.0) / p[1]).powf(p[0]);
        }
    }),
    // Roll acceleration moves load between left and right; with a degressive lateral law the
    // axle loses grip by the square of the shift.
    Info {
        name: "load-transfer",
        summary: "roll acceleration shifts load from runner to runner",
        formula: "F_y/(1 + k phi_dd^2)",
        signature: "roll acceleration, at the ends of curves",
        parameters: &[amplitude("per_radps2_squared", "s4/rad2", -1.0, 10.0, 0.02)],
        needs: &[Column::RollRate],
        looks_like: &["camber-thrust", "lever-arm"],
        decides: "runs with the roll excited on a straight",
        source: "W.F. Milliken, D.L. Milliken, Race Car Vehicle Dynamics (1995), ch. 7 and 18",
        example: "0.25: fy_f_n 300, roll_rate_radps_rate 2 -> fy_f_n 150",
        ..GRIP
    }
    .effect()
    .on_forces(|p, at, forces| {
        let factor = 1.0 / (1.0 + p[0] * at.roll_acceleration * at.roll_acceleration).max(0.05);
        for across in &mut forces.across {
            *across *= factor;
        }
    }),
    // The side force follows the slip after a distance: sigma/v dalpha'/dt + alpha' = alpha, the
    // force being that of alpha', to first order in how far alpha' is behind. A lag of the slip
    // sensor does not depend on speed.
    Info {
        name: "relaxation-length",
        summary: "the side force follows the slip after a distance",
        formula: "F_y - (sigma/v) dF_y/dalpha dalpha'/dt",
        signature: "slip rate over speed",
        parameters: &[amplitude("length_m", "m", -5.0, 10.0, 0.05)],
        needs: &[Column::Slip],
        form: Form::FirstOrder,
        looks_like: &["slip-lag", "steer-lag"],
        decides: "steering steps at low and at high speed",
        source: "H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 7",
        example: "0.5: fy_f_n 300, fy_f_n_per_rad 20000, alpha_f_rad_rate 0.1, v_mps 25 -> \
            fy_f_n 260",
        ..GRIP
    }
    .effect()
    .on_forces(|p, at, forces| {
        for runner in 0..2 {
            let lag = p[0] / at.point.v.max(1.0);
            forces.across[runner] -= lag * forces.stiffness[runner] * at.slip_rate[runner];
        }
    })
    .relaxes_after(0),
    // The side force saturates: kappa = 1/mu_y^2 with mu_y the largest side force over load;
    // front, rear, or both runners alike.
    Info {
        name: "saturation",
        summary: "the side force saturates",
        formula: "F_y/sqrt(1 + kappa (F_y/F_z)^2), kappa = 1/mu_y^2",
        signature: "the cube of the side force",
        parameters: &[
            amplitude("front", "", -20.0, 2.0e3, 0.2),
            amplitude("rear", "", -20.0, 2.0e3, 0.2),
            amplitude("both", "", -20.0, 2.0e3, 0.2),
        ],
        needs: &[Column::Slip],
        looks_like: &["load-sensitivity", "slip-scale"],
        decides: "drifts at large slip",
        source: "E. Fiala, VDI-Z 96 (1954); H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. \
            (2012)",
        example: "0, 0, 300: fy_r_n 200, fz_r_n 2000 -> fy_r_n 100",
        ..GRIP
    }
    .effect()
    .on_forces(|p, at, forces| {
        for runner in 0..2 {
            let ratio = forces.across[runner] / at.load[runner].max(1.0);
            let kappa = p[runner] + p[2];
            forces.across[runner] /= (1.0 + kappa * ratio * ratio).max(0.05).sqrt();
        }
    }),
    // Lateral grip changes with speed.
    Info {
        name: "speed-grip",
        summary: "lateral grip changes with speed",
        formula: "F_y (1 + k (v - v_ref))",
        signature: "over speed",
        parameters: &[
            amplitude("slope_s_per_m", "s/m", -0.02, 0.2, 0.002),
            setting("reference_mps", "m/s", 0.0, 60.0, 25.0),
        ],
        needs: &[Column::Speed],
        looks_like: &["load-sensitivity", "saturation", "speed-scale"],
        decides: "the same curve driven from a lower start",
        source: "F. Braghin and others, The Engineering Approach to Winter Sports (2016), \
            lateral friction of bobsled runners",
        example: "0.01, 25: fy_r_n 500, v_mps 35 -> fy_r_n 550",
        ..GRIP
    }
    .effect()
    .on_forces(|p, at, forces| {
        let factor = 1.0 + p[0] * (at.point.v - p[1]);
        for across in &mut forces.across {
            *across *= factor;
        }
    }),
    // Colder ice is harder and lets the runner cut in less.
    Info {
        name: "temperature-grip",
        summary: "lateral grip changes with the ice temperature",
        formula: "F_y (1 + k (T_ice - T_ref))",
        signature: "a level from session to session",
        parameters: &[
            amplitude("slope_per_k", "1/K", -0.2, 0.2, 0.01),
            setting("reference_c", "deg C", -40.0, 0.0, -5.0),
        ],
        needs: &[Column::IceTemperature],
        judged: Judged::BetweenSessions,
        looks_like: &[],
        decides: "sessions at other ice temperatures",
        source: "L. Poirier, E.P. Lozowski, R.I. Thompson, Cold Reg. Sci. Technol. 67 (2011) \
            129-134",
        example: "0.02, -5: fy_r_n 500, ice_c -10 -> fy_r_n 450",
        ..GRIP
    }
    .effect()
    .on_forces(|p, at, forces| {
        let factor = 1.0 + p[0] * (at.point.conditions.ice_c - p[1]);
        for across in &mut forces.across {
            *across *= factor;
        }
    }),
];
