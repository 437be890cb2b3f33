//! Constants of the sled that differ from the stated ones.

use crate::effects::*;

const SLED: Info = Info {
    acts_on: &[ActsOn::Sled],
    ..Info::NEW
};

/// Constants of the sled that differ from the stated ones.
pub(super) const EFFECTS: &[Effect] = &[
    // The centre of gravity lies ahead of where it is said to be, by x: axles and sensors are as
    // much further back.
    Info {
        name: "cg-place",
        summary: "the centre of gravity is not where it is said to be",
        formula: "l_f - x, l_r + x; sensors at - x",
        signature: "the side force times x in the balance of moments, and the loads of the \
            axles",
        parameters: &[amplitude("x_m", "m", -0.5, 0.5, 0.02)],
        needs: &[Column::YawRate],
        looks_like: &["lever-arm", "yaw-inertia", "mass", "accelerometer-scale"],
        decides: "the loads of both axles on scales",
        source: "the balance of moments about the centre of gravity; W.F. Milliken, D.L. \
            Milliken, Race Car Vehicle Dynamics (1995), ch. 18",
        example: "0.05: l_r_m 0.88 -> l_r_m 0.93",
        ..SLED
    }
    .effect()
    .on_sled(|p, sled| {
        sled.axles[0] -= p[0];
        sled.axles[1] += p[0];
        sled.accelerometer[0] -= p[0];
        sled.slip_sensor -= p[0];
    }),
    // The accelerometer is at the stated position plus (dx, 0, dz). Noise of the slip angle
    // attenuates forces that the yaw acceleration then shows.
    Info {
        name: "lever-arm",
        summary: "the accelerometer is not where it is said to be",
        formula: "accelerometer at + (dx, 0, dz)",
        signature: "yaw acceleration (dx), roll acceleration (dz), in the lateral acceleration \
            alone",
        parameters: &[
            amplitude("x_m", "m", -1.5, 1.5, 0.02),
            amplitude("z_m", "m", -1.5, 1.5, 0.02),
        ],
        needs: &[Column::RollRate],
        looks_like: &["camber-thrust", "load-transfer", "yaw-inertia"],
        decides: "the sensor's place measured with a tape",
        source: "rigid-body kinematics",
        example: "0.05, 0: accel_x_m -0.35 -> accel_x_m -0.3",
        ..SLED
    }
    .effect()
    .on_sled(|p, sled| {
        sled.accelerometer[0] += p[0];
        sled.accelerometer[2] += p[1];
    }),
    // The sled is heavier or lighter than stated: forces from accelerations grow with the mass,
    // moments with the stated inertias do not. The cornering stiffnesses take up a common
    // factor.
    Info {
        name: "mass",
        summary: "the sled is heavier or lighter than stated",
        formula: "m + dm",
        signature: "the balance of side force and yaw moment",
        parameters: &[amplitude("excess_kg", "kg", -300.0, 600.0, 5.0)],
        needs: &[Column::VerticalAcceleration],
        looks_like: &["yaw-inertia", "slip-scale"],
        decides: "the sled on a scale",
        source: "Newton's second law",
        example: "15: mass_kg 390 -> mass_kg 405",
        ..SLED
    }
    .effect()
    .on_sled(|p, sled| sled.mass += p[0]),
    // The yaw moment of inertia is not the stated one, by a share k of it.
    Info {
        name: "yaw-inertia",
        summary: "the yaw moment of inertia is not the stated one",
        formula: "J_zz (1 + k)",
        signature: "yaw acceleration, in the balance of moments alone",
        parameters: &[amplitude("factor", "", -0.7, 2.0, 0.05)],
        needs: &[Column::YawRate],
        // Measured: without the tolerance it is named in campaigns whose sessions only differ in
        // grip by 5 %.
        judged: Judged::BeyondTolerance,
        looks_like: &["mass", "yaw-rate-scale", "lever-arm"],
        decides: "the sled swung on a trifilar suspension",
        source: "the balance of angular momentum about the vertical",
        example: "0.1: j_zz_kgm2 150 -> j_zz_kgm2 165",
        ..SLED
    }
    .effect()
    .on_sled(|p, sled| sled.yaw_inertia *= 1.0 + p[0]),
];
