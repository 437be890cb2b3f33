//! The track channel: slope errors against the accelerometer's, by bins of a track.

pub(crate) mod bins;
mod chance;
pub(crate) mod channel;
pub(crate) mod on_track;
