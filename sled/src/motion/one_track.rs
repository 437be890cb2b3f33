//! The one-track sled: forces from motion (inverse) and forces from friction (forward).
//!
//! One right-handed frame throughout: x forward, y left, z up, body = rear part. The front runner's
//! frame is turned by `R = R_x(gamma) R_z(delta)`, so that `F_f0 = R F_f`. With the aerodynamic
//! force at the centre of gravity:
//!
//! ```text
//! m a_x = F_x,r + F_x,f0 + F_x,aero         J_zz dyaw/dt   =  l_f F_y,f0 - l_r F_y,r
//! m a_y = F_y,r + F_y,f0 + F_y,aero         J_yy dpitch/dt = -l_f F_z,f0 + l_r F_z,r
//! m a_z = F_z,r + F_z,f0
//! ```
//!
//! a is the specific force at the centre of gravity, so that gravity does not enter. Forces and
//! moments of effects on the body are added to the aerodynamic force.

use crate::effects::Forces;
use crate::friction::Braghin;

use crate::model::vehicle::Vehicle;
use crate::motion::balance::Balance;
use crate::sled::Sled;

pub use crate::motion::state::{AxleForces, Motion, Resultant, State};
pub use crate::motion::state::{body_to_front, front_to_body, normal_forces};

/// Forces on the runners from the measured motion.
///
/// Momentum along y and z and both moments give `F_y` and `F_z` at the axles in the body frame.
/// `F_x,f0` cannot be measured; it follows from the longitudinal friction of the front runner in
/// its own frame:
///
/// ```text
/// F_z,f  = cos(gamma) F_z,f0 - sin(gamma) F_y,f0
/// F_x,f  = -mu F_z,f cos(alpha_f)
/// F_x,f0 = (F_x,f - cos(gamma) sin(delta) F_y,f0 - sin(gamma) sin(delta) F_z,f0) / cos(delta)
/// ```
///
/// `F_x` of the rear runner follows from its friction, too. Forces are in N. The normal force of a
/// lifted runner is negative. Forces of the vehicle's effects on the body are subtracted first, and
/// their friction is included in `F_x`. The effects must be those of the track
/// ([`Vehicle::on_track`]).
pub fn inverse(vehicle: &Vehicle, state: &State, motion: &Motion) -> AxleForces {
    let at = Balance::new(&vehicle.sled, state, motion);
    let base = forces_of_motion(vehicle, &at, &Forces::default(), None);
    if vehicle.effects.is_empty() {
        return base;
    }
    // Effects depend on loads and forces, which depend on the effects: two iterations suffice.
    (0..2).fold(base, |known, _| {
        let forces = forces_with_effects(vehicle, &at, &known, None);
        forces_of_motion(vehicle, &at, &forces, Some(forces.along))
    })
}

/// Forces that balance the motion. `body` contains the forces of effects on the body. `along` is
/// the friction of the runners [N]; `None` for the base law.
fn forces_of_motion(
    vehicle: &Vehicle,
    at: &Balance,
    body: &Forces,
    along: Option<[f64; 2]>,
) -> AxleForces {
    let (sled, state, motion) = (&at.sled, &at.state, &at.motion);
    let lateral = sled.mass_kg * motion.accel_mps2[1] - at.air()[1] - body.body_across;
    let moment = sled.j_zz_kgm2 * motion.yaw_accel_radps2 - body.body_yaw;
    let wheelbase = sled.wheelbase_m();
    let fy_f0 = (sled.l_r_m * lateral + moment) / wheelbase;
    let fy_r = (sled.l_f_m * lateral - moment) / wheelbase;
    let (fz_f0, fz_r) = normal_forces(sled, motion.accel_mps2[2], motion.pitch_accel_radps2);

    let ((sd, cd), (sg, cg)) = (at.steer, at.split);
    let fz_f = cg * fz_f0 - sg * fy_f0;
    let [fx_f, fx_r] = along.unwrap_or_else(|| at.longitudinal(vehicle, [fz_f, fz_r]));
    let fx_f0 = (fx_f - cg * sd * fy_f0 - sg * sd * fz_f0) / cd;
    let front_body = [fx_f0, fy_f0, fz_f0];
    AxleForces {
        front: body_to_front(front_body, state.delta_rad, state.gamma_rad),
        front_body,
        rear: [fx_r, fy_r, fz_r],
        body: [body.body_along, body.body_across, body.body_yaw],
    }
}

