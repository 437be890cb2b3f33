//! Friction of a slider with a contact of known length and width.

use crate::error::Error;
use crate::friction::film::march::film;
use crate::friction::film::properties::{
    BoundaryContact, FilmConditions, FilmOptions, Properties, Strip,
};

/// The contact of a slider, approximated by a rectangle under uniform pressure.
///
/// ```
/// use kufe_sled::friction::film::Patch;
/// let patch = Patch { length: 0.06, width: 0.9e-3, roughness: 0.5e-6 };
/// let film = patch.friction(950.0, 5.0, -5.0, 0.0)?;
/// let mixed = patch.friction(950.0, 5.0, -5.0, 60e3)?;
/// assert!(film < mixed && mixed < 2.0 * film);
/// # Ok::<(), kufe_sled::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Patch {
    /// Length along the motion [m].
    pub length: f64,
    /// Mean width [m].
    pub width: f64,
    /// Standard deviation of the heights of steel and ice together [m].
    pub roughness: f64,
}

impl Patch {
    /// A contact with unknown sizes (NaN).
    pub const UNKNOWN: Patch = Patch {
        length: f64::NAN,
        width: f64::NAN,
        roughness: f64::NAN,
    };

    /// Coefficient of friction of the [`film`] under the normal force `fz` [N], at the speed `v`
    /// [m/s], on ice of the temperature `ice_c` [C]. Touching asperities have the shear stress
    /// `boundary_shear` [Pa].
    ///
    /// ```text
    /// p = F_z/(length width)
    /// ```
    ///
    /// The steel is as cold as the ice and has slid for ten seconds ([`FilmConditions::new`]). A
    /// shear stress of 0 does not read the roughness. Ploughing is not included.
    ///
    /// # Errors
    /// As [`Strip::uniform`] and [`film`].
    pub fn friction(&self, fz: f64, v: f64, ice_c: f64, boundary_shear: f64) -> Result<f64, Error> {
        let strip = Strip::uniform(self.length, self.width, fz / (self.length * self.width))?;
        let mut conditions = FilmConditions::new(v, ice_c);
        if boundary_shear != 0.0 {
            conditions.boundary = BoundaryContact {
                roughness: self.roughness,
                shear: boundary_shear,
            };
        }
        let options = FilmOptions::default();
        let film = film(&strip, &conditions, &Properties::WATER_AND_ICE, &options)?;
        Ok(film.totals.friction)
    }
}
