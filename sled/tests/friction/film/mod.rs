//! The melt film under a runner against closed forms, balances and a second method.

mod any_patch;
mod balance;
mod boundary;
mod closed_form;
mod groove;
mod hardness;
mod input;
mod limits;
mod patches;
mod plane_film;
mod pressure_map;
mod reynolds;
