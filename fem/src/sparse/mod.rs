//! The stiffness stored: its graph, its assembly and its Cholesky factor.

pub mod assembly;
pub mod block_matrix;
pub mod cholesky;
pub mod dissection;
pub mod node_graph;
