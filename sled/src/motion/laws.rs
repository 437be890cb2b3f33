//! The base laws asked at one instant.

use crate::effects::Forces;
use crate::friction::LateralDerivatives;

use crate::model::runner::RunnerFriction;
use crate::model::vehicle::Vehicle;
use crate::motion::balance::Balance;
use crate::motion::law_forces::LawForces;

impl Balance {
    /// Longitudinal force on each runner in its own frame at its normal force [N], as [`crate::friction::longitudinal_force`] has it.
    ///
    /// A lifted runner does not push.
    #[inline]
    pub(crate) fn longitudinal(&self, vehicle: &Vehicle, load: [f64; 2]) -> [f64; 2] {
        [
            self.longitudinal_of(&vehicle.front, self.slips[0], load[0]),
            self.longitudinal_of(&vehicle.rear, self.slips[1], load[1]),
        ]
    }

    #[inline]
    fn longitudinal_of(&self, runner: &RunnerFriction, slip: (f64, f64), load: f64) -> f64 {
        let at = &self.state;
        let mu = runner.mu(load, at.curvature_1pm, at.v_mps, at.ice_c);
        -mu * load.max(0.0) * slip.1
    }

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
        let mut near = None;
        let mut front = runner.lateral.derivatives_near(alpha, load, &mut near);
        if sg != 0.0 {
            let fx = self.longitudinal_of(runner, self.slips[0], load);
            let residual = cg * load + sg * (sd * fx + cd * front.fy) - state.fz_f0_n;
            let by_load = if load > 0.0 { fx / load } else { 0.0 };
            load -= residual / (cg + sg * (sd * by_load + cd * front.fz));
            front = runner.lateral.derivatives_near(alpha, load, &mut near);
        }
        let rear = vehicle
            .rear
            .lateral
            .derivatives(state.alpha_r_rad, state.fz_r_n);
        self.law_forces(vehicle, [load, state.fz_r_n], [front, rear])
    }

    /// The same to first order from the laws of a motion close by, `of` being those of `known`.
    #[inline]
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

    #[inline]
    fn law_forces(
        &self,
        vehicle: &Vehicle,
        load_n: [f64; 2],
        lateral: [LateralDerivatives; 2],
    ) -> LawForces {
        LawForces {
            load_n,
            lateral,
            forces: Forces {
                along: self.longitudinal(vehicle, load_n),
                across: lateral.map(|law| law.fy),
                stiffness: lateral.map(|law| law.alpha),
                ..Forces::default()
            },
        }
    }
}
