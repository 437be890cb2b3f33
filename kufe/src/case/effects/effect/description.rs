//! An effect as a value, one static of it in each file of the catalogue.

use kufe_contact::Problem;
use kufe_sled::effects::{Form, Info, Judged, Parameter};

use crate::case::effects::effect::example::{Example, Measure};
use crate::case::effects::effect::map::Map;
use crate::case::effects::effect::search::Search;

/// A switchable part of a contact problem or of its measurement; at size 0 it changes nothing.
pub struct Effect {
    /// Name, formula, parameter and source.
    pub info: Info,
    /// Changes the problem before it is solved.
    pub on_problem: Option<fn(f64, &mut Problem)>,
    /// Changes the map as the sensor would.
    pub on_map: Option<fn(f64, &mut Map)>,
    /// Factor of a peak pressure that is measured without a map.
    pub on_peak: Option<fn(f64) -> f64>,
    /// How a search follows it.
    pub search: Search,
    /// A number that it must give.
    pub example: Example,
}

impl Effect {
    /// What a file of an effect leaves out: no law, a straight search.
    pub(crate) const NEW: Effect = Effect {
        info: Self::ON_PRESSURE,
        on_problem: None,
        on_map: None,
        on_peak: None,
        search: Search::NEW,
        example: Example {
            size: 0.0,
            of: "",
            measure: Measure::OfMap(|_| f64::NAN),
            gives: f64::NAN,
        },
    };

    /// What the description of an effect leaves out: it is judged by pressures.
    pub(crate) const ON_PRESSURE: Info = Info {
        judged: Judged::ByPressure,
        ..Info::NEW
    };

    /// What is known of it.
    pub fn info(&'static self) -> &'static Info {
        &self.info
    }

    /// Its one parameter.
    pub fn parameter(&self) -> &'static Parameter {
        self.info.amplitude()
    }

    /// Changes the problem before it is solved.
    pub fn alter(&self, size: f64, problem: &mut Problem) {
        if let Some(law) = self.on_problem {
            law(size, problem);
        }
    }

    /// Changes the map as the sensor would.
    pub fn sense(&self, size: f64, map: &mut Map) {
        if let Some(law) = self.on_map {
            law(size, map);
        }
    }

    /// Factor of a peak pressure that is measured without a map.
    pub fn peak_factor(&self, size: f64) -> f64 {
        self.on_peak.map_or(1.0, |law| law(size))
    }

    /// Relative standard deviation of its size that its own form leaves open, whatever the noise.
    pub fn form_error(&self) -> f64 {
        match self.info.form {
            Form::Open(deviation) => deviation,
            Form::Exact | Form::FirstOrder => 0.0,
        }
    }

    /// Whether it leaves the problem as it is.
    pub fn is_of_the_sensor(&self) -> bool {
        self.on_problem.is_none()
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Effect").field(&self.info.name).finish()
    }
}
