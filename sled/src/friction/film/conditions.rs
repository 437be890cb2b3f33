//! The state of sliding that a film is asked for, and how exactly.

use super::properties::Properties;
use crate::friction::error::{Error, in_range};

/// Speed and temperatures of a runner that slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmConditions {
    /// Sliding speed [m/s].
    pub v: f64,
    /// Temperature of the ice before the runner comes [C].
    pub ice_temperature: f64,
    /// Temperature of the runner's steel before it slid [C].
    pub steel_temperature: f64,
    /// Time for which the runner has been sliding, in which heat went into its steel [s].
    pub sliding_time: f64,
    /// Factor on the viscosity of water: what a slurry of ice and water would have more.
    pub viscosity_factor: f64,
}

impl FilmConditions {
    /// A runner as cold as the ice, ten seconds after its start, over plain water.
    pub fn new(v: f64, ice_temperature: f64) -> Self {
        FilmConditions {
            v,
            ice_temperature,
            steel_temperature: ice_temperature,
            sliding_time: 10.0,
            viscosity_factor: 1.0,
        }
    }

    /// Viscosity of the film [Pa s].
    pub fn viscosity(&self, properties: &Properties) -> f64 {
        self.viscosity_factor * properties.water_viscosity
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a speed, time or factor that is not positive, ice outside -100 to 0 C, steel outside -100 to 100 C.
    pub fn check(&self) -> Result<(), Error> {
        let positive = "a positive number";
        in_range("v", self.v, self.v > 0.0, positive)?;
        let ice = self.ice_temperature;
        in_range(
            "ice_temperature",
            ice,
            (-100.0..=0.0).contains(&ice),
            "-100 to 0 C",
        )?;
        let steel = self.steel_temperature;
        let steel_range = (-100.0..=100.0).contains(&steel);
        in_range("steel_temperature", steel, steel_range, "-100 to 100 C")?;
        in_range(
            "sliding_time",
            self.sliding_time,
            self.sliding_time > 0.0,
            positive,
        )?;
        let factor = self.viscosity_factor;
        in_range("viscosity_factor", factor, factor > 0.0, positive)
    }
}

/// How exactly the film's equation is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmOptions {
    /// Discretisation error asked of every total, 1e-10 to 0.1: relative to its value, that of heat and water, which may be small
    /// differences, to the power that is dissipated and the water that it would melt. Down to 1e-8 it is reached on any patch
    /// that was tried (thousands, of pressures in steps among them); where it is not, [`Error::NotConverged`] says how far it came.
    pub accuracy: f64,
}

impl Default for FilmOptions {
    fn default() -> Self {
        FilmOptions { accuracy: 1e-6 }
    }
}

impl FilmOptions {
    /// Checks the number.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn check(&self) -> Result<(), Error> {
        let holds = (1e-10..=0.1).contains(&self.accuracy);
        in_range("accuracy", self.accuracy, holds, "1e-10 to 0.1")
    }
}
