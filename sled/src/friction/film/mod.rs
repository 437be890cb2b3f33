//! The melt film under a sliding runner: its thickness, temperature and drag from friction heat, heat conduction and squeeze-out.
//!
//! | item | purpose |
//! |---|---|
//! | [`Strip`], [`FilmConditions`], [`BoundaryContact`], [`Properties`] | what the film is under, and of |
//! | [`film`] | thickness, melt rate, shear, heat and drag along the strip |
//! | [`PressureMap`], [`reynolds_film`] | the same with the two-dimensional Reynolds equation |
//! | [`IceHardness`] | the pressure that the ice bears |
//! | [`melt_and_squeeze_friction`] and its neighbours | closed forms of the limits |
//!
//! ```
//! use kufe_sled::friction::film::{FilmConditions, FilmOptions, Properties, Strip, film};
//! let strip = Strip::uniform(0.06, 1.0e-3, 17.7e6)?; // 60 mm long, 1 mm wide, ice that yields at 17.7 MPa
//! let conditions = FilmConditions::new(30.0, -5.0);
//! let film = film(&strip, &conditions, &Properties::WATER_AND_ICE, &FilmOptions::default())?;
//! assert!((3e-3..6e-3).contains(&film.totals.friction));
//! # Ok::<(), kufe_sled::friction::Error>(())
//! ```

mod closed_form;
mod march;
mod pressure_map;
mod properties;
mod reynolds;

pub use closed_form::{
    cold_friction, film_pressure, melt_and_squeeze_friction, melt_and_squeeze_thickness,
    self_similar_start, squeeze_out_rate,
};
pub use march::{Film, FilmStation, FilmTotals, film};
pub use pressure_map::PressureMap;
pub use properties::{
    BoundaryContact, FilmConditions, FilmOptions, HARDNESS_EXPONENT, HeatIntoIce, IceHardness,
    Properties, Strip, pressure_melting_bound,
};
pub use reynolds::{ReynoldsFilm, reynolds_film};
