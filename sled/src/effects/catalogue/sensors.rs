//! Faults of the sensors.

use crate::effects::*;

const SENSOR: Info = Info {
    acts_on: &[ActsOn::Sensor],
    ..Info::NEW
};

/// A channel that is late.
///
/// A delay common to all channels is one clock, which no residual shows: only the delay of a
/// channel relative to the others is identifiable.
const LATE: Info = Info {
    parameters: &[amplitude("time_s", "s", -0.2, 0.5, 0.002)],
    decides: "one shock that all sensors feel",
    source: "group delay of a digital low pass: half its length, 1 to 20 ms in loggers of \
            100 to 1000 Hz",
    ..SENSOR
};

/// A channel that reads a share too much or too little.
const SCALED: Info = Info {
    parameters: &[amplitude("factor", "", -0.5, 1.0, 0.02)],
    ..SENSOR
};

/// A gyroscope with an offset.
const GYRO_BIAS: Info = Info {
    parameters: &[amplitude("offset_radps", "rad/s", -0.2, 0.2, 0.002)],
    decides: "the sled at rest",
    source: "data sheets of MEMS gyroscopes: rate offsets within 0.1 to 3 deg/s; IEEE Std 952",
    ..SENSOR
};

/// A gyroscope with a wrong scale.
const GYRO_SCALE: Info = Info {
    decides: "the sled turned about this axis by a known angle",
    source: "data sheets of MEMS gyroscopes: scale factors within 0.1 to 3 %; IEEE Std 952",
    ..SCALED
};

