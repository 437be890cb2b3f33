//! Ice, air and crew of a run, and the effects that need what they do not state.

use crate::effects::Effects;
use crate::error::Error;
use crate::friction::air_density;
use crate::model::sled::ModelConditions;

/// Ice, air and crew of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Ice temperature [degrees Celsius]; NaN where nothing states it: only tables and effects over it ask for it.
    pub ice_c: f64,
    /// Air temperature [degrees Celsius]; NaN where nothing states it: only the drag and effects over it ask for it.
    pub air_c: f64,
    /// Air pressure [Pa]; NaN likewise.
    pub air_pa: f64,
    /// Relative humidity [%], where it is stated; only effects ask for it.
    pub humidity_pct: Option<f64>,
    /// Distance run on this finish of the runners before the run [m], where it is stated; only effects ask for it.
    pub distance_m: Option<f64>,
    /// Mass of the sled with its crew [kg], where it is not the model's.
    pub mass_kg: Option<f64>,
}

impl Conditions {
    /// The same with what the model states where nothing is stated here.
    pub fn or(&self, model: &ModelConditions) -> Conditions {
        Conditions {
            humidity_pct: self.humidity_pct.or(model.humidity_pct),
            distance_m: self.distance_m.or(model.distance_m),
            ..*self
        }
    }

    /// What effects may ask for and is not stated.
    pub fn absent(&self) -> Vec<&'static str> {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let stated = [
            ("humidity_pct", self.humidity_pct),
            ("distance_m", self.distance_m),
            ("ice_c", finite(self.ice_c)),
            ("air_c", finite(self.air_c)),
            ("air_pa", finite(self.air_pa)),
        ];
        let absent = stated.into_iter().filter(|(_, value)| value.is_none());
        absent.map(|(name, _)| name).collect()
    }

    /// Density of the air [kg/m3] by [`air_density`]; NaN where nothing states the weather.
    pub fn air_density(&self) -> f64 {
        air_density(self.air_pa, self.air_c)
    }
}

/// Refuses effects that need one of the `absent` columns; `file` is where they would stand.
///
/// # Errors
/// [`Error::Keys`] with the file, the effect and the column.
pub fn refuse_effects(effects: &Effects, absent: &[&str], file: &str) -> Result<(), Error> {
    let there: Vec<&str> = effects
        .active
        .iter()
        .flat_map(|effect| effect.columns())
        .filter(|column| !absent.contains(column))
        .collect();
    effects.check_columns(&there).map_err(|error| Error::Keys {
        file: file.to_string(),
        reason: error.to_string(),
    })
}
