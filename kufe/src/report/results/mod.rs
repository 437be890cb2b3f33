//! The page of any document: pictures, and figures as tables.

mod entry;
mod page;
pub(super) mod sections;

pub use page::{Picture, picture_url, results_page};
