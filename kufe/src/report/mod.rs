//! Results as one self-contained page.
//!
//! A page is one HTML file that needs no network: it contains its data, style, scripts and, for
//! three-dimensional views, the library three.js. Text of users and files is escaped in HTML, in
//! SVG and within the script of the data. The content security policy allows only the script of the
//! page.
//!
//! | item | purpose |
//! |---|---|
//! | [`page`] | the whole page of one [`Kind`] from its title and data |
//! | [`discovery_page`] | findings of a search for missing effects: tables and diagrams without scripts |
//! | [`results_page`] | any other document: pictures, and figures as tables |
//! | [`result_page`] | the page of a folder that a command has written, or of a lookup table |
//! | [`ViewedPart`] | a link into the page of recorded runs |
//! | [`record_page`] | faults and anomalies of recorded runs, worst first, without scripts |
//! | [`run_findings`] | each fault and anomaly once, with its runs |
//! | [`index_page`] | an index of runs |
//! | [`PackedGrid`] | fields on a regular grid, thinned and packed for a page |
//! | [`ContactPage`], [`SeriesPage`], [`TablePage`], [`RunsPage`] | the data of four kinds |
//!
//! ```
//! use kufe::report::{Kind, page};
//! let data = serde_json::json!({ "runs": [], "groups": [] });
//! let html = page(Kind::Evaluation, "Drivers <1>", &data);
//! assert!(html.starts_with("<!DOCTYPE html>") && html.contains("Drivers &lt;1&gt;"));
//! assert!(!html.contains("src=\"http") && !html.contains("href=\"http"));
//! ```

mod contact;
mod discovery;
mod folder;
mod grid;
mod html;
mod index;
mod page;
mod record;
mod results;
mod runs;
mod table;
mod viewer;

pub use contact::{ContactPage, PackedHull, SeriesPage};
pub use discovery::discovery_page;
pub use folder::{
    MAX_CONTACTS, MAX_TREE_BYTES, PAGE, ResultPage, TABLE_PICTURES, read_json, result_page,
};
pub use grid::PackedGrid;
pub use index::index_page;
pub use page::{Kind, page};
pub use record::{RunFinding, record_page, run_findings, verdict};
pub use results::{Picture, picture_url, results_page};
pub use runs::RunsPage;
pub use table::TablePage;
pub use viewer::{Stretch, VIEWER, ViewedPart};
