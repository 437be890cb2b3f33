//! The one-track bobsled: measured runs, inverse model, fits, driver evaluation, simulation.
//!
//! | item | purpose |
//! |---|---|
//! | [`Model`], [`Vehicle`] | `model.toml`, and the model with its pressure tables opened |
//! | [`Run`], [`read_runs`] | recorded runs, checked: CSV, Parquet, MATLAB v5 |
//! | [`prepare()`] | filter, down-sample, transfer to the centre of gravity, slips: [`State`]s and [`Motion`]s |
//! | [`Balance`] | forces of laws and effects at one instant, and the residual of the equations of motion; the model of all commands |
//! | [`one_track`] | forces from motion ([`one_track::inverse`]) and from friction ([`one_track::forward`]) |
//! | [`simulate()`], [`record`] | simulates a [`Driver`] on a [`Track`], and the recording of the sled's sensors |
//! | [`replay()`] | simulates a measured run, and states where both differ |
//! | [`align()`] | aligns runs of one track to a common distance, and estimates the track |
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

mod align;
mod column;
mod columns;
mod conditions;
mod contacts;
pub mod effects;
mod error;
mod evaluate;
mod fault;
mod fit;
pub mod friction;
mod model;
mod motion;
mod record;
mod replay;
mod series;
mod signals;
mod simulate;
mod sled;
mod track;

pub use friction::GRAVITY;

pub use align::estimate::TrackEstimate;
pub use align::signature::DistanceWarp;
pub use align::{Aligned, AlignedRun, align, state_places};
pub use column::{COLUMNS, Column, Sensor};
pub use columns::matlab::{
    LONGEST_MATLAB, MatlabVariables, matlab_column, matlab_remark, read_matlab,
};
pub use columns::parquet::{read_parquet, write_parquet};
pub use columns::{Columns, FileColumns, MOST_NUMBERS, read_columns, read_csv, write_csv};
pub use conditions::{CONDITIONS, Conditions};
pub use contacts::{
    HARDEST, HITS_DIFFER, Push, as_expected, as_of_run, find_contacts, half_waves, hits_of,
    likelier, push_within, scatter, stretch_of, with_own_contacts,
};
pub use error::Error;
pub use evaluate::driving::{Angles, DrivingForce, RunEvaluation, evaluate};
pub use evaluate::groups::{Group, Summary, groups, quantile};
pub use evaluate::track_loss::{DriverLosses, TrackLoss, losses_by_driver};
pub use evaluate::validate::{
    Disagreement, LateralForce, RunValidation, TrackValidation, by_track, residuals,
    root_mean_square, validate,
};
pub use fault::{Fault, FaultKind};
pub use fit::{
    Axle, FitResult, SlipOffset, fit, lateral_samples, slip_offsets, slip_offsets_text,
    without_slip_offsets,
};
pub use model::model_toml::{Friction, MODEL_EXAMPLE, Model};
pub use model::vehicle::{RunnerFriction, RunnerLaw, RunnerTable, Vehicle, refuse_effects};
pub use motion::balance::{Balance, BalanceResidual, LawForces};
pub use motion::outside::{OutsideTable, outside_tables, table_samples, together};
pub use motion::state::{
    AxleForces, Motion, Slips, State, from_sensors, slips, to_centre_of_gravity,
};
pub use motion::{aero, one_track};
pub use record::check;
pub use record::check::columns::LARGEST_VALUE;
pub use record::check::examine::{Examination, Note, examine};
pub use record::check::faults::{RelationRules, check_relations, find_faults, find_faults_with};
pub use record::check::profile::{OddKind, OddStretch, Profile};
pub use record::file_names::{file_stem, run_file, track_file};
pub use record::files::{RunFormat, read_good_runs, read_run, read_runs, write_run};
pub use record::gaps::{Gaps, OnGaps, SampleCoverage, Saturation, gaps_line, rows_held};
pub use record::index::{
    COVARIATE, Entry, ICE_AT, INDEX_COLUMNS, MORE_INDEX_COLUMNS, covariates, read_index,
    write_index,
};
pub use record::needs::{Needs, refuse_unstated_air};
pub use record::run::Run;
pub use replay::compared::{Compared, Difference, Section};
pub use replay::drive::{Replay, add_measured_columns, replay};
pub use replay::inputs::{Inputs, READ, Reading, read_for_replay};
pub use series::{
    MIN_FILTER_SAMPLES, bridged, correlation, derivative, distinct, integral, low_pass, median,
    resample, resample_stretches,
};
pub use signals::filtered::estimate_noise;
pub use signals::prepare::{PrepareOptions, Prepared, prepare, prepare_all};
pub use simulate::drive::{EnergyBalance, SimulateOptions, Simulated, simulate};
pub use simulate::driver::Driver;
pub use simulate::dynamics::{Instant, WallContact};
pub use simulate::sample_data;
pub use simulate::sensors::{record, simulated_entry};
pub use sled::{ModelConditions, Noise, Sled, Survey, Tolerances};
pub use track::spline::Spline;
pub use track::table::{IceAlong, Track, TrackShape};
