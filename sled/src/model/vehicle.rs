//! A model with its friction tables opened.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use kufe_lut::{AxisKind, Interpolated, Interpolator, Mode, Outside, Point, Quantity, Table};

use crate::column::Column;
use crate::conditions::Conditions;
use crate::effects::{Active, Effects};
use crate::error::Error;
use crate::friction::{Longitudinal, MagicFormula, PressureLaw};
use crate::model::model_toml::{Model, range};
use crate::sled::{ModelConditions, Sled};

/// A sled with the friction of both runners.
#[derive(Clone, Debug)]
pub struct Vehicle {
    /// Masses, lengths, sensor places and drag.
    pub sled: Sled,
    /// Front runner.
    pub front: RunnerFriction,
    /// Rear runner.
    pub rear: RunnerFriction,
    /// Effects in addition to the base model; empty from [`Vehicle::new`].
    pub effects: Effects,
    /// Conditions of runs that do not state their own.
    pub conditions: ModelConditions,
}

impl Vehicle {
    /// The base model: opens the tables that the model names, relative to the model's folder.
    ///
    /// # Errors
    /// [`Error::File`] if the friction law needs a table and the model names none, or if a table
    /// cannot be read or does not have the quantity.
    pub fn new(model: &Model) -> Result<Vehicle, Error> {
        let keys = &model.friction.longitudinal;
        let factor = keys.tabled()?;
        let stated = factor.is_none().then(|| keys.model()).transpose()?;
        let open_table = |key: &str, path: &Option<String>, quantity| -> Result<_, Error> {
            let path = path.as_ref().ok_or_else(|| {
                let reason = format!(
                    "[friction.longitudinal] {key} is missing: a friction law of the pressure, or friction from tables, needs the runner's table"
                );
                Error::file(model.name(), reason)
            })?;
            RunnerTable::open(&model.folder.join(path), quantity).map(Arc::new)
        };
        let runner = |key: &str, path: &Option<String>, lateral: MagicFormula| {
            let mut film = None;
            let longitudinal = match stated {
                Some(Longitudinal::Fixed(mu)) => {
                    let table = path.as_ref().map(|_| open_table(key, path, Quantity::Mu));
                    film = table.transpose()?;
                    RunnerLaw::Fixed(mu)
                }
                Some(Longitudinal::Pressure(law)) => {
                    RunnerLaw::Pressure(law, open_table(key, path, Quantity::PMax)?)
                }
                None => {
                    RunnerLaw::Tabled(factor.unwrap_or(1.0), open_table(key, path, Quantity::Mu)?)
                }
            };
            Ok::<_, Error>(RunnerFriction {
                longitudinal,
                film,
                lateral,
                mu_scale: 1.0,
            })
        };
        Ok(Vehicle {
            sled: model.sled,
            front: runner("front_table", &keys.front_table, model.friction.front)?,
            rear: runner("rear_table", &keys.rear_table, model.friction.rear)?,
            effects: Effects::default(),
            conditions: model.conditions.unwrap_or_default(),
        })
    }

    /// [`Vehicle::new`] with the effects that the model switches on.
    ///
    /// The constants of the sled that effects change, e.g. mass and place of the accelerometer, are
    /// changed in `sled`.
    ///
    /// # Errors
    /// Those of [`Vehicle::new`], and [`Error::File`] for an effect that does not exist or whose
    /// parameters are wrong.
    pub fn with_effects(model: &Model) -> Result<Vehicle, Error> {
        let mut vehicle = Vehicle::new(model)?;
        let effects = Effects::from_tables(&model.effects);
        vehicle.effects = effects.map_err(|error| Error::file(model.name(), error))?;
        if vehicle.front.film.is_none() || vehicle.rear.film.is_none() {
            refuse_effects(&vehicle.effects, &[Column::Film.name()], &model.name())?;
        }
        // Experiments alone state the contact.
        let contact = Column::ContactLength.name();
        refuse_effects(&vehicle.effects, &[contact], &model.name())?;
        vehicle.effects.find_constants(&mut vehicle.sled);
        let Sled {
            mass_kg,
            j_yy_kgm2,
            j_zz_kgm2,
            ..
        } = vehicle.sled;
        let inertia = [mass_kg, j_yy_kgm2, j_zz_kgm2];
        let mut keys = ["mass_kg", "j_yy_kgm2", "j_zz_kgm2"]
            .into_iter()
            .zip(inertia);
        let outside = |(key, value): &(&str, f64)| {
            let (low, high, _) = range(&format!("sled.{key}"));
            !(low..=high).contains(value)
        };
        if let Some((key, value)) = keys.find(outside) {
            return Err(Error::KeyRange {
                file: model.name(),
                key: format!("sled.{key} with [effects]"),
                value,
                expected: range(&format!("sled.{key}")).2,
            });
        }
        Ok(vehicle)
    }

