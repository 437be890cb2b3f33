//! A page of what any command has written: its pictures, and its figures as tables that an engineer
//! reads.

mod entry;
mod page;
pub(super) mod sections;

pub use page::{Picture, picture_url, results_page};
