//! An effect on pressures: its laws, and its options in a search.

use kufe_contact::Problem;
use kufe_sled::effects::{Form, Info, Parameter};
use serde::Deserialize;

/// A switchable part of a contact problem or of its measurement; at size 0 it changes nothing.
#[derive(Deserialize)]
#[serde(bound(deserialize = "'de: 'static"))]
pub struct Effect {
    /// Name, formula, parameter and source.
    #[serde(flatten)]
    pub info: Info,
    /// Options of a search for its size.
    #[serde(default)]
    pub search: Search,
    /// Changes the problem before it is solved; never called with size 0.
    #[serde(skip)]
    pub on_problem: Option<fn(f64, &mut Problem)>,
    /// Changes the map as the sensor would; never called with size 0.
    #[serde(skip)]
    pub on_map: Option<fn(f64, &mut Map)>,
    /// Factor of a peak pressure that is measured without a map.
    #[serde(skip)]
    pub on_peak: Option<fn(f64) -> f64>,
}

impl Effect {
    /// Name, formula, parameter and source.
    pub fn info(&'static self) -> &'static Info {
        &self.info
    }

    /// Its one parameter.
    pub fn parameter(&self) -> &'static Parameter {
        self.info.amplitude()
    }

    /// Changes the problem before it is solved.
    pub fn alter(&self, size: f64, problem: &mut Problem) {
        if let Some(law) = self.on_problem.filter(|_| size != 0.0) {
            law(size, problem);
        }
    }

    /// Changes the map as the sensor would.
    pub fn sense(&self, size: f64, map: &mut Map) {
        if let Some(law) = self.on_map.filter(|_| size != 0.0) {
            law(size, map);
        }
    }

    /// Factor of a peak pressure that is measured without a map.
    pub fn peak_factor(&self, size: f64) -> f64 {
        self.on_peak.map_or(1.0, |law| law(size))
    }

    /// Relative standard deviation of its size due to the uncertainty of its form, without noise.
    pub fn form_error(&self) -> f64 {
        match self.info.form {
            Form::Open(deviation) => deviation,
            Form::Exact | Form::FirstOrder => 0.0,
        }
    }

    /// Whether it acts on the sensor only and does not change the problem.
    pub fn is_of_the_sensor(&self) -> bool {
        self.on_problem.is_none()
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Effect").field(&self.info.name).finish()
    }
}

/// A pressure map on a regular grid, `ny` rows of `nx`, as a film or sensor array gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Columns.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
    /// Centre of the first pixel along the runner [m].
    pub x0: f64,
    /// Centre of the first pixel across [m].
    pub y0: f64,
    /// Size of a pixel along the runner [m].
    pub dx: f64,
    /// Size of a pixel across the runner [m].
    pub dy: f64,
    /// Pressure [Pa].
    pub pressure: Vec<f64>,
}

/// Dependence of the maps on the size of an effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Growth {
    /// Nearly linear.
    #[default]
    Straight,
    /// Quadratic.
    Square,
    /// Strongly nonlinear: the gain that the first linear step predicts is unreliable.
    Bent,
    /// Strongly nonlinear over the whole range from 0 to a usual size.
    Far,
}

/// Composition of two sizes a and b of the same effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Adds {
    /// a + b.
    #[default]
    Sums,
    /// (1 + a) (1 + b) - 1.
    Factors,
    /// sqrt(a^2 + b^2).
    Squares,
}

/// Options of a search for the best size of an effect. Defaults: linear growth from 0, sizes add
/// up, and peak pressures suffice.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Search {
    /// Whether a map is needed, since a peak pressure alone does not determine the size.
    pub needs_map: bool,
    /// Dependence of the maps on the size.
    pub growth: Growth,
    /// Composition of two sizes.
    pub adds: Adds,
    /// Size up to which the effect has no influence, as a function of the problem and the largest
    /// measured pressure [Pa]; 0 where absent.
    #[serde(skip)]
    pub begins: Option<fn(&Problem, f64) -> f64>,
}

impl Search {
    /// Transforms a size to the coordinate in which the maps are nearly linear.
    pub fn along(&self, size: f64) -> f64 {
        match self.growth {
            Growth::Square => size * size,
            _ => size,
        }
    }

    /// Transforms the coordinate of [`along`](Self::along) back to the size.
    pub fn back(&self, place: f64) -> f64 {
        match self.growth {
            Growth::Square => place.max(0.0).sqrt(),
            _ => place,
        }
    }

    /// Size of the composition of two effects of the same kind.
    ///
    /// ```
    /// let gain = kufe::case::effects::find("sensor-gain").unwrap();
    /// assert!((gain.search.together(0.5, 0.2) - 0.8).abs() < 1e-15);
    /// ```
    pub fn together(&self, first: f64, second: f64) -> f64 {
        match self.adds {
            Adds::Sums => first + second,
            Adds::Factors => (1.0 + first) * (1.0 + second) - 1.0,
            Adds::Squares => first.hypot(second),
        }
    }
}
