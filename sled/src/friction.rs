//! A model made ready to drive: friction laws with their pressure tables opened.

use std::sync::Arc;

use kufe_friction::{Longitudinal, MagicFormula};

use crate::Error;
use crate::model::{Model, Sled};
use kufe_effect::Effects;

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
#[derive(Clone)]
pub struct Vehicle {
    /// Masses, lengths, sensor places and drag.
    pub sled: Sled,
    /// Front runner.
    pub front: RunnerFriction,
    /// Rear runner.
    pub rear: RunnerFriction,
    /// Effects beyond the base model that act on forces, sensors and track; none from [`Vehicle::new`].
    pub effects: Effects,
}

impl std::fmt::Debug for Vehicle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let effects: Vec<&str> = self
            .effects
            .active
            .iter()
            .map(|e| e.name.as_str())
            .collect();
        f.debug_struct("Vehicle")
            .field("sled", &self.sled)
            .field("front", &self.front)
            .field("rear", &self.rear)
            .field("effects", &effects)
            .finish()
    }
}

impl Vehicle {
    /// The base model: opens the pressure tables that the model names, relative to the model's folder.
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
                file: model.name(),
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
            effects: Effects::default(),
        })
    }

    /// [`Vehicle::new`] with the effects that the model switches on.
    ///
    /// What is constant about the sensors, the accelerometer's true place and the true mass, is put into `sled`.
    ///
    /// # Errors
    /// Those of [`Vehicle::new`], and [`Error::Keys`] for an effect that does not exist or whose parameters are wrong.
    pub fn with_effects(model: &Model) -> Result<Vehicle, Error> {
        let mut vehicle = Vehicle::new(model)?;
        vehicle.effects = Effects::from_tables(&model.effects).map_err(|error| Error::Keys {
            file: model.name(),
            reason: error.to_string(),
        })?;
        let mut constants = model.sled.constants();
        vehicle.effects.find_constants(&mut constants);
        vehicle.sled.set_constants(&constants);
        let sled = &vehicle.sled;
        for (key, value) in [
            ("sled.mass_kg", sled.mass_kg),
            ("sled.j_yy_kgm2", sled.j_yy_kgm2),
            ("sled.j_zz_kgm2", sled.j_zz_kgm2),
        ] {
            if value.is_nan() || value <= 0.0 {
                return Err(Error::KeyRange {
                    file: model.name(),
                    key: format!("{key} with [effects]"),
                    value,
                    expected: "a positive number",
                });
            }
        }
        Ok(vehicle)
    }

    /// The vehicle with only the effects that act on this track, freed of its name.
    pub fn on_track(&self, track: &str) -> Vehicle {
        Vehicle {
            effects: self.effects.on_track(track),
            ..self.clone()
        }
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
