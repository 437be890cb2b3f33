//! Operating point, forces and signals of a sled in a curve, shared by the tests of the effects.

use kufe_sled::Conditions;
use kufe_sled::Sled;
use kufe_sled::effects::{Forces, OperatingPoint, Sensor, Signals, State};
use kufe_sled::friction::film::Patch;

pub fn point() -> OperatingPoint {
    OperatingPoint {
        t: 3.0,
        s: 20.0,
        v: 21.0,
        fz: 1300.0,
        conditions: Conditions {
            ice_c: -9.0,
            air_c: 2.0,
            air_pa: 94_000.0,
            humidity_pct: 60.0,
            distance_m: 900.0,
            mass_kg: 390.0,
        },
        air_density: 1.2,
        drag_area: 0.28,
        film: 1.2,
        patch: Patch {
            length: 0.06,
            width: 0.9e-3,
            roughness: 0.5e-6,
        },
    }
}

pub fn state() -> State {
    State {
        point: point(),
        slip: [0.01, -0.008],
        slip_rate: [0.1, 0.2],
        load: [1800.0, 2500.0],
        film: [1.2, 0.9],
        chassis_slip: 0.003,
        steering: 0.01,
        roll_split: -0.02,
        roll_rate: 0.3,
        roll_acceleration: 1.5,
        pitch_rate: -0.2,
        yaw_rate: 0.4,
        acceleration: [-0.3, 4.0, 15.0],
        mass: 390.0,
        carried: f64::NAN,
    }
}

pub fn forces() -> Forces {
    Forces {
        along: [-7.0, -10.0],
        across: [90.0, -310.0],
        stiffness: [9000.0, 35_000.0],
        body_along: -80.0,
        body_across: 0.0,
        body_yaw: 0.0,
    }
}

pub fn signals() -> Signals {
    let mut signals = Signals {
        sled: Sled {
            mass_kg: 390.0,
            j_yy_kgm2: 145.0,
            j_zz_kgm2: 150.0,
            l_f_m: 0.82,
            l_r_m: 0.88,
            accel_x_m: -0.35,
            accel_y_m: 0.0,
            accel_z_m: 0.12,
            slip_x_m: -0.6,
            ..Sled::default()
        },
        ..Signals::default()
    };
    let values = [-0.3, 4.0, 15.0, 0.3, -0.2, 0.4, 21.0, 0.01, 0.02, -0.02];
    let rates = [0.5, 3.0, -2.0, 1.5, 0.1, -0.8, 0.7, 0.2, 0.3, -0.1];
    for (sensor, (value, rate)) in Sensor::ALL.into_iter().zip(values.into_iter().zip(rates)) {
        signals.set(sensor, value, rate);
    }
    signals
}
