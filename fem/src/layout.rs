//! The two layouts of a displacement vector: three numbers a node, or component after component.
//!
//! Bodies and their matrices go node by node, tensor grids component by component.

/// `out` = `u` node by node, from component after component; both hold three numbers a node.
///
/// ```
/// let mut by_node = [0.0; 6];
/// kufe_fem::to_nodes(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], &mut by_node);
/// assert_eq!(by_node, [1.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
/// ```
///
/// # Panics
/// Where `u` is shorter than `out`.
pub fn to_nodes(u: &[f64], out: &mut [f64]) {
    let nodes = u.len() / 3;
    for (node, values) in out.chunks_exact_mut(3).enumerate() {
        values.copy_from_slice(&[u[node], u[nodes + node], u[2 * nodes + node]]);
    }
}

/// `out` = `u` component after component, from node by node: the inverse of [`to_nodes`].
///
/// # Panics
/// Where `out` is shorter than `u`.
pub fn to_components(u: &[f64], out: &mut [f64]) {
    let nodes = u.len() / 3;
    for (node, values) in u.chunks_exact(3).enumerate() {
        for c in 0..3 {
            out[c * nodes + node] = values[c];
        }
    }
}