    /// The vehicle with the effects that act on this track ([`Effects::on_track`]).
    pub fn on_track(&self, track: &str) -> Vehicle {
        Vehicle {
            effects: self.effects.on_track(track),
            ..self.clone()
        }
    }

    /// The vehicle on a run: with the effects of the track, and the mass of the run if the run
    /// states it.
    pub fn on_run(&self, track: &str, conditions: &Conditions) -> Vehicle {
        let mut vehicle = self.on_track(track);
        if conditions.mass_kg.is_finite() {
            let mut sled = Sled {
                mass_kg: conditions.mass_kg,
                ..vehicle.sled
            };
            // Effects change this mass as they change the mass of the model.
            self.effects.find_constants(&mut sled);
            vehicle.sled.mass_kg = sled.mass_kg;
        }
        vehicle
    }

    /// Warnings of effects that act only on a track which is not among `tracks`, one line per
    /// track.
    pub fn effects_elsewhere(&self, tracks: &[&str]) -> Vec<String> {
        let mut elsewhere: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for effect in &self.effects.active {
            let only = effect.track.as_deref();
            if let Some(only) = only.filter(|only| !tracks.contains(only)) {
                let name = format!("[effects.{}]", effect.name);
                elsewhere.entry(only).or_default().push(name);
            }
        }
        let line = |(only, names): (&str, Vec<String>)| {
            format!(
                "{} track = {only:?}: no run is on this track, so that the effect does nothing; expected one of {}",
                names.join(", "),
                tracks.join(", ")
            )
        };
        elsewhere.into_iter().map(line).collect()
    }

    /// The tables in use, front and rear: those of the law, or those of groove and film if an
    /// effect uses them.
    pub fn tables(&self) -> [Option<&RunnerTable>; 2] {
        let mut columns = self.effects.active.iter().flat_map(Active::columns);
        let films = columns.any(|column| column == Column::Film.name());
        [&self.front, &self.rear].map(|runner| {
            let film = runner.film.as_deref().filter(|_| films);
            runner.table().or(film)
        })
    }

    /// Returns an error if a table of this vehicle needs a temperature of the ice and it is not
    /// `stated`; `file` names the source in the error.
    ///
    /// # Errors
    /// [`Error::File`] with the table.
    pub fn refuse_unstated_ice(&self, stated: bool, file: &str) -> Result<(), Error> {
        let mut tables = self.tables().into_iter().flatten();
        let over_ice = |table: &&RunnerTable| table.interpolator.has(AxisKind::IceTemperature);
        let Some(table) = tables.find(over_ice).filter(|_| !stated) else {
            return Ok(());
        };
        let reason = format!(
            "the table {} is over ice_c, which is stated neither in runs.csv nor in the run's file; expected a temperature of the ice",
            table.file
        );
        Err(Error::file(file, reason))
    }

    /// The vehicle with other lateral laws, for fits.
    pub fn with_lateral(&self, front: MagicFormula, rear: MagicFormula) -> Vehicle {
        let mut vehicle = self.clone();
        vehicle.front.lateral = front;
        vehicle.rear.lateral = rear;
        vehicle
    }
}

/// Returns an error if an effect needs one of the `absent` columns; `file` names the source in the
/// error.
///
/// # Errors
/// [`Error::File`] with the file, the effect and the column.
pub fn refuse_effects(effects: &Effects, absent: &[&str], file: &str) -> Result<(), Error> {
    let columns = effects.active.iter().flat_map(Active::columns);
    let available: Vec<&str> = columns.filter(|column| !absent.contains(column)).collect();
    let checked = effects.check_columns(&available);
    checked.map_err(|error| Error::file(file, error))
}

