//! Contact mechanics and dynamics of bobsled and luge runners on ice.
//!
//! | module | contents |
//! |---|---|
//! | [`case`] | `case.toml`: one contact problem, validated |
//! | [`jobs`] | press a case, slide it, sweep it into a table, read runs |
//! | [`results`] | results as typed documents |
//! | [`charts`], [`plot`] | pictures of results, and the style they share |
//! | [`report`] | results as one self-contained page |

pub mod case;
pub mod charts;
pub mod jobs;
pub mod plot;
pub mod report;
pub mod results;
