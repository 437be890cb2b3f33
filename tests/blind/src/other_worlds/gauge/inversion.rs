//! Runs of these worlds as the inversion takes them.

use crate::other_worlds::plan::Plan;
use crate::other_worlds::recorder::{ROWS_HZ, Row};
use crate::other_worlds::runners::Sled;
use crate::residuals::inverse::Residual;
use crate::world::sensors::Sample;
use crate::world::sled::{Conditions, Lateral, Sled as Stated};

/// The four balances: along, of the speed, across, about the vertical.
pub type Balances = [f64; 4];

/// Residuals of the balances.
pub fn balances(r: &Residual) -> Balances {
    [r.x_mps2, r.v_mps2, r.y_mps2, r.yaw_radps2]
}

/// One less the other, row by row.
pub fn minus(a: &[Balances], b: &[Balances]) -> Vec<Balances> {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(a, b)| std::array::from_fn(|c| a[c] - b[c]))
        .collect()
}

/// Rows as the inversion takes them.
pub fn samples(rows: &[Row]) -> Vec<Sample> {
    rows.iter()
        .enumerate()
        .map(|(k, r)| Sample {
            t_s: k as f64 / ROWS_HZ,
            accel_mps2: [r[0], r[1], r[2]],
            rates_radps: [r[3], r[4], r[5]],
            v_mps: r[6],
            alpha_rad: r[7],
            delta_rad: r[8],
            gamma_rad: r[9],
            extra: 0.0,
        })
        .collect()
}

/// A sled as the inversion takes it, friction and grip those of the run's session.
pub fn stated(sled: &Sled, plan: &Plan) -> Stated {
    let [friction, grip] = plan.factors;
    let law = |[peak, shape, bend, stiffness]: [f64; 4]| Lateral {
        mu_zeta: grip * peak,
        c: shape,
        e: bend,
        k_n_per_rad: grip * stiffness,
    };
    Stated {
        mass_kg: sled.mass_kg,
        j_yy_kgm2: sled.inertia_kgm2[0],
        j_zz_kgm2: sled.inertia_kgm2[1],
        l_f_m: sled.axle_m[0],
        l_r_m: sled.axle_m[1],
        accel_m: sled.accel_m,
        slip_x_m: sled.slip_m,
        cda_m2: sled.drag[0],
        yaw_drag_per_deg: sled.drag[1],
        mu: friction * sled.mu,
        front: law(sled.grip[0]),
        rear: law(sled.grip[1]),
    }
}

/// The weather of a run as the inversion takes it: the density of its air at freezing.
pub fn conditions(plan: &Plan) -> Conditions {
    Conditions {
        track: String::new(),
        ice_c: plan.ice_c,
        air_c: 0.0,
        air_pa: plan.air * 287.05 * 273.15,
        humidity_pct: 0.0,
        worn_m: 0.0,
        session_mu: 1.0,
        session_grip: 1.0,
        glide: None,
    }
}
