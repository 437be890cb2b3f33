//! The stored stiffness: its graph, its assembly, its product and its Cholesky factor.

pub mod assembly;
pub mod cholesky;
pub mod graph;
pub mod stiffness;
