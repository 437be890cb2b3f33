//! One run: its recordings read, converted, brought to one clock and one rate, and what was done said.

mod convert;
mod fragment;
mod note;
mod run;
mod times;

pub use fragment::model_fragment;
pub use note::{ChannelNote, LoggerNote, Note};
pub use run::{Imported, Importer};
