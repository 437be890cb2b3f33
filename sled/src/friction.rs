//! A model made ready to drive: friction laws with their pressure tables opened.

use std::sync::Arc;

use kufe_friction::{Longitudinal, MagicFormula};

use crate::Error;
use crate::model::{Model, Sled};

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
}

impl RunnerFriction {
    /// Longitudinal coefficient of friction at a normal force [N] and a track curvature [1/m].
    pub fn mu(&self, fz: f64, curvature: f64) -> f64 {
        match (&self.longitudinal, &self.pressure) {
            (Longitudinal::Fixed(mu), _) => *mu,
            (law, Some(pressure)) => law.mu(pressure(fz.max(0.0), curvature)),
            (law, None) => law.mu(f64::NAN),
        }
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

/// A sled with the friction of both runners.
#[derive(Clone, Debug)]
pub struct Vehicle {
    /// Masses, lengths, sensor places and drag.
    pub sled: Sled,
    /// Front runner.
    pub front: RunnerFriction,
    /// Rear runner.
    pub rear: RunnerFriction,
}

impl Vehicle {
    /// Opens the pressure tables that the model names, relative to the model's folder.
    ///
    /// # Errors
    /// [`Error::Keys`] where the friction law needs a pressure and the model names no table, [`Error::File`] where a
    /// table cannot be read.
    pub fn new(model: &Model) -> Result<Vehicle, Error> {
        let keys = &model.friction.longitudinal;
        let longitudinal = keys.model()?;
        let open = |key: &str, path: &Option<String>| -> Result<Option<PressureLookup>, Error> {
            if !longitudinal.needs_pressure() {
                return Ok(None);
            }
            let path = path.as_ref().ok_or_else(|| Error::Keys {
                file: "model".to_string(),
                reason: format!(
                    "[friction.longitudinal] {key} is missing: friction over pressure needs the runner's table"
                ),
            })?;
            open_table(&model.folder.join(path)).map(Some)
        };
        Ok(Vehicle {
            sled: model.sled,
            front: RunnerFriction {
                longitudinal,
                pressure: open("front_table", &keys.front_table)?,
                lateral: model.friction.front,
            },
            rear: RunnerFriction {
                longitudinal,
                pressure: open("rear_table", &keys.rear_table)?,
                lateral: model.friction.rear,
            },
        })
    }

    /// The vehicle with other lateral laws, for fits.
    pub fn with_lateral(&self, front: MagicFormula, rear: MagicFormula) -> Vehicle {
        let mut vehicle = self.clone();
        vehicle.front.lateral = front;
        vehicle.rear.lateral = rear;
        vehicle
    }
}

/// Opens a lookup table of peak pressure; its smooth mode has no kinks that an integrator would feel.
fn open_table(path: &std::path::Path) -> Result<PressureLookup, Error> {
    use kufe_lut::{Lookup, Mode, Quantity, Table};
    let name = path.display().to_string();
    let told = |error: kufe_lut::Error| Error::file(&name, error);
    let mut file = std::fs::File::open(path).map_err(|error| Error::file(&name, error))?;
    let table = Table::read(&mut file).map_err(told)?;
    let lookup = Lookup::new(&table, Quantity::PMax, Mode::Smooth).map_err(told)?;
    Ok(Arc::new(move |fz, curvature| {
        lookup.at(fz, curvature).value
    }))
}
