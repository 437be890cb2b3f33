//! Effects with their sizes.

use kufe::case::effects::Effect;

/// Effects with their sizes, in the order in which they were found.
pub type SizedEffects = Vec<(&'static Effect, f64)>;
