//! Recordings as loggers and their programs write them.

mod cell;
mod encoding;
mod layout;
mod log;
#[cfg(feature = "mat73")]
mod matlab73;
#[cfg(feature = "mdf4")]
mod mdf4;
mod read;
mod text;
#[cfg(any(feature = "mdf4", feature = "mat73"))]
mod unpacked;

pub use layout::TextOptions;
pub use log::{Channel, Log};
#[cfg(feature = "mat73")]
pub use matlab73::read_matlab73;
#[cfg(feature = "mdf4")]
pub use mdf4::read_mdf4;
pub(crate) use read::bytes_of;
pub use read::{read_log, read_recording};
pub use text::read_text;
