//! Benchmarks.
//!
//! | program | what it measures |
//! |---|---|
//! | `solver` | contact and linear solves: time, memory, unknowns, iterations |
//!
//! ```
//! let (seconds, sum) = kufe_benches::best_of(3, || (0..1000u64).sum::<u64>());
//! assert!(seconds > 0.0 && sum == 499_500);
//! ```

mod measured;

pub use measured::{Cost, again, best_of, peak_bytes};