/// Longitudinal friction of one runner.
#[derive(Clone, Debug)]
pub enum RunnerLaw {
    /// A constant coefficient.
    Fixed(f64),
    /// A quadratic in the peak pressure, which is read from the table.
    Pressure(PressureLaw, Arc<RunnerTable>),
    /// A factor times the coefficient that is read from the table.
    Tabled(f64, Arc<RunnerTable>),
}

/// One quantity of a runner's lookup table.
#[derive(Clone, Debug)]
pub struct RunnerTable {
    /// The file.
    pub file: String,
    /// Mean over the table's nodes.
    mean: f64,
    interpolator: Interpolator,
}

impl RunnerTable {
    /// Opens a table with smooth interpolation, whose derivative is continuous as an integrator
    /// needs.
    pub(crate) fn open(path: &Path, quantity: Quantity) -> Result<Self, Error> {
        let file = path.display().to_string();
        let failure = |error: kufe_lut::Error| Error::file(&file, error);
        let opened = kufe_files::open_regular(path);
        let mut opened = opened.map_err(|error| Error::file(&file, error))?;
        let table = Table::read(&mut opened).map_err(failure)?;
        let refuses = |kind: &AxisKind| table.axes().outside(*kind) == Outside::Error;
        if let Some(kind) = AxisKind::ALL.into_iter().find(refuses) {
            let reason = format!(
                "axis {}, outside = \"error\": expected \"hold\" or \"linear\", since a simulation evaluates states outside",
                kind.key()
            );
            return Err(Error::file(&file, reason));
        }
        let interpolator =
            Interpolator::new(&table, quantity, Mode::Smooth, None).map_err(failure)?;
        let values = table.values(quantity).unwrap_or_default();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Ok(RunnerTable {
            file,
            mean,
            interpolator,
        })
    }

    /// The quantity at a point; a negative force counts as 0.
    pub fn at(&self, mut point: Point) -> Interpolated {
        point.fz = point.fz.max(0.0);
        self.interpolator.at(point)
    }
}

/// Ice friction of one runner.
#[derive(Clone, Debug)]
pub struct RunnerFriction {
    /// Longitudinal law.
    pub longitudinal: RunnerLaw,
    /// The table of mu of a runner with a fixed coefficient, used by the effect of groove and film.
    pub film: Option<Arc<RunnerTable>>,
    /// Lateral law.
    pub lateral: MagicFormula,
    /// Factor on the longitudinal coefficient: 1 except in fits.
    pub mu_scale: f64,
}

impl RunnerFriction {
    /// Longitudinal coefficient of friction at a normal force [N], a curvature of the track [1/m],
    /// a speed [m/s] and a temperature of the ice [C].
    #[inline]
    pub fn mu(&self, fz: f64, curvature: f64, speed: f64, ice_c: f64) -> f64 {
        let at = Point::sliding(fz, curvature, speed, ice_c);
        let mu = match &self.longitudinal {
            RunnerLaw::Fixed(mu) => *mu,
            RunnerLaw::Pressure(law, table) => law.mu(table.at(at).value),
            RunnerLaw::Tabled(factor, table) => factor * table.at(at).value,
        };
        self.mu_scale * mu
    }

    /// Ratio of the friction of groove and film, read from the table at these arguments, to the
    /// mean of the table; NaN without a table.
    #[inline]
    pub fn film(&self, fz: f64, curvature: f64, speed: f64, ice_c: f64) -> f64 {
        let at = Point::sliding(fz, curvature, speed, ice_c);
        let film = self.film.as_ref();
        film.map_or(f64::NAN, |table| table.at(at).value / table.mean)
    }

    /// The table of the law.
    pub fn table(&self) -> Option<&RunnerTable> {
        match &self.longitudinal {
            RunnerLaw::Fixed(_) => None,
            RunnerLaw::Pressure(_, table) | RunnerLaw::Tabled(_, table) => Some(table),
        }
    }
}
