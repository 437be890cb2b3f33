//! The one-track bobsled: measured runs, inverse model, fits, driver evaluation, simulation.
//!
//! | item | purpose |
//! |---|---|
//! | [`Model`], [`Vehicle`] | `model.toml`, and the same with its pressure tables opened |
//! | [`Run`], [`read_runs`] | recorded runs, checked: CSV, Parquet, MATLAB v5, MDF 4 (feature `mdf4`) |
//! | [`prepare()`] | filter, down-sample, transfer to the centre of gravity, slips: [`State`]s and [`Motion`]s |
//! | [`one_track`] | forces from motion ([`one_track::inverse`]) and from friction ([`one_track::forward`]) |
//!
//! ```
//! use kufe_sled::one_track::{State, forward, normal_forces};
//! use kufe_sled::{Model, Vehicle};
//! let vehicle = Vehicle::new(&Model::published())?;
//! let (fz_f0_n, fz_r_n) = normal_forces(&vehicle.sled, 9.81, 0.0);
//! let drifting = State { v_mps: 30.0, alpha_f_rad: 0.01, alpha_r_rad: 0.01, fz_f0_n, fz_r_n, ..State::default() };
//! let forces = forward(&vehicle, &drifting);
//! // The rear runner is the stiffer one.
//! assert!(forces.rear[1] > 2.0 * forces.front[1]);
//! # Ok::<(), kufe_sled::Error>(())
//! ```

pub mod aero;
pub mod check;
mod derivative;
pub mod effects;
mod error;
mod filter;
mod friction;
mod matlab;
#[cfg(feature = "mdf4")]
mod mdf4;
mod model;
mod noise;
pub mod one_track;
mod parquet_file;
mod prepare;
mod read;
mod run;
mod transfer;

pub use derivative::derivative;
pub use error::Error;
pub use filter::{low_pass, noise_gain, resample};
pub use friction::{PressureLookup, RunnerFriction, Vehicle};
pub use model::{Friction, Model, Noise, Sled, Survey};
pub use noise::{estimate_noise, slip_noise, white_noise_sd};
pub use one_track::{AxleForces, Motion, State};
pub use parquet_file::{read_parquet, write_parquet};
pub use prepare::{PrepareOptions, Prepared, prepare, prepare_all};
pub use read::{Columns, read_columns, read_csv, write_csv};
pub use run::{
    COLUMNS, Conditions, Entry, INDEX_COLUMNS, Run, read_good_runs, read_index, read_run,
    read_runs, write_index,
};
pub use transfer::{Slips, lever_acceleration, slips, to_centre_of_gravity};
