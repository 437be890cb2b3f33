//! The melt film under a runner against closed forms, balances and a second method.

mod any_patch;
mod balance;
mod boundary;
mod groove;
mod hardness;
mod input;
mod limits;
mod patches;
mod reynolds;
