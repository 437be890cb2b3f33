//! F_x += -k F_z,f |delta| at the front runner. Unit of k: 1/rad. Scrubbing of the steered runner beyond the rotation of its side force.
//! Signature: the steering angle. Confounders: slip drag. Source: L. Poirier, Ice Friction in the Sport of Bobsleigh, PhD thesis, University of Calgary (2011).

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct SteerDrag;

static INFO: Info = Info {
    name: "steer-drag",
    summary: "steering brakes",
    level: Level::Sample,
    parameters: &[Parameter::amplitude(
        "coefficient_per_rad",
        "1/rad",
        -5.0,
        50.0,
        0.05,
    )],
    needs: &[Column::Steering],
    decides: "steering pulses on a straight",
};

impl Effect for SteerDrag {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        forces.along[0] -= parameters[0] * at.load[0].max(0.0) * at.steering.abs();
    }
}
