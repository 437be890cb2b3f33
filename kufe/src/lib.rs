//! Contact mechanics and dynamics of bobsled and luge runners on ice.
//!
//! | item | contents |
//! |---|---|
//! | [`Contact`] | one contact problem, from a runner, ice and a load to its solution |
//! | [`case`] | `case.toml`: one contact problem, validated |
//! | [`jobs`] | press a case, slide it, sweep it into a table, read runs |
//! | [`results`] | results as typed documents |
//! | [`charts`], [`plot`] | pictures of results, and the style they share |
//! | [`report`] | results as one self-contained page |
//!
//! ```
//! use kufe::Contact;
//! use kufe::case::{IceTable, Shape};
//!
//! # fn main() -> Result<(), kufe::jobs::Failure> {
//! let runner = Shape::Paraboloid { rocker_radius_m: 30.0, section_radius_m: 0.005 };
//! let ice = IceTable::half_space(9.0e9, 0.33);
//! let result = Contact::new(runner, ice).load(1000.0).solve()?.result();
//! println!("peak pressure {}", result.p_max);
//! println!("contact {} x {}", result.length, result.width);
//! // Hertz: 138.52 MPa.
//! assert!((result.p_max.value - 138.52e6).abs() < result.p_max.error);
//! # Ok(())
//! # }
//! ```

pub mod case;
pub mod charts;
pub mod jobs;
pub mod plot;
pub mod report;
pub mod results;

pub use jobs::Contact;
