//! How a search is made.

/// How a search is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Twins a look.
    pub twins: u64,
    /// Sign-flips a look.
    pub flips: usize,
    /// Whether the longitudinal channel of runs takes part.
    pub longitudinal: bool,
    /// Whether the lateral channels of runs take part.
    pub lateral: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            seed: 1,
            twins: 40,
            flips: 1999,
            longitudinal: true,
            lateral: true,
        }
    }
}
