//! Boundary elements, alone and verified by finite elements.

mod alone;
mod anchored;
