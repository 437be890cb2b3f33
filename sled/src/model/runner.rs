//! Ice friction of one runner, with its pressure table opened.

use std::sync::Arc;

use kufe_friction::{Longitudinal, MagicFormula};

use crate::error::Error;

/// Peak pressure [Pa] of a runner over normal force [N] and track curvature [1/m].
pub type PressureLookup = Arc<dyn Fn(f64, f64) -> f64 + Send + Sync>;

/// Ice friction of one runner.
#[derive(Clone)]
pub struct RunnerFriction {
    /// Longitudinal law.
    pub longitudinal: Longitudinal,
    /// Peak pressure, where the longitudinal law asks for it.
    pub pressure: Option<PressureLookup>,
    /// Lateral law.
    pub lateral: MagicFormula,
    /// Multiplier of the longitudinal coefficient: 1 but in fits.
    pub mu_scale: f64,
}

impl RunnerFriction {
    /// Longitudinal coefficient of friction at a normal force [N] and a track curvature [1/m].
    pub fn mu(&self, fz: f64, curvature: f64) -> f64 {
        let mu = match (&self.longitudinal, &self.pressure) {
            (Longitudinal::Fixed(mu), _) => *mu,
            (law, Some(pressure)) => law.mu(pressure(fz.max(0.0), curvature)),
            (law, None) => law.mu(f64::NAN),
        };
        self.mu_scale * mu
    }
}

impl std::fmt::Debug for RunnerFriction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RunnerFriction")
            .field("longitudinal", &self.longitudinal)
            .field("pressure", &self.pressure.is_some())
            .field("lateral", &self.lateral)
            .finish()
    }
}

/// Opens a lookup table of peak pressure; its smooth mode has no kinks that an integrator would feel.
pub(crate) fn open_table(path: &std::path::Path) -> Result<PressureLookup, Error> {
    use kufe_lut::{Lookup, Mode, Quantity, Table};
    let name = path.display().to_string();
    let told = |error: kufe_lut::Error| Error::file(&name, error);
    let mut file = kufe_files::open_regular(path).map_err(|error| Error::file(&name, error))?;
    let table = Table::read(&mut file).map_err(told)?;
    let lookup = Lookup::new(&table, Quantity::PMax, Mode::Smooth).map_err(told)?;
    Ok(Arc::new(move |fz, curvature| {
        lookup.at(fz, curvature).value
    }))
}
