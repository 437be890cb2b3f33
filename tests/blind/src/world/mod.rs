//! A sled on its track and its measurement chain, with physics written a second time.

pub mod campaign;
pub mod drive;
pub mod film;
pub mod hidden;
pub mod noise;
pub mod sensors;
pub mod sled;
pub mod track;
