//! What the contact iteration asks of an elastic body.

use faer::Mat;

/// An elastic body under or over the contact plane, with a preconditioner M of its stiffness K.
///
/// Plane values have one number for each node of the contact plane, x fastest; B takes displacements to the closing of
/// the gap on the plane, so its vertical displacements with the sign of the body's side. Displacement vectors hold
/// component after component.
pub(crate) trait ElasticBody: Sync {
    /// Length of a displacement vector.
    fn len(&self) -> usize;

    /// Unknowns that nothing holds.
    fn free_dofs(&self) -> usize;

    /// `out` = K `u`, with 0 on held entries.
    fn apply(&self, u: &[f64], out: &mut [f64]);

    /// `closing` += B `u`.
    fn add_closing(&self, u: &[f64], closing: &mut [f64]);

    /// `out` += B^T f for the forces (node, value).
    fn add_forces(&self, forces: &[(usize, f64)], out: &mut [f64]);

    /// `closing` += B M^-1 `residual`, and keeps M^-1 `residual` for [`ElasticBody::finish`].
    fn begin(&self, residual: &[f64], closing: &mut [f64]);

    /// `step` = M^-1 (residual - B^T m) for the residual last given to [`ElasticBody::begin`] and the forces m on nodes.
    fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64]);

    /// B M^-1 B^T between plane nodes, and the estimate of B K^-1 B^T that contact sets are predicted with.
    fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2];

    /// Forces from outside on the body [N]; none where empty.
    fn load(&self) -> &[f64];
}
