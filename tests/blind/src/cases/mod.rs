//! Blind cases: data that hide something, and what they hide.

pub mod answer;
pub mod campaign_case;
pub mod catalogue;
pub mod experiments;
mod film;
mod gliding;
pub mod label;
pub mod pressure_case;
pub mod run_case;
