//! Benchmarks.
//!
//! | program | what it measures |
//! |---|---|
//! | `solver` | contact and linear solves: time, memory, unknowns, iterations |
//! | `limits` | the solver's kernels against the machine's bandwidth and faer's matrix products |
//! | `fields` | one field, 64 fields, and fields for other programs to compare with |
//! | `elastic` | elastic runners over shapes, tracks and mounts |
//! | `real_time` | the driving simulation against the clock, the height of a fitted hull |
//! | `lookup` | one evaluation of a table |
//! | `growth` | cost against size, with exponents and a picture |
//! | `guard` | four fixed small cases whose instructions are counted |
//!
//! ```
//! let (seconds, sum) = kufe_benches::best_of(3, || (0..1000u64).sum::<u64>());
//! assert!(seconds > 0.0 && sum == 499_500);
//! ```

mod chart;
mod half_space;
mod measured;
mod needle;
mod table;

pub use chart::{Line, growth_figure, growth_panel};
pub use half_space::on_half_space;
pub use measured::{Cost, again, best_of, cpu_seconds, peak_bytes};
pub use needle::{ICE, NeedleBlock, needle_block};
pub use table::{pressure_table, random_queries, table_of};
