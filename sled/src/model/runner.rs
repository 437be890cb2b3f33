//! Ice friction of one runner, with its table opened.

use std::path::Path;
use std::sync::Arc;

use crate::friction::{MagicFormula, PressureLaw};
use kufe_lut::{Layered, Looked, Mode, Quantity, Table};

use crate::error::Error;

/// Longitudinal friction of one runner.
#[derive(Clone, Debug)]
pub enum RunnerLaw {
    /// The same coefficient everywhere.
    Fixed(f64),
    /// A quadratic in the peak pressure, which the table holds.
    Pressure(PressureLaw, Arc<RunnerTable>),
    /// The coefficient that the table holds, times a factor.
    Tabled(f64, Arc<RunnerTable>),
}

/// One quantity of a runner's lookup table.
#[derive(Clone, Debug)]
pub struct RunnerTable {
    /// The file.
    pub file: String,
    /// Mean over the table's nodes.
    mean: f64,
    lookup: Layered,
}

impl RunnerTable {
    /// Opens a table; its smooth mode has no kinks that an integrator would feel.
    pub(crate) fn open(path: &Path, quantity: Quantity) -> Result<Self, Error> {
        let file = path.display().to_string();
        let told = |error: kufe_lut::Error| Error::file(&file, error);
        let mut opened =
            kufe_files::open_regular(path).map_err(|error| Error::file(&file, error))?;
        let table = Table::read(&mut opened).map_err(told)?;
        let lookup = Layered::new(&table, quantity, Mode::Smooth, None).map_err(told)?;
        let values = table.nodes().iter().filter_map(|node| node.get(quantity));
        let mean = values.sum::<f64>() / table.nodes().len() as f64;
        Ok(RunnerTable { file, mean, lookup })
    }

    /// Whether it is over the temperature of the ice.
    pub fn asks_ice(&self) -> bool {
        self.lookup.asks_ice()
    }

    /// The quantity at a normal force [N], a curvature of the track [1/m], a speed [m/s] and a temperature of the ice [C].
    pub fn at(&self, fz: f64, curvature: f64, speed: f64, ice_c: f64) -> Looked {
        self.lookup.at(fz.max(0.0), curvature, speed, ice_c)
    }
}

/// Ice friction of one runner.
#[derive(Clone, Debug)]
pub struct RunnerFriction {
    /// Longitudinal law.
    pub longitudinal: RunnerLaw,
    /// The table of mu beside a stated coefficient: what the effect of groove and film puts in its place.
    pub film: Option<Arc<RunnerTable>>,
    /// Lateral law.
    pub lateral: MagicFormula,
    /// Multiplier of the longitudinal coefficient: 1 but in fits.
    pub mu_scale: f64,
}

impl RunnerFriction {
    /// Longitudinal coefficient of friction at a normal force [N], a curvature of the track [1/m], a speed [m/s] and a
    /// temperature of the ice [C].
    #[inline]
    pub fn mu(&self, fz: f64, curvature: f64, speed: f64, ice_c: f64) -> f64 {
        let mu = match &self.longitudinal {
            RunnerLaw::Fixed(mu) => *mu,
            RunnerLaw::Pressure(law, table) => law.mu(table.at(fz, curvature, speed, ice_c).value),
            RunnerLaw::Tabled(factor, table) => {
                factor * table.at(fz, curvature, speed, ice_c).value
            }
        };
        self.mu_scale * mu
    }

    /// How [`RunnerFriction::mu`] changes with the normal force [1/N], the curvature [m] and the speed [s/m]: of a table by central
    /// differences over a thousandth of each.
    pub fn mu_by(&self, fz: f64, curvature: f64, speed: f64, ice_c: f64) -> [f64; 3] {
        if self.table().is_none() {
            return [0.0; 3];
        }
        let at = [fz, curvature, speed];
        let least = [1.0, 1e-6, 1e-3];
        std::array::from_fn(|k| {
            let step = (1e-3 * at[k].abs()).max(least[k]);
            let moved = |by: f64| {
                let mut there = at;
                there[k] += by;
                self.mu(there[0], there[1], there[2], ice_c)
            };
            (moved(step) - moved(-step)) / (2.0 * step)
        })
    }

    /// Friction of groove and film over the mean of their table, where [`RunnerFriction::mu`] is asked; NaN without a table.
    #[inline]
    pub fn film(&self, fz: f64, curvature: f64, speed: f64, ice_c: f64) -> f64 {
        let over_mean =
            |table: &Arc<RunnerTable>| table.at(fz, curvature, speed, ice_c).value / table.mean;
        self.film.as_ref().map_or(f64::NAN, over_mean)
    }

    /// The table that the law asks.
    pub fn table(&self) -> Option<&RunnerTable> {
        match &self.longitudinal {
            RunnerLaw::Fixed(_) => None,
            RunnerLaw::Pressure(_, table) | RunnerLaw::Tabled(_, table) => Some(table),
        }
    }
}
