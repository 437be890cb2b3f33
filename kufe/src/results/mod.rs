//! Results as typed documents.
//!
//! Each command writes one of these structs as JSON, and commands that read the document use the
//! same struct. The keys are described on the formats page. [`QUANTITIES`] states the keys and the
//! label of every number with an error; the unit is the ending of the key. Text, tables and pages
//! use these labels.
//!
//! | item | document |
//! |---|---|
//! | [`ContactResult`], [`SlidingResult`] | `result.json`: one solved contact |
//! | [`Comparison`] | `comparison.json`: two solved contacts |
//! | [`SeriesRow`] | a row of `table.json`: one contact of a series |
//! | [`FrictionTable`], [`FrictionOptimum`] | `friction.json` |
//! | [`PressureFit`] | `fit.json` of friction over pressure |
//! | [`IceHouseResult`] | `icehouse.json` |
//! | [`LateralFitDocument`], [`Evaluation`], [`Validation`] | `fit.json`, `evaluation.json`, `validation.json` of runs |
//! | [`Simulation`], [`ReplayResult`] | `simulation.json` |
//! | [`RunCheck`], [`Alignment`], [`SampleTruth`] | `check.json`, `align.json`, `truth.json` |
//! | [`ImportList`] | `import.json` |
//! | [`HullCheck`], [`MeshQuality`] | an examined hull; `quality.json` |
//! | [`TableSummary`], [`TableInfo`], [`TableLookup`] | a lookup table, and its values at one contact |
//! | [`finding::Report`] | `report.json` of a search for missing effects |
//! | [`CaseRecord`] | the case within a result |
//! | [`pack`] | numbers in the form that scripts of pages read |
//! | [`Datum`], [`DocumentKind`] | any document as a tree of data, and its kind |
//!
//! ```
//! use kufe::results::{Measured, PeakPressure};
//! let peak = Measured::<PeakPressure>::new(138.5e6, 0.4e6);
//! assert_eq!(peak.to_string(), "138.50 ± 0.40 MPa");
//! assert_eq!(serde_json::to_string(&peak)?, r#"{"p_max_pa":138500000.0,"p_max_error_pa":400000.0}"#);
//! # Ok::<(), serde_json::Error>(())
//! ```

mod bodies;
mod comparison;
mod contact;
mod datum;
mod document;
mod figures;
pub mod finding;
mod friction;
pub(crate) mod label;
mod pack;
mod quantity;
mod record;
mod runs;
mod series;
mod table;

pub use bodies::*;
pub use comparison::*;
pub use contact::*;
pub use datum::{Data, Datum};
pub use document::DocumentKind;
pub use figures::{Figure, error_in, measured_in};
pub use friction::*;
pub use label::{name_of, unit_in, without_unit};
pub use pack::{Packed, pack};
pub use quantity::*;
pub use record::{CaseRecord, write_csv};
pub use runs::*;
pub use series::*;
pub use table::*;
