//! What applications of a preconditioner write to.

/// Vectors that applications reuse.
#[derive(Default)]
pub(crate) struct InverseWork {
    /// What a beginning leaves for its finish: modal values, or the residual itself.
    pub kept: Vec<f64>,
    /// What a beginning leaves for its finish of the motions of a beam.
    pub motion: Vec<f64>,
    pub scratch: Vec<f64>,
    /// A vector node by node.
    pub by_node: Vec<f64>,
    /// Sums of a projection's tasks.
    pub sums: Vec<f64>,
}
