//! The search: fit, screen, select, add, refit; at the end, once, the held-out data.

pub(crate) mod candidate;
pub(crate) mod closed;
pub(crate) mod evidence;
pub(crate) mod lock;
pub(crate) mod misfit_decrease;
pub(crate) mod rivals;
pub(crate) mod rules;
pub(crate) mod search;
pub(crate) mod sentence;
pub(crate) mod shared_effects;
pub(crate) mod verdict;
pub(crate) mod verification;

pub use lock::LockRules;
pub use rivals::RivalRule;
pub use rules::{ExperimentRules, MapRules, Rules, RunRules, SearchRules};
pub use search::Found;
