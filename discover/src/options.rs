//! How a search is made.

use crate::procedure::rules::Rules;

/// How a search is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Simulated runs or tables in which nothing is missing, a screen.
    pub twins: u64,
    /// Sign-flips or permutations a screen.
    pub flips: usize,
    /// Whether the longitudinal channel of runs takes part.
    pub longitudinal: bool,
    /// Whether the lateral channels of runs take part.
    pub lateral: bool,
    /// Whether runs with gaps are refused rather than used without what stands beside the gaps.
    pub strict: bool,
    /// Every constant of judgement.
    pub rules: Rules,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            seed: 1,
            twins: 40,
            flips: 1999,
            longitudinal: true,
            lateral: true,
            strict: false,
            rules: Rules::default(),
        }
    }
}
