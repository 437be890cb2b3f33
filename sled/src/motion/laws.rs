//! The base laws asked at one instant.

use kufe_effect::Forces;
use kufe_friction::{LateralDerivatives, longitudinal_force};

use crate::model::runner::RunnerFriction;
use crate::model::vehicle::Vehicle;
use crate::motion::balance::Balance;
use crate::motion::law_forces::LawForces;
use crate::motion::state::State;

/// Longitudinal force on a runner in its own frame [N] at a normal force [N] and a slip angle [rad], on the track, at the speed
/// and on the ice of a state.
///
/// A lifted runner does not push.
pub(crate) fn longitudinal(runner: &RunnerFriction, fz: f64, alpha: f64, at: &State) -> f64 {
    let mu = runner.mu(fz, at.curvature_1pm, at.v_mps, at.ice_c);
    longitudinal_force(fz.max(0.0), alpha, mu)
}

impl Balance {
    /// Forces of the vehicle's base laws at the state's slip angles and normal forces.
    ///
    /// The front runner's own `F_z,f` depends on its forces through the roll-split; one Newton step on
    ///
    /// ```text
    /// cos(gamma) F_z,f = F_z,f0 - sin(gamma) (sin(delta) F_x,f + cos(delta) F_y,f)
    /// ```
    ///
    /// from `F_z,f0 / cos(gamma)` leaves less than 1e-6 of it. F_x enters because the axle's vertical force is what the
    /// turned runner's force has along z, whatever its parts; the laws are then asked at the load found.
    pub fn laws(&self, vehicle: &Vehicle) -> LawForces {
        let ((sd, cd), (sg, cg)) = (self.steer, self.split);
        let (state, runner) = (&self.state, &vehicle.front);
        let alpha = state.alpha_f_rad;
        let mut load = state.fz_f0_n / cg;
        let mut front = runner.lateral.derivatives(alpha, load);
        if sg != 0.0 {
            let fx = longitudinal(runner, load, alpha, state);
            let residual = cg * load + sg * (sd * fx + cd * front.fy) - state.fz_f0_n;
            let by_load = if load > 0.0 { fx / load } else { 0.0 };
            load -= residual / (cg + sg * (sd * by_load + cd * front.fz));
            front = runner.lateral.derivatives(alpha, load);
        }
        let rear = vehicle
            .rear
            .lateral
            .derivatives(state.alpha_r_rad, state.fz_r_n);
        self.law_forces(vehicle, [load, state.fz_r_n], [front, rear])
    }

    /// The same to first order from the laws of a motion close by, `of` being those of `known`.
    pub fn laws_near(&self, vehicle: &Vehicle, known: &Balance, of: &LawForces) -> LawForces {
        let ((sd, cd), (sg, cg)) = (self.steer, self.split);
        let (state, then) = (&self.state, &known.state);
        let [mut front, mut rear] = of.lateral;
        front.fy += front.alpha * (state.alpha_f_rad - then.alpha_f_rad);
        rear.fy += rear.alpha * (state.alpha_r_rad - then.alpha_r_rad);
        let (load, fx) = (of.load_n[0], of.forces.along[0]);
        let residual = cg * load + sg * (sd * fx + cd * front.fy) - state.fz_f0_n;
        let by_load = if load > 0.0 { fx / load } else { 0.0 };
        let step = residual / (cg + sg * (sd * by_load + cd * front.fz));
        front.fy -= front.fz * step;
        rear.fy += rear.fz * (state.fz_r_n - then.fz_r_n);
        self.law_forces(vehicle, [load - step, state.fz_r_n], [front, rear])
    }

    fn law_forces(
        &self,
        vehicle: &Vehicle,
        load_n: [f64; 2],
        lateral: [LateralDerivatives; 2],
    ) -> LawForces {
        let state = &self.state;
        let along = [
            longitudinal(&vehicle.front, load_n[0], state.alpha_f_rad, state),
            longitudinal(&vehicle.rear, load_n[1], state.alpha_r_rad, state),
        ];
        LawForces {
            load_n,
            lateral,
            forces: Forces {
                along,
                across: lateral.map(|law| law.fy),
                stiffness: lateral.map(|law| law.alpha),
                ..Forces::default()
            },
        }
    }
}
