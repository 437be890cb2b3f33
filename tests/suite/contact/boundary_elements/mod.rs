//! Boundary elements: by themselves, and between contacts that finite elements have confirmed.

mod alone;
mod anchored;
