//! The melt film under a sliding runner: its thickness, temperature and drag from friction heat,
//! heat conduction and squeeze-out.
//!
//! | item | purpose |
//! |---|---|
//! | [`Strip`], [`FilmConditions`], [`BoundaryContact`], [`Properties`] | input: contact, sliding conditions, mixed lubrication, materials |
//! | [`film`] | thickness, melt rate, shear, heat and drag along the strip |
//! | [`Patch`] | coefficient of friction of a contact of known length and width |
//! | [`IceHardness`] | indentation hardness of ice |
//!
//! ```
//! use kufe_sled::friction::film::{FilmConditions, FilmOptions, Properties, Strip, film};
//! let strip = Strip::uniform(0.06, 1.0e-3, 17.7e6)?; // 60 mm long, 1 mm wide, ice of hardness 17.7 MPa
//! let conditions = FilmConditions::new(30.0, -5.0);
//! let film = film(&strip, &conditions, &Properties::WATER_AND_ICE, &FilmOptions::default())?;
//! assert!((3e-3..6e-3).contains(&film.totals.friction));
//! # Ok::<(), kufe_sled::Error>(())
//! ```

mod march;
mod patch;
mod properties;

pub use march::{Film, FilmStation, FilmTotals, film, film_with_outflow};
pub use patch::Patch;
pub use properties::{
    BoundaryContact, FilmConditions, FilmOptions, HARDNESS_EXPONENT, HeatIntoIce, IceHardness,
    Properties, Strip, pressure_melting_bound,
};
