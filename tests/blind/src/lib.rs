//! Blind cases for `kufe discover`: data with a hidden cause, and the program that scores the
//! answers.
//!
//! Nothing here uses a kufe crate. The sled, its sensors, the friction experiments and the
//! pressure maps come from physics written a second time, so that a mistake in the finder's model
//! of an effect is not repeated in the data that test it.
//!
//! | module | what it is |
//! |---|---|
//! | [`catalogue`] | the list of cases: families, what each hides, how large |
//! | [`run_case`], [`experiments`], [`pressure_case`] | builders of the three kinds of data |
//! | [`track`], [`sled`], [`drive`], [`sensors`], [`campaign`] | the sled on its track and its measurement chain |
//! | [`film`] | the friction of groove and melt film, by closed forms |
//! | [`inverse`], [`signature`] | residuals by an independent inversion; size and likeness of effects in them |
//! | [`other_worlds`] | runs by a second generator, in worlds where data are wrong as real ones are |
//! | [`open_worlds`] | runs by a third generator, of a two-track sled, in worlds where much is wrong at once |
//! | [`half_space`], [`fourier`] | contact pressures by boundary elements |
//! | [`answer`] | what a case hides, as a file |
//! | [`score`], [`table`], [`ci`] | runs the finder on cases and compares its reports with the answers |
//!
//! ```
//! let specs = kufe_blind::catalogue::chosen("experiment/temperature@4").unwrap();
//! let case = specs[0].build(1).unwrap();
//! assert_eq!(case.answer.hides[0].effect, "temperature");
//! ```

mod cases;
mod contact;
pub mod open_worlds;
pub mod other_worlds;
mod residuals;
pub mod score;
mod world;

pub use cases::{answer, catalogue, experiments, label, pressure_case, run_case};
pub use contact::{fourier, half_space};
pub use residuals::{inverse, least_squares, signature};
pub use score::{ci, constants, table};
pub use world::{campaign, drive, film, hidden, noise, sensors, sled, track};
