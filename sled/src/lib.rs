//! The one-track bobsled: measured runs, inverse model, fits, driver evaluation, simulation.
//!
//! | item | purpose |
//! |---|---|
//! | [`Model`], [`Vehicle`] | `model.toml`, and the same with its pressure tables opened |
//! | [`Run`], [`read_runs`] | recorded runs, checked: CSV, Parquet, MATLAB v5, MDF 4 (feature `mdf4`) |
//! | [`prepare()`] | filter, down-sample, transfer to the centre of gravity, slips: [`State`]s and [`Motion`]s |
//! | [`one_track`] | forces from motion ([`one_track::inverse`]) and from friction ([`one_track::forward`]) |
//! | [`simulate()`], [`record`] | drives a [`Track`] with a [`Driver`]; what the sled's sensors record of it |
//! | [`sample_data`] | 44 runs of five drivers on two tracks, with the truth known |
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
mod bootstrap;
pub mod check;
mod derivative;
mod driver;
mod dynamics;
mod error;
mod evaluate;
mod filter;
mod fit;
mod friction;
mod matlab;
#[cfg(feature = "mdf4")]
mod mdf4;
mod model;
mod noise;
pub mod one_track;
mod parquet_file;
pub mod plots;
mod prepare;
mod read;
mod run;
pub mod sample_data;
mod simulate;
mod spline;
mod track;
mod transfer;
mod validate;
mod write;

pub use kufe_effect as effects;

pub use bootstrap::{Summary, quantile, summarise};
pub use derivative::derivative;
pub use driver::Driver;
pub use dynamics::{GRAVITY, Instant, WallContact};
pub use error::Error;
pub use evaluate::{Angles, DrivingForce, Group, RunEvaluation, distinct, evaluate, groups};
pub use filter::{low_pass, noise_gain, resample};
pub use fit::{FitOptions, SledFit, find_contacts, fit, lateral_samples};
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
pub use simulate::{EnergyBalance, SimulateOptions, Simulated, record, simulate, simulated_entry};
pub use spline::Spline;
pub use track::{Track, TrackShape};
pub use transfer::{Slips, lever_acceleration, slips, to_centre_of_gravity};
pub use validate::{
    Disagreement, LateralForce, RunValidation, TrackValidation, by_track, validate,
};
pub use write::{RunFormat, write_run};
