//! The track channel: slope errors against the accelerometer's, by bins of a track.

pub(crate) mod bins;
pub(crate) mod channel;
pub(crate) mod on_track;
mod significance;
