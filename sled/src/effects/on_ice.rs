//! Effects of the friction coefficient, acting on both runners.
//!
//! The coefficient that the base law used is the force along the runner over its load; the effect turns it into another
//! one and the force follows. Formulas, units and sources stand in `kufe_friction::effects`.

use kufe_friction::effects as friction;

use super::{Effect, Forces, Info, State};

/// The friction effect of this name.
pub struct OnIce(pub(super) &'static str);

impl OnIce {
    fn effect(&self) -> &'static dyn friction::Effect {
        friction::find(self.0).expect("named in the friction catalogue")
    }
}

impl Effect for OnIce {
    fn info(&self) -> &'static Info {
        self.effect().info()
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        scale_along(self.effect(), parameters, at, forces);
    }
}

/// Replaces the coefficient behind the force along each runner.
pub(super) fn scale_along(
    effect: &dyn friction::Effect,
    parameters: &[f64],
    at: &State,
    forces: &mut Forces,
) {
    for runner in 0..2 {
        let load = at.load[runner];
        if load <= 0.0 {
            continue;
        }
        let mut conditions = at.conditions;
        conditions.fz = load;
        let mu = -forces.along[runner] / load;
        forces.along[runner] = -load * effect.coefficient(parameters, mu, &conditions);
    }
}