/// Slip, steering and roll-split angle.
pub(super) const ANGLES: &[Effect] = &[
    Info {
        name: "roll-split-bias",
        summary: "the roll-split angle has an offset",
        formula: "gamma + b",
        signature: "the load of the front times a constant, in the front's side force",
        parameters: &[amplitude("offset_rad", "rad", -0.2, 0.2, 0.002)],
        needs: &[Column::RollSplit],
        looks_like: &["camber-thrust", "steer-offset", "slip-offset"],
        decides: "the sled on level ice",
        source: "zero error of an angle sensor",
        example: "0.004: gamma_rad 0.02 -> gamma_rad 0.024",
        ..SENSOR
    }
    .faults(&[Fault::bias(Sensor::RollSplit, 0)]),
    Info {
        name: "roll-split-lag",
        summary: "the roll-split angle is late",
        formula: "gamma(t - tau)",
        signature: "the rate of the roll split times the load of the front",
        needs: &[Column::RollSplit],
        looks_like: &["camber-thrust", "lever-arm"],
        example: "0.02: gamma_rad 0.03, gamma_rad_rate 0.5 -> gamma_rad 0.02",
        ..LATE
    }
    .faults(&[Fault::lag(Sensor::RollSplit, 0)]),
    Info {
        name: "roll-split-scale",
        summary: "the roll-split angle is read too large or too small",
        formula: "(1 + k) gamma",
        signature: "the roll split times the load of the front: a camber thrust of the sled's \
            own",
        needs: &[Column::RollSplit],
        looks_like: &["camber-thrust", "roll-split-drag"],
        decides: "the front turned by a known angle",
        source: "scale-factor error, IEEE Std 1293-2018",
        example: "0.2: gamma_rad 0.01 -> gamma_rad 0.012",
        ..SCALED
    }
    .faults(&[Fault::scale(Sensor::RollSplit, 0)]),
    // The slip angle is late; a relaxation length goes with 1/v and acts on steering too.
    Info {
        name: "slip-lag",
        summary: "the slip angle is late",
        formula: "alpha(t - tau)",
        signature: "the slip rate",
        needs: &[Column::Slip],
        looks_like: &["relaxation-length", "yaw-rate-lag", "steer-lag"],
        decides: "the sensor's clock against the gyroscope's on a shaken sled",
        example: "0.02: alpha_rad 0.01, alpha_rad_rate 0.1 -> alpha_rad 0.008",
        ..LATE
    }
    .faults(&[Fault::lag(Sensor::Slip, 0)]),
    Info {
        name: "slip-offset",
        summary: "the slip angle has an offset",
        formula: "alpha + b",
        signature: "a constant side force at both axles",
        parameters: &[amplitude("offset_rad", "rad", -0.1, 0.1, 0.0005)],
        needs: &[Column::Slip],
        looks_like: &["steer-offset", "accelerometer-bias", "accelerometer-tilt"],
        decides: "a straight run with the steering fixed at zero",
        source: "mounting angle of an optical slip sensor",
        example: "0.002: alpha_rad 0.01 -> alpha_rad 0.012",
        ..SENSOR
    }
    .faults(&[Fault::bias(Sensor::Slip, 0)]),
    // The slip angle is read too large or too small, but not the part that yaw rate and steering
    // add at the axles.
    Info {
        name: "slip-scale",
        summary: "the slip angle is read too large or too small",
        formula: "(1 + k) alpha",
        signature: "the slip at the sensor",
        needs: &[Column::Slip],
        looks_like: &["saturation", "yaw-rate-scale"],
        decides: "the sensor turned by a known angle",
        source: "scale-factor error, IEEE Std 1293-2018",
        example: "0.2: alpha_rad 0.01 -> alpha_rad 0.012",
        ..SCALED
    }
    .faults(&[Fault::scale(Sensor::Slip, 0)]),
    Info {
        name: "steer-lag",
        summary: "the steering angle is late",
        formula: "delta(t - tau)",
        signature: "the rate of the steering angle, at the front alone",
        needs: &[Column::Steering],
        looks_like: &["relaxation-length", "slip-lag", "yaw-rate-lag"],
        decides: "the sensor's clock against the gyroscope's on a steered bench",
        example: "0.02: delta_rad 0.03, delta_rad_rate 0.5 -> delta_rad 0.02",
        ..LATE
    }
    .faults(&[Fault::lag(Sensor::Steering, 0)]),
    Info {
        name: "steer-offset",
        summary: "the steering angle has an offset",
        formula: "delta + b",
        signature: "a constant side force at the front alone",
        parameters: &[amplitude("offset_rad", "rad", -0.2, 0.2, 0.001)],
        needs: &[Column::Steering],
        looks_like: &["slip-offset", "yaw-rate-bias"],
        decides: "a straight run with the steering clamped",
        source: "zero error of an angle sensor",
        example: "0.004: delta_rad 0.02 -> delta_rad 0.024",
        ..SENSOR
    }
    .faults(&[Fault::bias(Sensor::Steering, 0)]),
    // The steering angle is read too large or too small: the ratio of ropes and linkage.
    Info {
        name: "steer-scale",
        summary: "the steering angle is read too large or too small",
        formula: "(1 + k) delta",
        signature: "the steering angle, at the front alone",
        needs: &[Column::Steering],
        looks_like: &["slip-scale", "saturation", "yaw-rate-scale"],
        decides: "the runner turned by a known angle",
        source: "ratio of a steering linkage, scale-factor error, IEEE Std 1293-2018",
        example: "0.2: delta_rad 0.01 -> delta_rad 0.012",
        ..SCALED
    }
    .faults(&[Fault::scale(Sensor::Steering, 0)]),
];

