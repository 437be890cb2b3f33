//! Benchmarks.
//!
//! | program | measurement |
//! |---|---|
//! | `solver` | contact and linear solves: time, memory, unknowns, iterations |
//! | `limits` | the solver's kernels relative to the machine's bandwidth and faer's matrix products |
//! | `fields` | one field, 64 fields, and fields for other programs to compare with |
//! | `elastic` | elastic runners over shapes, tracks and mounts |
//! | `real_time` | speed of the driving simulation relative to real time, evaluation of a fitted hull |
//! | `lookup` | one evaluation of a table |
//! | `growth` | cost as a function of size, with exponents and a chart |
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
pub use measured::{Cost, best_of, cpu_seconds, measure_again, peak_bytes, run_again};
pub use needle::{ICE, NeedleBlock, needle_block};
pub use table::{pressure_table, random_queries, table_of};
