//! mu' = mu (F_z / F_ref)^n. n is a pure number: -1/3 for a line contact with a melt film, near 0 for plowing. Signature: over load, in curves.
//! Confounders: plowing, drag of lateral slip, since load and side force rise in the same curves.
//! Source: P. Oksanen, J. Keinonen, The mechanism of friction of ice, Wear 78 (1982) 315-324.

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct Load;

static INFO: Info = Info {
    name: "load",
    summary: "friction changes with the normal force",
    level: Level::Sample,
    parameters: &[
        Parameter::amplitude("exponent", "", -1.0, 1.0, 0.05),
        Parameter::setting("reference_n", "N", 1.0, 20000.0, 1000.0),
    ],
    needs: &[Column::Load],
    decides: "the same runs with ballast",
};

impl Effect for Load {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        mu * (at.fz.max(1.0) / parameters[1]).powf(parameters[0])
    }
}