/// Gyroscopes.
pub(super) const GYROS: &[Effect] = &[
    // The gyroscopes pick up the vertical acceleration, each axis by its own.
    Info {
        name: "gyro-g-sensitivity",
        summary: "the gyroscopes pick up the vertical acceleration",
        formula: "omega + k a_z",
        signature: "rates in curves, over the vertical acceleration",
        parameters: &[
            amplitude("roll_radps_per_mps2", "rad s/m", -0.01, 0.01, 1e-4),
            amplitude("pitch_radps_per_mps2", "rad s/m", -0.01, 0.01, 1e-4),
            amplitude("yaw_radps_per_mps2", "rad s/m", -0.01, 0.01, 1e-4),
        ],
        needs: &[Column::VerticalAcceleration],
        judged: Judged::BeyondTolerance,
        looks_like: &["yaw-rate-bias", "pitch-rate-bias", "roll-rate-bias"],
        decides: "the inertial unit turned through six positions at rest",
        source: "IEEE Std 1431-2004, drift rate sensitive to acceleration",
        example: "0, 0, 1e-3: yaw_rate_radps 0.3, az_mps2 20 -> yaw_rate_radps 0.32",
        ..SENSOR
    }
    .faults(&[
        Fault::picks_up(Sensor::RollRate, Sensor::Az, 1.0, 0),
        Fault::picks_up(Sensor::PitchRate, Sensor::Az, 1.0, 1),
        Fault::picks_up(Sensor::YawRate, Sensor::Az, 1.0, 2),
    ]),
    Info {
        name: "pitch-rate-bias",
        summary: "the pitch rate has an offset",
        formula: "q + b",
        signature: "the track's curvature where a table needs it, over 1/v; little else",
        needs: &[Column::PitchRate],
        looks_like: &["pitch-rate-scale"],
        example: "0.01: pitch_rate_radps 0.2 -> pitch_rate_radps 0.21",
        ..GYRO_BIAS
    }
    .faults(&[Fault::bias(Sensor::PitchRate, 0)]),
    Info {
        name: "pitch-rate-lag",
        summary: "the pitch rate is late",
        formula: "q(t - tau)",
        signature: "the derivative of the pitch acceleration, in the loads of the axles: \
            little",
        needs: &[Column::PitchRate],
        looks_like: &["pitch-rate-scale"],
        example: "0.02: pitch_rate_radps 0.2, pitch_rate_radps_rate 0.5 -> pitch_rate_radps \
            0.19",
        ..LATE
    }
    .faults(&[Fault::lag(Sensor::PitchRate, 0)]),
    Info {
        name: "pitch-rate-scale",
        summary: "the pitch rate is read too large or too small",
        formula: "(1 + k) q",
        signature: "loads of the axles by the pitch acceleration, and the curvature where a \
            table needs it",
        needs: &[Column::PitchRate],
        looks_like: &["load-sensitivity", "cg-place"],
        example: "0.05: pitch_rate_radps 0.2 -> pitch_rate_radps 0.21",
        ..GYRO_SCALE
    }
    .faults(&[Fault::scale(Sensor::PitchRate, 0)]),
    Info {
        name: "roll-rate-bias",
        summary: "the roll rate has an offset",
        formula: "p + b",
        signature: "the lever of the accelerometer at a constant roll rate: centimetres per \
            second squared, little of which shows",
        needs: &[Column::RollRate],
        looks_like: &["accelerometer-bias", "yaw-rate-bias"],
        example: "0.01: roll_rate_radps 0.2 -> roll_rate_radps 0.21",
        ..GYRO_BIAS
    }
    .faults(&[Fault::bias(Sensor::RollRate, 0)]),
    Info {
        name: "roll-rate-lag",
        summary: "the roll rate is late",
        formula: "p(t - tau)",
        signature: "the derivative of the roll acceleration, in the lateral reading alone",
        needs: &[Column::RollRate],
        looks_like: &["lever-arm", "yaw-rate-lag"],
        example: "0.02: roll_rate_radps 0.2, roll_rate_radps_rate 0.5 -> roll_rate_radps 0.19",
        ..LATE
    }
    .faults(&[Fault::lag(Sensor::RollRate, 0)]),
    Info {
        name: "roll-rate-scale",
        summary: "the roll rate is read too large or too small",
        formula: "(1 + k) p",
        signature: "the roll acceleration at the height of the accelerometer, in its lateral \
            reading",
        needs: &[Column::RollRate],
        looks_like: &["lever-arm", "load-transfer"],
        example: "0.05: roll_rate_radps 0.2 -> roll_rate_radps 0.21",
        ..GYRO_SCALE
    }
    .faults(&[Fault::scale(Sensor::RollRate, 0)]),
    // The yaw gyro reads a constant too much. A constant yaw rate moves the slip angles of the
    // axles apart by a share of 1/v.
    Info {
        name: "yaw-rate-bias",
        summary: "the yaw rate has an offset",
        formula: "r + b",
        signature: "slip of opposite sign at front and rear, over 1/v",
        needs: &[Column::YawRate],
        looks_like: &["steer-offset", "slip-offset"],
        example: "0.01: yaw_rate_radps 0.4 -> yaw_rate_radps 0.41",
        ..GYRO_BIAS
    }
    .faults(&[Fault::bias(Sensor::YawRate, 0)]),
    Info {
        name: "yaw-rate-lag",
        summary: "the yaw rate is late",
        formula: "r(t - tau)",
        signature: "the yaw acceleration in the slip of the axles, and its derivative in the \
            balance of moments",
        needs: &[Column::YawRate],
        looks_like: &[
            "slip-lag",
            "steer-lag",
            "relaxation-length",
            "yaw-inertia",
            "lever-arm",
        ],
        example: "0.02: yaw_rate_radps 0.2, yaw_rate_radps_rate 0.5 -> yaw_rate_radps 0.19",
        ..LATE
    }
    .faults(&[Fault::lag(Sensor::YawRate, 0)]),
    // The yaw gyro reads a share too much or too little: a factor of every turn.
    Info {
        name: "yaw-rate-scale",
        summary: "the yaw rate is read too large or too small",
        formula: "(1 + k) r",
        signature: "the slip that the yaw rate adds at the axles, and the yaw acceleration",
        needs: &[Column::YawRate],
        looks_like: &["yaw-inertia", "slip-scale", "speed-scale", "lever-arm"],
        decides: "the sled turned by a known angle",
        example: "0.05: yaw_rate_radps 0.4 -> yaw_rate_radps 0.42",
        ..GYRO_SCALE
    }
    .faults(&[Fault::scale(Sensor::YawRate, 0)]),
];

