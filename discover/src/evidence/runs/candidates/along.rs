//! Which effects show along the sled alone.

use kufe_sled::effects::{Conditions, Effect, Forces, Measured, State};

/// Whether an effect moves neither a side force nor a signal, tried on one state in a curve.
pub fn acts_only_along(effect: &dyn Effect) -> bool {
    let state = State {
        conditions: Conditions {
            t: 3.0,
            s: 20.0,
            v: 21.0,
            fz: 0.0,
            ice_c: -9.0,
            air_c: 2.0,
            air_pa: 94_000.0,
            humidity_pct: 60.0,
            distance: 900.0,
            air_density: 1.2,
            drag_area: 0.28,
        },
        slip: [0.01, -0.008],
        slip_rate: [0.1, 0.2],
        load: [1800.0, 2500.0],
        chassis_slip: 0.003,
        steering: 0.01,
        roll_split: -0.02,
        roll_rate: 0.3,
        roll_acceleration: 1.5,
        yaw_rate: 0.4,
        acceleration: [-0.3, 4.0, 15.0],
        mass: 390.0,
    };
    let base = Forces {
        along: [-7.0, -10.0],
        across: [90.0, -310.0],
        stiffness: [9000.0, 35_000.0],
        body_along: -80.0,
        body_across: 0.0,
    };
    let signal = Measured {
        acceleration: [-0.3, 4.0, 15.0],
        slip: 0.01,
        slip_rate: 0.2,
        steering: 0.02,
        accelerometer: [-0.35, 0.0, 0.12],
        mass: 390.0,
    };
    let on: Vec<f64> = effect
        .info()
        .parameters
        .iter()
        .map(|p| p.default + p.typical)
        .collect();
    let (mut forces, mut measured) = (base, signal);
    effect.act(&on, &state, &mut forces);
    effect.correct(&on, &mut measured);
    forces.across == base.across && forces.body_across == base.body_across && measured == signal
}
