//! The two orders of displacements: component after component, and node by node.

/// From component after component to node by node.
pub(crate) fn to_nodes(u: &[f64], out: &mut [f64]) {
    let nodes = u.len() / 3;
    for (node, values) in out.chunks_exact_mut(3).enumerate() {
        values.copy_from_slice(&[u[node], u[nodes + node], u[2 * nodes + node]]);
    }
}

/// From node by node to component after component.
pub(crate) fn to_components(u: &[f64], out: &mut [f64]) {
    let nodes = u.len() / 3;
    for (node, values) in u.chunks_exact(3).enumerate() {
        for c in 0..3 {
            out[c * nodes + node] = values[c];
        }
    }
}
