//! Sensor noise: as stated, from differences of the recordings, or from their spectra.

pub(crate) mod axes;
pub(crate) mod colour;
pub(crate) mod periodogram;
pub(crate) mod sensors;
