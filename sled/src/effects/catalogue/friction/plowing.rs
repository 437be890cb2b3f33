//! The runner plows a groove: its cross-section over load for a runner of constant section radius, k >= 0.
//!
//! The hardness of ice is H(T) = (14.7 - 0.6 T) MPa, T in deg C.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "plowing",
        summary: "the runner plows a groove",
        formula: "mu + k sqrt(F_z/kN H(0)/H(T)), H = 14.7 - 0.6 T MPa",
        signature: "over load, stronger on warm ice",
        acts_on: &[ActsOn::Friction],
        parameters: &[Parameter::amplitude("coefficient", "", 0.0, 0.02, 0.0005)],
        needs: &[Column::Load, Column::IceTemperature],
        looks_like: &["load", "temperature"],
        decides: "ballast on ice of one temperature; the groove's profile after the run",
        source: "L. Poirier, E.P. Lozowski, R.I. Thompson, Cold Reg. Sci. Technol. 67 (2011) 129-134; E.P. Lozowski, K. Szilder, Int. J. Offshore Polar Eng. 23 (2013)",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, at| {
        if p[0] == 0.0 {
            return mu;
        }
        let softness = 14.7 / (14.7 - 0.6 * at.ice_c.min(0.0));
        mu + p[0] * (at.fz.max(0.0) / 1000.0 * softness).sqrt()
    }),
    example: Example {
        parameters: &[0.001],
        given: &[("mu", 0.004), ("fz_n", 4000.0), ("ice_c", 0.0)],
        gives: ("mu", 0.006),
    },
    ..Effect::NEW
};
