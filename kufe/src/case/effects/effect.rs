//! An effect on pressures: its laws, how a search follows it, and an example with the number it
//! must give.

use kufe_contact::Problem;
use kufe_sled::effects::{Form, Info, Judged, Parameter};

/// A switchable part of a contact problem or of its measurement; at size 0 it changes nothing.
pub struct Effect {
    /// Name, formula, parameter and source.
    pub info: Info,
    /// Changes the problem before it is solved; never called with size 0.
    pub on_problem: Option<fn(f64, &mut Problem)>,
    /// Changes the map as the sensor would; never called with size 0.
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

/// A size and the number that it must give.
///
/// The problem is a rigid paraboloid of radii 30 m and 5 mm on a half-space of 9 GPa under 1 kN,
/// free to turn; the map has 41 by 31 pixels of 1 mm, 1 MPa on the one in the middle.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// Size of the effect.
    pub size: f64,
    /// What is measured, in words, with its unit.
    pub of: &'static str,
    /// How it is measured.
    pub measure: Measure,
    /// What must come out.
    pub gives: f64,
}

/// What is measured after an effect has acted.
#[derive(Clone, Copy, Debug)]
pub enum Measure {
    /// Of the problem.
    OfProblem(fn(&Problem) -> f64),
    /// Of the map.
    OfMap(fn(&Map) -> f64),
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
    /// Pixel along [m].
    pub dx: f64,
    /// Pixel across [m].
    pub dy: f64,
    /// Pressure [Pa].
    pub pressure: Vec<f64>,
}

/// How the maps follow the size of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Growth {
    /// Nearly in proportion.
    Straight,
    /// In proportion to its square.
    Square,
    /// Far from straight: what the first step promises means little.
    Bent,
    /// Far from straight all the way from nothing to a usual size.
    Far,
}

/// What two of the same effect, one after the other, are together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adds {
    /// a + b.
    Sums,
    /// (1 + a) (1 + b) - 1.
    Factors,
    /// sqrt(a^2 + b^2).
    Squares,
}

/// How a search for the best size follows an effect.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// Whether a peak pressure alone says next to nothing of it.
    pub needs_map: bool,
    /// How the maps follow its size.
    pub growth: Growth,
    /// What two of it are together.
    pub adds: Adds,
    /// The size up to which it does nothing, from the problem and the largest pressure measured
    /// [Pa]; 0 where absent.
    pub begins: Option<fn(&Problem, f64) -> f64>,
}

impl Search {
    /// Straight from 0, sizes add up, peaks are enough.
    pub(crate) const NEW: Search = Search {
        needs_map: false,
        growth: Growth::Straight,
        adds: Adds::Sums,
        begins: None,
    };

    /// From a size to its place on the line that the maps follow nearly straight.
    pub fn along(&self, size: f64) -> f64 {
        match self.growth {
            Growth::Square => size * size,
            _ => size,
        }
    }

    /// From a place on that line to the size.
    pub fn back(&self, place: f64) -> f64 {
        match self.growth {
            Growth::Square => place.max(0.0).sqrt(),
            _ => place,
        }
    }

    /// Size of two of the same effect, one after the other.
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