/// Forces of the base laws at the loads of `known`, as changed by the effects. The forces across
/// the runners before the effects are `across` [N], or those of `known`.
fn forces_with_effects(
    vehicle: &Vehicle,
    at: &Balance,
    known: &AxleForces,
    across: Option<[f64; 2]>,
) -> Forces {
    let state = &at.state;
    let load = [known.front[2], known.rear[2]];
    let slip = [state.alpha_f_rad, state.alpha_r_rad];
    let runners = [&vehicle.front, &vehicle.rear];
    let mut forces = Forces {
        along: at.longitudinal(vehicle, load),
        across: across.unwrap_or([known.front[1], known.rear[1]]),
        stiffness: std::array::from_fn(|i| runners[i].lateral.derivatives(slip[i], load[i]).alpha),
        ..Forces::default()
    };
    let seen = at.seen(vehicle, load);
    vehicle.effects.act(&seen, &mut forces);
    forces
}

/// Lateral forces of the base laws [N] (front in its own frame, rear) that with the effects give
/// the measured forces.
///
/// Solved by Newton's method. Without effects they are the measured forces; NaN if there is no
/// solution.
pub fn share_of_laws(vehicle: &Vehicle, state: &State, measured: &AxleForces) -> [f64; 2] {
    let measured_across = [measured.front[1], measured.rear[1]];
    if vehicle.effects.is_empty() {
        return measured_across;
    }
    let at = Balance::new(&vehicle.sled, state, &Motion::default());
    let mut across = measured_across;
    for _ in 0..6 {
        let step: [f64; 2] = across.map(|force| 1.0 + 1e-4 * force.abs());
        let base = forces_with_effects(vehicle, &at, measured, Some(across)).across;
        let perturbed = [across[0] + step[0], across[1] + step[1]];
        let shifted = forces_with_effects(vehicle, &at, measured, Some(perturbed)).across;
        for i in 0..2 {
            let slope = (shifted[i] - base[i]) / step[i];
            across[i] += if slope > 1e-3 {
                (measured_across[i] - base[i]) / slope
            } else {
                f64::NAN
            };
        }
    }
    across
}

/// Forces on the runners from the friction laws at the state's slip angles and normal forces, with
/// the vehicle's effects ([`Balance::laws`], [`Balance::forces`]).
pub fn forward(vehicle: &Vehicle, state: &State) -> AxleForces {
    let at = Balance::new(&vehicle.sled, state, &Motion::default());
    forces_at(vehicle, &at)
}

/// [`forward`] with a given balance.
pub(crate) fn forces_at(vehicle: &Vehicle, at: &Balance) -> AxleForces {
    let laws = at.laws(vehicle);
    if vehicle.effects.is_empty() {
        return at.axle_forces(&laws.forces, laws.load_n[0]);
    }
    // The front runner's normal force follows its changed force.
    let forces = at.forces(vehicle, &laws);
    at.axle_forces(&forces, at.front_load(&forces))
}

/// [`forward`] with Braghin's lateral law on both runners and no effects, the paper's comparison.
pub fn forward_braghin(vehicle: &Vehicle, law: &Braghin, state: &State) -> AxleForces {
    let at = Balance::new(&vehicle.sled, state, &Motion::default());
    let mut load = [state.fz_f0_n / at.split.1, state.fz_r_n];
    let (mut forces, mut front_load) = (Forces::default(), load[0]);
    // The force is proportional to the load: few iterations suffice for the coupling by the
    // roll-split.
    for _ in 0..3 {
        forces.along = at.longitudinal(vehicle, load);
        forces.across = [
            law.force(state.alpha_f_rad, load[0]),
            law.force(state.alpha_r_rad, load[1]),
        ];
        front_load = load[0];
        load[0] = at.front_load(&forces);
    }
    at.axle_forces(&forces, front_load)
}

/// Resultant of runners, air and effects at the centre of gravity.
pub fn resultant(sled: &Sled, state: &State, forces: &AxleForces) -> Resultant {
    Balance::new(sled, state, &Motion::default()).resultant(forces)
}
