//! Prescribed displacements, symmetry planes, and the numbering of the free displacements.

use std::collections::BTreeMap;

use crate::error::Error;

/// Displacements that are prescribed, zero or not.
///
/// ```
/// let mut constraints = kufe_fem::Constraints::new(10);
/// constraints.clamp([0, 1])?;                 // all three components zero
/// constraints.symmetry([2, 3], 1)?;           // on the plane y = 0: no displacement across it
/// constraints.prescribe(9, 2, -1e-3)?;        // pushed down by a millimetre
/// assert_eq!(constraints.dof_map().free_count(), 30 - 6 - 2 - 1);
/// # Ok::<(), kufe_fem::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Constraints {
    node_count: usize,
    values: BTreeMap<u32, f64>,
}

impl Constraints {
    /// Nothing prescribed, on a mesh with `node_count` nodes.
    pub fn new(node_count: usize) -> Self {
        Self {
            node_count,
            values: BTreeMap::new(),
        }
    }

    /// Prescribes one component (0, 1, 2 for x, y, z) of a node's displacement [m].
    ///
    /// Fails if node or component do not exist, the value is not finite, or the displacement
    /// already has another value.
    pub fn prescribe(&mut self, node: usize, component: usize, value: f64) -> Result<(), Error> {
        if node >= self.node_count || component > 2 || !value.is_finite() {
            return Err(Error::Prescribed {
                node,
                component,
                value,
                node_count: self.node_count,
            });
        }
        let first = *self
            .values
            .entry((3 * node + component) as u32)
            .or_insert(value);
        if first != value {
            return Err(Error::PrescribedTwice {
                node,
                component,
                first,
                second: value,
            });
        }
        Ok(())
    }

    /// Fixes all three components of these nodes at zero. Fails as [`Constraints::prescribe`].
    pub fn clamp(&mut self, nodes: impl IntoIterator<Item = usize>) -> Result<(), Error> {
        for node in nodes {
            for component in 0..3 {
                self.prescribe(node, component, 0.0)?;
            }
        }
        Ok(())
    }

    /// Puts nodes on a symmetry plane with the normal `axis` (0, 1, 2): no displacement along it,
    /// no shear traction. Fails as [`Constraints::prescribe`].
    pub fn symmetry(
        &mut self,
        nodes: impl IntoIterator<Item = usize>,
        axis: usize,
    ) -> Result<(), Error> {
        for node in nodes {
            self.prescribe(node, axis, 0.0)?;
        }
        Ok(())
    }

    /// The prescribed displacements as (3 * node + component, value [m]), ascending.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.values
            .iter()
            .map(|(&dof, &value)| (dof as usize, value))
    }

    /// Sets the prescribed entries of a vector to their values.
    pub fn write_values(&self, u: &mut [f64]) {
        for (dof, value) in self.iter() {
            u[dof] = value;
        }
    }

    /// The free displacements, numbered in the order of the nodes.
    pub fn dof_map(&self) -> DofMap {
        let mut index = vec![0; 3 * self.node_count];
        for (dof, _) in self.iter() {
            index[dof] = FIXED;
        }
        let mut free = Vec::with_capacity(index.len() - self.values.len());
        for (dof, place) in index.iter_mut().enumerate() {
            if *place != FIXED {
                *place = free.len() as u32;
                free.push(dof as u32);
            }
        }
        DofMap { index, free }
    }
}

const FIXED: u32 = u32::MAX;

/// Numbering of the free displacements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DofMap {
    index: Vec<u32>,
    free: Vec<u32>,
}

impl DofMap {
    /// Number of displacements, free or prescribed.
    pub fn dofs(&self) -> usize {
        self.index.len()
    }

    /// Number of free displacements.
    pub fn free_count(&self) -> usize {
        self.free.len()
    }

    /// The free displacements as 3 * node + component, ascending.
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// Index of displacement `dof` among the free ones; `None` if it is prescribed.
    pub fn index(&self, dof: usize) -> Option<usize> {
        let index = self.index[dof];
        (index != FIXED).then_some(index as usize)
    }

    /// The free entries of a full vector.
    pub fn restrict(&self, full: &[f64]) -> Vec<f64> {
        self.free.iter().map(|&dof| full[dof as usize]).collect()
    }

    /// Writes free entries into a full vector, leaving the prescribed ones.
    pub fn extend(&self, free: &[f64], full: &mut [f64]) {
        for (&dof, &value) in self.free.iter().zip(free) {
            full[dof as usize] = value;
        }
    }
}

/// `out` = `u` reordered by nodes, from `u` by components; both hold three numbers per node.
///
/// ```
/// let mut by_node = [0.0; 6];
/// kufe_fem::to_nodes(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], &mut by_node);
/// assert_eq!(by_node, [1.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
/// ```
///
/// # Panics
/// If `u` is shorter than `out`.
pub fn to_nodes(u: &[f64], out: &mut [f64]) {
    let nodes = u.len() / 3;
    for (node, values) in out.chunks_exact_mut(3).enumerate() {
        values.copy_from_slice(&[u[node], u[nodes + node], u[2 * nodes + node]]);
    }
}

/// `out` = `u` reordered by components, from `u` by nodes: the inverse of [`to_nodes`].
///
/// # Panics
/// If `out` is shorter than `u`.
pub fn to_components(u: &[f64], out: &mut [f64]) {
    let nodes = u.len() / 3;
    for (node, values) in u.chunks_exact(3).enumerate() {
        for c in 0..3 {
            out[c * nodes + node] = values[c];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contradictions_and_missing_nodes_are_refused() {
        let mut constraints = Constraints::new(4);
        constraints.prescribe(1, 2, 0.5).unwrap();
        constraints.prescribe(1, 2, 0.5).unwrap();
        assert_eq!(
            constraints.symmetry([1], 2).unwrap_err(),
            Error::PrescribedTwice {
                node: 1,
                component: 2,
                first: 0.5,
                second: 0.0
            }
        );
        for (node, component, value) in [(4, 0, 0.0), (0, 3, 0.0), (0, 0, f64::NAN)] {
            let error = constraints.prescribe(node, component, value).unwrap_err();
            assert!(matches!(error, Error::Prescribed { .. }), "{error}");
        }
    }

    #[test]
    fn restricting_what_was_extended_gives_it_back() {
        let mut constraints = Constraints::new(3);
        constraints.clamp([1]).unwrap();
        let map = constraints.dof_map();
        let free: Vec<f64> = (0..6).map(f64::from).collect();
        let mut full = vec![-1.0; 9];
        map.extend(&free, &mut full);
        assert_eq!(full, [0.0, 1.0, 2.0, -1.0, -1.0, -1.0, 3.0, 4.0, 5.0]);
        assert_eq!(map.restrict(&full), free);
        assert_eq!(
            (map.index(2), map.index(3), map.index(6)),
            (Some(2), None, Some(3))
        );
    }
}
