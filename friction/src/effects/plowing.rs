//! mu' = mu + k sqrt(F_z/1000 N * H(0 C)/H(T)) with the hardness H(T) = (14.7 - 0.6 T) MPa, T in deg C. k >= 0, a pure number: the groove's
//! cross-section over load for a runner of constant section radius. Signature: over load, stronger on warm ice. Confounders: load, temperature.
//! Source: L. Poirier, E.P. Lozowski, R.I. Thompson, Ice hardness in winter sports, Cold Reg. Sci. Technol. 67 (2011) 129-134;
//! E.P. Lozowski, K. Szilder, Derivation and new analysis of a hydrodynamic model of speed skate ice friction, Int. J. Offshore Polar Eng. 23 (2013).

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct Plowing;

static INFO: Info = Info {
    name: "plowing",
    summary: "the runner plows a groove",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("coefficient", "", 0.0, 0.02, 0.0005)],
    needs: &[Column::Load, Column::IceTemperature],
    decides: "ballast on ice of one temperature; the groove's profile after the run",
};

impl Effect for Plowing {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        if parameters[0] == 0.0 {
            return mu;
        }
        let softness = 14.7 / (14.7 - 0.6 * at.ice_c.min(0.0));
        mu + parameters[0] * (at.fz.max(0.0) / 1000.0 * softness).sqrt()
    }
}
