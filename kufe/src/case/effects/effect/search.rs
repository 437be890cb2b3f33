//! How a search for the best size follows an effect.

use kufe_contact::Problem;

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
    /// The size up to which it does nothing, from the problem and the largest pressure measured [Pa]; 0 where absent.
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
