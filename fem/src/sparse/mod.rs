//! The stiffness stored: its graph, its assembly, its product and its Cholesky factor.

pub mod assembly;
pub mod block_matrix;
pub mod cholesky;
pub mod dissection;
pub mod matrix_market;
pub mod node_cells;
pub mod node_graph;
pub mod stiffness;