/// Accelerometer and speed.
pub(super) const ACCELEROMETER_AND_SPEED: &[Effect] = &[
    Info {
        name: "accelerometer-bias",
        summary: "the accelerometer reads a constant too much",
        formula: "a_x + b, a_y + b",
        signature: "a constant",
        parameters: &[
            amplitude("x_mps2", "m/s2", -3.0, 3.0, 0.01),
            amplitude("y_mps2", "m/s2", -3.0, 3.0, 0.05),
        ],
        looks_like: &["accelerometer-tilt", "slope", "slip-offset", "steer-offset"],
        decides: "the sled at rest on level ice, turned round once",
        source: "IEEE Std 1293-2018, linear single-axis accelerometers",
        example: "0, 0.05: ay_mps2 4 -> ay_mps2 4.05",
        ..SENSOR
    }
    .faults(&[Fault::bias(Sensor::Ax, 0), Fault::bias(Sensor::Ay, 1)]),
    // The accelerometer reads a share too much or too little, each axis by its own.
    Info {
        name: "accelerometer-scale",
        summary: "the accelerometer reads too much or too little",
        formula: "(1 + k_x) a_x, (1 + k_y) a_y, (1 + k_z) a_z",
        signature: "the balance of side force and yaw moment (k_y), loads in curves (k_z), \
            drag and friction alike (k_x)",
        parameters: &[
            amplitude("x_factor", "", -0.5, 1.0, 0.01),
            amplitude("y_factor", "", -0.5, 1.0, 0.01),
            amplitude("z_factor", "", -0.5, 1.0, 0.01),
        ],
        needs: &[Column::VerticalAcceleration],
        looks_like: &["mass", "yaw-inertia", "load", "load-sensitivity"],
        decides: "the sensor turned through six positions at rest",
        source: "IEEE Std 1293-2018, linear single-axis accelerometers: scale factor",
        example: "0, 0.05, 0: ay_mps2 4 -> ay_mps2 4.2",
        ..SENSOR
    }
    .faults(&[
        Fault::scale(Sensor::Ax, 0),
        Fault::scale(Sensor::Ay, 1),
        Fault::scale(Sensor::Az, 2),
    ]),
    // The accelerometer is mounted askew: pitched by theta (nose down) and rolled by phi (left side
    // up), small angles. On a level track the pitch is exactly an opposite slope.
    Info {
        name: "accelerometer-tilt",
        summary: "the accelerometer sits askew",
        formula: "a_x - theta a_z, a_y + phi a_z",
        signature: "the vertical acceleration",
        parameters: &[
            amplitude("pitch_rad", "rad", -0.3, 0.3, 0.001),
            amplitude("roll_rad", "rad", -0.3, 0.3, 0.003),
        ],
        needs: &[Column::VerticalAcceleration],
        form: Form::FirstOrder,
        looks_like: &["load", "accelerometer-bias", "slope"],
        decides: "the sled at rest on level ice; a curve with known load",
        source: "IEEE Std 1293-2018, misalignment of the input axis",
        example: "0.01, 0: ax_mps2 -0.3, az_mps2 20 -> ax_mps2 -0.5",
        ..SENSOR
    }
    .faults(&[
        Fault::picks_up(Sensor::Ax, Sensor::Az, -1.0, 0),
        Fault::picks_up(Sensor::Ay, Sensor::Az, 1.0, 1),
    ]),
    // The box of the inertial unit is mounted askew: rolled by phi (left side up), pitched by theta
    // (nose down), turned by psi. Accelerometer and gyroscopes turn together.
    Info {
        name: "imu-misalignment",
        summary: "the box of the inertial unit is mounted askew",
        formula: "a + a x (phi, theta, psi), omega + omega x (phi, theta, psi)",
        signature: "the vertical acceleration, and rates that pick up one another",
        parameters: &[
            amplitude("roll_rad", "rad", -0.3, 0.3, 0.003),
            amplitude("pitch_rad", "rad", -0.3, 0.3, 0.001),
            amplitude("yaw_rad", "rad", -0.3, 0.3, 0.003),
        ],
        needs: &[Column::VerticalAcceleration],
        judged: Judged::BeyondTolerance,
        form: Form::FirstOrder,
        looks_like: &["accelerometer-tilt", "accelerometer-bias", "slope"],
        decides: "the box turned by half a turn about the vertical; the sled at rest on level \
            ice",
        source: "IEEE Std 1293-2018, misalignment of the input axis",
        example: "0, 0.01, 0: ax_mps2 -0.3, az_mps2 20 -> ax_mps2 -0.5",
        ..SENSOR
    }
    .faults(Fault::MISALIGNED.as_flattened()),
    Info {
        name: "speed-bias",
        summary: "the speed has an offset",
        formula: "v + b",
        signature: "the slip that turning adds over 1/v, and the drag over v",
        parameters: &[amplitude("offset_mps", "m/s", -5.0, 5.0, 0.1)],
        needs: &[Column::Speed],
        looks_like: &["speed-scale", "drag-area", "headwind"],
        decides: "the time between two marks on the track, at two speeds",
        source: "zero error of a Doppler or optical speed sensor, data sheets: 0.05 to 0.5 m/s",
        example: "0.5: v_mps 25 -> v_mps 25.5",
        ..SENSOR
    }
    .faults(&[Fault::bias(Sensor::Speed, 0)]),
    Info {
        name: "speed-lag",
        summary: "the speed is late",
        formula: "v(t - tau)",
        signature: "the acceleration times the delay, a speed that is too low while it grows",
        parameters: &[amplitude("time_s", "s", -0.5, 1.0, 0.01)],
        needs: &[Column::Speed],
        looks_like: &["slope", "track-profile", "speed-scale"],
        decides: "the time at which a mark on the track is passed",
        source: "filters of satellite receivers and wheel counters: 10 to 200 ms",
        example: "0.1: v_mps 25, v_mps_rate 2 -> v_mps 24.8",
        ..SENSOR
    }
    .faults(&[Fault::lag(Sensor::Speed, 0)]),
    // The speed is read a share too large or too small, as of a wheel of another radius.
    Info {
        name: "speed-scale",
        summary: "the speed is read too large or too small",
        formula: "(1 + k) v",
        signature: "v^2 in the drag, the slip that turning adds over 1/v, and the derivative \
            of the speed",
        parameters: &[amplitude("factor", "", -0.5, 1.0, 0.01)],
        needs: &[Column::Speed],
        looks_like: &["drag-area", "yaw-rate-scale", "slope", "speed-grip"],
        decides: "the time between two marks on the track",
        source: "scale-factor error of a speed sensor, as of an encoder on a wheel of another \
            radius",
        example: "0.02: v_mps 25 -> v_mps 25.5",
        ..SENSOR
    }
    .faults(&[Fault::scale(Sensor::Speed, 0)]),
];
